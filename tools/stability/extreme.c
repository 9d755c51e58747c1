/* Runs the catalogue of extreme scenes with every method, against what each scene expects. */
#include "stability/extreme.h"

#include "base/clock.h"
#include "session/perturb.h"
#include "session/process_pool.h"
#include "session/scene_view.h"
#include "session/session.h"
#include "stability/extreme_scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PERTURBATION 1e-4 /* lengths of the shortest spring */

/* Facts about the end of a run that its verdict does not hold. */
struct ending {
    bool refused, silent; /* silent: not finite, and the run did not say so */
    double theory;        /* s, limit at the start; HUGE_VAL: none */
};

/* Sets the message of a row, cut to its size. */
static void say(struct cs_extreme_row *row, const char *text) {
    snprintf(row->message, sizeof row->message, "%.310s", text);
}

/* Steps to the end, a verdict or the end of the budget. The energy monitor samples each frame.
 * A blow-up that the run reports takes precedence over the monitor's verdict. */
static void step(struct cs_extreme_row *row, struct cs_session *session, double seconds,
                 struct ending *ending, struct cs_error *error) {
    struct cs_run *run = &session->run;
    struct cs_energy_monitor monitor;
    struct cs_energy_monitor_row look;
    struct cs_run_result result;
    struct cs_text text = {0};
    struct cs_follow follow = {
        .run = run, .last = cs_follow_frames(session->scene, seconds), .every = 1};
    if (cs_energy_monitor_begin(&monitor, run, error))
        return;
    while (cs_follow_next(&follow, error)) {
        cs_energy_monitor_sample(&monitor, run, &look);
        ending->silent |= look.verdict == CS_STABILITY_NOT_FINITE;
    }
    if (cs_follow_result(run, "", &result, error))
        return;
    cs_energy_monitor_print(&monitor, run->system, &text);
    ending->refused = cs_outcome_has_reason(result.outcome);
    row->verdict = ending->refused                    ? CS_STABILITY_FAILED
                   : result.outcome == CS_OVER_BUDGET ? CS_STABILITY_OVER_BUDGET
                   : result.outcome == CS_NOT_FINITE  ? CS_STABILITY_NOT_FINITE
                   : result.outcome == CS_UNBOUNDED   ? CS_STABILITY_GLOBAL
                                                      : monitor.worst_verdict;
    say(row, ending->refused || result.outcome == CS_OVER_BUDGET ? result.message
                                                                 : cs_text_get(&text));
    cs_text_finish(&text);
}

/* True for a verdict that the expectation "blows up" accepts. */
static bool is_blown(enum cs_stability_verdict verdict) {
    return verdict == CS_STABILITY_GLOBAL || verdict == CS_STABILITY_NOT_FINITE;
}

/* Compares the outcome with the expectation. Within 10 % of the theoretical limit both outcomes
 * are accepted: "bounded" below 1.1 times the limit, "blown" above 0.9 times. A silent
 * non-finite state never meets an expectation. */
static bool is_met(const struct cs_extreme_row *row, double dt, const struct ending *ending) {
    const bool bounded = cs_stability_is_stable(row->verdict);
    const bool finite = bounded || row->verdict == CS_STABILITY_LOCAL;
    const bool blown = is_blown(row->verdict) || row->verdict == CS_STABILITY_LOCAL;
    if (ending->silent)
        return false;
    if (cs_extreme_expects(row->expected, "theory") &&
        (dt < 1.1 * ending->theory ? bounded && !ending->refused : false))
        return true;
    if (cs_extreme_expects(row->expected, "theory") && dt > 0.9 * ending->theory && blown)
        return true;
    return (cs_extreme_expects(row->expected, "bounded") && bounded) ||
           (cs_extreme_expects(row->expected, "finite") && finite) ||
           (cs_extreme_expects(row->expected, "blows up") && is_blown(row->verdict)) ||
           (cs_extreme_expects(row->expected, "refused") && ending->refused) ||
           (cs_extreme_expects(row->expected, "over budget") &&
            row->verdict == CS_STABILITY_OVER_BUDGET);
}

/* Step limit in s at the start. Modes that grow by less than a factor e^7 = 1100 during the run
 * count as stable, because the perturbation of 1e-4 needs about that to show. */
static enum cs_status find_theory(struct cs_session *session, double seconds, double *limit,
                                  struct cs_error *error) {
    struct cs_theory theory;
    struct cs_theory_limit found = {.dt = HUGE_VAL};
    /* what grows less than e^7 in the time of the run is not seen */
    if (!cs_theory_init(&theory, &session->system, session->method.integrator,
                        session->method.options, 7 / seconds, error))
        cs_theory_at(&theory, session->system.state, &found, error);
    cs_theory_finish(&theory);
    *limit = found.dt;
    return error->status;
}

/* A scene or method that is refused before the first step is an outcome too. Errors of the
 * command, of memory and interruption stay errors. */
static enum cs_status take_refusal(struct cs_extreme_row *row, struct ending *ending,
                                   struct cs_error *error) {
    if (error->status == CS_ERR_MEMORY || error->status == CS_ERR_INTERRUPT ||
        error->status == CS_ERR_USAGE)
        return error->status;
    ending->refused = true;
    row->verdict = CS_STABILITY_FAILED;
    say(row, error->message);
    *error = (struct cs_error){0};
    return CS_OK;
}

/* True if a method without needs follows the scene: one that refuses it says what it needs. */
static bool is_followed_by_others(struct cs_session_settings settings) {
    struct cs_session session = {0};
    struct cs_error ignored = {0};
    settings.integrator = "symplectic-euler";
    const bool opens = !cs_session_open_plan(&session, &settings, &ignored);
    cs_session_close(&session);
    return opens;
}

/* Runs one scene with one method: open, perturb, predict, step, judge. */
static enum cs_status run_row(const struct cs_extreme *extreme,
                              const struct cs_extreme_scene *scene, struct cs_extreme_row *row,
                              struct cs_error *error) {
    struct cs_session session = {0};
    struct ending ending = {.theory = HUGE_VAL};
    const struct cs_session_settings settings = {
        .scene = scene->path,
        .integrator = row->method,
        .plugins = extreme->plugins,
        .n_plugins = extreme->n_plugins,
        .run = {.stop = extreme->stop, .budget = extreme->budget}};
    const double begin = cs_clock_wall();
    double dt = 0;
    if (cs_session_open_plan(&session, &settings, error)) {
        row->as_expected = is_followed_by_others(settings);
        row->is_done = true;
        return take_refusal(row, &ending, error);
    }
    row->expected = cs_extreme_expected(scene, session.method.integrator);
    if (scene->dt > 0 && cs_method_set_dt(&session.method, scene->dt))
        dt = scene->dt;
    // long steps are what is extreme
    cs_method_step_by_frames(&session.method);
    if (!cs_session_build(&session, error)) {
        /* an instability needs something to grow from */
        cs_perturb_random(&session.system,
                          PERTURBATION * cs_diagnostics_shortest(&session.system), 0);
        if (dt > 0 && cs_extreme_expects(row->expected, "theory"))
            find_theory(&session, scene->seconds, &ending.theory, error);
        if (!error->status && !cs_session_begin(&session, NULL, error))
            step(row, &session, scene->seconds, &ending, error);
    }
    if (error->status)
        take_refusal(row, &ending, error);
    row->as_expected = is_met(row, dt, &ending);
    row->seconds = cs_clock_wall() - begin;
    row->is_done = true;
    cs_session_close(&session);
    return error->status;
}

/* A run over the catalogue: scenes times methods, and the rows in shared memory. */
struct catalogue {
    struct cs_extreme *extreme;
    struct cs_extreme_scene *scenes;
    uint32_t reported;
    struct cs_extreme_row *rows; /* (n_scenes, n_methods), seen by all workers */
    const char *const *methods;
    uint32_t n_scenes, n_methods;
};

/* Task k is row k of the table (n_scenes, n_methods). */
static enum cs_status run_task(void *ctx, uint32_t task, struct cs_error *error) {
    struct catalogue *catalogue = ctx;
    return run_row(catalogue->extreme, catalogue->scenes + task / catalogue->n_methods,
                   catalogue->rows + task, error);
}

/* The requested names, or all methods of the registry that follow the motion of springs. */
static enum cs_status list_methods(struct catalogue *catalogue, struct cs_registry *registry,
                                   struct cs_error *error) {
    const struct cs_extreme *extreme = catalogue->extreme;
    catalogue->methods = extreme->methods;
    catalogue->n_methods = extreme->n_methods;
    if (!cs_registry_add_files(registry, extreme->plugins, extreme->n_plugins, error) &&
        !extreme->n_methods)
        catalogue->methods = cs_registry_names(registry, false, &catalogue->n_methods, error);
    return error->status;
}

/* Removes the scenes whose name does not contain the text (NULL: keeps all). */
static void filter_scenes(struct catalogue *catalogue, const char *part) {
    uint32_t kept = 0;
    for (uint32_t k = 0; k < catalogue->n_scenes; k++)
        if (!part || strstr(catalogue->scenes[k].name, part))
            catalogue->scenes[kept++] = catalogue->scenes[k];
    catalogue->n_scenes = kept;
}

/* Reports the finished rows in order. all: unfinished rows are reported as over budget too;
 * their worker was stopped in a step that never ended. */
static void report_rows(struct catalogue *catalogue, bool all) {
    struct cs_extreme *extreme = catalogue->extreme;
    const uint32_t n = catalogue->n_scenes * catalogue->n_methods;
    while (catalogue->reported < n && (all || catalogue->rows[catalogue->reported].is_done)) {
        struct cs_extreme_row *row = catalogue->rows + catalogue->reported++;
        if (!row->is_done) {
            row->as_expected = cs_extreme_expects(row->expected, "over budget");
            row->verdict = CS_STABILITY_OVER_BUDGET;
            say(row, "no step ended: it was stopped as one that hangs");
        }
        *(row->as_expected ? &extreme->n_met : &extreme->n_missed) += 1;
        if (extreme->report)
            extreme->report(extreme->ctx, row);
    }
}

static void progress(void *ctx, uint32_t ticks) {
    (void)ticks;
    report_rows(ctx, false);
}

static enum cs_status run_all(struct catalogue *catalogue, struct cs_error *error) {
    const uint32_t n = catalogue->n_scenes * catalogue->n_methods;
    catalogue->rows = cs_process_pool_shared_alloc(n * sizeof *catalogue->rows, error);
    if (!catalogue->rows)
        return error->status;
    /* these texts are from before the fork: their addresses hold in every worker */
    for (uint32_t k = 0; k < n; k++) {
        catalogue->rows[k].scene = catalogue->scenes[k / catalogue->n_methods].name;
        catalogue->rows[k].method = catalogue->methods[k % catalogue->n_methods];
        catalogue->rows[k].expected = "";
    }
    struct cs_process_pool pool = {
        .n_workers = catalogue->extreme->n_workers,
        .n_tasks = n,
        .task = run_task,
        .ctx = catalogue,
        .progress = progress,
        .progress_ctx = catalogue,
        /* a run ends itself at its budget: only a step that never ends is cut off */
        .silence_max = cs_hang_seconds(catalogue->extreme->budget),
        .task_seconds_max = cs_hang_seconds(10 * catalogue->extreme->budget),
        .stop = catalogue->extreme->stop};
    return cs_process_pool_run(&pool, error);
}

enum cs_status cs_extreme_run(struct cs_extreme *extreme, struct cs_error *error) {
    struct catalogue catalogue = {.extreme = extreme};
    struct cs_registry registry = {0};
    extreme->n_met = extreme->n_missed = 0;
    if (cs_extreme_scenes(extreme->folder, &catalogue.scenes, &catalogue.n_scenes, error) ||
        list_methods(&catalogue, &registry, error))
        goto done;
    filter_scenes(&catalogue, extreme->only_scene);
    if (!catalogue.n_scenes)
        cs_fail(error, CS_ERR_USAGE, "no scene of the catalogue has \"%.60s\" in its name",
                extreme->only_scene);
    else if (!run_all(&catalogue, error)) {
        /* rows that no worker finished are reported too */
        report_rows(&catalogue, true);
        if (extreme->n_missed)
            cs_fail(error, CS_ERR_CHECK, "%u of %u runs did not end as expected",
                    extreme->n_missed, extreme->n_missed + extreme->n_met);
    }
done:
    cs_process_pool_shared_free(catalogue.rows, catalogue.n_scenes * catalogue.n_methods *
                                                    sizeof *catalogue.rows);
    free(catalogue.scenes);
    cs_registry_finish(&registry);
    return error->status;
}
