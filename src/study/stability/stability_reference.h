/* stability_reference.h - runs a trusted reference that other runs are judged by, and evaluates
 * linear theory along its trajectory.
 *
 * Linear theory holds at one state. A spring that stretches, turns or meets a collider changes
 * K and C, so the limit at the start can be too long for the rest of the run. The limit is
 * therefore evaluated at each sample of the reference, and the smallest one counts. */
#ifndef CS_STABILITY_REFERENCE_H
#define CS_STABILITY_REFERENCE_H

#include "study/stability/theory.h"
#include "study/stability_verdict.h"

/* Reference run and the limits of one method. Contains no pointers: it is stored in the journal
 * of a map as it is. */
struct cs_reference {
    bool exists; /* else only the limits at the start exist, and message says why */
    char message[320];
    double seconds;            /* simulated: enough for 200 steps at the limit */
    struct cs_sampled_run run; /* velocity-verlet with a small step */
    double gershgorin_limit;   /* s, limit by Gershgorin bounds, of contact along the way */
    struct cs_theory_limit start_limit;    /* before the start is perturbed */
    struct cs_theory_limit smallest_limit; /* along the way */
};

/* Runs the scene of `settings` by velocity-verlet, and finds the limits of the method of
 * `settings` along this run.
 *
 * From `settings` the run takes seconds (as a minimum), samples, perturbation and budget; it
 * chooses its step itself and halves it up to 3 times if the run is not stable. A method
 * without option dt gets no limits (HUGE_VAL). A reference that fails is a result: exists is
 * false and message says why. Errors: those of scene, method, memory, or CS_ERR_INTERRUPT. */
enum cs_status cs_reference_run(struct cs_reference *reference,
                                const struct cs_sampled_run_settings *settings,
                                struct cs_error *error);

#endif
