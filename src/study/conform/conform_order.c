/* Checks closed-form oscillators, the order of fixed steps, the tolerance of adaptive methods,
 * and both through an event.
 *
 * Order: with the error e(h) = C h^p (1 + O(h)), the slope log2(e(h) / e(h/2)) tends to p. The
 * slope is only evident between the region of large steps, where higher terms count, and the
 * floor of rounding. Therefore the step is halved until two successive slopes agree with the
 * claim.
 *
 * Tolerance: an adaptive method controls the local error per step. The global error is a
 * multiple of the tolerance that depends on the scene. A factor CS_TOLERANCE_FACTOR is allowed,
 * and the error must shrink with the tolerance. */
#include "study/conform/conform_checks.h"
#include "study/conform/conform_drum.h"

#include <math.h>
#include <string.h>

/* A free pair of masses m: the elongation s obeys s'' + 2 d s' + w^2 s = 0 with w^2 = 2 k/m =
 * 100/s^2 and d = c/m = 1.2/s, because the reduced mass is m/2. */
#define OSCILLATOR                                                                             \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": 0.5},"             \
    " \"springs\": {\"stretch\": 25, \"damping\": 0.6, \"damping_model\": \"%s\"}}],"          \
    " \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": {\"fps\": 20}}"

/* Compares the elongation at T = 1 s with s(T) = s0 exp(-d T) (cos(u T) + d/u sin(u T)), u^2 =
 * w^2 - d^2, from rest at s0 = 0.1 m. The phase error of order (h w)^p accumulates over w T =
 * 10 radians; half of that product is allowed. */
static void check_oscillator(const struct cs_conform *card, struct cs_conform_row *row,
                             const char *model, int level) {
    const double d = 0.6 / 0.5, w = 10, u = sqrt(w * w - d * d), reach = 0.1;
    const double expected = reach * exp(-d) * (cos(u) + d / u * sin(u));
    struct cs_probe pair;
    if (cs_probe_open(&pair, card, card->method, OSCILLATOR, model)) {
        pair.x[0] -= reach / 2;
        pair.x[1] += reach / 2;
    }
    const double share = cs_probe_set_level(&pair, 5e-3, w, card->method->order_damped, level);
    if (!cs_probe_run(&pair, 20))
        cs_row_fail(row, "%s", pair.error.message);
    else {
        const double found = pair.x[1] - pair.x[0] - 1;
        // an error grows over w T = 10 radians; half of that is left to the method
        cs_row_state(row, fabs(found - expected) / reach, fmax(share * w / 2, 1e-11),
                     "of the amplitude off after 1.6 periods: %.6f m, expected %.6f m", found,
                     expected);
    }
    cs_probe_close(&pair);
}

/* Both levels of accuracy. */
static void oscillator(const struct cs_conform *card, struct cs_conform_row *row,
                       const char *model) {
    if (!cs_probe_can_be_set(card, row))
        return;
    check_oscillator(card, row, model, 0);
    check_oscillator(card, row, model, 1);
}

void cs_check_oscillator_axial(const struct cs_conform *card, struct cs_conform_row *row) {
    oscillator(card, row, "axial");
}

void cs_check_oscillator_relative(const struct cs_conform *card, struct cs_conform_row *row) {
    oscillator(card, row, "relative");
}

/* Maximum number of halvings; and the order above which the first step can already be at the
 * floor of rounding. */
enum { HALVINGS = 10, HIGH_ORDER = 5 };
/* Relative error below which rounding would show as a slope. */
#define FLOOR 2e-11

/* Halves the step until two successive slopes are within 0.1 of the claimed order, or the last
 * one above rounding is. Positions and velocities are both measured, each relative to its own
 * change. A single slope is not enough: it can cross the value by chance. */
static void measure_order(const struct cs_conform *card, struct cs_conform_row *row,
                          uint32_t order, const struct cs_drum *drum) {
    double reference[2 * CS_DRUM_VALUES], state[2 * CS_DRUM_VALUES], scale[2], error[2] = {0};
    double slope[2] = {(double)NAN, (double)NAN}, off = (double)NAN, h = cs_drum_step();
    bool near = false, settled = false;
    if (!cs_drum_reference(card, drum, reference, scale, row))
        return;
    for (int k = 0; k < HALVINGS && !settled; k++, h /= 2) {
        if (!cs_drum_state(card, card->method, drum, h, state, row))
            return;
        double found[2], now = 0;
        for (int part = 0; part < 2; part++)
            found[part] = cs_rms_difference(state + part * CS_DRUM_VALUES,
                                            reference + part * CS_DRUM_VALUES, CS_DRUM_VALUES) /
                          scale[part];
        /* from here on rounding would show as a slope */
        if (k > 0 && fmin(found[0], found[1]) < FLOOR)
            break;
        for (int part = 0; part < 2 && k > 0; part++) {
            slope[part] = log2(error[part] / found[part]);
            now = fmax(now, fabs(slope[part] - order));
        }
        settled = k > 0 && near && now <= 0.1;
        near = k > 0 && now <= 0.1;
        off = k > 0 ? now : off;
        memcpy(error, found, sizeof error);
    }
    if (isnan(off) && order > HIGH_ORDER)
        cs_row_skip(row, "its error is at the rounding from the first step on");
    else if (isnan(off))
        cs_row_fail(row, "no order is seen: errors %.3g and %.3g at the first step", error[0],
                    error[1]);
    else
        cs_row_state(row, settled || near ? off : fmax(off, 0.1001), 0.1,
                     "off order %u: %.3f of position, %.3f of velocity", order, slope[0],
                     slope[1]);
}

/* Error over tolerance at three tolerances, and the decrease of the error between the ends. */
static void measure_tolerance(const struct cs_conform *card, struct cs_conform_row *row,
                              const struct cs_drum *drum) {
    static const double tolerances[] = {1e-3, 1e-5, 1e-7};
    double reference[2 * CS_DRUM_VALUES], state[2 * CS_DRUM_VALUES], scale[2], error[3];
    if (!cs_drum_reference(card, drum, reference, scale, row))
        return;
    for (int k = 0; k < 3; k++) {
        if (!cs_drum_state(card, card->method, drum, tolerances[k], state, row))
            return;
        error[k] = cs_rms_difference(state, reference, CS_DRUM_VALUES) / scale[0];
        cs_row_state(row, error[k] / tolerances[k], CS_TOLERANCE_FACTOR,
                     "times the tolerance: error %.3g of the motion at rtol %g", error[k],
                     tolerances[k]);
    }
    // four decades of the tolerance are two decades of the error at least
    cs_row_state(row, error[2] / error[0], 0.01, "of the error at rtol 1e-3 left at 1e-7");
}

/* An adaptive method with an option dt has two code paths, fixed and controlled steps. Here the
 * fixed one is tested; `tolerance` tests the other. */
static void order_on(const struct cs_conform *card, struct cs_conform_row *row,
                     double damping) {
    const struct cs_drum drum = {.damping = damping, .fixed_steps = true};
    if (cs_method_has(card->method, "dt"))
        measure_order(card, row, cs_probe_order(card, damping > 0), &drum);
    else
        cs_row_skip(row, card->method->traits & CS_ADAPTIVE
                             ? "it chooses its own steps: see tolerance"
                             : "it has no option dt");
}

void cs_check_order(const struct cs_conform *card, struct cs_conform_row *row) {
    order_on(card, row, 0);
}

void cs_check_order_damped(const struct cs_conform *card, struct cs_conform_row *row) {
    order_on(card, row, 0.05);
}

/* On the damped drum. */
void cs_check_tolerance(const struct cs_conform *card, struct cs_conform_row *row) {
    if (!(card->method->traits & CS_ADAPTIVE))
        cs_row_skip(row, "its step is fixed: see order");
    else if (cs_probe_can_be_set(card, row))
        measure_tolerance(card, row, &(struct cs_drum){.damping = 0.05});
}

/* On the drum whose velocities jump at the end of the first frame. A multistep method must
 * discard its history there. */
void cs_check_event(const struct cs_conform *card, struct cs_conform_row *row) {
    const struct cs_drum kicked = {.has_velocity_jump = true};
    if (!cs_probe_can_be_set(card, row))
        return;
    if (card->method->traits & CS_ADAPTIVE)
        measure_tolerance(card, row, &kicked);
    else
        measure_order(card, row, cs_probe_order(card, false), &kicked);
}

/* The contact law is smooth in range: contact must cost neither order nor tolerance. Friction
 * depends on the velocity, hence the damped order. */
void cs_check_contact_order(const struct cs_conform *card, struct cs_conform_row *row) {
    static const struct cs_drum drum = {.has_contact = true};
    if (card->method->traits & CS_EXPLICIT_OUTER)
        cs_row_skip(row, "it is refused with contact by force");
    else if (cs_probe_can_be_set(card, row) && card->method->traits & CS_ADAPTIVE)
        measure_tolerance(card, row, &drum);
    else if (cs_method_has(card->method, "dt"))
        measure_order(card, row, cs_probe_order(card, true), &drum);
}

/* Richardson extrapolation to h = 0. With e(h) = c_p h^p + c_(p+1) h^(p+1) + ..., the
 * combination
 *   S'(h/2) = S(h/2) + (S(h/2) - S(h)) / (2^p - 1)
 * removes the term of h^p; each further column removes the next power. states (LEVELS, values)
 * belongs to the steps h, h/2, h/4, ... and is overwritten; its last row is the result. */
enum { LEVELS = 6 };
static void extrapolate(double (*states)[2 * CS_DRUM_VALUES], uint32_t order) {
    for (int column = 1; column < LEVELS; column++) {
        const double power = pow(2, (double)order + column - 1);
        for (int k = LEVELS - 1; k >= column; k--)
            for (size_t i = 0; i < 2 * CS_DRUM_VALUES; i++)
                states[k][i] += (states[k][i] - states[k - 1][i]) / (power - 1);
    }
}

/* Compares the limit h -> 0 with the reference: order alone would not notice convergence to the
 * solution of another equation. Six steps are extrapolated; an adaptive method runs once with a
 * tight tolerance. The bound of 1e-8 is well above the error of the reference, 1e-12. */
void cs_check_solution(const struct cs_conform *card, struct cs_conform_row *row) {
    static const struct cs_drum drum = {.damping = 0.05};
    const struct cs_integrator *method = card->method;
    const bool adaptive = method->traits & CS_ADAPTIVE;
    // a hundred thousand steps of order 2 are within the bound at a looser tolerance already
    const double rtol = cs_probe_order(card, true) > 2 ? 1e-11 : 1e-10;
    double reference[2 * CS_DRUM_VALUES], states[LEVELS][2 * CS_DRUM_VALUES], scale[2];
    if (method->fidelity != CS_FIDELITY_ODE) {
        cs_row_skip(row, "it claims another fidelity");
        return;
    }
    if (!cs_probe_can_be_set(card, row) ||
        !cs_drum_reference(card, &drum, reference, scale, row))
        return;
    for (int k = adaptive ? LEVELS - 1 : 0; k < LEVELS; k++)
        if (!cs_drum_state(card, method, &drum, adaptive ? rtol : ldexp(cs_drum_step(), -k),
                           states[k], row))
            return;
    if (!adaptive)
        extrapolate(states, method->order_damped);
    cs_row_state(row,
                 cs_rms_difference(states[LEVELS - 1], reference, CS_DRUM_VALUES) / scale[0],
                 1e-8, "of the motion off the reference, %s",
                 !adaptive      ? "extrapolated from six steps to h = 0"
                 : rtol > 5e-11 ? "at rtol 1e-10"
                                : "at rtol 1e-11");
}
