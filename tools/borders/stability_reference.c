/* Runs a trusted reference, and tracks the limits of linear theory along its trajectory.
 *
 * Order of the work:
 *   1. Open the scene with the method whose limits are wanted; extend the time to 200 steps at
 *    the limit 2/omega, because an instability near the border grows slowly.
 *   2. Limits at the unperturbed start: worst mode, and Gershgorin bounds.
 *   3. Run velocity-verlet at half of its Gershgorin limit from the perturbed start. At each
 *    step, or each eighth without contact: bounds that depend on the state, by rate. Where they
 * are tightest so far, and at times of a fixed grid: tighten the limit of the worst mode, and
 * the Gershgorin limit.
 *   4. If the run is not stable, reset the limits to those of the start and halve the step. */
#include "borders/stability_state.h"

#include "session/session.h"

#include <math.h>
#include <stdio.h>

/* Attempts, each with half the step of the last one, before a scene has no reference. */
enum { MOST_HALVINGS = 4 };
/* Steps at the limit 2/omega that the run lasts at least. */
enum { STEPS = 200 };

/* s; theory looks at the run every GRID, later every t / GRID_RATIO: times that do not depend
 * on the length of the run, so that the limit of a longer run is never larger. */
#define GRID       (1.0 / 64)
#define GRID_RATIO 32
/* Fraction of the smallest limit by rate so far below which a step is looked at too. */
#define TIGHTER 0.95
/* Work of bounds at a state, and of those with bending, in passes over the forces, about. */
#define BOUND_PASSES   10
#define BENDING_PASSES 35
/* Steps from one bound to the next where bounds change with the motion alone: a step is at most
 * 1/omega, hence about a period of the stiffest mode. */
enum { STEPS_PER_BOUND = 8 };

/* Context of the steps of one run. */
struct way {
    struct cs_theory *theory; /* NULL: no limits are asked for */
    struct cs_reference *reference;
    struct cs_system *system; /* of the run: its colliders move, and its ramps continue */
    bool is_explicit;
    double gershgorin;    /* s, at the start */
    double next;          /* s, time of the next look */
    double smallest_rate; /* s, smallest limit by rate so far */
    uint64_t steps;       /* that were looked at */
    struct cs_error *error;
};

/* Limit in s by rate of a symplectic step with explicit damping, at most 2/w. With square = w^2
 * and rate = r it has trace 2 - h r - (h w)^2 and determinant 1 - h r, and is stable while
 * |trace|
 * <= 1 + determinant: (h w)^2 + 2 h r <= 4. The positive root is h = 4 / (r + sqrt(r^2 + 4
 * w^2)). */
static double limit_by_rate(double w, double r) {
    return 4 / (r + sqrt(r * r + 4 * w * w));
}

/* Subtracts passes over the forces that no run counts from the work that is left. */
static void charge(struct way *way, double passes) {
    const struct cs_stiffest_modes *modes = &way->theory->modes;
    if (modes->pot)
        *modes->pot -= passes * modes->pass_seconds;
}

/* True if the stiffness of contact at the state leaves a clearly smaller step than any before.
 * The bounds cost about an evaluation of the force, a search for the mode fifty and more.
 * Dampers are left to the looks of the grid. */
static bool is_tightest(struct way *way, const struct cs_eval *at) {
    double w, delta;
    if (!cs_spectral_bounds_depend_on_state(way->system) ||
        (way->steps++ % STEPS_PER_BOUND && !cs_spectral_bounds_can_jump(way->system)))
        return false;
    cs_spectral_bounds_rate(way->system, at, false, way->theory->modes.dx, &w, &delta);
    charge(way, cs_system_bends(way->system) ? BENDING_PASSES : BOUND_PASSES);
    const double limit = limit_by_rate(w, 2 * way->system->view.delta);
    if (!(limit < TIGHTER * way->smallest_rate))
        return false;
    way->smallest_rate = limit;
    return true;
}

/* Tightens the limits at a state, and notes the time of the smallest. Without a limit at the
 * start contact may bring one. */
static void tighten(struct way *way, double t, const double *x, bool with_dampers) {
    struct cs_reference *reference = way->reference;
    struct cs_theory_limit *smallest = &reference->smallest_limit;
    const double before = smallest->dt;
    if (smallest->dt < HUGE_VAL)
        cs_theory_tighten(way->theory, x, with_dampers, smallest, way->error);
    else if (way->is_explicit && cs_spectral_bounds_depend_on_state(way->system))
        cs_theory_at(way->theory, x, smallest, way->error);
    if (smallest->dt < before)
        reference->smallest_time = t;
    /* bounds other than those of contact hold for the whole run; nothing limits an implicit
     * method without a limit at the start */
    if (!way->error->status && cs_spectral_bounds_depend_on_state(way->system) &&
        (way->is_explicit || reference->gershgorin_limit < HUGE_VAL))
        cs_theory_gershgorin(way->theory, x, &reference->gershgorin_limit, way->error);
}

/* Called after every step of the run: looks at it if its bounds are the tightest so far, or if
 * a look is due. Moves nothing. */
static bool look_at_step(void *ctx, double t, double dt, double *x, double *v) {
    struct way *way = ctx;
    (void)dt;
    if (!way->theory || !way->system || way->error->status)
        return false;
    const struct cs_eval at = {.t = t, .x = x, .v = v, .parts = CS_PART_ALL};
    way->theory->modes.system = way->system;
    way->theory->modes.t = t;
    const bool tightest = is_tightest(way, &at);
    if (!tightest && t < way->next)
        return false;
    const bool due = t >= way->next;
    if (due)
        way->next = t + fmax(GRID, t / GRID_RATIO);
    tighten(way, t, x, due);
    return false;
}

/* The first sample gives the system of the run. The last one is at rest, or as near as the run
 * comes: its limit stands beside the smallest. */
static void take_sample(void *ctx, const struct cs_run *run, const struct cs_energy *energy) {
    struct way *way = ctx;
    (void)energy;
    way->system = run->system;
    if (way->theory && !way->error->status && run->t >= way->reference->seconds * (1 - 1e-9) &&
        way->reference->smallest_limit.dt < HUGE_VAL &&
        cs_spectral_bounds_depend_on_state(run->system)) {
        way->theory->modes.system = run->system;
        way->theory->modes.t = run->t;
        cs_theory_at(way->theory, run->x, &way->reference->end_limit, way->error);
    }
}

/* Runs once with the step dt in s. Returns false if the run blew up, was unstable, failed or
 * had an error. The limits that a failed run collected are discarded. */
static bool run_once(struct cs_reference *reference,
                     const struct cs_sampled_run_settings *settings, double dt, struct way *way,
                     struct cs_error *error) {
    struct cs_sampled_run_settings asked = *settings;
    asked.session.integrator = "velocity-verlet";
    asked.session.dt = dt;
    asked.on_sample = take_sample;
    asked.ctx = way;
    asked.session.run.after_commit = look_at_step;
    asked.session.run.ctx = way;
    way->system = NULL;
    way->next = 0;
    way->smallest_rate = HUGE_VAL;
    way->steps = 0;
    reference->smallest_time = 0;
    // limits along a failed run do not count
    reference->smallest_limit = reference->start_limit;
    reference->gershgorin_limit = way->gershgorin;
    return !cs_sampled_run_execute(&reference->run, &asked, error) && !way->error->status &&
           reference->run.result.outcome == CS_RUNNING &&
           cs_stability_is_sound(reference->run.monitor.worst_verdict);
}

/* Sets the message: a singular force, or else how the last run ended. */
static void name_failure(struct cs_reference *reference,
                         const struct cs_sampled_run_settings *settings,
                         struct cs_error *error) {
    struct cs_singular_force cause;
    cs_singular_force_find(&settings->session, settings->seconds,
                           4.0 * (double)reference->run.steps, &cause, error);
    snprintf(reference->message, sizeof reference->message, "%s%.280s",
             *cause.text ? "" : "velocity-verlet: ",
             *cause.text ? cause.text : reference->run.result.message);
}

/* True if the method has no limit to be found along the run, and the run would take more than
 * its budget: such a reference is not begun. A step takes an evaluation of the forces. */
static bool is_beyond(struct cs_reference *reference,
                      const struct cs_sampled_run_settings *settings, double dt,
                      const struct way *way) {
    const double steps = settings->seconds / dt, budget = settings->session.run.budget;
    if (way->is_explicit || !way->theory || reference->start_limit.dt < HUGE_VAL ||
        !(budget > 0) || !(steps * way->theory->modes.pass_seconds > budget))
        return false;
    reference->steps_ahead = steps;
    snprintf(reference->message, sizeof reference->message,
             "velocity-verlet: its %.3g steps exceed the budget", steps);
    return true;
}

/* Halves the step until a run succeeds. A run out of budget ends the attempts, because a
 * shorter step costs more. */
static void run_reference(struct cs_reference *reference,
                          const struct cs_sampled_run_settings *settings, double dt,
                          struct way *way, struct cs_error *error) {
    if (is_beyond(reference, settings, dt, way))
        return;
    for (int k = 0; k < MOST_HALVINGS && !reference->exists && !error->status; k++) {
        reference->exists = run_once(reference, settings, dt, way, error);
        if (reference->run.result.outcome == CS_OVER_BUDGET)
            break;
        dt /= 2;
    }
    if (!reference->exists && !error->status)
        name_failure(reference, settings, error);
}

/* Growth rate in 1/s that the run cannot show: ln(length / perturbation) / seconds, from the
 * perturbation to the length of the longest spring within the time of the run. 0 without a
 * perturbation. */
static double growth_of(const struct cs_system *system,
                        const struct cs_sampled_run_settings *settings) {
    const double length = cs_system_longest_spring(system);
    return settings->session.perturbation > 0 && length > settings->session.perturbation
               ? log(length / settings->session.perturbation) / settings->seconds
               : 0;
}

/* Step of the reference in s: half of the Gershgorin limit, at most one sample (`space`) or
 * look of theory, and 10 s. Half of the limit by rate also satisfies the condition of
 * velocity-verlet, whose damping uses a predicted velocity: (h w)^2 + 4 h r <= 4. */
static double choose_dt(const struct cs_system *system, double space) {
    const double limit = limit_by_rate(system->view.omega, 2 * system->view.delta);
    return fmin(fmin(0.5 * limit, fmax(space, GRID)), 10);
}

/* Limits at the start, then the run. theory stays empty for a method without option dt. */
static enum cs_status run_with(struct cs_reference *reference, struct cs_session *session,
                               const struct cs_sampled_run_settings *settings,
                               struct cs_error *error) {
    struct cs_theory theory = {0};
    struct way way = {.reference = reference, .gershgorin = HUGE_VAL, .error = error};
    reference->gershgorin_limit = reference->start_limit.dt = reference->smallest_limit.dt =
        reference->end_limit.dt = HUGE_VAL;
    way.is_explicit = !(session->method.integrator->traits & CS_IMPLICIT);
    if (cs_method_takes_dt(session->method.integrator)) {
        way.theory = &theory;
        if (cs_theory_init(&theory, &session->system, session->method.integrator,
                           session->method.options, growth_of(&session->system, settings),
                           error))
            goto done;
        theory.modes.pot = theory.amplification.pot = settings->session.run.pot;
        theory.modes.pass_seconds = cs_pass_seconds(&session->system);
        if (cs_theory_gershgorin(&theory, session->system.state, &reference->gershgorin_limit,
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
