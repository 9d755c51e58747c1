/* Draws contact sheets: last frames of the methods, coloured by distance to the reference. */
#include "study/compare/compare.h"

#include "base/file.h"
#include "io/png.h"
#include "io/subprocess.h"
#include "sim/install_paths.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TILE_WIDTH = 400, TILE_HEIGHT = 300, TILES_MAX = 64, COLUMNS = 5 };

/* The cells of one sheet, one per series at most. */
struct sheet {
    const char *kind;
    const struct cs_cell *cells[TILES_MAX];
    uint32_t n;
    double range[2]; /* log10 m */
};

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
    const struct cs_cell_list *sweep = &compare->cells;
    double best = (double)NAN;
    uint32_t most = 0;
    for (uint32_t k = 0; k < sweep->n; k++) {
        uint32_t n = 0;
        for (uint32_t i = 0; i < sweep->n; i++)
            n += has_step(sweep->cells + i, sweep->cells[k].value);
        if (n > most || (n == most && sweep->cells[k].value > best)) {
            most = n;
            best = sweep->cells[k].value;
        }
    }
    for (uint32_t k = 0; k < sweep->n && sheet->n < TILES_MAX; k++)
        if (has_step(sweep->cells + k, best))
            sheet->cells[sheet->n++] = sweep->cells + k;
}

/* Cost in s that every method can keep: the largest of the methods' cheapest cells. */
static double common_cost(const struct cs_compare *compare) {
    const struct cs_cell_list *sweep = &compare->cells;
    double cost = 0, least = HUGE_VAL;
    for (uint32_t k = 0; k <= sweep->n; k++) {
        if (k == sweep->n || is_first_of_series(compare, k)) {
            cost = least < HUGE_VAL ? fmax(cost, least) : cost;
            least = HUGE_VAL;
        }
        if (k < sweep->n && cs_cell_is_finished(sweep->cells + k))
            least = fmin(least, sweep->cells[k].cpu);
    }
    return cost;
}

/* Chooses the most expensive cell of each series within the common cost: its best result. */
static void choose_cost(struct sheet *sheet, const struct cs_compare *compare) {
    const struct cs_cell_list *sweep = &compare->cells;
    const double cost = common_cost(compare);
    const struct cs_cell *best = NULL;
    for (uint32_t k = 0; k <= sweep->n; k++) {
        if ((k == sweep->n || is_first_of_series(compare, k)) && best && sheet->n < TILES_MAX) {
            sheet->cells[sheet->n++] = best;
            best = NULL;
        }
        const struct cs_cell *cell = sweep->cells + k;
        if (k < sweep->n && cs_cell_is_finished(cell) && cell->cpu <= cost &&
            (!best || cell->cpu > best->cpu))
            best = cell;
    }
}

/* Renders one tile with a scalar per particle. */
static enum cs_status paint(struct cs_recorded_run *recording, const struct cs_frame *frame,
                            const struct cs_posed_collider *obstacles,
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
                                                .colliders = obstacles};
    scene->render.size[0] = TILE_WIDTH;
    scene->render.size[1] = TILE_HEIGHT;
    scene->render.look = CS_LOOK_FORCE; // colours of what has no sign
    if (!image.rgb || !textures || !obstacles)
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

/* Runs a cell again and draws its last frame: a comparison stores no states of its cells. */
static enum cs_status draw_tile(const struct sheet *sheet, const struct cs_cell *cell,
                                const struct cs_compare *compare, enum cs_renderer_kind kind,
                                struct cs_error *error) {
    char integrator[CS_CELL_INTEGRATOR], file[CS_SERIES_BYTES], path[4400];
    struct cs_recorded_run recording;
    struct cs_trajectory track = {0};
    struct cs_recorded_run_result end;
    double *distance = calloc(compare->particles, sizeof *distance);
    struct cs_posed_collider *obstacles = NULL;
    cs_cell_integrator(cell, integrator, sizeof integrator);
    cs_series_file_name(cell->series, file);
    snprintf(path, sizeof path, "%s/pictures/%s_%s.png", compare->settings->folder, sheet->kind,
             file);
    if (!distance)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the colours");
    else if (!cs_recorded_run_open(&recording, &compare->settings->run, integrator, error)) {
        if (!cs_trajectory_init(&track, &recording, error) &&
            !cs_recorded_run_execute(&recording, 0, &track, &end, error) &&
            track.n_recorded == track.frames) {
            const double *x = cs_trajectory_state(&track, track.frames);
            cs_distance_each(track.n, x,
                             cs_trajectory_state(&compare->reference.trajectory, track.frames),
                             distance);
            for (uint32_t i = 0; i < track.n; i++)
                distance[i] = log10(fmax(distance[i], pow(10, sheet->range[0])));
            const struct cs_system *system = &recording.session.system;
            obstacles = calloc(system->scene->colliders.n + 1, sizeof *obstacles);
            if (obstacles)
                cs_posed_colliders_at(system, compare->time, obstacles);
            /* no time: what viewpoint forces saw was forgotten at the end of the run */
            const struct cs_frame frame = {.x = x,
                                           .scalar = distance,
                                           .range = {sheet->range[0], sheet->range[1]},
                                           .inv_mass = system->inv_mass,
                                           .colliders = obstacles};
            paint(&recording, &frame, obstacles, kind, path, error);
        }
        cs_trajectory_finish(&track);
        cs_recorded_run_close(&recording);
    }
    free(obstacles);
    free(distance);
    return error->status;
}

/* gnuplot script that assembles the tiles. */
static void print_script(const struct sheet *sheet, const struct cs_compare *compare,
                         struct cs_text *out) {
    const uint32_t lines = (sheet->n + COLUMNS - 1) / COLUMNS;
    cs_text_add(
        out,
        "set terminal pngcairo size %d,%u font \"DejaVu Sans,11\"\n"
        "set output \"%s.png\"\n"
        "set multiplot layout %u,%d title \"%s at %.4g s: distance to the reference from "
        "10^{%.0f} m (dark) to 10^{%.0f} m (bright)\"\n"
        "unset key\nunset border\nunset tics\nset size ratio -1\n"
        "set lmargin 0\nset rmargin 0\nset bmargin 0\n",
        COLUMNS * 320, 60 + lines * 275, sheet->kind, lines, COLUMNS,
        !strcmp(sheet->kind, "equal_step") ? "Equal step" : "Equal cost", compare->time,
        sheet->range[0], sheet->range[1]);
    /* paths are relative: gnuplot runs in the folder of the script */
    for (uint32_t k = 0; k < sheet->n; k++) {
        const struct cs_cell *cell = sheet->cells[k];
        char file[CS_SERIES_BYTES];
        cs_series_file_name(cell->series, file);
        cs_text_add(out,
                    "set title \"%s\\n%s %.3g, %.3g ms, error %.1e m\" noenhanced\n"
                    "plot \"pictures/%s_%s.png\" binary filetype=png with rgbimage\n",
                    cell->series, cell->control, cell->value, 1e3 * cell->cpu, cell->error,
                    sheet->kind, file);
    }
    cs_text_add(out, "unset multiplot\n");
}

/* Range of colours in log10 m: from the smallest error, or the reference's bar, to the largest.
 */
static void set_range(struct sheet *sheet, const struct cs_compare *compare) {
    double least = HUGE_VAL, most = 0;
    for (uint32_t k = 0; k < sheet->n; k++) {
        least = fmin(least, sheet->cells[k]->error);
        most = fmax(most, sheet->cells[k]->max_error);
    }
    sheet->range[0] = floor(log10(fmax(least, compare->reference.error_bar)));
    sheet->range[1] = fmax(ceil(log10(most)), sheet->range[0] + 1);
}

static enum cs_status write_sheet(struct sheet *sheet, const struct cs_compare *compare,
                                  enum cs_renderer_kind kind, struct cs_error *error) {
    struct cs_text script = {0};
    char name[32], path[4200];
    bool drawn;
    /* before the tiles, which all share it */
    set_range(sheet, compare);
    snprintf(path, sizeof path, "%s/pictures", compare->settings->folder);
    if (sheet->n == 0 || cs_folder_create(path, error))
        return error->status;
    for (uint32_t k = 0; k < sheet->n && !error->status; k++)
        draw_tile(sheet, sheet->cells[k], compare, kind, error);
    print_script(sheet, compare, &script);
    snprintf(name, sizeof name, "%s.gp", sheet->kind);
    snprintf(path, sizeof path, "%s/%s", compare->settings->folder, name);
    if (!error->status && !cs_file_write_text(path, &script, error))
        cs_gnuplot_run(compare->settings->folder, name, &drawn, error);
    cs_text_finish(&script);
    return error->status;
}

enum cs_status cs_compare_contact_sheet_write(const struct cs_compare *compare,
                                              enum cs_renderer_kind kind,
                                              struct cs_error *error) {
    struct sheet step = {.kind = "equal_step"}, cost = {.kind = "equal_cost"};
    if (!compare->reference.pointwise)
        return CS_OK;
    choose_step(&step, compare);
    choose_cost(&cost, compare);
    if (!write_sheet(&step, compare, kind, error))
        write_sheet(&cost, compare, kind, error);
    return error->status;
}
