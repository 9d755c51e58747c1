/* Checks the order of fixed steps, the tolerance of adaptive methods, and both through an
 * event.
 *
 * Order: with the error e(h) = C h^p (1 + O(h)), the slope log2(e(h) / e(h/2)) tends to p. The
 * slope is only evident between the region of large steps, where higher terms count, and the
 * floor of rounding. Therefore the step is shortened until two successive slopes agree with the
 * claim.
 *
 * Tolerance: an adaptive method controls the local error per step. The global error is a
 * multiple of the tolerance that depends on the scene. A factor CS_TOLERANCE_FACTOR is allowed,
 * and the error must shrink with the tolerance.
 *
 * Fidelity: a method that iterates constraints or local steps does not converge to the solution
 * of the ODE by iterations alone. Its descriptor claims their limit, implicit Euler or another
 * one, which is checked at one fixed step. */
#include "conform/conform_checks.h"

#include <math.h>

/* Most steps of a measurement, the order from which it starts at the stability limit, and the
 * steps of a frame that it tries there. */
enum { STEPS_MAX = 10, HIGH_ORDER = 5, FIRST_PARTS = 2, PARTS_MAX = 24 };
/* Relative error below which rounding would show as a slope: it leaves up to 7e-14, and
 * at 2.4e-13 moved the slope of a method of Adams by 0.2. */
#define FLOOR 3e-13
/* How far a slope may be from a high order. Few steps lie between the stability limit and
 * rounding, and terms of the next order still count there: for the same reason the errors of
 * position and velocity, one of which may be small by chance, are joined. */
#define HIGH_ORDER_BOUND 0.25

/* A measurement at one step after another. */
struct slopes {
    const double *reference, *scale; /* of the drum */
    bool joined;                     /* both errors are the root mean square of the two */
    double h;                        /* s: the last step; 0: none */
    double error[2];                 /* of position and velocity there */
    double slope[2];                 /* between the last two */
};

/* Runs with a step, and updates errors and slopes. Returns false if the run ended early. */
static bool add_step(struct slopes *slopes, const struct cs_conform *conform,
                     const struct cs_drum *drum, double h, struct cs_conform_row *row) {
    double state[2 * CS_DRUM_VALUES];
    if (!cs_drum_state(conform, conform->method, drum, h, state, row))
        return false;
    double error[2];
    for (int part = 0; part < 2; part++)
        error[part] =
            cs_rms_difference(state + part * CS_DRUM_VALUES,
                              slopes->reference + part * CS_DRUM_VALUES, CS_DRUM_VALUES) /
            slopes->scale[part];
    if (slopes->joined)
        error[0] = error[1] = sqrt((error[0] * error[0] + error[1] * error[1]) / 2);
    // of two steps in turn, so that the first has none
    for (int part = 0; part < 2; part++) {
        slopes->slope[part] = slopes->h > 0
                                  ? log(slopes->error[part] / error[part]) / log(slopes->h / h)
                                  : (double)NAN;
        slopes->error[part] = error[part];
    }
    slopes->h = h;
    return true;
}

/* Steps that a frame is cut into next: twice as many, or for a high order 2, 3, 4, 6, 8, 12...
 */
static uint32_t more_parts(uint32_t parts, bool high) {
    const bool is_power = (parts & (parts - 1)) == 0;
    return !high ? 2 * parts : is_power ? parts / 2 * 3 : parts / 3 * 4;
}

/* Shortens the step until two successive slopes are near the claimed order, or the last one
 * above rounding is. Positions and velocities are both measured, each relative to its own
 * change. A single slope is not enough: it can cross the value by chance. A high order is at
 * rounding where the others begin: it starts from the longest step that holds. */
static void measure_order(const struct cs_conform *conform, struct cs_conform_row *row,
                          uint32_t order, const struct cs_drum *drum) {
    const bool high = order >= HIGH_ORDER;
    const double bound = high ? HIGH_ORDER_BOUND : 0.1;
    double reference[2 * CS_DRUM_VALUES], scale[2], off = (double)NAN;
    struct slopes slopes = {.reference = reference, .scale = scale, .joined = high};
    uint32_t parts = high ? FIRST_PARTS : (uint32_t)lround(CS_DRUM_FRAME / cs_drum_step());
    bool near = false, settled = false;
    if (!cs_drum_reference(conform, drum, reference, scale, row))
        return;
    for (int steps = 0; steps < STEPS_MAX && !settled; parts = more_parts(parts, high)) {
        struct cs_conform_row unstable = *row;
        const bool may_fail = high && slopes.h == 0 && parts < PARTS_MAX;
        if (!add_step(&slopes, conform, drum, CS_DRUM_FRAME / parts,
                      may_fail ? &unstable : row)) {
            if (may_fail && unstable.verdict == CS_VERDICT_FAIL)
                continue;
            *row = unstable.verdict == CS_VERDICT_NONE ? unstable : *row;
            return;
        }
        steps++;
        /* from here on rounding would show as a slope */
        if (fmin(slopes.error[0], slopes.error[1]) < FLOOR)
            break;
        const double now = fmax(fabs(slopes.slope[0] - order), fabs(slopes.slope[1] - order));
        // a slope that still falls passes other orders on its way
        settled = near && now <= bound && fabs(now - off) <= 0.1;
        near = now <= bound;
        off = isnan(slopes.slope[0]) ? off : now;
    }
    if (isnan(off))
        cs_row_fail(row, "no order is seen: errors %.3g and %.3g at the first step",
                    slopes.error[0], slopes.error[1]);
    else
        cs_row_state(row, settled || near ? off : fmax(off, 1.001 * bound), bound,
                     "off order %u: %.3f of position, %.3f of velocity", order, slopes.slope[0],
                     slopes.slope[1]);
}

/* Error over tolerance at four tolerances, and the decrease of the error between the first and
 * the third. Where stability limits the step, the error at a loose tolerance is small already:
 * then it need not fall, as long as it stays below the tolerance. */
static void measure_tolerance(const struct cs_conform *conform, struct cs_conform_row *row,
                              const struct cs_drum *drum) {
    static const double tolerances[] = {1e-3, 1e-5, 1e-7, 1e-9};
    enum { TOLERANCES = sizeof tolerances / sizeof *tolerances };
    double reference[2 * CS_DRUM_VALUES], state[2 * CS_DRUM_VALUES], scale[2];
    double error[TOLERANCES];
    if (!cs_drum_reference(conform, drum, reference, scale, row))
        return;
    for (int k = 0; k < TOLERANCES; k++) {
        if (!cs_drum_state(conform, conform->method, drum, tolerances[k], state, row))
            return;
        error[k] = cs_rms_difference(state, reference, CS_DRUM_VALUES) / scale[0];
        cs_row_state(row, error[k] / tolerances[k], CS_TOLERANCE_FACTOR,
                     "times the tolerance: error %.3g of the motion at rtol %g", error[k],
                     tolerances[k]);
    }
    // four decades of the tolerance are two decades of the error at least
    if (error[2] > tolerances[2])
        cs_row_state(row, error[2] / error[0], 0.01, "of the error at rtol 1e-3 left at 1e-7");
}

/* An adaptive method has two code paths, fixed and controlled steps, by an option dt. Here the
 * fixed one is tested; `tolerance` tests the other. One without dt takes a step a frame at its
 * loosest tolerance, if no history ties it to its steps. */
static void order_on(const struct cs_conform *conform, struct cs_conform_row *row,
                     double damping) {
    const struct cs_drum drum = {.damping = damping, .fixed_steps = true};
    const uint32_t traits = conform->method->traits;
    if (cs_method_has(conform->method, "dt") ||
        (traits & CS_ADAPTIVE && !(traits & CS_MULTISTEP)))
        measure_order(conform, row, cs_conform_order(conform, damping > 0), &drum);
    else
        cs_row_skip(row, traits & CS_ADAPTIVE ? "it chooses its own steps: see tolerance"
                                              : "it has no option dt");
}

void cs_check_order(const struct cs_conform *conform, struct cs_conform_row *row) {
    order_on(conform, row, 0);
}

void cs_check_order_damped(const struct cs_conform *conform, struct cs_conform_row *row) {
    order_on(conform, row, 0.05);
}

/* On the damped drum. */
void cs_check_tolerance(const struct cs_conform *conform, struct cs_conform_row *row) {
    if (!(conform->method->traits & CS_ADAPTIVE))
        cs_row_skip(row, "its step is fixed: see order");
    else if (cs_probe_can_be_set(conform, row))
        measure_tolerance(conform, row, &(struct cs_drum){.damping = 0.05});
}

/* On the drum whose velocities jump at the end of the first frame. A multistep method must
 * discard its history there. */
void cs_check_event(const struct cs_conform *conform, struct cs_conform_row *row) {
    const uint32_t order = cs_conform_order(conform, false);
    /* damped, where that keeps the order: a force that is kept is then another one */
    const bool damped = cs_conform_order(conform, true) == order;
    const struct cs_drum kicked = {.damping = damped ? 0.05 : 0, .has_velocity_jump = true};
    if (!cs_probe_can_be_set(conform, row))
        return;
    if (conform->method->traits & CS_ADAPTIVE)
        measure_tolerance(conform, row, &kicked);
    else
        measure_order(conform, row, order, &kicked);
}

/* The contact law is smooth in range: contact must cost neither order nor tolerance. Friction
 * depends on the velocity, hence the damped order. */
void cs_check_contact_order(const struct cs_conform *conform, struct cs_conform_row *row) {
    static const struct cs_drum drum = {.has_contact = true};
    if (conform->method->traits & CS_EXPLICIT_OUTER)
        cs_row_skip(row, "it is refused with contact by force");
    else if (cs_probe_can_be_set(conform, row) && conform->method->traits & CS_ADAPTIVE)
        measure_tolerance(conform, row, &drum);
    else if (cs_method_has(conform->method, "dt"))
        measure_order(conform, row, cs_conform_order(conform, true), &drum);
}

enum { LEVELS = 6 };

/* Compares the limit h -> 0 with the reference: order alone would not notice convergence to the
 * solution of another equation. Six steps are extrapolated; an adaptive method runs once with a
 * tight tolerance. The bounds are well above the error of the reference, 1e-12: right methods
 * of order 1 leave 1e-9, others 1e-12. */
void cs_check_solution(const struct cs_conform *conform, struct cs_conform_row *row) {
    static const struct cs_drum drum = {.damping = 0.05};
    const struct cs_integrator *method = conform->method;
    const bool adaptive = method->traits & CS_ADAPTIVE;
    const double rtol = cs_probe_tightest_tolerance(conform);
    double reference[2 * CS_DRUM_VALUES], states[LEVELS][2 * CS_DRUM_VALUES], scale[2];
    if (method->fidelity != CS_FIDELITY_ODE) {
        cs_row_skip(row, "it claims another fidelity");
        return;
    }
    if (!cs_probe_can_be_set(conform, row) ||
        !cs_drum_reference(conform, &drum, reference, scale, row))
        return;
    for (int k = adaptive ? LEVELS - 1 : 0; k < LEVELS; k++)
        if (!cs_drum_state(conform, method, &drum, adaptive ? rtol : ldexp(cs_drum_step(), -k),
                           states[k], row))
            return;
    if (!adaptive)
        cs_extrapolate(states[0], LEVELS, 2 * CS_DRUM_VALUES, 2 * CS_DRUM_VALUES,
                       cs_conform_order(conform, true));
    cs_row_state(row,
                 cs_rms_difference(states[LEVELS - 1], reference, CS_DRUM_VALUES) / scale[0],
                 adaptive || cs_conform_order(conform, true) < 2 ? 1e-8 : 1e-10,
                 "of the motion off the reference, %s",
                 !adaptive      ? "extrapolated from six steps to h = 0"
                 : rtol > 5e-11 ? "at rtol 1e-10"
                                : "at rtol 1e-11");
}

#define STEP (CS_DRUM_FRAME / 8) /* large: w h is near 1, so that iterations matter */

static const struct cs_drum drum = {.damping = 0};

/* Positions after CS_DRUM_FRAMES with a number of iterations per step. Returns false if the run
 * ended early: the row says why. */
static bool state_at(const struct cs_conform *conform, const struct cs_integrator *method,
                     double iterations, double *state, struct cs_conform_row *row) {
    struct cs_probe probe;
    cs_drum_open(&probe, conform, method, &drum);
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
static void meets_implicit_euler(const struct cs_conform *conform, struct cs_conform_row *row,
                                 const double *target, double motion) {
    double state[CS_DRUM_VALUES];
    if (!state_at(conform, conform->method, 1000, state, row))
        return;
    cs_row_state(row, cs_rms_difference(state, target, CS_DRUM_VALUES) / motion, 1e-6,
                 "of the motion away from %s after 1000 iterations",
                 conform->implicit_euler->name);
}

/* The claim of a limit other than implicit Euler: four times the iterations may change at most
 * a tenth of the distance to implicit Euler. Then the distance is that of the limit, not of
 * unfinished iterations. */
static void has_converged(const struct cs_conform *conform, struct cs_conform_row *row,
                          const double *target, double motion) {
    double many[CS_DRUM_VALUES], more[CS_DRUM_VALUES];
    if (!state_at(conform, conform->method, 500, many, row) ||
        !state_at(conform, conform->method, 2000, more, row))
        return;
    const double left = cs_rms_difference(more, target, CS_DRUM_VALUES);
    cs_row_state(row, cs_rms_difference(more, many, CS_DRUM_VALUES) / left, 0.1,
                 "of the distance to %s, %.3g of the motion, changed by four times the "
                 "iterations",
                 conform->implicit_euler->name, left / motion);
}

/* Both claims need implicit Euler at the same step as the target. */
void cs_check_fidelity(const struct cs_conform *conform, struct cs_conform_row *row) {
    const struct cs_integrator *method = conform->method;
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
    if (!conform->implicit_euler) {
        cs_row_skip(row, "there is no integrator backward-euler to compare with");
        return;
    }
    /* the start gives the scale: distances are fractions of the motion */
    struct cs_probe probe;
    if (cs_drum_open(&probe, conform, method, &drum))
        for (size_t i = 0; i < CS_DRUM_VALUES; i++)
            start[i] = probe.x[i];
    cs_probe_close(&probe);
    if (!state_at(conform, conform->implicit_euler, 1000, target, row))
        return;
    const double motion = cs_rms_difference(target, start, CS_DRUM_VALUES);
    if (method->fidelity == CS_FIDELITY_IMPLICIT_EULER)
        meets_implicit_euler(conform, row, target, motion);
    else
        has_converged(conform, row, target, motion);
}
