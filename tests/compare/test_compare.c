/* A whole comparison: rows, orders, the file, the verdict. */
#include "place.h"
#include "study/compare/cell_list_parse.h"
#include "study/compare/compare_cell.h"
#include "study/compare/compare_curves.h"
#include "study/compare/equal_error.h"

#include <math.h>
#include <string.h>

static const char *const METHODS =
    "symplectic-euler:dt=2.5e-4..2e-3,velocity-verlet:dt=2.5e-4..2e-3,rk4:dt=1e-3..8e-3,"
    "explicit-euler:dt=0.05,dopri5:rtol=1e-8..1e-4";

/* Leaves out the cells that were run for equal errors: how many depends on times. */
static void keep_sweep(struct cs_compare *compare) {
    uint32_t n = 0;
    for (uint32_t k = 0; k < compare->cells.n; k++)
        if (!isfinite(compare->cells.cells[k].target))
            compare->cells.cells[n++] = compare->cells.cells[k];
    compare->cells.n = n;
}

TEST(orders_are_seen) {
    struct place place;
    struct watch watch = {0};
    struct cs_compare compare;
    struct cs_compare_settings settings;
    static const double orders[] = {1, 2, 4};
    place_make(&place, "0.02");
    run(&compare, &settings, &place, METHODS, &watch);
    ck_assert_uint_eq(watch.rows, compare.cells.n);
    keep_sweep(&compare);
    ck_assert_uint_eq(compare.cells.n, 4 + 4 + 4 + 1 + 9);
    for (uint32_t m = 0; m < 3; m++)
        ck_assert_msg(fabs(compare.cells.cells[4 * m + 3].order - orders[m]) < 0.1,
                      "%s: order %g", compare.cells.cells[4 * m].method,
                      compare.cells.cells[4 * m + 3].order);
    const struct cs_cell *blown = compare.cells.cells + 12;
    ck_assert_msg(!strncmp(blown->outcome, "blew up", 7), "explicit Euler %s", blown->outcome);
    ck_assert(isnan(blown->error) && blown->cpu > 0);
    // tolerances are asked for and kept within reason
    for (uint32_t k = 13; k < compare.cells.n; k++)
        ck_assert(compare.cells.cells[k].achieved > 1e-4 &&
                  compare.cells.cells[k].achieved < 100);
    cs_compare_finish(&compare);
}

TEST(file_reads_back) {
    struct place place;
    struct watch watch = {0};
    struct cs_compare compare;
    struct cs_compare_settings settings;
    struct cs_cell *cells;
    struct cs_error error = {0};
    char path[128];
    uint32_t n;
    place_make(&place, "0.02");
    run(&compare, &settings, &place, METHODS, &watch);
    snprintf(path, sizeof path, "%s/compare.csv", place.folder);
    ck_assert(!cs_csv_read(path, true, &cells, &n, &error));
    ck_assert_uint_eq(n, compare.cells.n);
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t c = 0; c < cs_n_columns; c++) {
            const size_t at = cs_columns[c].offset;
            const char *a = (const char *)(cells + k) + at,
                       *b = (const char *)(compare.cells.cells + k) + at;
            const bool nan = cs_columns[c].type == CS_CELL_NUMBER &&
                             isnan(cs_cell_number(cells + k, cs_columns + c));
            if (cs_columns[c].type == CS_CELL_TEXT)
                ck_assert_str_eq(a, b);
            else if (nan)
                ck_assert(isnan(cs_cell_number(compare.cells.cells + k, cs_columns + c)));
            else
                ck_assert_mem_eq(a, b, cs_columns[c].size);
        }
    free(cells);
    cs_compare_finish(&compare);
}

TEST(quotes_read_back) {
    struct cs_cell cell, *cells;
    struct cs_text text = {0};
    struct cs_error error = {0};
    const char *path = "cells.csv";
    uint32_t n;
    cs_cell_init(&cell, "rk4");
    snprintf(cell.note, sizeof cell.note, "a, \"b\" and \"\"");
    snprintf(cell.options, sizeof cell.options, "dt=0.1,order=2");
    cs_columns_print_names(cs_columns, cs_n_columns, &text);
    cs_columns_print_row(cs_columns, cs_n_columns, &cell, &text);
    cs_columns_print_row(cs_columns, cs_n_columns, &cell, &text);
    // the end of a line that was being written
    text.bytes[text.length - 8] = 0;
    FILE *file = fopen(path, "w");
    fputs(text.bytes, file);
    fclose(file);
    cs_text_finish(&text);
    ck_assert_msg(!cs_csv_read(path, true, &cells, &n, &error), "%s", error.message);
    ck_assert_uint_eq(n, 1);
    ck_assert_str_eq(cells->note, cell.note);
    ck_assert_str_eq(cells->options, cell.options);
    free(cells);
}

/* The error that ranks a cell. */
static double typical_of(const struct cs_compare *compare, const struct cs_cell *cell) {
    const struct cs_choice choice = {.compare = compare, .norm = CS_NORM_END};
    return cs_choice_error(cell, &choice);
}

/* The least work of a cell's series at an error of at most bound. */
static double least_work(const struct cs_compare *compare, const struct cs_cell *cell,
                         double bound) {
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < compare->cells.n; k++) {
        const struct cs_cell *other = compare->cells.cells + k;
        if (cs_cell_same_series(other, cell) && typical_of(compare, other) <= bound)
            least = fmin(least, other->work);
    }
    return least;
}

TEST(ranking_takes_the_cheapest) {
    struct place place;
    struct watch watch = {0};
    struct cs_compare compare;
    struct cs_compare_settings settings;
    struct cs_ranking ranking;
    struct cs_error error = {0};
    place_make(&place, "0.02");
    run(&compare, &settings, &place, METHODS, &watch);
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    ck_assert_uint_gt(ranking.n, 3);
    for (uint32_t r = 0; r < ranking.n; r++) {
        const struct cs_rank *rank = ranking.ranks + r;
        const double bound = pow(10, rank->exponent);
        ck_assert_double_le(typical_of(&compare, rank->best), bound);
        for (uint32_t k = 0; k < compare.cells.n; k++) {
            const struct cs_cell *cell = compare.cells.cells + k;
            // a series stands for its cell of least work: times of neighbours differ by noise
            if (typical_of(&compare, cell) <= bound &&
                cell->work <= least_work(&compare, cell, bound))
                ck_assert(cs_cell_same_series(cell, rank->best)
                              ? cell->work == rank->best->work
                              : cell->cpu >= 0.8 * rank->best->cpu);
        }
        ck_assert(!rank->has_factor || rank->ratio.median >= 1);
        ck_assert(!rank->runner_up || strcmp(rank->runner_up->series, rank->best->series) != 0);
    }
    cs_ranking_finish(&ranking);
    cs_compare_finish(&compare);
}

/* A method that goes over the springs itself is not cheaper by that: ten passes a step. */
TEST(sweeps_are_work) {
    struct place place;
    struct watch watch = {0};
    struct cs_compare compare;
    struct cs_compare_settings settings;
    place_make(&place, "0.02");
    run(&compare, &settings, &place, "xpbd:dt=5e-3,velocity-verlet:dt=1e-3", &watch);
    ck_assert_uint_eq(compare.cells.n, 2);
    const struct cs_cell *xpbd = compare.cells.cells, *verlet = xpbd + 1;
    ck_assert_double_eq(xpbd->sweeps, 10 * xpbd->steps);
    ck_assert_double_eq(xpbd->work, xpbd->evals + xpbd->sweeps);
    ck_assert_double_eq(verlet->sweeps, 0);
    ck_assert_double_eq(verlet->work, verlet->evals);
    cs_compare_finish(&compare);
}

TEST(list_is_read) {
    struct cs_cell_list list;
    struct cs_error error = {0};
    const struct cs_cell_list_settings settings = {
        .list = "rk4:dt=1e-3..4e-3,velocity-verlet,dopri5:rtol=1e-4..1e-3,atol=1e-9",
        .fps = 60,
        .omega = 1000};
    ck_assert_msg(!cs_cell_list_parse(&list, &settings, &error), "%s", error.message);
    ck_assert_uint_eq(list.n, 3 + 20 + 3);
    ck_assert_str_eq(list.cells[0].options, "dt=0.004");
    ck_assert_str_eq(list.cells[2].options, "dt=0.001");
    ck_assert_double_le(list.cells[3].value, 1 / 60.0);
    ck_assert_double_gt(list.cells[3].value, 2 / settings.omega);
    ck_assert_str_eq(list.cells[23].options, "atol=1e-09,rtol=0.001");
    // what may be run besides: between the ends of a range, or as far as the method goes
    ck_assert(list.cells[1].low == 1e-3 && list.cells[1].high == 4e-3 && !list.cells[1].open);
    ck_assert(list.cells[3].open && list.cells[3].high == 1 / 60.0);
    cs_cell_list_finish(&list);
}

/* The cells of a list, "series options" each, between semicolons. */
static const char *cells_of(const char *list, char *out, size_t size) {
    struct cs_cell_list sweep;
    struct cs_error error = {0};
    const struct cs_cell_list_settings settings = {.list = list, .fps = 60, .omega = 1000};
    *out = 0;
    if (cs_cell_list_parse(&sweep, &settings, &error))
        snprintf(out, size, "%s", error.message);
    for (uint32_t k = 0; k < sweep.n; k++)
        snprintf(out + strlen(out), size - strlen(out), "%s%s %s", k ? "; " : "",
                 sweep.cells[k].series, sweep.cells[k].options);
    cs_cell_list_finish(&sweep);
    return out;
}

TEST(series_are_named_apart) {
    char out[2000];
    // the same method and options are one series, however they are written
    ck_assert_str_eq(cells_of("rk4:dt=1e-3..2e-3,rk4:dt=5e-4..1e-3", out, sizeof out),
                     "rk4 dt=0.002; rk4 dt=0.001; rk4 dt=0.0005");
    ck_assert_str_eq(
        cells_of("newmark:beta=0.3,variant=own,dt=1e-3,"
                 "newmark:variant=own,dt=2e-3,beta=0.300,newmark:variant=newmark,dt=1e-3",
                 out, sizeof out),
        "newmark:variant=own,beta=0.3 variant=own,beta=0.3,dt=0.002; "
        "newmark:variant=own,beta=0.3 variant=own,beta=0.3,dt=0.001; newmark dt=0.001");
    ck_assert_str_eq(cells_of("a=rk4:dt=1e-3,b=rk4:dt=1e-3", out, sizeof out),
                     "a dt=0.001; b dt=0.001");
    // atol=0 is the default: the scene's own
    ck_assert_str_eq(cells_of("dopri5:rtol=1e-3,dopri5:rtol=1e-3,atol=0", out, sizeof out),
                     "dopri5 rtol=0.001");
}

/* The small scene in another unit of length; forces scale with it. */
static void write_scaled(char path[64], double unit) {
    char scaled[1000];
    snprintf(scaled, sizeof scaled,
             "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"size\": [%g, %g], \"velocity\":"
             " [0, 0, %g]}, \"mass\": {\"total\": 0.2}, \"springs\": {\"stretch\": 40,"
             " \"shear\": 15, \"bend\": 5, \"damping\": 0.02}, \"pins\": [\"top-left\","
             " \"top-right\"]}], \"forces\": {\"gravity\": [0, %.17g, 0]}, \"time\": {\"fps\": "
             "%%s}}",
             unit, unit, 0.5 * unit, -9.81 * unit);
    scene_write(path, scaled, "20");
}

TEST(tolerances_have_no_unit) {
    static const char *const methods = "dopri5:rtol=1e-6..1e-3,ark-erk:rtol=1e-6..1e-3";
    struct cs_compare compare[2];
    struct cs_compare_settings settings[2];
    struct place place;
    for (int k = 0; k < 2; k++) {
        struct watch watch = {0};
        const double unit = k ? 1024 : 1; // exact, or a rejected step may be another one
        place_make(&place, "0.02");
        write_scaled(place.scene, unit);
        run_in(compare + k, settings + k, &place, methods, &watch, 0.5, unit);
    }
    keep_sweep(compare);
    keep_sweep(compare + 1);
    ck_assert_uint_eq(compare[0].cells.n, compare[1].cells.n);
    for (uint32_t k = 0; k < compare[0].cells.n; k++) {
        const struct cs_cell *one = compare[0].cells.cells + k,
                             *other = compare[1].cells.cells + k;
        ck_assert_double_eq_tol(other->achieved / one->achieved, 1, 0.01);
        ck_assert_double_eq_tol(other->error / one->error / 1024, 1, 0.01);
    }
    cs_compare_finish(compare);
    cs_compare_finish(compare + 1);
}

/* a ring about the cell with crossings, and none where they are 0 or were not counted */
TEST(crossings_are_ringed) {
    struct cs_cell cells[3] = {{.outcome = "finished", .crossings = 0},
                               {.outcome = "finished", .crossings = 3},
                               {.outcome = "finished", .crossings = (double)NAN}};
    for (int k = 0; k < 3; k++) {
        cells[k].cpu = 0.5 * (k + 1);
        cells[k].error = 0.25 * (k + 1);
        cells[k].target = (double)NAN;
    }
    for (uint32_t n = 1; n <= 3; n += 2) {
        const struct cs_plot_settings settings = {.cells = cells,
                                                  .n = n,
                                                  .x = cs_column_find("cpu"),
                                                  .y = cs_column_find("error"),
                                                  .width = CS_WIDTH_COLUMN};
        struct cs_diagram plot;
        struct cs_error error = {0};
        bool key = false;
        ck_assert_int_eq(cs_plot_make(&plot, &settings, &error), CS_OK);
        const struct cs_series *line = plot.panels->series + plot.panels->n_series - 1;
        ck_assert_uint_eq(line->n, n);
        for (uint32_t k = 0; k < n; k++)
            ck_assert_int_eq(line->points[k].ring, cells[k].crossings > 0);
        for (uint32_t k = 0; k < plot.n_keys; k++)
            key |= plot.keys[k].kind == CS_KEY_SAMPLE &&
                   plot.keys[k].mark == CS_MARK_RING;
        ck_assert_int_eq(key, n == 3);
        cs_plot_finish(&plot);
    }
}
