/* stability_reference.h - a trusted run that others are judged by, and theory along its way. */
#ifndef CS_STABILITY_REFERENCE_H
#define CS_STABILITY_REFERENCE_H

#include "study/stability/theory.h"
#include "study/stability_verdict.h"

struct cs_reference {
    bool exists; /* else only theory at rest is there, and message says why */
    char message[320];
    double seconds;            /* simulated: enough for 200 steps at the limit */
    struct cs_sampled_run run; /* velocity-verlet with a small step */
    double gershgorin_limit;   /* s, limit by Gershgorin bounds, of contact along the way */
    struct cs_theory_limit start_limit;    /* before the start is perturbed */
    struct cs_theory_limit smallest_limit; /* along the way */
};

/* Runs the scene of settings (its integrator and dt are the method's whose limits are asked
 * for; its seconds (at least), samples, perturbation and budget hold for the run) with
 * velocity-verlet at its own step, or a smaller one where that is not stable. Methods without a
 * fixed dt have no limits. */
enum cs_status cs_reference_run(struct cs_reference *reference,
                                const struct cs_sampled_run_settings *settings,
                                struct cs_error *error);

#endif
