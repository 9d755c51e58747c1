/* Compares methods on a scene: reference, cells, measurements, and the rows of compare.csv. */
#include "study/compare/compare.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/json_writer.h"
#include "io/scene_write.h"
#include "model/event/events.h"
#include "scene/pairs.h"
#include "study/compare/compare_ledger.h"
#include "study/compare/compare_measure.h"
#include "study/compare/compare_time.h"
#include "study/compare/sweep_list.h"
#include "study/origin.h"
#include "study/reference/compare_reference.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* m: the longest side of the scene's box, as a power of 10 */
static double size_of(const struct cs_course *course) {
    const size_t n = course->session.system.view.n;
    double longest = 0;
    for (size_t c = 0; c < 3; c++) {
        double least = HUGE_VAL, most = -HUGE_VAL;
        for (size_t i = 0; i < n; i++) {
            least = fmin(least, course->start[c * n + i]);
            most = fmax(most, course->start[c * n + i]);
        }
        longest = fmax(longest, most - least);
    }
    return longest > 0 ? pow(10, floor(log10(longest) + 0.5)) : 1;
}

/* The scene as it is, and what its smooth form comes to. */
static enum cs_status look_at_scene(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_course_settings *settings = &compare->settings->course;
    struct cs_session_settings asked = settings->session;
    struct cs_session session = {0};
    struct cs_course course = {0};
    asked.integrator = "velocity-verlet";
    /* opened as it is first: the smooth form no longer has what it leaves out */
    if (!cs_session_open_plan(&session, &asked, error))
        cs_course_describe_changes(&session.scene, &compare->changes);
    cs_session_close(&session);
    if (!error->status && !cs_course_open(&course, settings, asked.integrator, error)) {
        const struct cs_system *system = &course.session.system;
        snprintf(compare->scene, sizeof compare->scene, "%.255s", asked.scene);
        compare->particles = system->view.n;
        compare->springs = course.session.plan.n_springs;
        compare->fps = course.session.scene.time.fps;
        /* above 0, because default steps are derived from it */
        compare->omega = fmax(system->view.omega, 1e-3);
        compare->size = size_of(&course);
        compare->time = settings->frames / compare->fps;
        compare->contact =
            course.session.scene.colliders.n > 0 || cs_scene_any_meet(&course.session.scene);
        compare->cuts = system->events ? cs_events_cuts(system->events, compare->time) : 0;
    }
    cs_course_close(&course);
    return error->status;
}

/* The scene as it was given, with the options of its own method, and for how long. */
static enum cs_status tell_origin(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_course_settings *course = &compare->settings->course;
    const struct cs_session_settings *asked = &course->session;
    struct cs_text *out = &compare->origin;
    struct cs_scene scene = {0};
    char found[CS_DATA_PATH_MAX];
    if (cs_scene_read(&scene, cs_data_find(asked->scene, found, sizeof found), asked->overrides,
                      asked->n_overrides, error))
        return error->status;
    cs_json_write(out, "{\n  'versions': {'clothsim': %s},\n  'frames': %u,\n", CS_VERSION,
                  course->frames);
    cs_origin_print_scene(&scene, out, error);
    cs_text_add(out, ",\n  \"scene\": ");
    cs_scene_print(&scene, NULL, NULL, 2, out);
    cs_text_add(out, "\n}\n");
    cs_scene_finish(&scene);
    if (!error->status && out->failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the scene");
    return error->status;
}

static enum cs_status write_origin(const struct cs_compare *compare, struct cs_error *error) {
    char path[4096];
    snprintf(path, sizeof path, "%s/origin.json", compare->settings->folder);
    return cs_file_write(path, compare->origin.bytes, compare->origin.length, error);
}

static struct cs_compare_reference_settings ask_reference(const struct cs_compare *compare) {
    const struct cs_compare_settings *settings = compare->settings;
    return (struct cs_compare_reference_settings){
        .course = &settings->course,
        .methods = {settings->reference[0], settings->reference[1]},
        .accuracy = settings->accuracy,
        .cache = settings->cache,
        .progress = settings->reference_progress,
        .ctx = settings->ctx};
}

/* Without a budget of the user's own, all cells together get a time. Steps are halved, so the
 * last run of a series that gets through takes as long as all before it; one more may be over
 * budget, and what got through is run once more in a round. */
static void share_time(struct cs_compare *compare) {
    const struct cs_sweep *sweep = &compare->sweep;
    uint32_t n = 0;
    for (uint32_t k = 0; k < sweep->n; k++)
        n += k == 0 || !cs_cell_same_series(sweep->cells + k, sweep->cells + k - 1);
    compare->budget = compare->settings->budget > 0
                          ? compare->settings->budget
                          : fmin(CS_COMPARE_SECONDS / (5 * fmax(n, 1)), CS_COMPARE_MOST);
    compare->rounds_for = fmax(CS_COMPARE_ROUND_SECONDS, 5 * compare->settings->budget);
}

/* A method that cannot follow the scene, which others can, is left out: one row says why. */
static void refuse(struct cs_sweep *sweep, uint32_t first, struct cs_error *error) {
    if (error->status != CS_ERR_SCENE)
        return;
    cs_sweep_refuse(sweep, first, error->message);
    *error = (struct cs_error){0};
}

/* An option that a method does not have is known before anything runs. */
static enum cs_status check_methods(struct cs_compare *compare, struct cs_error *error) {
    struct cs_sweep *sweep = &compare->sweep;
    struct cs_session_settings asked = compare->settings->course.session;
    char integrator[CS_CELL_INTEGRATOR];
    for (uint32_t k = 0; k < sweep->n && !error->status; k++) {
        const struct cs_cell *cell = sweep->cells + k;
        struct cs_session session = {0};
        if (*cell->outcome || (k > 0 && cs_cell_same_series(cell, cell - 1)))
            continue;
        cs_cell_integrator(cell, integrator, sizeof integrator);
        asked.integrator = integrator;
        if (cs_session_open_plan(&session, &asked, error))
            refuse(sweep, k, error);
        cs_session_close(&session);
    }
    return error->status;
}

/* The cells that this process is to run. */
static void keep_shard(struct cs_compare *compare) {
    struct cs_sweep *sweep = &compare->sweep;
    uint32_t kept = 0;
    for (uint32_t k = 0; k < sweep->n; k++)
        if (cs_shard_holds(&compare->settings->shard, k))
            sweep->cells[kept++] = sweep->cells[k];
    sweep->n = kept;
}

static enum cs_status make_cells(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_session_settings *session = &compare->settings->course.session;
    const struct cs_sweep_settings asked = {.list = compare->settings->methods,
                                            .plugins = session->plugins,
                                            .n_plugins = session->n_plugins,
                                            .fps = compare->fps,
                                            .omega = compare->omega,
                                            .size = compare->size};
    if (!cs_sweep_make(&compare->sweep, &asked, error) && !check_methods(compare, error)) {
        keep_shard(compare);
        share_time(compare);
    }
    return error->status;
}

/* What a row depends on: reference (with scene, overrides, length), then method. The sweep has
 * put the hash of the module there. */
static enum cs_status make_keys(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_compare_reference_settings asked = ask_reference(compare);
    struct cs_compare_reference reference;
    char of_reference[CS_HASH_DIGITS], of_cell[CS_HASH_DIGITS];
    cs_compare_reference_plan(&reference, &asked, of_reference, error);
    for (uint32_t k = 0; k < compare->sweep.n && !error->status; k++) {
        struct cs_cell *cell = compare->sweep.cells + k;
        struct cs_text all = {0};
        cs_text_add(&all, "%s|%s|%s", cell->key, cell->method, cell->options);
        cs_hash_bytes(cs_text_get(&all), all.length, of_cell);
        snprintf(cell->key, sizeof cell->key, "%.*s-%.16s", CS_COMPARE_DIGITS, of_reference,
                 of_cell);
        cs_text_finish(&all);
    }
    return error->status;
}

static void report_row(struct cs_compare *compare, const struct cs_cell *cell, bool taken) {
    compare->done++;
    if (compare->settings->row)
        compare->settings->row(compare->settings->ctx, cell, taken);
}

/* Shorter steps and tighter tolerances take longer still: nothing behind it is run. */
static bool is_ended(const struct cs_cell *cell) {
    return !*cell->outcome || !strcmp(cell->outcome, cs_outcome_text(CS_OVER_BUDGET));
}

static enum cs_status measure_cells(struct cs_compare *compare, struct cs_ledger *ledger,
                                    struct cs_error *error) {
    for (uint32_t k = 0; k < compare->sweep.n; k++)
        if (*compare->sweep.cells[k].outcome)
            report_row(compare, compare->sweep.cells + k, true);
    for (uint32_t k = 0; k < compare->sweep.n; k++) {
        struct cs_cell *cell = compare->sweep.cells + k;
        if (*cell->outcome)
            continue;
        if (k > 0 && cs_cell_same_series(cell, cell - 1) && is_ended(cell - 1)) {
            compare->done++;
            continue;
        }
        if (cs_compare_measure(compare, cell, error) || cs_ledger_append(ledger, cell, error))
            return error->status;
        report_row(compare, cell, false);
    }
    compare->left_out = cs_sweep_drop_open(&compare->sweep, &compare->ended);
    return CS_OK;
}

enum cs_status cs_compare_run(struct cs_compare *compare,
                              const struct cs_compare_settings *settings,
                              struct cs_error *error) {
    struct cs_ledger ledger = {0};
    *compare = (struct cs_compare){.settings = settings};
    cs_machine_name(compare->machine);
    const struct cs_compare_reference_settings reference = ask_reference(compare);
    // the folder is looked at before the reference, which may take long
    if (!look_at_scene(compare, error) && !tell_origin(compare, error) &&
        !make_cells(compare, error) && !make_keys(compare, error) &&
        !cs_ledger_open(&ledger, compare, error) && !write_origin(compare, error) &&
        !cs_compare_reference_get(&compare->reference, &reference, error)) {
        if (settings->begun)
            settings->begun(settings->ctx);
        if (!measure_cells(compare, &ledger, error) &&
            !cs_ledger_refresh(&ledger, compare, error) && !cs_compare_time(compare, error)) {
            cs_compare_find_orders(compare->sweep.cells, compare->sweep.n,
                                   compare->reference.bar, compare->reference.scale);
            cs_ledger_rewrite(&ledger, compare, error);
        }
    }
    cs_ledger_close(&ledger);
    return error->status;
}

void cs_compare_finish(struct cs_compare *compare) {
    cs_compare_reference_finish(&compare->reference);
    cs_sweep_finish(&compare->sweep);
    cs_rounds_finish(&compare->rounds);
    cs_text_finish(&compare->changes);
    cs_text_finish(&compare->origin);
    *compare = (struct cs_compare){0};
}
