/* Runs a trusted reference, and follows the limits of linear theory along its trajectory. */
#include "study/stability/reference.h"

#include "model/force/bounds.h"

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

static void look(void *ctx, const struct cs_run *run, const struct cs_energy *energy) {
    struct way *way = ctx;
    (void)energy;
    if (!way->theory || way->error->status)
        return;
    // of the run: its obstacles move, and its ramps go on
    way->theory->modes.system = run->system;
    way->theory->modes.t = run->t;
    cs_theory_lower(way->theory, run->x, &way->reference->worst, way->error);
    // other bounds than those of contact hold for the whole run
    if (!way->error->status && cs_bounds_have_rate(run->system))
        cs_theory_gershgorin(way->theory, run->x, &way->reference->gershgorin, way->error);
}

/* one run; false: it was not stable by what it can be judged without a reference */
static bool run_once(struct cs_reference *reference, const struct cs_trial_settings *settings,
                     double dt, struct way *way, struct cs_error *error) {
    struct cs_trial_settings asked = *settings;
    asked.session.integrator = "velocity-verlet";
    asked.session.dt = dt;
    asked.limits = (struct cs_trial_limits){HUGE_VAL, HUGE_VAL, HUGE_VAL};
    asked.sampled = look;
    asked.ctx = way;
    // what a run that failed went through does not count
    reference->worst = reference->at_rest;
    reference->gershgorin = way->gershgorin;
    return !cs_trial_run(&reference->trial, &asked, error) && !way->error->status &&
           reference->trial.result.outcome == CS_RUNNING;
}

static void run_way(struct cs_reference *reference, const struct cs_trial_settings *settings,
                    double dt, struct way *way, struct cs_error *error) {
    for (int k = 0; k < MOST_HALVINGS && !reference->found && !error->status; k++) {
        reference->found = run_once(reference, settings, dt, way, error);
        if (reference->trial.result.outcome == CS_OVER_BUDGET)
            break;
        dt /= 2;
    }
    if (!reference->found)
        snprintf(reference->message, sizeof reference->message, "velocity-verlet: %.280s",
                 reference->trial.result.message);
}

/* Growth that a run cannot show: from the perturbation to the length of a spring in its time.
 */
static double growth_of(const struct cs_system *system,
                        const struct cs_trial_settings *settings) {
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
                               const struct cs_trial_settings *settings,
                               struct cs_error *error) {
    struct cs_theory theory = {0};
    struct way way = {.reference = reference, .gershgorin = HUGE_VAL, .error = error};
    reference->gershgorin = reference->at_rest.dt = reference->worst.dt = HUGE_VAL;
    if (cs_method_takes_dt(session->method.integrator)) {
        way.theory = &theory;
        if (cs_theory_init(&theory, &session->system, session->method.integrator,
                           session->method.options, growth_of(&session->system, settings),
                           error) ||
            cs_theory_gershgorin(&theory, session->system.state, &reference->gershgorin,
                                 error) ||
            cs_theory_at(&theory, session->system.state, &reference->at_rest, error))
            goto done;
        way.gershgorin = reference->gershgorin;
    }
    run_way(reference, settings,
            choose_dt(&session->system, settings->seconds / settings->samples), &way, error);
done:
    cs_theory_finish(&theory);
    return error->status;
}

enum cs_status cs_reference_run(struct cs_reference *reference,
                                const struct cs_trial_settings *settings,
                                struct cs_error *error) {
    struct cs_trial_settings asked = *settings;
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
