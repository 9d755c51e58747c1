/* Checks the promises of symplectic methods, and the limits that hold for the energy with any
 * method. */
#include "study/conform/conform_checks.h"
#include "study/conform/conform_drum.h"

#include <math.h>
#include <string.h>

enum { FRAMES = 50 }; /* five seconds: 50 periods of the fastest mode, 10 of the slowest */

/* Runs to the end, reverses all velocities, and runs back. A method is symmetric if a step of
 * -h undoes a step of h (Hairer, Lubich, Wanner 2006); the equations are reversible, so a
 * symmetric method returns to the start up to rounding. A symplectic method of order 1 is not
 * symmetric. */
void cs_check_reversible(const struct cs_conform *card, struct cs_conform_row *row) {
    static const struct cs_drum drum = {0};
    struct cs_probe there, back;
    if (!(card->method->traits & CS_SYMPLECTIC)) {
        cs_row_skip(row, "it does not claim to be symplectic");
        return;
    }
    if (card->method->order < 2) {
        cs_row_skip(row, "a symplectic method of order 1 is not symmetric in time");
        return;
    }
    cs_drum_open(&there, card, card->method, &drum);
    cs_probe_set_level(&there, cs_drum_step(), CS_DRUM_OMEGA, 1, 0);
    if (cs_drum_open(&back, card, card->method, &drum) &&
        cs_probe_run(&there, CS_DRUM_FRAMES)) {
        double start[CS_DRUM_VALUES];
        /* kept before the run back overwrites it with the end of the run there */
        memcpy(start, back.x, sizeof start);
        const double move = cs_rms_difference(there.x, start, CS_DRUM_VALUES);
        for (size_t i = 0; i < CS_DRUM_VALUES; i++) {
            back.x[i] = there.x[i];
            back.v[i] = -there.v[i];
        }
        cs_probe_set_level(&back, cs_drum_step(), CS_DRUM_OMEGA, 1, 0);
        if (cs_probe_run(&back, CS_DRUM_FRAMES))
            cs_row_state(row, cs_rms_difference(back.x, start, CS_DRUM_VALUES) / move, 1e-9,
                         "of the motion away from the start");
    }
    if (there.has_ended || back.has_ended)
        cs_row_fail(row, "%s", there.has_ended ? there.error.message : back.error.message);
    cs_probe_close(&there);
    cs_probe_close(&back);
}

/* Energy in J of the drum at rest: stretched, without its bump and velocity. It is subtracted
 * to measure gains against the energy of the motion alone. */
static double rest_energy(const struct cs_conform *card) {
    struct cs_probe rest;
    double energy = (double)NAN;
    if (cs_drum_open(&rest, card, card->method, &(struct cs_drum){0})) {
        memset(rest.x + 2 * rest.n, 0, rest.n * sizeof *rest.x);
        memset(rest.v, 0, 3 * rest.n * sizeof *rest.v);
        energy = cs_probe_energy(&rest);
    }
    cs_probe_close(&rest);
    return energy;
}

/* Without damping, energy may fall (many implicit methods dissipate) but not grow by more than
 * the error of a step explains. With a symplectic method it stays near its start for good. Such
 * a method conserves a modified energy, up to terms that are exponentially small in 1/h
 * (Hairer, Lubich, Wanner 2006). The bound is (h w)^2, or h w for order 1. The run is 17 times
 * as long as that of `tolerance`, so an adaptive method is allowed ten times its error there.
 */
void cs_check_energy(const struct cs_conform *card, struct cs_conform_row *row) {
    const struct cs_integrator *method = card->method;
    const bool both = method->traits & CS_SYMPLECTIC;
    struct cs_probe drum;
    double start = (double)NAN, motion = (double)NAN, worst = 0;
    if (cs_drum_open(&drum, card, method, &(struct cs_drum){0})) {
        start = cs_probe_energy(&drum);
        /* the energy of the motion alone: the tension of the sheet at rest holds some too */
        motion = start - rest_energy(card);
    }
    const bool adaptive = method->traits & CS_ADAPTIVE;
    const double share = cs_probe_set_level(&drum, cs_drum_step(), CS_DRUM_OMEGA,
                                            method->order > 1 ? 2 : 1, adaptive);
    for (int k = 0; k < FRAMES && cs_probe_run(&drum, 1); k++) {
        const double gained = (cs_probe_energy(&drum) - start) / motion;
        worst = fmax(worst, both ? fabs(gained) : gained);
    }
    if (drum.has_ended)
        cs_row_fail(row, "%s", drum.error.message);
    else
        cs_row_state(row, worst, adaptive ? 10 * share : share,
                     "of the motion's energy %s in five seconds",
                     both ? "gained or lost at most" : "gained");
    cs_probe_close(&drum);
}
