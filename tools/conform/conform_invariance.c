/* Checks that need no reference: what one body does its copy does, and motion does not depend
 * on the unit of mass. Both show faults that one small scene hides, at any order of the method.
 */
#include "conform/conform_checks.h"

#include <math.h>
#include <string.h>

/* Relative difference that is allowed; all shipped methods have none. */
#define SMALL 1e-11

/* Frames of 1/240 s, and the rate of the copies' fastest mode, 1/s. */
enum { FRAMES = 12, RATE = 60 };

/* Two equal sheets at one place, which do not touch; a smaller body before them gives their
 * particles other indices. All counts of particles are odd. */
#define COPY                                                                                   \
    "{\"cloth\": {\"grid\": [27, 19], \"size\": [1.3, 0.9], \"bump\": 0.05, \"velocity\": "    \
    "[0.3, 0.2, 0.1], \"spin\": [0.5, 1, 2]}, \"mass\": {\"particle\": 0.1}, \"springs\": "    \
    "{\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": 0.05}, \"pins\": "             \
    "[\"top-left\"]%s}"
#define COPIES                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 1]}, \"mass\": {\"particle\": 0.1}, "            \
    "\"springs\": {\"stretch\": 40}%s}, " COPY ", " COPY "], \"forces\": {\"drag\": 0.01, "    \
    "\"wind\": {\"direction\": [0, 0, 1], \"strength\": 0.1}}, \"time\": {\"fps\": 240}}"
enum { BEFORE = 3, COPIED = 513 };

/* Largest difference of a component between the copies, of their displacement in m. */
static double farthest_copies(const struct cs_probe *probe, const double *values) {
    double most = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < COPIED; i++) {
            const double *first = values + c * probe->n + BEFORE + i;
            most = fmax(most, fabs(first[0] - first[COPIED]));
        }
    return most;
}

/* A loop that leaves out a range of particles, or takes other values for it, treats the copies
 * differently. */
void cs_check_copies(const struct cs_conform *conform, struct cs_conform_row *row) {
    const bool clusters = conform->method->needs & CS_NEED_CLUSTERS;
    const char *matched = clusters ? ", \"shape_matching\": {\"alpha\": 0.5}" : "";
    struct cs_probe sheets;
    cs_probe_open(&sheets, conform, conform->method, COPIES, matched, matched, matched);
    cs_probe_set_level(&sheets, 0.1 / RATE, RATE, 1, 0);
    if (!cs_probe_run(&sheets, FRAMES))
        cs_row_fail(row, "%s", sheets.error.message);
    else {
        const double move =
            cs_rms_difference(sheets.x, sheets.session.system.start, 3 * sheets.n);
        cs_row_state(row, farthest_copies(&sheets, sheets.x) / move, SMALL,
                     "of the motion between two sheets of %d particles that are equal", COPIED);
        cs_row_state(row, farthest_copies(&sheets, sheets.v) / (RATE * move), SMALL,
                     "of the speed between two sheets of %d particles that are equal", COPIED);
    }
    cs_probe_close(&sheets);
}

/* A sheet whose masses, lengths and times are in some units. */
#define SCALED                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"size\": [%.17g, %.17g], \"bump\": %.17g, " \
    "\"stretch\": [1.05, 1.02], \"velocity\": [%.17g, %.17g, %.17g]}, \"mass\": "              \
    "{\"particle\": "                                                                          \
    "%.17g}, \"springs\": {\"stretch\": %.17g, \"shear\": %.17g, \"bend\": %.17g, "            \
    "\"damping\": "                                                                            \
    "%.17g}, \"pins\": [\"top-left\"]}], \"forces\": {\"gravity\": [0, %.17g, 0], \"drag\": "  \
    "%.17g}, \"time\": {\"fps\": %.17g}}"
enum { SCALED_PARTICLES = 25, SCALED_VALUES = 6 * SCALED_PARTICLES, SCALED_FRAMES = 6 };

/* Powers of two, so that no number is rounded. */
struct units {
    const char *text;
    double mass, length, time;
};

/* State (6,n) and mean displacement, both in these units. Returns false if the run ended. */
static bool run_scaled(const struct cs_conform *conform, struct cs_conform_row *row,
                       const struct units *units, double *state, double *move) {
    const double m = units->mass, l = units->length, t = units->time, rate = m / t;
    struct cs_probe sheet;
    cs_probe_open(&sheet, conform, conform->method, SCALED, l, l, l / 16, l / t / 8, l / t / 4,
                  l / t / 2, m / 16, 32 * rate / t, 16 * rate / t, 4 * rate / t, rate / 32,
                  -8 * l / t / t, rate / 64, 64 / t);
    cs_probe_set_level(&sheet, t / 512, RATE / t, 1, 0);
    const bool done = cs_probe_run(&sheet, SCALED_FRAMES);
    if (done) {
        for (size_t i = 0; i < SCALED_VALUES; i++)
            state[i] = sheet.x[i] / (i < SCALED_VALUES / 2 ? l : l / t);
        *move = cs_rms_difference(sheet.x, sheet.session.system.start, 3 * sheet.n) / l;
    } else
        cs_row_fail(row, "in units of %s: %s", units->text, sheet.error.message);
    cs_probe_close(&sheet);
    return done;
}

/* A force or speed that is clamped, or compared with a constant, does not scale. */
void cs_check_units(const struct cs_conform *conform, struct cs_conform_row *row) {
    static const struct units all[] = {{"1 kg, 1 m, 1 s", 1, 1, 1},
                                       {"2^20 kg", 1048576, 1, 1},
                                       {"2^-20 kg", 1 / 1048576.0, 1, 1},
                                       {"2^-10 s", 1, 1, 1 / 1024.0}};
    /* the steps of methods that choose them, and those of shape matching, know the second */
    const bool any_time = !(conform->method->traits & CS_ADAPTIVE) &&
                          conform->method->fidelity != CS_FIDELITY_OTHER;
    double plain[SCALED_VALUES], scaled[SCALED_VALUES], move;
    if (!run_scaled(conform, row, all, plain, &move))
        return;
    for (size_t k = 1; k < sizeof all / sizeof *all; k++)
        if ((all[k].time == 1 || any_time) && run_scaled(conform, row, all + k, scaled, &move))
            cs_row_state(row, cs_rms_difference(plain, scaled, SCALED_VALUES) / move, SMALL,
                         "of the motion changed in units of %s", all[k].text);
}
