/* The search as the source of a comparison's cells: finds the longest stable step of each fixed
 * explicit method by linear theory, at the start of the reference and at a few of its frames.
 * What moves by itself, colliders for example, is where it is at time 0. */
#include "advise/cheapest.h"

#include "borders/theory.h"

#include <math.h>
#include <string.h>

/* Frames that are looked at besides the start. A search for the worst mode costs about fifty
 * evaluations of the force. */
enum { LOOKS = 8 };

/* ln of what a mode may grow in the time of the run: from 1e-4 to 1 spring's length. */
#define GROWTH 9.21

/* Fraction of the limit that is run: large motions stiffen springs. */
#define SAFE 0.95

/* Tightens the limit at frames of the trajectory that are equally far apart. */
static enum cs_status look_along(struct cs_theory *theory,
                                 const struct cs_trajectory *trajectory, double *limit,
                                 struct cs_error *error) {
    struct cs_theory_limit found;
    if (cs_theory_at(theory, cs_trajectory_state(trajectory, 0), &found, error))
        return error->status;
    for (uint32_t k = 1; k <= LOOKS && !error->status; k++) {
        const uint32_t frame = (uint32_t)((uint64_t)trajectory->frames * k / LOOKS);
        theory->modes.t = frame / trajectory->fps;
        cs_theory_tighten(theory, cs_trajectory_state(trajectory, frame), true, &found, error);
    }
    *limit = found.dt;
    return error->status;
}

static enum cs_status find_limit(const struct cs_compare *compare, const char *integrator,
                                 double *limit, struct cs_error *error) {
    const struct cs_trajectory *trajectory = &compare->reference.trajectory;
    struct cs_recorded_run recording = {0};
    struct cs_theory theory = {0};
    if (!cs_recorded_run_open(&recording, &compare->settings->run, integrator, error) &&
        !cs_theory_init(&theory, &recording.session.system, recording.session.method.integrator,
                        recording.session.method.options,
                        GROWTH * trajectory->fps / trajectory->frames, error))
        look_along(&theory, trajectory, limit, error);
    cs_theory_finish(&theory);
    cs_recorded_run_close(&recording);
    return error->status;
}

/* Lowers the longest steps of fixed explicit methods to their limits. */
static enum cs_status find_limits(struct cs_cheapest *cheapest,
                                  const struct cs_compare *compare, struct cs_error *error) {
    char integrator[CS_CELL_INTEGRATOR];
    double limit = HUGE_VAL;
    for (uint32_t k = 0; k < cheapest->n && !error->status; k++) {
        struct cs_cell *probe = &cheapest->candidates[k].probe;
        if (strcmp(probe->family, "explicit") != 0 || strcmp(probe->control, "dt") != 0)
            continue;
        cs_cell_integrator(probe, integrator, sizeof integrator);
        if (!find_limit(compare, integrator, &limit, error))
            probe->high = fmax(fmin(probe->high, SAFE * limit), probe->low);
    }
    return error->status;
}

/* Rows of an earlier run get the limits of the candidate: compare.csv does not have them. */
static void set_limits(struct cs_compare *compare, const struct cs_cell *probe) {
    for (uint32_t k = 0; k < compare->cells.n; k++) {
        struct cs_cell *cell = compare->cells.cells + k;
        if (cs_cell_same_series(cell, probe)) {
            cell->low = probe->low;
            cell->high = probe->high;
            cell->open = probe->open;
            cell->declared_order = probe->declared_order;
        }
    }
}

enum cs_status cs_cheapest_choose(void *ctx, struct cs_compare *compare,
                                  const struct cs_cell **of, double *value,
                                  struct cs_error *error) {
    struct cs_cheapest *cheapest = ctx;
    *of = NULL;
    if (!cheapest->candidates &&
        (cs_cheapest_begin(cheapest, compare, error) ||
         (compare->reference.pointwise && find_limits(cheapest, compare, error))))
        return error->status;
    for (uint32_t k = 0; cheapest->n_runs == 0 && k < cheapest->n; k++)
        set_limits(compare, &cheapest->candidates[k].probe);
    *of = cs_cheapest_find_next(cheapest, compare, value);
    return CS_OK;
}
