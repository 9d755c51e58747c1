/* stability_boundary.h - judges one cell of a map, and bisects the border between stable and
 * unstable steps.
 *
 * The border assumes that stability is monotone in dt near it: every shorter step is stable,
 * every longer one unstable. Resonances of a method can violate this; the bisection then finds
 * one of several borders. */
#ifndef CS_STABILITY_BOUNDARY_H
#define CS_STABILITY_BOUNDARY_H

#include "study/stability/stability_reference.h"

/* Steps of one cell: a sound run that reaches them is CS_STABILITY_SHORT, not stable. */
enum { CS_CELL_STEPS = 20000 };

/* Result of one cell: one step length on one scene. */
struct cs_stability_cell {
    /* s; 0: not tried yet */
    double dt;
    enum cs_stability_verdict verdict;
    double drift;       /* see cs_stability_drift; NAN if the run did not finish */
    double time;        /* s, where the verdict showed; the end of a stable one */
    uint32_t particles; /* of a local instability: most at one time */
    double crossings;   /* most of all samples; NAN where they are not counted */
};

/* Runs one cell with the step dt in s and judges it by a reference, over the time of the
 * reference or CS_CELL_STEPS steps, whichever is shorter. A blow-up or a failed method is a
 * verdict. Errors: those of cs_sampled_run_execute; *cell is then undefined. */
enum cs_status cs_stability_run_cell(const struct cs_sampled_run_settings *settings,
                                     const struct cs_reference *reference, double dt,
                                     struct cs_stability_cell *cell, struct cs_error *error);

/* Finds the largest stable step in s, *border, to 1 %.
 *
 * stable: a stable step, 0 if none is known. unstable: an unstable one, HUGE_VAL if none is
 * known; at least one of the two must be known. The search steps by factors of 4 until it has a
 * bracket, then bisects its logarithm by runs over the whole time of the reference. *border is
 * 0 if no stable step was found, HUGE_VAL if every step up to 10 s is stable, NAN if the budget
 * of a run ended. */
enum cs_status cs_stability_boundary(const struct cs_sampled_run_settings *settings,
                                     const struct cs_reference *reference, double stable,
                                     double unstable, double *border, struct cs_error *error);

#endif
