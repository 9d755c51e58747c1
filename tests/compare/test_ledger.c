/* The folder of a comparison: what an interrupt leaves, and what another run adds. */
#include "place.h"
#include "study/compare/compare_cell.h"
#include "study/compare/compare_state.h"
#include "study/compare/equal_error.h"

#include <math.h>
#include <sys/stat.h>
#include <sys/wait.h>

static const char *const METHODS =
    "symplectic-euler:dt=2.5e-4..2e-3,velocity-verlet:dt=2.5e-4..2e-3,rk4:dt=1e-3..8e-3,"
    "explicit-euler:dt=0.05,dopri5:rtol=1e-8..1e-4";

TEST(interrupted_comparison_goes_on) {
    struct place place;
    struct watch watch = {.stop_after = 5}, again = {0};
    struct cs_compare compare;
    struct cs_compare_settings settings;
    struct cs_cell *cells;
    struct cs_error error = {0};
    char path[128];
    uint32_t n;
    place_make(&place, "0.02");
    ck_assert_int_eq(run(&compare, &settings, &place, METHODS, &watch), CS_ERR_INTERRUPT);
    cs_compare_finish(&compare);
    stop = 0;
    snprintf(path, sizeof path, "%s/compare.csv", place.folder);
    ck_assert(!cs_csv_read(path, true, &cells, &n, &error));
    ck_assert_uint_eq(n, 5);
    free(cells);
    ck_assert_int_eq(run(&compare, &settings, &place, METHODS, &again), CS_OK);
    ck_assert_uint_eq(again.taken, 5);
    ck_assert_uint_eq(again.rows, compare.cells.n);
    cs_compare_finish(&compare);
}

TEST(other_methods_are_added) {
    struct place place;
    struct watch first = {0}, second = {0}, third = {0};
    struct cs_compare compare;
    struct cs_compare_settings settings;
    struct cs_cell *cells;
    struct cs_error error = {0};
    char path[128];
    uint32_t n;
    place_make(&place, "0.02");
    run(&compare, &settings, &place, "rk4:dt=1e-3..8e-3,velocity-verlet:dt=1e-3..2e-3", &first);
    cs_compare_finish(&compare);
    // a shorter list keeps all rows, another step falls into its place
    run(&compare, &settings, &place, "rk4:dt=5e-4..2e-3", &second);
    ck_assert_uint_eq(second.taken, 6);
    ck_assert_uint_eq(compare.cells.n, 7);
    for (uint32_t k = 0; k < 5; k++) {
        ck_assert_str_eq(compare.cells.cells[k].method, "rk4");
        ck_assert_double_eq(compare.cells.cells[k].value, 8e-3 / (1 << k));
    }
    ck_assert_double_eq_tol(compare.cells.cells[4].order, 4, 0.1);
    cs_compare_finish(&compare);
    snprintf(path, sizeof path, "%s/compare.csv", place.folder);
    ck_assert(!cs_csv_read(path, true, &cells, &n, &error));
    ck_assert_uint_eq(n, 7);
    free(cells);
    // another scene is no part of it
    scene_write(place.scene, SMALL_SCENE, "0.03");
    ck_assert_int_eq(run(&compare, &settings, &place, "rk4:dt=2e-3", &third), CS_ERR_USAGE);
    ck_assert_uint_eq(third.rows, 0);
    cs_compare_finish(&compare);
    ck_assert(!cs_csv_read(path, true, &cells, &n, &error));
    ck_assert_uint_eq(n, 7);
    free(cells);
}

TEST(over_budget_runs_again_with_more) {
    struct place place;
    struct watch first = {0}, second = {0}, third = {0};
    struct cs_compare compare;
    struct cs_compare_settings settings;
    place_make(&place, "0.02");
    run_for(&compare, &settings, &place, "rk4:dt=5e-5", &first, 1e-3);
    ck_assert_str_eq(compare.cells.cells->outcome, cs_outcome_text(CS_OVER_BUDGET));
    cs_compare_finish(&compare);
    run_for(&compare, &settings, &place, "rk4:dt=5e-5", &second, 1e-3);
    ck_assert_uint_eq(second.taken, 1);
    cs_compare_finish(&compare);
    // without one, a single cell has the most that there is
    run_for(&compare, &settings, &place, "rk4:dt=5e-5", &third, 0);
    ck_assert_uint_eq(third.taken, 0);
    ck_assert_double_eq(compare.budget, CS_COMPARE_RUN_SECONDS_MAX);
    cs_compare_finish(&compare);
}

/* The number of rows of a series in the file of a comparison. */
static uint32_t rows_of(const struct place *place, const char *series) {
    struct cs_cell *cells;
    struct cs_error error = {0};
    char path[128];
    uint32_t n, found = 0;
    snprintf(path, sizeof path, "%s/compare.csv", place->folder);
    ck_assert(!cs_csv_read(path, true, &cells, &n, &error));
    for (uint32_t k = 0; k < n; k++)
        found += !strcmp(cells[k].series, series) && isnan(cells[k].target) &&
                 !strcmp(cells[k].outcome, "finished");
    free(cells);
    return found;
}

TEST(two_processes_fill_one_folder) {
    static const char *const lists[] = {"a=rk4:dt=5e-4..8e-3", "b=rk4:dt=5e-4..8e-3",
                                        "c=rk4:dt=5e-4..8e-3", "d=rk4:dt=5e-4..8e-3"};
    struct place place;
    struct watch watch = {0};
    struct cs_compare compare;
    struct cs_compare_settings settings;
    pid_t children[4];
    place_make(&place, "0.02");
    for (int k = 0; k < 4; k++) {
        children[k] = fork();
        ck_assert_int_ge(children[k], 0);
        if (children[k] == 0)
            _exit(run(&compare, &settings, &place, lists[k], &watch) != CS_OK);
    }
    for (int k = 0; k < 4; k++) {
        int status;
        ck_assert_int_eq(waitpid(children[k], &status, 0), children[k]);
        ck_assert_int_eq(status, 0);
    }
    for (int k = 0; k < 4; k++)
        ck_assert_uint_eq(rows_of(&place, (char[]){(char)('a' + k), 0}), 5);
}

TEST(other_machines_are_told_apart) {
    struct place place;
    struct watch first = {0}, second = {0};
    struct cs_compare compare;
    struct cs_compare_settings settings;
    struct cs_ranking ranking;
    struct cs_error error = {0};
    char command[400];
    place_make(&place, "0.02");
    run(&compare, &settings, &place, "rk4:dt=1e-3..2e-3", &first);
    ck_assert_str_ne(compare.machine, "");
    ck_assert_str_eq(compare.cells.cells->machine, compare.machine);
    cs_compare_finish(&compare);
    snprintf(command, sizeof command,
             "sed -i '1s/,check$//; s/,[^,]*: [^,]*,\\([^,]*\\),[^,]*$/,far: away,\\1/' "
             "%s/compare.csv",
             place.folder);
    ck_assert_int_eq(system(command), 0);
    // rows without checks are taken in by merge alone, which gives them new ones
    char merged[300];
    const char *const folders[] = {place.folder};
    uint32_t n_rows;
    snprintf(merged, sizeof merged, "%s/merged", place.folder);
    ck_assert_int_eq(mkdir(merged, 0700), 0);
    ck_assert_msg(!cs_compare_results_merge(folders, 1, merged, true, &n_rows, &error), "%s",
                  error.message);
    snprintf(command, sizeof command, "mv %s/compare.csv %s/compare.csv", merged, place.folder);
    ck_assert_int_eq(system(command), 0);
    // what is of another machine stays, and is run here as well
    run(&compare, &settings, &place, "rk4:dt=1e-3..2e-3", &second);
    ck_assert_uint_eq(compare.cells.n, 4);
    ck_assert_str_eq(compare.cells.cells[0].series, "rk4");
    ck_assert_str_eq(compare.cells.cells[2].series, "rk4@far");
    ck_assert_double_eq(compare.cells.cells[0].error, compare.cells.cells[2].error);
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    for (uint32_t k = 0; k < ranking.n; k++)
        ck_assert(ranking.ranks[k].best < compare.cells.cells + 2 &&
                  !ranking.ranks[k].runner_up);
    cs_ranking_finish(&ranking);
    cs_compare_finish(&compare);
}

/* What a reference takes by estimate is taken from the search and the rounds, never from a
 * sweep. The runs are interrupted: the budget stands before the first one. */
TEST(dear_references_shorten_search_and_rounds) {
    static const uint32_t frames[] = {6, 600, 20000};
    double equal[3], rounds[3];
    for (int k = 0; k < 3; k++) {
        struct place place;
        struct cs_compare compare;
        struct cs_compare_settings settings;
        struct cs_error error = {0};
        place_make(&place, "0.02");
        stop = 1;
        settings = (struct cs_compare_settings){
            .run = {.session = {.scene = place.scene, .run = {.stop = &stop}},
                    .frames = frames[k]},
            .methods = "rk4",
            .accuracy = 1e-6,
            .reference_budget = 1e9,
            .runs = 1,
            .folder = place.folder};
        ck_assert_int_eq(cs_compare_run(&compare, &settings, &error), CS_ERR_INTERRUPT);
        ck_assert_double_eq(compare.budget, CS_COMPARE_RUN_SECONDS_MAX);
        equal[k] = compare.equal_seconds;
        rounds[k] = compare.rounds_seconds;
        cs_compare_finish(&compare);
    }
    stop = 0;
    ck_assert_double_eq(equal[0], CS_COMPARE_EQUAL_SECONDS);
    ck_assert_double_eq(rounds[0], CS_COMPARE_ROUND_SECONDS);
    ck_assert_msg(equal[1] < equal[0] && equal[1] > equal[2], "%g %g %g", equal[0], equal[1],
                  equal[2]);
    ck_assert_double_eq_tol(rounds[1] / rounds[0], equal[1] / equal[0], 1e-12);
    ck_assert_double_eq(rounds[2], CS_COMPARE_PART_MIN * CS_COMPARE_ROUND_SECONDS);
}
