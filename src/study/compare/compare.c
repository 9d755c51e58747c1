/* Compares methods on a scene: facts of the scene, cells, keys, reference, measurements,
 * rounds. */
#include "study/compare/compare.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/json_writer.h"
#include "session/process_pool.h"
#include "session/provenance_write.h"
#include "session/scene_view.h"
#include "session/session.h"
#include "study/compare/cell_list_parse.h"
#include "study/reference/compare_reference_state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Nominal s to open a small scene for a run. */
#define OPEN_SECONDS 2e-3

/* Reads the facts of the scene and of its smooth form (recorded_run.h). */
static enum cs_status read_scene_facts(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_recorded_run_settings *settings = &compare->settings->run;
    struct cs_session_settings asked = settings->session;
    struct cs_session session = {0};
    struct cs_recorded_run recording = {0};
    asked.integrator = "velocity-verlet";
    /* opened as it is first: the smooth form no longer has what it leaves out */
    if (!cs_session_open_plan(&session, &asked, error))
        cs_recorded_run_describe_changes(session.scene, &compare->switched_off);
    cs_session_close(&session);
    if (!error->status &&
        !cs_recorded_run_open(&recording, settings, asked.integrator, error)) {
        const struct cs_system *system = &recording.session.system;
        struct cs_text scene = {0};
        cs_text_add_plain(&scene, asked.scene);
        snprintf(compare->scene, sizeof compare->scene, "%.255s", cs_text_get(&scene));
        cs_text_finish(&scene);
        compare->particles = system->view.n;
        compare->springs = recording.session.plan.n_springs;
        compare->fps = recording.session.scene->time.fps;
        /* above 0, because default steps are derived from it */
        compare->omega = fmax(system->view.omega, 1e-3);
        compare->pass_seconds = cs_pass_seconds(system);
        compare->time = settings->frames / compare->fps;
        compare->contact = recording.session.scene->colliders.n > 0 ||
                           cs_scene_has_body_contact(recording.session.scene);
        compare->n_event_times = cs_recorded_run_count_stops(&recording, compare->time);
    }
    cs_recorded_run_close(&recording);
    return error->status;
}

/* Writes the scene as given, its own method and the number of frames as JSON: everything a row
 * depends on besides its method. */
static enum cs_status print_origin(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_recorded_run_settings *recording = &compare->settings->run;
    const struct cs_session_settings *asked = &recording->session;
    struct cs_text *out = &compare->provenance;
    struct cs_scene scene = {0};
    char found[CS_DATA_PATH_MAX];
    if (cs_scene_read(&scene, cs_scene_find(asked->scene, found, sizeof found),
                      asked->overrides, asked->n_overrides, error))
        return error->status;
    cs_json_write(out, "{\n  'versions': {'clothsim': %s},\n  'frames': %u,\n", CS_VERSION,
                  recording->frames);
    if (compare->settings->reference[0])
        cs_json_write(out, "  'reference': [%s, %s],\n", compare->settings->reference[0],
                      compare->settings->reference[1]);
    cs_json_write(out, "  'accuracy': %g,\n  'reference_budget': %g,\n",
                  compare->settings->accuracy, compare->settings->reference_budget);
    cs_provenance_out_print_scene(&scene, out, error);
    cs_text_add(out, ",\n  \"scene\": ");
    cs_provenance_out_print_given(&scene, out);
    cs_text_add(out, "\n}\n");
    cs_scene_finish(&scene);
    if (!error->status && out->failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the scene");
    return error->status;
}

/* origin.json beside compare.csv, for compare.h. */
static enum cs_status write_origin(const struct cs_compare *compare, struct cs_error *error) {
    char path[4096];
    snprintf(path, sizeof path, "%s/origin.json", compare->settings->folder);
    return cs_file_write(path, compare->provenance.bytes, compare->provenance.length, error);
}

struct cs_compare_reference_settings
cs_compare_reference_query(const struct cs_compare_settings *settings) {
    return (struct cs_compare_reference_settings){
        .run = &settings->run,
        .methods = {settings->reference[0], settings->reference[1]},
        .accuracy = settings->accuracy,
        .explicit_seconds = settings->reference_budget > 0 ? settings->reference_budget
                                                           : CS_COMPARE_REFERENCE_SECONDS,
        .cache = settings->cache,
        .progress = settings->reference_progress,
        .ctx = settings->ctx};
}

/* Budget of one run, of the search and of the rounds in nominal s of work.
 *
 * Without a budget from the user all series together get CS_COMPARE_SECONDS. Steps are halved,
 * so the last finished run of a series takes about as long as all before it (1/2 + 1/4 + ... =
 * 1): twice the budget in total. One more run may exceed the budget: three per series.
 * of_reference: estimated nominal s, which do not depend on what the cache has. */
static void divide_budget(struct cs_compare *compare, double of_reference) {
    const struct cs_cell_list *list = &compare->cells;
    const double asked = compare->settings->budget,
                 left = CS_COMPARE_ALL_SECONDS - CS_COMPARE_SECONDS - of_reference,
                 part = left / (CS_COMPARE_EQUAL_SECONDS + CS_COMPARE_ROUND_SECONDS),
                 bounded = fmin(fmax(part, CS_COMPARE_PART_MIN), 1);
    uint32_t n = 0;
    for (uint32_t k = 0; k < list->n; k++)
        n += k == 0 || !cs_cell_same_series(list->cells + k, list->cells + k - 1);
    compare->budget =
        asked > 0 ? asked
                  : fmin(CS_COMPARE_SECONDS / (3 * fmax(n, 1)), CS_COMPARE_RUN_SECONDS_MAX);
    compare->equal_seconds = fmax(bounded * CS_COMPARE_EQUAL_SECONDS, 20 * asked);
    compare->rounds_seconds = fmax(bounded * CS_COMPARE_ROUND_SECONDS, 5 * asked);
}

/* A method that refuses a scene which others accept becomes one row with the reason. */
static void refuse_cells(struct cs_cell_list *list, uint32_t first, struct cs_error *error) {
    if (error->status != CS_ERR_SCENE)
        return;
    cs_cell_list_refuse(list, first, error->message);
    *error = (struct cs_error){0};
}

/* Opens each series once without a run: unknown options and refusals are known before the
 * reference, which may take long. */
static enum cs_status check_methods(struct cs_compare *compare, struct cs_error *error) {
    struct cs_cell_list *list = &compare->cells;
    struct cs_session_settings asked = compare->settings->run.session;
    char integrator[CS_CELL_INTEGRATOR];
    for (uint32_t k = 0; k < list->n && !error->status; k++) {
        const struct cs_cell *cell = list->cells + k;
        struct cs_session session = {0};
        if (*cell->outcome || (k > 0 && cs_cell_same_series(cell, cell - 1)))
            continue;
        cs_cell_integrator(cell, integrator, sizeof integrator);
        asked.integrator = integrator;
        if (cs_session_open_plan(&session, &asked, error))
            refuse_cells(list, k, error);
        cs_session_close(&session);
    }
    return error->status;
}

/* Keeps the cells of this process's shard only. */
static void store_shard(struct cs_compare *compare) {
    struct cs_cell_list *list = &compare->cells;
    uint32_t kept = 0;
    for (uint32_t k = 0; k < list->n; k++)
        if (cs_shard_holds(&compare->settings->shard, k))
            list->cells[kept++] = list->cells[k];
    list->n = kept;
}

/* Reads the list of methods and expands it to cells. */
static enum cs_status make_cells(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_session_settings *session = &compare->settings->run.session;
    const struct cs_cell_list_settings asked = {.list = compare->settings->methods,
                                                .plugins = session->plugins,
                                                .n_plugins = session->n_plugins,
                                                .fps = compare->fps,
                                                .omega = compare->omega};
    for (uint32_t k = 0; k < asked.n_plugins; k++)
        compare->by_work |= !strncmp(asked.plugins[k], "program:", 8);
    if (!cs_cell_list_parse(&compare->cells, &asked, error) && !check_methods(compare, error))
        store_shard(compare);
    return error->status;
}

/* Key of a row: that of the reference (scene, overrides, duration), then the hash of module,
 * method and options. */
static void make_key(struct cs_cell *cell, const char *reference, const char *module) {
    struct cs_text all = {0};
    char hash[CS_HASH_DIGITS];
    cs_text_add(&all, "%s|%s|%s", module, cell->method, cell->options);
    cs_hash_bytes(cs_text_get(&all), all.length, hash);
    snprintf(cell->key, sizeof cell->key, "%.*s-%.16s", CS_COMPARE_DIGITS, reference, hash);
    cs_text_finish(&all);
}

static enum cs_status make_keys(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_compare_reference_settings asked =
        cs_compare_reference_query(compare->settings);
    struct cs_compare_reference reference;
    char of_reference[CS_HASH_DIGITS];
    cs_compare_reference_plan(&reference, &asked, of_reference, error);
    divide_budget(compare, reference.passes * compare->pass_seconds);
    for (uint32_t k = 0; k < compare->cells.n && !error->status; k++) {
        struct cs_cell *cell = compare->cells.cells + k;
        make_key(cell, of_reference, cell->module);
    }
    return error->status;
}

/* Counts a row and passes it on. taken: from an earlier run. */
static void report_row(struct cs_compare *compare, const struct cs_cell *cell, bool taken) {
    compare->n_done++;
    if (compare->settings->row)
        compare->settings->row(compare->settings->ctx, cell, taken);
}

/* True if the cells after cell k in its series need not be run: they take longer, and no power
 * of 10 above the bar is left to be passed. A range that was asked for is run whole. */
static bool is_ended(const struct cs_compare *compare, uint32_t k) {
    const struct cs_cell *cell = compare->cells.cells + k;
    const double bar = compare->reference.error_bar;
    const double least = compare->settings->bound > 0 ? compare->settings->bound
                         : bar > 0                    ? pow(10, ceil(log10(bar)))
                                                      : 0;
    return !*cell->outcome || !strcmp(cell->outcome, cs_outcome_text(CS_OVER_BUDGET)) ||
           (cell->open && (cell->error <= least ||
                           cs_cell_is_rounding(cell, k + 1, compare->reference.motion_scale)));
}

struct cell_apart {
    const struct cs_compare *compare;
    struct cs_cell *shared;
};

static enum cs_status measure_shared(void *ctx, struct cs_error *error) {
    const struct cell_apart *apart = ctx;
    return cs_compare_measure(apart->compare, apart->shared, error);
}

/* Runs a cell in a process of its own, which is ended if it hangs. A process that dies is a
 * failed cell. */
static enum cs_status measure_apart(const struct cs_compare *compare, struct cs_cell *cell,
                                    struct cs_error *error) {
    struct cell_apart apart = {compare, cs_process_pool_shared_alloc(sizeof *cell, error)};
    const struct cs_isolate isolate = {.task_seconds = cs_hang_seconds(10 * compare->budget),
                                       .stop_seconds = 0.5,
                                       .is_cell = true,
                                       .task = measure_shared,
                                       .ctx = &apart,
                                       .stop = compare->settings->run.session.run.stop};
    struct cs_error result = {0};
    if (!apart.shared)
        return error->status;
    *apart.shared = *cell;
    if (!cs_isolate_run(&isolate, &result))
        *cell = *apart.shared;
    else if (isolate.stop && *isolate.stop)
        cs_fail(error, CS_ERR_INTERRUPT, "interrupted; finished rows are saved");
    else {
        snprintf(cell->outcome, sizeof cell->outcome, "%s", cs_outcome_text(CS_FAILED));
        snprintf(cell->note, sizeof cell->note, "%.239s", result.message);
    }
    cs_process_pool_shared_free(apart.shared, sizeof *cell);
    return error->status;
}

/* Runs a cell, appends its row and reports it. */
static enum cs_status measure_list(struct cs_compare *compare,
                                   struct cs_compare_results *results, struct cs_cell *cell,
                                   struct cs_error *error) {
    const bool apart = compare->settings->isolates_cells;
    if (!(apart ? measure_apart : cs_compare_measure)(compare, cell, error) &&
        !cs_compare_results_append(results, cell, error))
        report_row(compare, cell, false);
    return error->status;
}

static void report_old_rows(struct cs_compare *compare) {
    for (uint32_t k = 0; k < compare->cells.n; k++)
        if (*compare->cells.cells[k].outcome)
            report_row(compare, compare->cells.cells + k, true);
}

/* Runs the cells that no earlier run has, and appends each row at once. */
static enum cs_status measure_cells(struct cs_compare *compare,
                                    struct cs_compare_results *results,
                                    struct cs_error *error) {
    for (uint32_t k = 0; k < compare->cells.n && !error->status; k++) {
        struct cs_cell *cell = compare->cells.cells + k;
        if (*cell->outcome)
            continue;
        if (k > 0 && cs_cell_same_series(cell, cell - 1) && is_ended(compare, k - 1))
            compare->n_done++;
        else
            measure_list(compare, results, cell, error);
    }
    cs_cell_list_drop_unrun(&compare->cells);
    return error->status;
}

/* Runs a cell of the series of another one and adds it to the cells. */
static enum cs_status measure_further(struct cs_compare *compare,
                                      struct cs_compare_results *results,
                                      const struct cs_cell *of, double value, double target,
                                      struct cs_error *error) {
    struct cs_cell cell;
    cs_cell_derive(&cell, of, value);
    cell.target = target;
    make_key(&cell, of->key, of->module);
    if (!measure_list(compare, results, &cell, error))
        cs_cell_list_add(&compare->cells, &cell, error);
    return error->status;
}

/* Nominal s of the cells that were run for equal errors, each at least as long as it takes to
 * open a scene. */
static double searched_seconds(const struct cs_compare *compare) {
    double sum = 0;
    for (uint32_t k = 0; k < compare->cells.n; k++)
        if (isfinite(compare->cells.cells[k].target))
            sum += fmax(compare->cells.cells[k].work * compare->pass_seconds, OPEN_SECONDS);
    return sum;
}

/* Runs cells in between until the methods near the front have cells at the errors of the
 * verdict (equal_error.h). A shard has not all cells: that is left to the whole. */
static enum cs_status equalise_errors(struct cs_compare *compare,
                                      struct cs_compare_results *results,
                                      struct cs_error *error) {
    const struct cs_cell *near;
    double value, target;
    while (compare->settings->shard.count < 2 && !error->status &&
           searched_seconds(compare) < compare->equal_seconds &&
           (near = cs_equal_error_find_next(compare, &value, &target)))
        measure_further(compare, results, near, value, target, error);
    return error->status;
}

/* Runs the cells of the default sweep, and those for equal errors. */
static enum cs_status run_sweep(struct cs_compare *compare, struct cs_compare_results *results,
                                struct cs_error *error) {
    if (!measure_cells(compare, results, error) &&
        !cs_compare_results_refresh(results, compare, error))
        equalise_errors(compare, results, error);
    return error->status;
}

/* Runs the cells that settings->next chooses. */
static enum cs_status run_chosen(struct cs_compare *compare, struct cs_compare_results *results,
                                 struct cs_error *error) {
    const struct cs_compare_settings *settings = compare->settings;
    const struct cs_cell *of;
    double value;
    while (!settings->next(settings->ctx, compare, &of, &value, error) && of)
        if (measure_further(compare, results, of, value, settings->bound, error))
            break;
    cs_cell_list_drop_unrun(&compare->cells);
    return error->status;
}

enum cs_status cs_compare_run(struct cs_compare *compare,
                              const struct cs_compare_settings *settings,
                              struct cs_error *error) {
    struct cs_compare_results results = {0};
    *compare = (struct cs_compare){.settings = settings};
    cs_machine_name(compare->machine);
    const struct cs_compare_reference_settings reference =
        cs_compare_reference_query(compare->settings);
    // the folder is checked before the reference, which may take long
    if (!read_scene_facts(compare, error) && !print_origin(compare, error) &&
        !make_cells(compare, error) && !make_keys(compare, error) &&
        !cs_compare_results_open(&results, compare, error) && !write_origin(compare, error) &&
        !cs_compare_reference_get(&compare->reference, &reference, error)) {
        if (settings->on_begin)
            settings->on_begin(settings->ctx);
        report_old_rows(compare);
        if (!(settings->next ? run_chosen : run_sweep)(compare, &results, error) &&
            !cs_compare_time(compare, error)) {
            cs_compare_find_orders(compare->cells.cells, compare->cells.n,
                                   compare->reference.error_bar,
                                   compare->reference.motion_scale);
            cs_compare_results_rewrite(&results, compare, error);
        }
    }
    cs_compare_results_close(&results);
    return error->status;
}

void cs_compare_finish(struct cs_compare *compare) {
    cs_compare_reference_finish(&compare->reference);
    cs_cell_list_finish(&compare->cells);
    cs_rounds_finish(&compare->rounds);
    cs_text_finish(&compare->switched_off);
    cs_text_finish(&compare->provenance);
    *compare = (struct cs_compare){0};
}
