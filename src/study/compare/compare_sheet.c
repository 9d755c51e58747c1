/* Draws the last frames of the methods, coloured by distance to the reference. */
#include "study/compare/compare.h"

#include "base/file.h"
#include "session/frame_picture.h"
#include "session/scene_view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TILE_WIDTH = 400, TILE_HEIGHT = 300, TILES_MAX = 64, SHEETS = 2 };
enum { STOPS = 6 /* colours of a map */, PATH_BYTES = 4400 };

/* The cells of one sheet, one per series at most. */
struct sheet {
    const char *kind, *title;
    const struct cs_cell *cells[TILES_MAX];
    uint32_t n;
    double range[2]; /* log10 m */
};

/* FOLDER/pictures/KIND_SERIES.png; cell NULL: FOLDER/pictures/KIND_reference.png. */
static void tile_path(const struct sheet *sheet, const struct cs_cell *cell,
                      const struct cs_compare *compare, char path[PATH_BYTES]) {
    char series[CS_SERIES_BYTES] = "reference";
    if (cell)
        cs_series_file_name(cell->series, series);
    snprintf(path, PATH_BYTES, "%s/pictures/%s_%s.png", compare->settings->folder, sheet->kind,
             series);
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

/* Chooses the best cell of each series, its most expensive one, within the cost in s that every
 * method can keep: the largest of the methods' cheapest cells. */
static void choose_cost(struct sheet *sheet, const struct cs_compare *compare) {
    const struct cs_cell *begin = compare->cells.cells, *end = begin + compare->cells.n;
    double cost = 0;
    for (int pass = 0; pass < 2; pass++) {
        const struct cs_cell *best = NULL;
        for (const struct cs_cell *cell = begin; cell < end; cell++) {
            if (cs_cell_is_finished(cell) &&
                (pass ? cell->cpu <= cost && (!best || cell->cpu > best->cpu)
                      : !best || cell->cpu < best->cpu))
                best = cell;
            if (cell + 1 < end && cs_cell_same_series(cell, cell + 1))
                continue;
            if (best && pass == 0)
                cost = fmax(cost, best->cpu);
            else if (best && sheet->n < TILES_MAX)
                sheet->cells[sheet->n++] = best;
            best = NULL;
        }
    }
}

/* Shared by the tiles of all cells; then the end of the run of one. */
struct tile {
    const struct cs_compare *compare;
    enum cs_renderer_kind kind;
    struct cs_system *system;
    const struct cs_trajectory *trajectory;
};

/* Draws the last frame of a cell, and before that of a sheet's first cell the reference. */
static enum cs_status paint_end(const struct sheet *sheet, const struct cs_cell *cell,
                                const struct tile *tile, struct cs_error *error) {
    const struct cs_trajectory *trajectory = tile->trajectory,
                               *reference = &tile->compare->reference.trajectory;
    double *right = cs_trajectory_state(reference, reference->frames),
           *distance = calloc(trajectory->n, sizeof *distance);
    struct cs_run run = {.system = tile->system, .t = tile->compare->time};
    if (!distance)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the colours");
    for (int own = cell != sheet->cells[0]; own < 2 && !error->status; own++) {
        char path[PATH_BYTES];
        struct cs_image image = {0};
        struct cs_text renderer = {0};
        run.x = own ? cs_trajectory_state(trajectory, trajectory->frames) : right;
        cs_distance_each(trajectory->n, run.x, right, distance);
        for (uint32_t i = 0; i < trajectory->n; i++)
            distance[i] = log10(fmax(distance[i], pow(10, sheet->range[0])));
        tile_path(sheet, own ? cell : NULL, tile->compare, path);
        if (!cs_snapshot_draw(&run, distance, tile->kind, &image, &renderer, error))
            cs_png_write(path, &image, 6, NULL, 0, error);
        free(image.rgb);
        cs_text_finish(&renderer);
    }
    free(distance);
    return error->status;
}

/* Runs a cell again and draws it: a comparison stores no states of its cells. */
static enum cs_status draw_tile(const struct sheet *sheet, const struct cs_cell *cell,
                                struct tile tile, struct cs_error *error) {
    char integrator[CS_CELL_INTEGRATOR];
    struct cs_recorded_run recording;
    struct cs_trajectory trajectory = {0};
    struct cs_recorded_run_result result;
    cs_cell_integrator(cell, integrator, sizeof integrator);
    if (cs_recorded_run_open(&recording, &tile.compare->settings->run, integrator, error))
        return error->status;
    struct cs_render *render = recording.session.scene->render;
    render->size[0] = TILE_WIDTH;
    render->size[1] = TILE_HEIGHT;
    render->look = CS_LOOK_FORCE; // colours of what has no sign
    memcpy(render->range, sheet->range, sizeof render->range);
    render->marks.particles.n = 0;
    render->viewpoint_forces = false; // what they saw was forgotten at the end of the run
    tile.system = &recording.session.system;
    tile.trajectory = &trajectory;
    if (!cs_trajectory_init(&trajectory, &recording, error) &&
        !cs_recorded_run_execute(&recording, 0, &trajectory, &result, error) &&
        trajectory.n_recorded == trajectory.frames)
        paint_end(sheet, cell, &tile, error);
    cs_trajectory_finish(&trajectory);
    cs_recorded_run_close(&recording);
    return error->status;
}

/* Chooses the cells of both sheets; none without errors of position. Sets the range of colours
 * in log10 m, one for both: from the smallest error, or the reference's bar, to the largest. */
static void choose_sheets(struct sheet sheets[SHEETS], const struct cs_compare *compare) {
    double least = HUGE_VAL, most = 0;
    sheets[0] = (struct sheet){.kind = "equal_step", .title = "Equal step"};
    sheets[1] = (struct sheet){.kind = "equal_cost", .title = "Equal cost"};
    if (!compare->reference.pointwise || !compare->settings->pictures)
        return;
    choose_step(sheets + 0, compare);
    choose_cost(sheets + 1, compare);
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

enum cs_status cs_compare_contact_sheet_write(struct cs_compare *compare,
                                              enum cs_renderer_kind kind,
                                              struct cs_error *error) {
    struct sheet sheets[SHEETS];
    char path[PATH_BYTES];
    const struct tile tile = {.compare = compare, .kind = kind};
    choose_sheets(sheets, compare);
    snprintf(path, PATH_BYTES, "%s/pictures", compare->settings->folder);
    for (const struct sheet *s = sheets; s < sheets + SHEETS && !error->status; s++)
        if (s->n && !cs_folder_create(path, error))
            for (uint32_t k = 0; k < s->n && !error->status; k++)
                draw_tile(s, s->cells[k], tile, error);
    return error->status;
}

/* --- in reports --- */

/* Adds the reference and the tiles of a sheet with their captions: figures of a page, or rows
 * of a table. */
static void add_tiles(const struct sheet *sheet, const struct cs_compare *compare, bool html,
                      struct cs_text *out) {
    const char *apart = html ? "<br>" : ", ";
    char path[PATH_BYTES];
    for (uint32_t k = 0; k <= sheet->n; k++) {
        const struct cs_cell *cell = k ? sheet->cells[k - 1] : NULL;
        tile_path(sheet, cell, compare, path);
        if (!html)
            cs_text_add(out, "| ![](pictures%s) | ", strrchr(path, '/'));
        else if (!cs_file_add_figure(path, "", out))
            continue;
        if (!cell)
            cs_text_add(out, "reference%sknown to %.1e m", apart, compare->reference.error_bar);
        else {
            (html ? cs_text_add_html : cs_text_add_markdown)(out, cell->series);
            cs_text_add(out, "%s%s %.3g, %.3g ms, error %.1e m", apart, cell->control,
                        cell->value, 1e3 * cell->cpu, cell->error);
        }
        cs_text_add(out, html ? "</figcaption></figure>\n" : " |\n");
    }
}

/* One bar of colours for all pictures, which have one range. */
static void add_bar(const struct sheet *sheet, struct cs_text *out) {
    const uint32_t *stops = cs_look_of(CS_LOOK_FORCE)->stops;
    cs_text_add(out,
                "<div class=\"bar\"><span>1e%.0f m</span>"
                "<i style=\"background:linear-gradient(90deg",
                sheet->range[0]);
    for (int k = 0; k < STOPS; k++)
        cs_text_add(out, ",#%06x", stops[k]);
    cs_text_add(out, ")\"></i><span>1e%.0f m</span></div>\n", sheet->range[1]);
}

void cs_compare_contact_sheet_add(const struct cs_compare *compare, bool html,
                                  struct cs_text *out) {
    struct sheet sheets[SHEETS];
    choose_sheets(sheets, compare);
    if (!sheets[1].n)
        return;
    cs_text_add(out,
                "%sPictures%sColours: distance to the reference after %.4g s, from 1e%.0f m to "
                "1e%.0f m.%s\n",
                html ? "<h2>" : "## ", html ? "</h2>\n<p>" : "\n\n", compare->time,
                sheets->range[0], sheets->range[1], html ? "</p>" : "\n");
    if (html)
        add_bar(sheets, out);
    for (const struct sheet *s = sheets; s < sheets + SHEETS; s++) {
        cs_text_add(
            out, html ? "<h3>%s</h3>\n<div class=\"strip\">\n" : "### %s\n\n| | |\n|---|---|\n",
            s->title);
        add_tiles(s, compare, html, out);
        cs_text_add(out, html ? "</div>\n" : "\n");
    }
}
