/* Checks the limit of a method's own iterations, at one fixed step.
 *
 * A method that iterates constraints or local steps does not converge to the solution of the
 * ODE by iterations alone. Its descriptor claims their limit: implicit Euler, or another one.
 */
#include "study/conform/conform_checks.h"
#include "study/conform/conform_drum.h"

#define STEP (CS_DRUM_FRAME / 8) /* large: w h is near 1, so that iterations matter */

static const struct cs_drum drum = {.damping = 0};

/* Positions after CS_DRUM_FRAMES with a number of iterations per step. Returns false if the run
 * ended early: the row says why. */
static bool state_at(const struct cs_conform *card, const struct cs_integrator *method,
                     double iterations, double *state, struct cs_conform_row *row) {
    struct cs_probe probe;
    cs_drum_open(&probe, card, method, &drum);
    cs_probe_set_step(&probe, STEP);
    cs_probe_set(&probe, "iterations", iterations);
    const bool done = cs_probe_run(&probe, CS_DRUM_FRAMES);
    if (done)
        for (size_t i = 0; i < CS_DRUM_VALUES; i++)
            state[i] = probe.x[i];
    else
        cs_row_fail(row, "%s", probe.error.message);
    cs_probe_close(&probe);
    return done;
}

/* The claim of implicit Euler: after 1000 iterations the state must agree to 1e-6 of the
 * motion. */
static void meets_implicit_euler(const struct cs_conform *card, struct cs_conform_row *row,
                                 const double *target, double motion) {
    double state[CS_DRUM_VALUES];
    if (!state_at(card, card->method, 1000, state, row))
        return;
    cs_row_state(row, cs_rms_difference(state, target, CS_DRUM_VALUES) / motion, 1e-6,
                 "of the motion away from %s after 1000 iterations",
                 card->implicit_euler->name);
}

/* The claim of a limit other than implicit Euler: four times the iterations may change at most
 * a tenth of the distance to implicit Euler. Then the distance is that of the limit, not of
 * unfinished iterations. */
static void has_converged(const struct cs_conform *card, struct cs_conform_row *row,
                          const double *target, double motion) {
    double many[CS_DRUM_VALUES], more[CS_DRUM_VALUES];
    if (!state_at(card, card->method, 500, many, row) ||
        !state_at(card, card->method, 2000, more, row))
        return;
    const double left = cs_rms_difference(more, target, CS_DRUM_VALUES);
    cs_row_state(row, cs_rms_difference(more, many, CS_DRUM_VALUES) / left, 0.1,
                 "of the distance to %s, %.3g of the motion, changed by four times the "
                 "iterations",
                 card->implicit_euler->name, left / motion);
}

/* Both claims need implicit Euler at the same step as the target. */
void cs_check_fidelity(const struct cs_conform *card, struct cs_conform_row *row) {
    const struct cs_integrator *method = card->method;
    double start[CS_DRUM_VALUES] = {0}, target[CS_DRUM_VALUES];
    if (method->fidelity == CS_FIDELITY_ODE) {
        cs_row_skip(row, "an ODE method: see solution");
        return;
    }
    if (method->fidelity == CS_FIDELITY_OTHER) {
        cs_row_skip(row, "it claims no limit");
        return;
    }
    if (!cs_method_has(method, "iterations") || !cs_method_has(method, "dt")) {
        cs_row_skip(row, "it has no option iterations");
        return;
    }
    if (!card->implicit_euler) {
        cs_row_skip(row, "there is no integrator backward-euler to compare with");
        return;
    }
    /* the start gives the scale: distances are fractions of the motion */
    struct cs_probe probe;
    if (cs_drum_open(&probe, card, method, &drum))
        for (size_t i = 0; i < CS_DRUM_VALUES; i++)
            start[i] = probe.x[i];
    cs_probe_close(&probe);
    if (!state_at(card, card->implicit_euler, 1000, target, row))
        return;
    const double motion = cs_rms_difference(target, start, CS_DRUM_VALUES);
    if (method->fidelity == CS_FIDELITY_IMPLICIT_EULER)
        meets_implicit_euler(card, row, target, motion);
    else
        has_converged(card, row, target, motion);
}
