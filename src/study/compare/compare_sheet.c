/* Draws the last frames of the methods, coloured by distance to the reference. */
#include "study/compare/compare.h"

#include "base/file.h"
#include "base/install_paths.h"
#include "draw/look.h"
#include "io/png.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TILE_WIDTH = 400, TILE_HEIGHT = 300, TILES_MAX = 64, SHEETS = 2 };
/* colours of a map; bytes of a tile's file, at most */
enum { STOPS = 6, TILE_BYTES_MAX = 1 << 22 };

/* The cells of one sheet, one per series at most. */
struct sheet {
    const char *kind, *title;
    const struct cs_cell *cells[TILES_MAX];
    uint32_t n;
    double range[2]; /* log10 m */
};

/* FOLDER/pictures/KIND_SERIES.png */
static void tile_path(const struct sheet *sheet, const struct cs_cell *cell,
                      const struct cs_compare *compare, char *path, size_t size) {
    char file[CS_SERIES_BYTES];
    cs_series_file_name(cell->series, file);
    snprintf(path, size, "%s/pictures/%s_%s.png", compare->settings->folder, sheet->kind, file);
}

/* True for the first cell of a series. */
static bool is_first_of_series(const struct cs_compare *compare, uint32_t k) {
    const struct cs_cell *cells = compare->cells.cells;
    return k == 0 || !cs_cell_same_series(cells + k, cells + k - 1);
}

/* True for a finished cell with that step, equal up to rounding of its text. */
static bool has_step(const struct cs_cell *cell, double step) {
    return cs_cell_is_finished(cell) && !cell->adaptive && fabs(cell->value / step - 1) < 1e-6;
}

/* Chooses the step with most finished methods, of two the longer one. */
static void choose_step(struct sheet *sheet, const struct cs_compare *compare) {
    const struct cs_cell_list *list = &compare->cells;
    double best = (double)NAN;
    uint32_t most = 0;
    for (uint32_t k = 0; k < list->n; k++) {
        uint32_t n = 0;
        for (uint32_t i = 0; i < list->n; i++)
            n += has_step(list->cells + i, list->cells[k].value);
        if (n > most || (n == most && list->cells[k].value > best)) {
            most = n;
            best = list->cells[k].value;
        }
    }
    for (uint32_t k = 0; k < list->n && sheet->n < TILES_MAX; k++)
        if (has_step(list->cells + k, best))
            sheet->cells[sheet->n++] = list->cells + k;
}

/* Cost in s that every method can keep: the largest of the methods' cheapest cells. */
static double common_cost(const struct cs_compare *compare) {
    const struct cs_cell_list *list = &compare->cells;
    double cost = 0, least = HUGE_VAL;
    for (uint32_t k = 0; k <= list->n; k++) {
        if (k == list->n || is_first_of_series(compare, k)) {
            cost = least < HUGE_VAL ? fmax(cost, least) : cost;
            least = HUGE_VAL;
        }
        if (k < list->n && cs_cell_is_finished(list->cells + k))
            least = fmin(least, list->cells[k].cpu);
    }
    return cost;
}

/* Chooses the most expensive cell of each series within the common cost: its best result. */
static void choose_cost(struct sheet *sheet, const struct cs_compare *compare) {
    const struct cs_cell_list *list = &compare->cells;
    const double cost = common_cost(compare);
    const struct cs_cell *best = NULL;
    for (uint32_t k = 0; k <= list->n; k++) {
        if ((k == list->n || is_first_of_series(compare, k)) && best && sheet->n < TILES_MAX) {
            sheet->cells[sheet->n++] = best;
            best = NULL;
        }
        const struct cs_cell *cell = list->cells + k;
        if (k < list->n && cs_cell_is_finished(cell) && cell->cpu <= cost &&
            (!best || cell->cpu > best->cpu))
            best = cell;
    }
}

/* Renders one tile with a scalar per particle. */
static enum cs_status paint(struct cs_recorded_run *recording, const struct cs_frame *frame,
                            enum cs_renderer_kind kind, const char *path,
                            struct cs_error *error) {
    struct cs_scene *scene = &recording->session.scene;
    const struct cs_renderer *renderer = NULL;
    struct cs_canvas *canvas = NULL;
    struct cs_image image = {TILE_WIDTH, TILE_HEIGHT, malloc(3 * TILE_WIDTH * TILE_HEIGHT),
                             NULL};
    struct cs_image *textures = calloc(scene->bodies.n, sizeof *textures);
    const struct cs_canvas_settings settings = {.scene = scene,
                                                .system = &recording->session.system,
                                                .textures = textures,
                                                .colliders = frame->colliders};
    scene->render.size[0] = TILE_WIDTH;
    scene->render.size[1] = TILE_HEIGHT;
    scene->render.look = CS_LOOK_FORCE; // colours of what has no sign
    if (!image.rgb || !textures || !frame->colliders)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a picture");
    else if (!cs_renderer_open(cs_renderer_folder(), kind, &renderer, error) &&
             !renderer->create(&settings, &canvas, error) &&
             !renderer->paint(canvas, frame, &image, error)) {
        cs_png_write(path, &image, 6, NULL, 0, error);
    }
    if (renderer)
        renderer->destroy(canvas);
    free(textures);
    free(image.rgb);
    return error->status;
}

/* Draws the reference. frame: of a method, with distances of 0. */
static enum cs_status draw_reference(const struct sheet *sheet,
                                     const struct cs_compare *compare,
                                     struct cs_recorded_run *recording, struct cs_frame frame,
                                     enum cs_renderer_kind kind, struct cs_error *error) {
    const struct cs_trajectory *trajectory = &compare->reference.trajectory;
    char path[4400];
    snprintf(path, sizeof path, "%s/pictures/%s_reference.png", compare->settings->folder,
             sheet->kind);
    frame.x = cs_trajectory_state(trajectory, trajectory->frames);
    return paint(recording, &frame, kind, path, error);
}

/* Runs a cell again and draws its last frame: a comparison stores no states of its cells. The
 * reference is drawn with the first. */
static enum cs_status draw_tile(const struct sheet *sheet, const struct cs_cell *cell,
                                const struct cs_compare *compare, enum cs_renderer_kind kind,
                                struct cs_error *error) {
    char integrator[CS_CELL_INTEGRATOR], path[4400];
    struct cs_recorded_run recording;
    struct cs_trajectory trajectory = {0};
    struct cs_recorded_run_result result;
    double *distance = calloc(compare->particles, sizeof *distance);
    struct cs_posed_collider *colliders = NULL;
    cs_cell_integrator(cell, integrator, sizeof integrator);
    tile_path(sheet, cell, compare, path, sizeof path);
    if (!distance)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the colours");
    else if (!cs_recorded_run_open(&recording, &compare->settings->run, integrator, error)) {
        if (!cs_trajectory_init(&trajectory, &recording, error) &&
            !cs_recorded_run_execute(&recording, 0, &trajectory, &result, error) &&
            trajectory.n_recorded == trajectory.frames) {
            const double *x = cs_trajectory_state(&trajectory, trajectory.frames);
            cs_distance_each(
                trajectory.n, x,
                cs_trajectory_state(&compare->reference.trajectory, trajectory.frames),
                distance);
            for (uint32_t i = 0; i < trajectory.n; i++)
                distance[i] = log10(fmax(distance[i], pow(10, sheet->range[0])));
            const struct cs_system *system = &recording.session.system;
            colliders = calloc(system->scene->colliders.n + 1, sizeof *colliders);
            if (colliders)
                cs_posed_colliders_at(system, compare->time, colliders);
            /* no time: what viewpoint forces saw was forgotten at the end of the run */
            const struct cs_frame frame = {.x = x,
                                           .scalar = distance,
                                           .range = {sheet->range[0], sheet->range[1]},
                                           .inv_mass = system->inv_mass,
                                           .colliders = colliders};
            paint(&recording, &frame, kind, path, error);
            for (uint32_t i = 0; i < compare->particles; i++)
                distance[i] = sheet->range[0];
            if (!error->status && cell == sheet->cells[0])
                draw_reference(sheet, compare, &recording, frame, kind, error);
        }
        cs_trajectory_finish(&trajectory);
        cs_recorded_run_close(&recording);
    }
    free(colliders);
    free(distance);
    return error->status;
}

/* Range of colours in log10 m, one for all sheets: from the smallest error, or the reference's
 * bar, to the largest. */
static void set_range(struct sheet sheets[SHEETS], const struct cs_compare *compare) {
    double least = HUGE_VAL, most = 0;
    for (int s = 0; s < SHEETS; s++)
        for (uint32_t k = 0; k < sheets[s].n; k++) {
            least = fmin(least, sheets[s].cells[k]->error);
            most = fmax(most, sheets[s].cells[k]->max_error);
        }
    for (int s = 0; s < SHEETS; s++) {
        sheets[s].range[0] = floor(log10(fmax(least, compare->reference.error_bar)));
        sheets[s].range[1] = fmax(ceil(log10(most)), sheets[s].range[0] + 1);
    }
}

/* Chooses the cells of both sheets and their range; none without errors of position. */
static void choose_sheets(struct sheet sheets[SHEETS], const struct cs_compare *compare) {
    sheets[0] = (struct sheet){.kind = "equal_step", .title = "Equal step"};
    sheets[1] = (struct sheet){.kind = "equal_cost", .title = "Equal cost"};
    if (!compare->reference.pointwise)
        return;
    choose_step(sheets + 0, compare);
    choose_cost(sheets + 1, compare);
    set_range(sheets, compare);
}

static enum cs_status write_sheet(const struct sheet *sheet, const struct cs_compare *compare,
                                  enum cs_renderer_kind kind, struct cs_error *error) {
    char path[4200];
    snprintf(path, sizeof path, "%s/pictures", compare->settings->folder);
    if (sheet->n == 0 || cs_folder_create(path, error))
        return error->status;
    for (uint32_t k = 0; k < sheet->n && !error->status; k++)
        draw_tile(sheet, sheet->cells[k], compare, kind, error);
    return error->status;
}

enum cs_status cs_compare_contact_sheet_write(struct cs_compare *compare,
                                              enum cs_renderer_kind kind,
                                              struct cs_error *error) {
    struct sheet sheets[SHEETS];
    choose_sheets(sheets, compare);
    for (int s = 0; s < SHEETS && !error->status; s++)
        write_sheet(sheets + s, compare, kind, error);
    return error->status;
}

/* --- in reports --- */

/* Begins a figure with the picture of a file; false, and nothing added, where it cannot be
 * read. */
static bool begin_figure(const char *path, struct cs_text *out) {
    char *bytes;
    size_t length;
    struct cs_error unread = {0};
    if (cs_file_read(path, TILE_BYTES_MAX, &bytes, &length, &unread))
        return false;
    /* in the page itself: it needs no other file */
    cs_text_add(out, "<figure><img alt=\"\" src=\"data:image/png;base64,");
    cs_text_add_base64(out, bytes, length);
    cs_text_add(out, "\"><figcaption>");
    free(bytes);
    return true;
}

/* Adds the reference and the tiles of a sheet with their captions. */
static void add_strip(const struct sheet *sheet, const struct cs_compare *compare,
                      struct cs_text *out) {
    char path[4400];
    cs_text_add(out, "<h3>%s</h3>\n<div class=\"strip\">\n", sheet->title);
    snprintf(path, sizeof path, "%s/pictures/%s_reference.png", compare->settings->folder,
             sheet->kind);
    if (begin_figure(path, out))
        cs_text_add(out, "reference<br>known to %.1e m</figcaption></figure>\n",
                    compare->reference.error_bar);
    for (uint32_t k = 0; k < sheet->n; k++) {
        const struct cs_cell *cell = sheet->cells[k];
        tile_path(sheet, cell, compare, path, sizeof path);
        if (!begin_figure(path, out))
            continue;
        cs_text_add_html(out, cell->series);
        cs_text_add(out, "<br>%s %.3g, %.3g ms, error %.1e m</figcaption></figure>\n",
                    cell->control, cell->value, 1e3 * cell->cpu, cell->error);
    }
    cs_text_add(out, "</div>\n");
}

void cs_compare_contact_sheet_add_html(const struct cs_compare *compare, struct cs_text *out) {
    const uint32_t *stops = cs_look_of(CS_LOOK_FORCE)->stops;
    struct sheet sheets[SHEETS];
    choose_sheets(sheets, compare);
    if (!compare->settings->pictures || !sheets[1].n)
        return;
    /* one bar for both strips, which have one range */
    cs_text_add(out,
                "<h2>Pictures</h2>\n<div class=\"bar\"><span>1e%.0f m</span>"
                "<i style=\"background:linear-gradient(90deg",
                sheets->range[0]);
    for (int k = 0; k < STOPS; k++)
        cs_text_add(out, ",#%06x", stops[k]);
    cs_text_add(out,
                ")\"></i><span>1e%.0f m: distance to the reference after %.4g s</span></div>\n",
                sheets->range[1], compare->time);
    for (int s = 0; s < SHEETS; s++)
        add_strip(sheets + s, compare, out);
}

void cs_compare_contact_sheet_add_markdown(const struct cs_compare *compare,
                                           struct cs_text *out) {
    struct sheet sheets[SHEETS];
    choose_sheets(sheets, compare);
    for (int s = 0; s < SHEETS && compare->settings->pictures; s++) {
        if (!sheets[s].n)
            continue;
        cs_text_add(
            out,
            "## %s\n\nColours: distance to the reference after %.4g s, from 1e%.0f m to "
            "1e%.0f m.\n\n| | |\n|---|---|\n| ![](pictures/%s_reference.png) | "
            "reference, known to %.1e m |\n",
            sheets[s].title, compare->time, sheets[s].range[0], sheets[s].range[1],
            sheets[s].kind, compare->reference.error_bar);
        for (uint32_t k = 0; k < sheets[s].n; k++) {
            const struct cs_cell *cell = sheets[s].cells[k];
            char file[CS_SERIES_BYTES];
            cs_series_file_name(cell->series, file);
            cs_text_add(out, "| ![](pictures/%s_%s.png) | ", sheets[s].kind, file);
            cs_text_add_markdown(out, cell->series);
            cs_text_add(out, ", %s %.3g, %.3g ms, error %.1e m |\n", cell->control, cell->value,
                        1e3 * cell->cpu, cell->error);
        }
        cs_text_add(out, "\n");
    }
}
