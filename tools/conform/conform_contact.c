/* Checks contact by force against closed forms: the incline, rest on a floor, and the energy of
 * a bounce and of impacts. conform_order.c measures its order.
 *
 * Friction is smoothed: its coefficient is mu v / sqrt(v^2 + ev^2) with ev = friction_speed. A
 * block on a slope of tangent t < mu does not stop but creeps where the friction balances
 * gravity:
 *   mu v / sqrt(v^2 + ev^2) = t   =>   v = ev t / sqrt(mu^2 - t^2).
 * On a steeper slope it accelerates by g (sin a - mu cos a), once v is large against ev. */
#include "conform/conform_checks.h"
#include "model/contact/barrier_law.h"

#include <math.h>
#include <string.h>

#define G     9.81
#define MU    0.3
#define SPEED 0.02 /* m/s: friction_speed */
#define RANGE 0.1  /* m */
#define STIFF 95.0 /* N/m a particle */
#define MASS  0.1  /* kg a particle */

/* s; friction of a block at rest decays at mu g/ev = 147/s: h times this rate is 0.15, half of
 * what the method of Adams and Bashforth of order 4 bears. */
#define STEP (1.0 / 960)

#define CONTACT                                                                                \
    "\"contact\": {\"law\": \"force\", \"start\": \"allow\", \"stiffness\": 95, \"damping\": " \
    "0.02,"                                                                                    \
    " \"friction_speed\": 0.02}, \"time\": {\"fps\": 20}"

/* Four particles with equal forces: a rigid body in any model. Rotated by an angle about z, and
 * placed along the normal of the slope. */
#define BLOCK                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"size\": [0.1, 0.1], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [%.17g, %.17g, 0], \"rotate\": [0, 0, %.17g, %.17g]}},"       \
    " \"mass\": {\"particle\": 0.1}, \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": "   \
    "0}}], \"colliders\": [{\"plane\": {\"point\": [0, 0, 0], \"normal\": [%.17g, %.17g, 0]}," \
    " \"thickness\": 0.1, \"friction\": 0.3}], " CONTACT "}"

/* Stretched, sliding, and above the height at which it will rest. */
#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"start\": \"flat\", \"stretch\": [1.05, "   \
    "0.97], \"velocity\": [0.1, 0, 0.05], \"place\": {\"translate\": [0, 0.07, 0]}}, "         \
    "\"mass\": {\"particle\": 0.1}, \"springs\": {\"stretch\": 20, \"shear\": 10, \"bend\": "  \
    "2, \"damping\": 0.1}}], \"colliders\": [{\"floor\": {\"height\": 0}, \"thickness\": "     \
    "0.1, \"friction\": 0.3}], " CONTACT "}"

/* thrown at a plane and back, without loss; a bump, so that it does not touch all at once */
#define BOUNCE                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"bump\": 0.05, \"velocity\": [0.2, 0, "     \
    "-1]}, \"mass\": {\"particle\": 0.1}, \"springs\": {\"stretch\": 20, \"shear\": 10, "      \
    "\"bend\": 2, \"damping\": 0}}], \"forces\": {\"gravity\": [0, 0, 0]}, \"colliders\": "    \
    "[{\"plane\": {\"point\": [0, 0, -0.25], \"normal\": [0, 0, 1]}, \"thickness\": 0.2, "     \
    "\"friction\": 0}], \"contact\": {\"law\": \"force\", \"start\": \"allow\", "              \
    "\"stiffness\": 100}, \"time\": "                                                          \
    "{\"fps\": 50}}"
/* Thrown at a floor whose range is short against speed times step, flat, without loss; it comes
 * into range after `phase` of a frame. */
#define THROW                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"size\": [0.3, 0.3], \"start\": \"flat\", " \
    "\"velocity\": [0, %.17g, 0], \"place\": {\"translate\": [0, %.17g, 0]}}, \"mass\": "      \
    "{\"areal_density\": 0.2}, \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 0.5, "  \
    "\"damping\": 0}}], \"colliders\": [{\"floor\": {\"height\": 0}, \"thickness\": 0.002, "   \
    "\"friction\": 0}], \"forces\": {\"gravity\": [0, 0, 0]}, \"contact\": {\"law\": "         \
    "\"force\"}, \"time\": {\"fps\": 60}}"
#define THROW_RANGE 0.002
/* Energy that an impact may gain. position-verlet, whose v is half a step late, shows up to
 * 0.31; methods that are unstable without damping gain 0.5 and more. */
#define GAIN_MAX 0.4
enum { PHASES = 40, THROW_FRAMES = 4 };

/* Two thin sheets, the smaller one thrown at the larger one: in a step of a frame it would move
 * 85 times their thickness. Meshes of unequal size, so that no two points meet. */
#define THIN_SHEET(n, size, more)                                                              \
    "{\"cloth\": {\"grid\": [" n ", " n "], \"size\": [" size ", " size "], \"start\": "       \
    "\"flat\"" more "}, \"mass\": {\"areal_density\": 0.2}, \"springs\": {\"stretch\": 60, "   \
    "\"shear\": 20, \"bend\": 0.5, \"damping\": 0.01}, \"thickness\": 0.002}"
#define THIN                                                                                   \
    "{\"bodies\": [" THIN_SHEET("5", "0.4", "") ", " THIN_SHEET(                               \
        "4", "0.2",                                                                            \
        ", \"velocity\": [0, -10, 0], \"place\": {\"translate\": [0, "                         \
        "0.1, 0]}") "], \"forces\": {\"gravity\": [0, 0, 0]}, \"pairs\": "                     \
                    "{\"among\": \"all\"}, \"contact\": "                                      \
                    "{\"law\": \"force\"}, \"time\": {\"fps\": 60}}"
enum { THIN_FRAMES = 6, THIN_BELOW = 25 };

#define BOUNCE_RATE 40 /* 1/s, of springs, and of contact where it is deepest */
enum { BOUNCE_FRAMES = 25 };

/* Skips methods that do not support contact by force, or whose accuracy cannot be set. */
static bool takes_contact(const struct cs_conform *conform, struct cs_conform_row *row) {
    if (conform->method->traits & CS_EXPLICIT_OUTER) {
        cs_row_skip(row, "it is refused with contact by force");
        return false;
    }
    return cs_probe_can_be_set(conform, row);
}

/* Mean velocity in m/s down the slope, towards +x. */
static double sliding(const struct cs_probe *block, double a) {
    double sum = 0;
    for (size_t i = 0; i < block->n; i++)
        sum += cos(a) * block->v[i] - sin(a) * block->v[block->n + i];
    return sum / (double)block->n;
}

/* One slope of the given tangent. The first five frames let the start decay; the mean
 * acceleration (t > mu) or the velocity (t < mu) of the next five is compared. */
static void slide(const struct cs_conform *conform, struct cs_conform_row *row,
                  double tangent) {
    const double a = atan(tangent),
                 d = cs_barrier_loaded_distance(RANGE, STIFF, MASS * G * cos(a));
    struct cs_probe block;
    cs_probe_open(&block, conform, conform->method, BLOCK, sin(a) * d, cos(a) * d, -sin(a / 2),
                  cos(a / 2), sin(a), cos(a));
    cs_probe_set_level(&block, STEP, 1, 1, 0);
    cs_probe_run(&block, 5);
    const double before = block.has_ended ? 0 : sliding(&block, a);
    if (!cs_probe_run(&block, 5))
        cs_row_fail(row, "%s", block.error.message);
    else if (tangent > MU) {
        const double found = (sliding(&block, a) - before) / (5 * block.frame);
        const double expected = G * (sin(a) - MU * cos(a));
        cs_row_state(row, fabs(found - expected) / (MU * G), 0.02,
                     "of g mu off on a slope of %g: %.4f m/s2, expected %.4f", tangent, found,
                     expected);
    } else {
        const double found = sliding(&block, a);
        const double expected = SPEED * tangent / sqrt(MU * MU - tangent * tangent);
        cs_row_state(row, fabs(found / expected - 1), 0.05,
                     "of the creep off on a slope of %g: %.5f m/s, expected %.5f", tangent,
                     found, expected);
    }
    cs_probe_close(&block);
}

void cs_check_contact_incline(const struct cs_conform *conform, struct cs_conform_row *row) {
    if (!takes_contact(conform, row))
        return;
    slide(conform, row, 0.2);
    slide(conform, row, 0.5);
}

/* A stretched sheet dropped on a floor: only friction and damping can stop it. A step too long
 * for friction shows as chatter of the size of friction_speed. */
void cs_check_contact_rest(const struct cs_conform *conform, struct cs_conform_row *row) {
    struct cs_probe sheet;
    double squares = 0;
    if (!takes_contact(conform, row))
        return;
    cs_probe_open(&sheet, conform, conform->method, SHEET);
    cs_probe_set_level(&sheet, STEP, 1, 1, 0);
    if (!cs_probe_run(&sheet, 30))
        cs_row_fail(row, "%s", sheet.error.message);
    for (size_t i = 0; i < 3 * sheet.n && !sheet.has_ended; i++)
        squares += sheet.v[i] * sheet.v[i];
    if (!sheet.has_ended)
        cs_row_state(row, sqrt(squares / (double)sheet.n) / SPEED, 0.1,
                     "of friction_speed left on a floor after 1.5 s");
    cs_probe_close(&sheet);
}

/* Distance of the lowest particle from the plane, as a fraction of the range. */
static double lowest(const struct cs_probe *sheet) {
    double low = HUGE_VAL;
    for (size_t i = 2 * sheet->n; i < 3 * sheet->n; i++)
        low = fmin(low, sheet->x[i]);
    return (low + 0.25) / 0.2;
}

/* Contact without friction and damping is conservative: the total energy may not grow by more
 * than half the expected error. The check fails if the sheet never came near the plane. */
void cs_check_contact_energy(const struct cs_conform *conform, struct cs_conform_row *row) {
    struct cs_probe sheet;
    double start = (double)NAN, worst = 0, low = HUGE_VAL;
    if (!takes_contact(conform, row))
        return;
    if (cs_probe_open(&sheet, conform, conform->method, BOUNCE))
        start = cs_probe_energy(&sheet);
    const double share = cs_probe_set_level(&sheet, 0.05 / BOUNCE_RATE, BOUNCE_RATE,
                                            cs_conform_order(conform, false) > 1 ? 2 : 1, 0);
    for (int k = 0; k < BOUNCE_FRAMES && cs_probe_run(&sheet, 1); k++) {
        worst = fmax(worst, (cs_probe_energy(&sheet) - start) / start);
        low = fmin(low, lowest(&sheet));
    }
    if (sheet.has_ended)
        cs_row_fail(row, "%s", sheet.error.message);
    else if (low > 0.8)
        cs_row_fail(row, "it came no nearer to the plane than %.2f of the range", low);
    else
        cs_row_state(row, worst, share / 2, "of the energy gained as it bounces off a plane");
    cs_probe_close(&sheet);
}

/* True if the step is the user's to choose: the method has a default for dt, and 0 is none.
 * Such a step is made short against the contact, as its user would. */
static bool takes_given_step(const struct cs_integrator *method) {
    for (uint32_t k = 0; k < method->n_options; k++)
        if (!strcmp(method->options[k].name, "dt"))
            return method->options[k].def > 0;
    return false;
}

/* Least and largest fraction of the energy that throws at a speed keep, over phases: where in a
 * step the sheet meets the floor. Returns false if a run ended. */
static bool throw_sheets(const struct cs_conform *conform, struct cs_conform_row *row,
                         double speed, double kept[2]) {
    bool done = true;
    kept[0] = HUGE_VAL, kept[1] = 0;
    for (int k = 0; k < PHASES && done; k++) {
        // multiples of the golden ratio: no phase is that of another in a step that is halved
        const double turns = 0.6180339887498949 * (k + 1), phase = turns - (int)turns;
        const double height = THROW_RANGE + speed * (1 + phase) / 60;
        struct cs_probe sheet;
        double start = (double)NAN;
        if (cs_probe_open(&sheet, conform, conform->method, THROW, -speed, height))
            start = cs_probe_energy(&sheet);
        if (takes_given_step(conform->method))
            cs_probe_set_level(&sheet, 0.03 * THROW_RANGE / speed, 1, 1, 0);
        done = cs_probe_run(&sheet, THROW_FRAMES);
        if (done) {
            const double share = cs_probe_energy(&sheet) / start;
            kept[0] = fmin(kept[0], share);
            kept[1] = fmax(kept[1], share);
        } else
            cs_row_fail(row, "%s", sheet.error.message);
        cs_probe_close(&sheet);
    }
    return done;
}

/* The law keeps all; what a method keeps at its own step is stated, and a large gain fails. */
void cs_check_restitution(const struct cs_conform *conform, struct cs_conform_row *row) {
    double slow[2], fast[2];
    if (conform->method->traits & CS_EXPLICIT_OUTER)
        cs_row_skip(row, "it is refused with contact by force");
    else if (throw_sheets(conform, row, 2, slow) && throw_sheets(conform, row, 10, fast))
        cs_row_state(row, fmax(0, fmax(slow[1], fast[1]) - 1), GAIN_MAX,
                     "of the energy gained; impacts keep %.3f to %.3f at 2 m/s, %.3f to %.3f "
                     "at 10 m/s",
                     slow[0], slow[1], fast[0], fast[1]);
}

/* Particles of the thrown sheet that lie below all of the other sheet. */
static uint32_t count_passed(const struct cs_probe *sheets) {
    double low = HUGE_VAL;
    uint32_t passed = 0;
    for (size_t i = 0; i < sheets->n; i++) {
        const double y = sheets->x[sheets->n + i];
        low = i < THIN_BELOW ? fmin(low, y) : low;
        passed += i >= THIN_BELOW && y < low;
    }
    return passed;
}

/* A method that asks max_step_fraction claims to shorten its step. One that never asks claims
 * nothing, and is right as it is: the guard is then the host's, which ends the run. Where the
 * step is the user's to choose, the sheets may well fly apart too fast: that is for
 * `restitution` to judge. */
void cs_check_crossing(const struct cs_conform *conform, struct cs_conform_row *row) {
    struct cs_probe sheets;
    if (conform->method->traits & CS_EXPLICIT_OUTER) {
        cs_row_skip(row, "it is refused with contact by force");
        return;
    }
    if (cs_probe_open(&sheets, conform, conform->method, THIN))
        sheets.trace.enabled = true;
    const bool ended = !cs_probe_run(&sheets, THIN_FRAMES);
    if (!sheets.asks_step_fraction) {
        cs_row_skip(row, "a guard and no claim: it never asks max_step_fraction");
        row->is_guard = true;
    } else if (ended && sheets.session.run.outcome != CS_UNBOUNDED)
        cs_row_fail(row, "%s", sheets.error.message);
    else
        cs_row_state(row, count_passed(&sheets), 0,
                     "particles of a thrown sheet passed through another one");
    cs_probe_close(&sheets);
}
