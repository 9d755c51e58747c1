/* Finds a safe step for each method from linear theory, and confirms it by probe runs. */
#include "advise/advise.h"

#include "session/process_pool.h"
#include "session/scene_view.h"
#include "session/session.h"

#include <math.h>
#include <stdio.h>

/* Samples of a probe run, halvings of a step that proved unstable, and the steps that a run
 * must take before its budget ends to be an answer. */
enum { SAMPLES = 32, HALVINGS = 6, STEPS_TESTED = 4 };
#define PERTURBATION    1e-4 /* lengths of the shortest spring */
#define MARGIN          0.9  /* fraction of the limit that is advised */
#define GROWTH_SEEN     1e-7 /* growth per step that counts; less is rounding */
#define CALL_BUDGET     20   /* nominal s of work of a call, if none is given */
#define METHOD_BUDGET   5    /* and of each of some methods */
#define MOST_BUDGET     50   /* of many, so that a call ends within two minutes */
#define REFERENCE_SHARE 0.5  /* of the work for a method, that its reference may take */

/* Probe runs with the advised step, from the perturbed start and, if that is stable, from the
 * scene's own, as `run` takes it: a flag that hangs straight buckles in one of them only. Sets
 * the verdict, and steps and cost per frame. */
static enum cs_status try_safe(struct cs_advice *advice,
                               const struct cs_sampled_run_settings *settings,
                               const struct cs_reference *reference, double frame,
                               struct cs_error *error) {
    struct cs_sampled_run_settings asked = *settings;
    struct cs_sampled_run sample, run;
    asked.session.dt = advice->safe;
    asked.seconds = reference->seconds;
    for (int own = 0; own < 2 && (!own || cs_stability_is_stable(advice->verdict)); own++) {
        if (cs_sampled_run_execute(&run, &asked, error))
            return error->status;
        const enum cs_stability_verdict verdict =
            cs_stability_judge(&run, own ? NULL : &reference->run, true);
        asked.session.perturbation = 0;
        if (own && cs_stability_is_stable(verdict))
            break;
        sample = run;
        advice->verdict = verdict;
    }
    advice->checked_seconds = sample.result.reached;
    advice->speed = fmax(advice->speed, sample.speed_max);
    if (advice->verdict == CS_STABILITY_OVER_BUDGET && sample.steps < STEPS_TESTED) {
        advice->kind = CS_ADVICE_REFUSED;
        snprintf(advice->message, sizeof advice->message,
                 "the budget ended before %d steps were tested: a larger --budget is needed",
                 STEPS_TESTED);
    }
    if (cs_outcome_has_reason(sample.result.outcome))
        snprintf(advice->message, sizeof advice->message, "%.300s", sample.result.message);
    if (advice->checked_seconds > 0) {
        advice->frame_cost = sample.seconds / advice->checked_seconds * frame;
        advice->steps = (double)sample.steps / advice->checked_seconds * frame;
    }
    return CS_OK;
}

/* Probes the safe step and halves it until a run is stable. After HALVINGS attempts no step is
 * advised. */
static enum cs_status try_shorter(struct cs_advice *advice,
                                  const struct cs_sampled_run_settings *settings,
                                  const struct cs_reference *reference, double frame,
                                  struct cs_error *error) {
    for (int k = 0; k < HALVINGS; k++) {
        if (try_safe(advice, settings, reference, frame, error) ||
            !cs_advice_is_unstable(advice))
            return error->status;
        *advice->message = 0;
        advice->safe /= 2;
    }
    snprintf(advice->message, sizeof advice->message,
             "no step was found stable down to %.3g s: %s", 2 * advice->safe,
             cs_stability_word(advice->verdict));
    advice->kind = CS_ADVICE_NONE;
    advice->safe = 0;
    return CS_OK;
}

static enum cs_status end_search(struct cs_advice *advice) {
    advice->kind = CS_ADVICE_REFUSED;
    snprintf(advice->message, sizeof advice->message,
             "a step of %.3g s is unstable, and the budget ended the search for a smaller one",
             advice->safe);
    return CS_OK;
}

/* Theory has no limit: probes one step per frame. If it is unstable, large motions limit the
 * step, and the border is bisected. */
static enum cs_status try_frame(struct cs_advice *advice,
                                const struct cs_sampled_run_settings *settings,
                                const struct cs_reference *reference, double frame,
                                struct cs_error *error) {
    advice->kind = CS_ADVICE_FRAME;
    advice->limit = HUGE_VAL;
    advice->safe = fmin(frame, 10);
    if (try_safe(advice, settings, reference, frame, error) || !cs_advice_is_unstable(advice))
        return error->status;
    advice->kind = CS_ADVICE_MEASURED;
    if (cs_stability_boundary(settings, reference, 0, advice->safe, &advice->limit, error))
        return error->status;
    if (isnan(advice->limit))
        return end_search(advice);
    if (!(advice->limit > 0)) {
        advice->kind = CS_ADVICE_NONE;
        return CS_OK;
    }
    /* the message is about the step of a frame, which is not advised */
    *advice->message = 0;
    advice->safe = MARGIN * advice->limit;
    return try_shorter(advice, settings, reference, frame, error);
}

/* The margin below the limit of theory is unstable: bisects the border. A motion that is large
 * from the start exceeds the verdict's limits with less growth than theory allows. */
static enum cs_status try_lower(struct cs_advice *advice,
                                const struct cs_sampled_run_settings *settings,
                                const struct cs_reference *reference, double frame,
                                struct cs_error *error) {
    double border;
    if (cs_stability_boundary(settings, reference, 0, advice->safe, &border, error))
        return error->status;
    if (isnan(border))
        return end_search(advice);
    if (!(border > 0 && border < HUGE_VAL)) {
        advice->safe /= 2;
        return try_shorter(advice, settings, reference, frame, error);
    }
    advice->kind = CS_ADVICE_LOWERED;
    advice->limit = border;
    advice->safe = MARGIN * border;
    *advice->message = 0;
    return try_shorter(advice, settings, reference, frame, error);
}

/* Bisects the border for comparison with theory, up to 1.5 times its limit; a border there is
 * not known to be unstable, and the search goes on from it. */
static enum cs_status check_limit(struct cs_advice *advice,
                                  const struct cs_sampled_run_settings *settings,
                                  const struct cs_reference *reference,
                                  struct cs_error *error) {
    const double most = 1.5 * advice->limit;
    if (cs_stability_boundary(settings, reference, 0, most, &advice->measured, error) ||
        !(advice->measured > 0.98 * most && advice->measured < HUGE_VAL))
        return error->status;
    return cs_stability_boundary(settings, reference, 0.98 * most, HUGE_VAL, &advice->measured,
                                 error);
}

/* Uses a sound reference whose budget ended up to the time that it reached; tells whether. */
static bool keep_cut_reference(struct cs_reference *reference) {
    const struct cs_run_result *end = &reference->run.result;
    if (reference->exists || end->outcome != CS_OVER_BUDGET || !(end->reached > 0) ||
        !cs_stability_is_sound(reference->run.monitor.worst_verdict))
        return false;
    reference->exists = true;
    reference->seconds = end->reached;
    return true;
}

/* Advice for a method with option dt, in the order of advise.h. Steps above 1e100 s stand for
 * no limit. */
static enum cs_status advise_fixed(struct cs_advice *advice,
                                   const struct cs_sampled_run_settings *settings, double frame,
                                   bool check, struct cs_error *error) {
    struct cs_reference reference, none = {.seconds = settings->seconds};
    struct cs_sampled_run_settings half = *settings;
    advice->held = (1 - REFERENCE_SHARE) * advice->pot;
    half.session.run.budget = advice->pot -= advice->held;
    cs_reference_run(&reference, &half, error);
    advice->pot = fmax(advice->pot, 0) + advice->held;
    advice->held = 0;
    if (error->status)
        return error->status;
    const struct cs_reference *by = keep_cut_reference(&reference) ? &none : &reference;
    advice->cut = by == &none ? reference.seconds : 0;
    advice->steps_ahead = reference.steps_ahead;
    advice->limit = advice->theory = HUGE_VAL;
    if (reference.steps_ahead > 0)
        return try_frame(advice, settings, &none, frame, error);
    if (!reference.exists) {
        advice->kind = CS_ADVICE_REFUSED;
        snprintf(advice->message, sizeof advice->message, "the reference run failed: %.280s",
                 reference.message);
        return CS_OK;
    }
    advice->speed = reference.run.speed_max;
    advice->limit = advice->theory = reference.smallest_limit.dt;
    advice->mode = reference.smallest_limit.mode;
    advice->time = reference.smallest_time;
    advice->end_limit = reference.end_limit.dt;
    advice->seconds = reference.seconds;
    /* theory knows no limit */
    if (advice->limit > 1e100)
        return try_frame(advice, settings, by, frame, error);
    advice->kind = advice->limit > 0 ? CS_ADVICE_THEORY : CS_ADVICE_NONE;
    advice->safe = fmin(MARGIN * advice->limit, fmin(frame, 10));
    if (advice->kind == CS_ADVICE_NONE)
        return CS_OK;
    if (check && check_limit(advice, settings, by, error))
        return error->status;
    if (try_safe(advice, settings, by, frame, error) || !cs_advice_is_unstable(advice))
        return error->status;
    return try_lower(advice, settings, by, frame, error);
}

/* Growth rate in 1/s of the worst mode at the advised step, ln(radius) / dt. Theory calls a
 * mode stable if it grows too slowly to show in the time of the advice; the growth is reported.
 */
static enum cs_status measure_growth(struct cs_advice *advice, const struct cs_method *method,
                                     struct cs_error *error) {
    const struct cs_amplification amplification = {method->integrator, method->options, 0,
                                                   NULL};
    double radius;
    if (!(advice->safe > 0) || !(advice->theory > 0 && advice->theory < HUGE_VAL) ||
        cs_amplification_measure(&amplification, advice->safe,
                                 fmax(advice->mode.omega_squared, 0),
                                 fmax(advice->mode.damping_rate, 0), &radius, error))
        return error->status;
    advice->mode_growth =
        radius > 1 + GROWTH_SEEN && isfinite(radius) ? log(radius) / advice->safe : 0;
    return CS_OK;
}

/* Advice for a method that chooses its steps: a probe run without a reference. */
static enum cs_status advise_adaptive(struct cs_advice *advice,
                                      const struct cs_sampled_run_settings *settings,
                                      double frame, struct cs_error *error) {
    const struct cs_reference none = {.seconds = settings->seconds};
    advice->kind = CS_ADVICE_ADAPTIVE;
    return try_safe(advice, settings, &none, frame, error);
}

/* A method that refuses the scene becomes a row with the reason. The scene itself was accepted
 * before, with its own method. */
static enum cs_status refuse_advice(struct cs_advice *advice, struct cs_error *error) {
    if (error->status != CS_ERR_SCENE)
        return error->status;
    advice->kind = CS_ADVICE_REFUSED;
    snprintf(advice->message, sizeof advice->message, "%.300s", error->message);
    *error = (struct cs_error){0};
    return CS_OK;
}

/* Runs in a worker process: advice for one method. */
static enum cs_status advise_task(void *ctx, uint32_t task, struct cs_error *error) {
    struct cs_advise *advise = ctx;
    struct cs_advice *advice = advise->rows + task;
    struct cs_session session;
    struct cs_sampled_run_settings settings = {
        .session = advise->session, .seconds = advise->seconds, .samples = SAMPLES};
    const double frame = 1 / advise->was_opened.scene->time.fps;
    settings.session.perturbation =
        PERTURBATION * cs_diagnostics_shortest(&advise->was_opened.system);
    settings.session.run.pot = &advice->pot;
    settings.session.integrator = advice->method = advise->names[task];
    /* only to learn whether the method can follow the scene, and whether it takes dt */
    if (cs_session_open_plan(&session, &settings.session, error)) {
        advice->pot = 0;
        return refuse_advice(advice, error);
    }
    if (!cs_method_takes_dt(session.method.integrator))
        advise_adaptive(advice, &settings, frame, error);
    else if (!advise_fixed(advice, &settings, frame, advise->bisect_too, error))
        measure_growth(advice, &session.method, error);
    cs_session_close(&session);
    advice->pot = 0;
    return error->status;
}

/* Progress in hundredths of the budget. A method that has ended has none left. */
static void report(void *ctx, uint32_t ticks) {
    const struct cs_advise *advise = ctx;
    double left = 0;
    (void)ticks;
    for (uint32_t k = 0; k < advise->n; k++)
        left += fmax(advise->rows[k].pot, 0) + advise->rows[k].held;
    if (advise->progress)
        advise->progress(advise->ctx, (uint32_t)(100 * (1 - left / advise->budget)), 100);
}

/* The requested methods, or all of the registry. */
static enum cs_status list_methods(struct cs_advise *advise, struct cs_error *error) {
    advise->names = advise->methods;
    advise->n = advise->n_methods;
    if (!cs_registry_add_files(&advise->registry, advise->session.plugins,
                               advise->session.n_plugins, error) &&
        !advise->n_methods)
        advise->names = cs_registry_names(&advise->registry, true, &advise->n, error);
    return error->status;
}

enum cs_status cs_advise_run(struct cs_advise *advise, struct cs_error *error) {
    struct cs_process_pool pool = {.n_workers = advise->workers,
                                   .task = advise_task,
                                   .ctx = advise,
                                   .progress = report,
                                   .progress_ctx = advise,
                                   .stop = advise->stop};
    if (cs_session_open_system(&advise->was_opened, &advise->session, error) ||
        list_methods(advise, error))
        return error->status;
    pool.n_tasks = advise->n;
    advise->rows = cs_process_pool_shared_alloc(advise->n * sizeof *advise->rows, error);
    if (!(advise->budget > 0))
        advise->budget = fmin(fmax(CALL_BUDGET, METHOD_BUDGET * advise->n), MOST_BUDGET);
    pool.silence_max = cs_hang_seconds(advise->budget / advise->n);
    for (uint32_t k = 0; advise->rows && k < advise->n; k++)
        advise->rows[k].pot = advise->budget / advise->n;
    return advise->rows ? cs_process_pool_run(&pool, error) : error->status;
}

enum cs_status cs_advise_check(const struct cs_advise *advise, struct cs_error *error) {
    for (uint32_t k = 0; k < advise->n; k++)
        if (advise->rows[k].kind != CS_ADVICE_REFUSED)
            return CS_OK;
    return advise->n ? cs_fail(error, CS_ERR_UNSTABLE, "no advice: %s: %.250s",
                               advise->rows->method, advise->rows->message)
                     : CS_OK;
}

void cs_advise_finish(struct cs_advise *advise) {
    cs_process_pool_shared_free(advise->rows, advise->n * sizeof *advise->rows);
    cs_registry_finish(&advise->registry);
    cs_session_close(&advise->was_opened);
    *advise = (struct cs_advise){0};
}
