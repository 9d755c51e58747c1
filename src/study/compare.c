#include "study/compare.h"

#include "base/hash.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The scene as it is, and what its smooth form comes to. */
static enum cs_status look_at_scene(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_course_settings *settings = &compare->settings->course;
    struct cs_session_settings asked = settings->session;
    struct cs_session session = {0};
    struct cs_course course = {0};
    asked.integrator = "velocity-verlet";
    if (!cs_session_open_plan(&session, &asked, error))
        cs_course_describe_changes(&session.scene, &compare->changes);
    cs_session_close(&session);
    if (!error->status && !cs_course_open(&course, settings, asked.integrator, error)) {
        const struct cs_system *system = &course.session.system;
        snprintf(compare->scene, sizeof compare->scene, "%.255s", asked.scene);
        compare->particles = system->view.n;
        compare->springs = course.session.plan.n_springs;
        compare->fps = course.session.scene.time.fps;
        compare->omega = fmax(system->view.omega, 1e-3);
        compare->time = settings->frames / compare->fps;
    }
    cs_course_close(&course);
    return error->status;
}

static enum cs_status get_reference(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_compare_settings *settings = compare->settings;
    const struct cs_yardstick_settings asked = {
        .course = &settings->course,
        .methods = {settings->reference[0], settings->reference[1]},
        .accuracy = settings->accuracy,
        .cache = settings->cache,
        .progress = settings->reference_progress,
        .ctx = settings->ctx};
    return cs_yardstick_get(&compare->yardstick, &asked, error);
}

static enum cs_status make_cells(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_session_settings *session = &compare->settings->course.session;
    const struct cs_sweep_settings asked = {.list = compare->settings->methods,
                                            .plugins = session->plugins,
                                            .n_plugins = session->n_plugins,
                                            .fps = compare->fps,
                                            .omega = compare->omega};
    return cs_sweep_make(&compare->sweep, &asked, error);
}

/* What a row depends on: reference (with scene, overrides, length), method, ways to measure. */
static enum cs_status make_keys(struct cs_compare *compare, struct cs_error *error) {
    const struct cs_compare_settings *settings = compare->settings;
    struct cs_session session = {0};
    struct cs_session_settings asked = settings->course.session;
    char of_reference[CS_HASH_DIGITS] = "";
    const struct cs_yardstick_settings by = {.course = &settings->course,
                                             .accuracy = settings->accuracy};
    asked.integrator = "velocity-verlet";
    if (!cs_session_open_plan(&session, &asked, error))
        cs_yardstick_key(&compare->yardstick, &session.scene, &by, of_reference);
    for (uint32_t k = 0; k < compare->sweep.n && !error->status; k++) {
        struct cs_cell *cell = compare->sweep.cells + k;
        struct cs_text all = {0};
        cs_text_add(&all, "%s|%s|%s|%u|%.17g", of_reference, cell->method, cell->options,
                    settings->runs, settings->budget);
        cs_hash_bytes(cs_text_get(&all), all.length, cell->key);
        cs_text_finish(&all);
    }
    cs_session_close(&session);
    return error->status;
}

static void report_row(struct cs_compare *compare, const struct cs_cell *cell, bool taken) {
    compare->done++;
    if (compare->settings->row)
        compare->settings->row(compare->settings->ctx, cell, taken);
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
        if (cs_compare_measure(compare, cell, error) || cs_ledger_append(ledger, cell, error))
            return error->status;
        report_row(compare, cell, false);
    }
    return CS_OK;
}

enum cs_status cs_compare_run(struct cs_compare *compare,
                              const struct cs_compare_settings *settings,
                              struct cs_error *error) {
    struct cs_ledger ledger = {0};
    *compare = (struct cs_compare){.settings = settings};
    if (!look_at_scene(compare, error) && !make_cells(compare, error) &&
        !get_reference(compare, error) && !make_keys(compare, error) &&
        !cs_ledger_open(&ledger, compare, error)) {
        if (settings->begun)
            settings->begun(settings->ctx);
        if (!measure_cells(compare, &ledger, error)) {
            cs_compare_find_orders(compare->sweep.cells, compare->sweep.n,
                                   compare->yardstick.bar, compare->yardstick.scale);
            cs_ledger_rewrite(&ledger, compare, error);
        }
    }
    cs_ledger_close(&ledger);
    return error->status;
}

void cs_compare_finish(struct cs_compare *compare) {
    cs_yardstick_finish(&compare->yardstick);
    cs_sweep_finish(&compare->sweep);
    cs_text_finish(&compare->changes);
    *compare = (struct cs_compare){0};
}
