/* stability_boundary.h - one cell of a map, and the border between stable and unstable ones. */
#ifndef CS_STABILITY_BOUNDARY_H
#define CS_STABILITY_BOUNDARY_H

#include "study/stability/stability_reference.h"

enum { CS_CELL_STEPS = 20000 };

struct cs_stability_cell {
    double dt;
    enum cs_stability_verdict verdict;
    double drift;       /* see cs_stability_drift; NAN where the run did not come to its end */
    double time;        /* s, where the verdict showed; the end of a stable one */
    uint32_t particles; /* of a local instability: most at one time */
    double crossings;   /* most of all samples; NAN where they are not counted */
};

/* One cell, judged by a reference; CS_STABILITY_SHORT where CS_CELL_STEPS ended a sound run. */
enum cs_status cs_stability_run_cell(const struct cs_sampled_run_settings *settings,
                                     const struct cs_reference *reference, double dt,
                                     struct cs_stability_cell *cell, struct cs_error *error);

/* The largest stable step: from a step on that is stable (0: none is known) and one that is
 * not (HUGE_VAL: none is known), found and bisected to 1 % by runs over the whole time; NAN
 * where the budget of one ran out. */
enum cs_status cs_stability_boundary(const struct cs_sampled_run_settings *settings,
                                     const struct cs_reference *reference, double stable,
                                     double unstable, double *border, struct cs_error *error);

#endif
