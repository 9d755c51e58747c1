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
void cs_check_copies(const struct cs_conform *card, struct cs_conform_row *row) {
    const bool clusters = card->method->needs & CS_NEED_CLUSTERS;
    const char *matched = clusters ? ", \"shape_matching\": {\"alpha\": 0.5}" : "";
    struct cs_probe sheets;
    cs_probe_open(&sheets, card, card->method, COPIES, matched, matched, matched);
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

/* Masses, springs, dampers and forces in some unit: gravity does not depend on it. */
#define HEAVY                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"bump\": 0.1, \"stretch\": [1.05, 1.02], "  \
    "\"velocity\": [0.1, 0.2, 0.3]}, \"mass\": {\"particle\": %.17g}, \"springs\": "           \
    "{\"stretch\": %.17g, \"shear\": %.17g, \"bend\": %.17g, \"damping\": %.17g}, \"pins\": "  \
    "[\"top-left\"]}], \"forces\": {\"drag\": %.17g}, \"time\": {\"fps\": 60}}"
enum { HEAVY_PARTICLES = 25, HEAVY_VALUES = 6 * HEAVY_PARTICLES, HEAVY_FRAMES = 6 };

/* The state (6,n) with all masses and forces `unit` times as large, a power of two. */
static bool run_heavy(const struct cs_conform *card, struct cs_conform_row *row, double unit,
                      double *state, double *move) {
    struct cs_probe sheet;
    cs_probe_open(&sheet, card, card->method, HEAVY, unit / 16, 32 * unit, 16 * unit, 4 * unit,
                  unit / 32, unit / 64);
    cs_probe_set_level(&sheet, 0.1 / RATE, RATE, 1, 0);
    const bool done = cs_probe_run(&sheet, HEAVY_FRAMES);
    if (done) {
        memcpy(state, sheet.x, HEAVY_VALUES * sizeof *state);
        *move = cs_rms_difference(sheet.x, sheet.session.system.start, 3 * sheet.n);
    } else
        cs_row_fail(row, "%s", sheet.error.message);
    cs_probe_close(&sheet);
    return done;
}

/* A force that is clamped, or compared with a constant in N, does not scale. */
void cs_check_units(const struct cs_conform *card, struct cs_conform_row *row) {
    static const double units[] = {1048576, 1 / 1048576.0};
    double plain[HEAVY_VALUES], scaled[HEAVY_VALUES], move;
    if (!run_heavy(card, row, 1, plain, &move))
        return;
    for (size_t k = 0; k < 2 && run_heavy(card, row, units[k], scaled, &move); k++)
        cs_row_state(row, cs_rms_difference(plain, scaled, HEAVY_VALUES / 2) / move, SMALL,
                     "of the motion changed with all masses and forces %s",
                     k ? "a millionth" : "a million times");
}
