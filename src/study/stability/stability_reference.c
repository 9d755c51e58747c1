/* Runs a trusted reference, and follows the limits of linear theory along its trajectory. */
#include "study/stability/stability_reference.h"

#include "model/force/spectral_bounds.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Halvings of the step before a scene counts as having no reference. */
enum { MOST_HALVINGS = 4 };
/* at the limit, that an instability needs to show */
enum { STEPS = 200 };

struct way {
    struct cs_theory *theory; /* NULL: no limits are asked for */
    struct cs_reference *reference;
    double gershgorin; /* s, at the start */
    struct cs_error *error;
};

static void sample_theory(void *ctx, const struct cs_run *run, const struct cs_energy *energy) {
    struct way *way = ctx;
    (void)energy;
    if (!way->theory || way->error->status)
        return;
    // of the run: its obstacles move, and its ramps go on
    way->theory->modes.system = run->system;
    way->theory->modes.t = run->t;
    cs_theory_tighten(way->theory, run->x, &way->reference->smallest_limit, way->error);
    // other bounds than those of contact hold for the whole run
    if (!way->error->status && cs_spectral_bounds_depend_on_state(run->system))
        cs_theory_gershgorin(way->theory, run->x, &way->reference->gershgorin_limit,
                             way->error);
}

/* one run; false: it was not stable by what it can be judged without a reference */
static bool run_once(struct cs_reference *reference,
                     const struct cs_sampled_run_settings *settings, double dt, struct way *way,
                     struct cs_error *error) {
    struct cs_sampled_run_settings asked = *settings;
    asked.session.integrator = "velocity-verlet";
    asked.session.dt = dt;
    asked.limits = (struct cs_sampled_run_limits){HUGE_VAL, HUGE_VAL, HUGE_VAL};
    asked.on_sample = sample_theory;
    asked.ctx = way;
    // what a run that failed went through does not count
    reference->smallest_limit = reference->start_limit;
    reference->gershgorin_limit = way->gershgorin;
    return !cs_sampled_run_execute(&reference->run, &asked, error) && !way->error->status &&
           reference->run.result.outcome == CS_RUNNING;
}

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

/* Growth that a run cannot show: from the perturbation to the length of a spring in its time.
 */
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

/* The step of the reference: half of what the Gershgorin bound allows, and at least one a
 * sample. */
static double choose_dt(const struct cs_system *system, double space) {
    const double w = system->view.omega, r = 2 * system->view.delta;
    const double limit = 4 / (r + sqrt(r * r + 4 * w * w));
    return fmin(fmin(0.5 * limit, space), 10);
}

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
