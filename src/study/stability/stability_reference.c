/* Runs a trusted reference, and tracks the limits of linear theory along its trajectory.
 *
 * Order of the work:
 *   1. Open the scene with the method whose limits are wanted; extend the time to 200 steps at
 *    the limit 2/omega, because an instability near the border grows slowly.
 *   2. Limits at the unperturbed start: worst mode, and Gershgorin bounds.
 *   3. Run velocity-verlet at half of its Gershgorin limit from the perturbed start. At each
 *    sample: tighten the limit of the worst mode, and the bounds that depend on the state.
 *   4. If the run is not stable, reset the limits to those of the start and halve the step. */
#include "study/stability/stability_state.h"

#include "model/force/diagnostics.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Attempts, each with half the step of the last one, before a scene has no reference. */
enum { MOST_HALVINGS = 4 };
/* Steps at the limit 2/omega that the run lasts at least. */
enum { STEPS = 200 };

/* Context of the samples of one run. */
struct way {
    struct cs_theory *theory; /* NULL: no limits are asked for */
    struct cs_reference *reference;
    double gershgorin; /* s, at the start */
    struct cs_error *error;
};

/* Tightens the limits at one sample. Bounds other than those of contact hold for the whole run,
 * so only state-dependent bounds are evaluated again. */
static void sample_theory(void *ctx, const struct cs_run *run, const struct cs_energy *energy) {
    struct way *way = ctx;
    (void)energy;
    if (!way->theory || way->error->status)
        return;
    // of the run: its colliders move, and its ramps continue
    way->theory->modes.system = run->system;
    way->theory->modes.t = run->t;
    cs_theory_tighten(way->theory, run->x, &way->reference->smallest_limit, way->error);
    // bounds other than those of contact hold for the whole run
    if (!way->error->status && cs_spectral_bounds_depend_on_state(run->system))
        cs_theory_gershgorin(way->theory, run->x, &way->reference->gershgorin_limit,
                             way->error);
}

/* Runs once with the step dt in s. Returns false if the run blew up, was unstable, failed or had
 * an error. The limits that a failed run collected are discarded. */
static bool run_once(struct cs_reference *reference,
                     const struct cs_sampled_run_settings *settings, double dt, struct way *way,
                     struct cs_error *error) {
    struct cs_sampled_run_settings asked = *settings;
    asked.session.integrator = "velocity-verlet";
    asked.session.dt = dt;
    asked.on_sample = sample_theory;
    asked.ctx = way;
    // limits along a failed run do not count
    reference->smallest_limit = reference->start_limit;
    reference->gershgorin_limit = way->gershgorin;
    return !cs_sampled_run_execute(&reference->run, &asked, error) && !way->error->status &&
           reference->run.result.outcome == CS_RUNNING &&
           cs_stability_is_sound(reference->run.monitor.worst_verdict);
}

/* Halves the step until a run succeeds. A run out of budget ends the attempts, because a
 * shorter step costs more. */
static void run_reference(struct cs_reference *reference,
                          const struct cs_sampled_run_settings *settings, double dt,
                          struct way *way, struct cs_error *error) {
    for (int k = 0; k < MOST_HALVINGS && !reference->exists && !error->status; k++) {
        reference->exists = run_once(reference, settings, dt, way, error);
        if (reference->run.result.outcome == CS_OVER_BUDGET)
            break;
        dt /= 2;
    }
    if (!reference->exists)
        snprintf(reference->message, sizeof reference->message, "velocity-verlet: %.280s",
                 reference->run.result.message);
}

/* Growth rate in 1/s that the run cannot show: ln(length / perturbation) / seconds, from the
 * perturbation to the length of the longest spring within the time of the run. 0 without a
 * perturbation. */
static double growth_of(const struct cs_system *system,
                        const struct cs_sampled_run_settings *settings) {
    double length = 0;
    for (uint32_t r = 0; r < system->springs.n_runs; r++)
        for (uint32_t i = 0; i < system->springs.runs[r].count; i++)
            length = fmax(length, cs_spring_length(system->springs.runs + r, i));
    return settings->session.perturbation > 0 && length > settings->session.perturbation
               ? log(length / settings->session.perturbation) / settings->seconds
               : 0;
}

/* Step of the reference in s: half of the Gershgorin limit, at most one sample (`space`) and 10
 * s.
 *
 * With square = w^2 and rate = r, a symplectic step with explicit damping has trace 2 - h r -
 * (h w)^2 and determinant 1 - h r. It is stable while |trace| <= 1 + determinant: (h w)^2 + 2 h
 * r <= 4. The positive root is h = 4 / (r + sqrt(r^2 + 4 w^2)), 2/w without damping. Half of it
 * also satisfies the condition of velocity-verlet, whose damping uses a predicted velocity: (h
 * w)^2 + 4 h r <= 4. */
static double choose_dt(const struct cs_system *system, double space) {
    const double w = system->view.omega, r = 2 * system->view.delta;
    const double limit = 4 / (r + sqrt(r * r + 4 * w * w));
    return fmin(fmin(0.5 * limit, space), 10);
}

/* Limits at the start, then the run. theory stays empty for a method without option dt. */
static enum cs_status run_with(struct cs_reference *reference, struct cs_session *session,
                               const struct cs_sampled_run_settings *settings,
                               struct cs_error *error) {
    struct cs_theory theory = {0};
    struct way way = {.reference = reference, .gershgorin = HUGE_VAL, .error = error};
    reference->gershgorin_limit = reference->start_limit.dt = reference->smallest_limit.dt =
        HUGE_VAL;
    if (cs_method_takes_dt(session->method.integrator)) {
        way.theory = &theory;
        if (cs_theory_init(&theory, &session->system, session->method.integrator,
                           session->method.options, growth_of(&session->system, settings),
                           error) ||
            cs_theory_gershgorin(&theory, session->system.state, &reference->gershgorin_limit,
                                 error) ||
            cs_theory_at(&theory, session->system.state, &reference->start_limit, error))
            goto done;
        way.gershgorin = reference->gershgorin_limit;
    }
    run_reference(reference, settings,
                  choose_dt(&session->system, settings->seconds / settings->samples), &way,
                  error);
done:
    cs_theory_finish(&theory);
    return error->status;
}

enum cs_status cs_reference_run(struct cs_reference *reference,
                                const struct cs_sampled_run_settings *settings,
                                struct cs_error *error) {
    struct cs_sampled_run_settings asked = *settings;
    struct cs_session session;
    *reference = (struct cs_reference){0};
    asked.session.dt = asked.session.perturbation = 0;
    if (cs_session_open_system(&session, &asked.session, error))
        return error->status;
    asked.session.perturbation = settings->session.perturbation;
    if (session.system.view.omega > 0)
        asked.seconds = fmax(asked.seconds, STEPS * 2 / session.system.view.omega);
    reference->seconds = asked.seconds;
    run_with(reference, &session, &asked, error);
    cs_session_close(&session);
    return error->status;
}
