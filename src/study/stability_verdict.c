/* Finds singular forces, and judges a run by how it ended and what its monitor saw. */
#include "study/stability_verdict.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Steps of dop853 that shrink: `tiny` in a row, below SHRUNK of the longest one before. A step
 * that ends at an event is tiny too, but alone. The stiffness of contact grows by 1.7e8 from
 * its range to its core, which shortens steps by 1.3e4. */
#define SHRUNK 1e-6
enum { TINY_STEPS = 8 };

struct shrinking {
    double longest, t; /* s */
    uint32_t tiny;
    const volatile sig_atomic_t *interrupt; /* may be NULL */
    sig_atomic_t stop;
};

static bool watch_step(void *ctx, double t, double dt, double *x, double *v) {
    struct shrinking *steps = ctx;
    (void)x, (void)v;
    steps->longest = fmax(steps->longest, dt);
    steps->tiny = dt < SHRUNK * steps->longest ? steps->tiny + 1 : 0;
    steps->t = t;
    steps->stop = steps->tiny >= TINY_STEPS || (steps->interrupt && *steps->interrupt);
    return false;
}

/* Sets where the steps shrank: the particle with the greatest acceleration. */
static enum cs_status name_singular(const struct cs_run *run, double t,
                                    struct cs_singular_force *found, struct cs_error *error) {
    const struct cs_system *system = run->system;
    const size_t n = system->view.n;
    double *force = calloc(4 * n, sizeof *force);
    uint32_t at = 0;
    if (!force)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for %zu particles", n);
    cs_diagnostics_particle_force(system, t, run->x, run->v, force, force + n);
    // the greatest acceleration, not force: masses differ
    for (uint32_t i = 1; i < n; i++)
        if (force[i] * system->inv_mass[i] > force[at] * system->inv_mass[at])
            at = i;
    struct cs_text name = {0};
    cs_system_print_particle(system, at, &name);
    found->time = t;
    found->particle = at;
    snprintf(found->text, sizeof found->text,
             "a force is singular at t = %.6g s, %s: no step passes", t, cs_text_get(&name));
    cs_text_finish(&name);
    free(force);
    return CS_OK;
}

enum cs_status cs_singular_force_find(const struct cs_session_settings *settings,
                                      double seconds, double evaluations,
                                      struct cs_singular_force *found, struct cs_error *error) {
    struct cs_session_settings asked = *settings;
    struct shrinking steps = {.interrupt = settings->run.stop};
    struct cs_session session;
    struct cs_error refused = {0};
    *found = (struct cs_singular_force){.text = ""};
    asked.integrator = "dop853";
    asked.method = NULL;
    asked.options = NULL;
    asked.dt = 0;
    // one frame, without the outputs of the run
    asked.fps = 1 / seconds;
    asked.threads = 0;
    asked.render = false;
    asked.run = (struct cs_run_settings){.pot = settings->run.pot,
                                         .stop = &steps.stop,
                                         .after_commit = watch_step,
                                         .ctx = &steps};
    if (!(seconds > 0) || cs_session_open_system(&session, &asked, &refused))
        return CS_OK;
    const double budget = evaluations * cs_pass_seconds(&session.system) + CS_SINGULAR_SECONDS,
                 given = settings->run.budget;
    session.settings.run.budget = given > 0 ? fmin(given, budget) : budget;
    if (!cs_session_begin(&session, NULL, &refused)) {
        struct cs_follow follow = {.run = &session.run, .last = 1};
        cs_follow_next(&follow, &refused);
        if (steps.tiny >= TINY_STEPS || cs_outcome_is_blow_up(session.run.outcome))
            name_singular(&session.run, steps.t, found, error);
    }
    cs_session_close(&session);
    return error->status;
}

enum cs_stability_verdict cs_stability_at_end(enum cs_outcome outcome,
                                              enum cs_stability_verdict seen) {
    if (outcome == CS_NOT_FINITE || seen == CS_STABILITY_NOT_FINITE)
        return CS_STABILITY_NOT_FINITE;
    if (outcome == CS_UNBOUNDED || seen == CS_STABILITY_GLOBAL)
        return CS_STABILITY_GLOBAL;
    if (cs_outcome_has_reason(outcome))
        return CS_STABILITY_FAILED;
    if (cs_stability_is_stable(seen) && outcome == CS_OVER_BUDGET)
        return CS_STABILITY_OVER_BUDGET;
    return seen;
}
