/* Checks motions that are known in closed form: free fall, translation, rotation, and the
 * momenta of a free sheet. */
#include "conform/conform_checks.h"

#include <math.h>
#include <string.h>

enum { FRAMES = 50 }; /* five seconds: 50 periods of the fastest mode, 10 of the slowest */

/* Runs to the end, reverses all velocities, and runs back. A method is symmetric if a step of
 * -h undoes a step of h (Hairer, Lubich, Wanner 2006); the equations are reversible, so a
 * symmetric method returns to the start up to rounding. A symplectic method of order 1 is not
 * symmetric. */
void cs_check_reversible(const struct cs_conform *conform, struct cs_conform_row *row) {
    static const struct cs_drum drum = {0};
    struct cs_probe there, back;
    if (!(conform->method->traits & CS_SYMPLECTIC)) {
        cs_row_skip(row, "it does not claim to be symplectic");
        return;
    }
    if (cs_conform_order(conform, false) < 2) {
        cs_row_skip(row, "a symplectic method of order 1 is not symmetric in time");
        return;
    }
    cs_drum_open(&there, conform, conform->method, &drum);
    cs_probe_set_level(&there, cs_drum_step(), CS_DRUM_OMEGA, 1, 0);
    if (cs_drum_open(&back, conform, conform->method, &drum) &&
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
static double rest_energy(const struct cs_conform *conform) {
    struct cs_probe rest;
    double energy = (double)NAN;
    if (cs_drum_open(&rest, conform, conform->method, &(struct cs_drum){0})) {
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
void cs_check_energy(const struct cs_conform *conform, struct cs_conform_row *row) {
    const struct cs_integrator *method = conform->method;
    const bool both = method->traits & CS_SYMPLECTIC;
    struct cs_probe drum;
    double start = (double)NAN, motion = (double)NAN, worst = 0;
    if (cs_drum_open(&drum, conform, method, &(struct cs_drum){0})) {
        start = cs_probe_energy(&drum);
        /* the energy of the motion alone: the tension of the sheet at rest holds some too */
        motion = start - rest_energy(conform);
    }
    const bool adaptive = method->traits & CS_ADAPTIVE;
    const double share =
        cs_probe_set_level(&drum, cs_drum_step(), CS_DRUM_OMEGA,
                           cs_conform_order(conform, false) > 1 ? 2 : 1, adaptive);
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

/* a sheet at rest length, stiff enough that any false force shows */
#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"velocity\": [%g, %g, %g]},"                \
    " \"mass\": {\"particle\": 1}, \"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": "  \
    "25}}], \"forces\": {\"gravity\": [0, %g, 0]}, \"time\": {\"fps\": 60}}"
#define G 9.81
#define PAIR                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": 0.5},"             \
    " \"springs\": {\"stretch\": 25}}], \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": "      \
    "{\"fps\": 20}}"

/* perturbed, so that all springs pull; axial damping, whose forces have no torque */
#define FREE                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5]}, \"mass\": {\"particle\": 0.1},"             \
    " \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": 0.05,"           \
    " \"damping_model\": \"axial\"}}], \"forces\": {\"gravity\": [0, 0, 0]},"                  \
    " \"time\": {\"fps\": 10}}"
#define FREE_OMEGA 60 /* 1/s, near the bound on its frequencies */

/* Relative change that rounding and inner solves may cause. */
#define SMALL 1e-9

/* The lower of the claimed orders, for scenes that may or may not be damped. */
static uint32_t lower_order(const struct cs_conform *conform) {
    const uint32_t free = cs_conform_order(conform, false);
    const uint32_t damped = cs_conform_order(conform, true);
    return free < damped ? free : damped;
}

/* Largest distance of a component from its start plus the same shift for all particles. */
static double deformation(const struct cs_probe *probe, const double shift[3]) {
    double most = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = c * probe->n; i < (c + 1) * probe->n; i++)
            most = fmax(most, fabs(probe->x[i] - probe->session.system.start[i] - shift[c]));
    return most;
}

/* Mean displacement of all particles in one direction, in m. */
static double mean_shift(const struct cs_probe *probe, size_t component) {
    double sum = 0;
    for (size_t i = component * probe->n; i < (component + 1) * probe->n; i++)
        sum += probe->x[i] - probe->session.system.start[i];
    return sum / (double)probe->n;
}

/* One second from rest: the mean must fall by g/2, and no spring may deform. Step sums of a
 * constant acceleration are exact to (h/T)^2, or h/T for order 1. Twice that is allowed. */
static void check_free_fall(const struct cs_conform *conform, struct cs_conform_row *row,
                            int level) {
    struct cs_probe sheet;
    cs_probe_open(&sheet, conform, conform->method, SHEET, 0.0, 0.0, 0.0, -G);
    const uint32_t order = lower_order(conform) > 1 ? 2 : 1;
    const double share = cs_probe_set_level(&sheet, 1.0 / 240, 1, order, level);
    if (!cs_probe_run(&sheet, 60))
        cs_row_fail(row, "%s", sheet.error.message);
    else {
        const double shift[3] = {0, mean_shift(&sheet, 1), 0};
        cs_row_state(row, fabs(shift[1] / (-G / 2) - 1), 2 * share,
                     "fell %.6f m in the first second instead of %.6f m", -shift[1], G / 2);
        cs_row_state(row, deformation(&sheet, shift), 1e-8,
                     "deformed in free fall by so many m");
    }
    cs_probe_close(&sheet);
}

void cs_check_free_fall(const struct cs_conform *conform, struct cs_conform_row *row) {
    if (!cs_probe_can_be_set(conform, row))
        return;
    check_free_fall(conform, row, 0);
    check_free_fall(conform, row, 1);
}

/* Galilean invariance: a uniform velocity must not change anything, however large. The path
 * must be straight and undeformed to 1e-8 m at any step; methods that damp absolute velocity
 * fail. */
static void translate(const struct cs_conform *conform, struct cs_conform_row *row,
                      const double speed[3]) {
    struct cs_probe sheet;
    cs_probe_open(&sheet, conform, conform->method, SHEET, speed[0], speed[1], speed[2], 0.0);
    cs_probe_set_level(&sheet, 1.0 / 60, 1, 1, 0);
    if (!cs_probe_run(&sheet, 60))
        cs_row_fail(row, "%s", sheet.error.message);
    else {
        const double length = hypot(hypot(speed[0], speed[1]), speed[2]);
        double off = 0;
        for (size_t i = 0; i < 3 * sheet.n; i++)
            off = fmax(off, fabs(sheet.v[i] - speed[i / sheet.n]));
        cs_row_state(row, deformation(&sheet, speed), 1e-8,
                     "m off the straight path after a second at %.1f m/s", length);
        cs_row_state(row, off / length, 1e-8, "of the velocity lost or gained at %.1f m/s",
                     length);
    }
    cs_probe_close(&sheet);
}

void cs_check_translation(const struct cs_conform *conform, struct cs_conform_row *row) {
    translate(conform, row, (const double[3]){1, 2, 3});
    translate(conform, row, (const double[3]){60, -120, 180});
}

/* Two particles on a circle: the spring force k (l - 1) provides the centripetal force m w^2
 * l/2. This gives w^2 = 2 k (l - 1) / (l m). */
static void check_rotation(const struct cs_conform *conform, struct cs_conform_row *row,
                           int level) {
    const double length = 1.1, w = sqrt(2 * 25 * (length - 1) / length / 0.5), time = 0.5;
    struct cs_probe pair;
    if (cs_probe_open(&pair, conform, conform->method, PAIR)) {
        for (size_t i = 0; i < 2; i++) {
            const double side = (i ? 0.5 : -0.5) * length;
            pair.x[i] = side;
            /* along y, across the spring: both particles go round their middle */
            pair.v[2 + i] = w * side;
        }
    }
    const double share = cs_probe_set_level(&pair, 2e-3, 10, lower_order(conform), level);
    if (!cs_probe_run(&pair, 10))
        cs_row_fail(row, "%s", pair.error.message);
    else {
        const double expected[6] = {-cos(w * time) * length / 2, cos(w * time) * length / 2,
                                    -sin(w * time) * length / 2, sin(w * time) * length / 2};
        const double off = cs_rms_difference(pair.x, expected, 6) / length;
        cs_row_state(row, off, fmax(2 * share, 1e-11),
                     "of the length off its place after %.2f rad", w * time);
    }
    cs_probe_close(&pair);
}

void cs_check_rotation(const struct cs_conform *conform, struct cs_conform_row *row) {
    if (!cs_probe_can_be_set(conform, row))
        return;
    check_rotation(conform, row, 0);
    check_rotation(conform, row, 1);
}

/* A free pair of masses m: the elongation s obeys s'' + 2 d s' + w^2 s = 0 with w^2 = 2 k/m =
 * 100/s^2 and d = c/m = 1.2/s, because the reduced mass is m/2. */
#define OSCILLATOR                                                                             \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": 0.5},"             \
    " \"springs\": {\"stretch\": 25, \"damping\": 0.6, \"damping_model\": \"%s\"}}],"          \
    " \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": {\"fps\": 20}}"

#define REACH 0.1 /* m */

/* s(t) / s0 = exp(-d t) (cos(u t) + d/u sin(u t)), u^2 = w^2 - d^2, from rest. */
static double elongation(double t) {
    const double d = 0.6 / 0.5, w = 10, u = sqrt(w * w - d * d);
    return exp(-d * t) * (cos(u * t) + d / u * sin(u * t));
}

/* Compares the elongation at T = 1 s with s(T) from s0 = 0.1 m. The phase error of order (h
 * w)^p accumulates over w T = 10 radians; half of that product is allowed. */
static void check_oscillator(const struct cs_conform *conform, struct cs_conform_row *row,
                             const char *model, int level) {
    const double w = 10, expected = REACH * elongation(1);
    struct cs_probe pair;
    if (cs_probe_open(&pair, conform, conform->method, OSCILLATOR, model)) {
        pair.x[0] -= REACH / 2;
        pair.x[1] += REACH / 2;
    }
    const double share =
        cs_probe_set_level(&pair, 5e-3, w, cs_conform_order(conform, true), level);
    if (!cs_probe_run(&pair, 20))
        cs_row_fail(row, "%s", pair.error.message);
    else {
        const double found = pair.x[1] - pair.x[0] - 1;
        // an error grows over w T = 10 radians; half of that is left to the method
        cs_row_state(row, fabs(found - expected) / REACH, fmax(share * w / 2, 1e-11),
                     "of the amplitude off after 1.6 periods: %.6f m, expected %.6f m", found,
                     expected);
    }
    cs_probe_close(&pair);
}

/* Elongation, as a fraction of the reach, after one period, in steps of h. */
static bool elongation_at(const struct cs_conform *conform, struct cs_conform_row *row,
                          const char *model, double h, double *found) {
    struct cs_probe pair;
    if (cs_probe_open(&pair, conform, conform->method, OSCILLATOR, model)) {
        pair.x[0] -= REACH / 2;
        pair.x[1] += REACH / 2;
    }
    cs_probe_set_step(&pair, h);
    const bool done = cs_probe_run(&pair, 12);
    if (done)
        *found = (pair.x[1] - pair.x[0] - 1) / REACH;
    else
        cs_row_fail(row, "%s", pair.error.message);
    cs_probe_close(&pair);
    return done;
}

/* Fixed steps are extrapolated to h = 0. The equation is linear and the pair small, so that
 * more digits are left than in other scenes. */
static void oscillator_limit(const struct cs_conform *conform, struct cs_conform_row *row,
                             const char *model) {
    const uint32_t order = cs_conform_order(conform, true);
    const int levels = order > 3 ? 5 : 7;
    double found[7];
    for (int k = 0; k < levels; k++)
        if (!elongation_at(conform, row, model, ldexp(0.025, -k), found + k))
            return;
    cs_extrapolate(found, levels, 1, 1, order);
    cs_row_state(row, fabs(found[levels - 1] - elongation(0.6)), order < 2 ? 1e-9 : 1.4e-12,
                 "of the amplitude off after a period in the limit");
}

/* Both levels of accuracy, and the limit. */
static void oscillator(const struct cs_conform *conform, struct cs_conform_row *row,
                       const char *model) {
    if (!cs_probe_can_be_set(conform, row))
        return;
    check_oscillator(conform, row, model, 0);
    check_oscillator(conform, row, model, 1);
    if (conform->method->fidelity == CS_FIDELITY_ODE && cs_method_has(conform->method, "dt"))
        oscillator_limit(conform, row, model);
}

void cs_check_oscillator_axial(const struct cs_conform *conform, struct cs_conform_row *row) {
    oscillator(conform, row, "axial");
}

void cs_check_oscillator_relative(const struct cs_conform *conform,
                                  struct cs_conform_row *row) {
    oscillator(conform, row, "relative");
}

/* p: momentum in kg m/s; l: angular momentum about the origin in kg m2/s. scale: the sums of
 * the magnitudes of all terms, which make changes relative even where the totals vanish. */
static void momenta(const struct cs_probe *probe, double p[3], double l[3], double scale[2]) {
    const size_t n = probe->n;
    const double *x = probe->x, *v = probe->v, *mass = probe->session.system.mass;
    memset(scale, 0, 2 * sizeof *scale);
    for (size_t c = 0; c < 3; c++) {
        const size_t d = (c + 1) % 3 * n, e = (c + 2) % 3 * n;
        p[c] = l[c] = 0;
        for (size_t i = 0; i < n; i++) {
            p[c] += mass[i] * v[c * n + i];
            l[c] += mass[i] * (x[d + i] * v[e + i] - x[e + i] * v[d + i]);
            scale[0] += mass[i] * fabs(v[c * n + i]);
            scale[1] += mass[i] * fabs(x[d + i] * v[e + i]);
        }
    }
}

/* Largest difference of a component. */
static double farthest(const double a[3], const double b[3]) {
    return fmax(fmax(fabs(a[0] - b[0]), fabs(a[1] - b[1])), fabs(a[2] - b[2]));
}

/* Relative changes of momentum and angular momentum in half a second without external forces.
 * Returns the error that the method's order explains, NAN if the run ended early. */
static double drift(const struct cs_conform *conform, struct cs_conform_row *row, int level,
                    double change[2]) {
    double before[2][3], after[2][3], scale[2];
    struct cs_probe sheet;
    if (cs_probe_open(&sheet, conform, conform->method, FREE)) {
        /* from rest at rest length the momenta would stay 0 with any method */
        cs_perturb_smooth(&sheet.session.system, 0.01, 0.2);
        momenta(&sheet, before[0], before[1], scale);
    }
    double share =
        cs_probe_set_level(&sheet, 0.1 / FREE_OMEGA, FREE_OMEGA, lower_order(conform), level);
    if (!cs_probe_run(&sheet, 5)) {
        cs_row_fail(row, "%s", sheet.error.message);
        share = (double)NAN;
    } else {
        double unused[2];
        momenta(&sheet, after[0], after[1], unused);
        for (int k = 0; k < 2; k++)
            change[k] = farthest(before[k], after[k]) / scale[k];
    }
    cs_probe_close(&sheet);
    return share;
}

/* Inner forces cancel in pairs, so any method that adds forces linearly conserves momentum. */
void cs_check_momentum(const struct cs_conform *conform, struct cs_conform_row *row) {
    double change[2];
    if (!isnan(drift(conform, row, 0, change)))
        cs_row_state(row, change[0], SMALL, "of the momentum lost or gained in 0.5 s");
}

/* Symplectic methods conserve the quadratic invariant exactly; other methods to their order. */
void cs_check_angular_momentum(const struct cs_conform *conform, struct cs_conform_row *row) {
    const bool exact = conform->method->traits & CS_SYMPLECTIC;
    if (!exact && !cs_probe_can_be_set(conform, row))
        return;
    for (int level = 0; level < (exact ? 1 : 2); level++) {
        double change[2];
        const double share = drift(conform, row, level, change);
        if (!isnan(share))
            cs_row_state(row, change[1], exact ? SMALL : fmax(share, 1e-11),
                         "of the angular momentum lost or gained in 0.5 s%s",
                         exact   ? ""
                         : level ? ", fine"
                                 : ", coarse");
    }
}
