/* newton_methods.h - the methods of the module `newton`, and the SDIRK2 step that sdirk2 and
 * bdf2 use. */
#ifndef NEWTON_METHODS_H
#define NEWTON_METHODS_H

#include "step_halving.h"

extern const struct cs_integrator backward_euler, implicit_midpoint, bdf2, tr_bdf2, sdirk2,
    ros2, newmark, gauss, esdirk, energy_momentum;

/* Arrays (3,n) of an SDIRK2 step. */
struct sdirk2_arrays {
    double *u;       /* velocity of the running stage: the new velocity in the end */
    double *xb, *ub; /* known part of the second stage */
};
enum cs_step sdirk2_alloc(const struct cs_host *host, struct sdirk2_arrays *arrays);

/* One step of SDIRK2 (see sdirk2.c) by `solve`, newton_solve or newton_step. */
enum cs_step sdirk2_step(struct newton *newton, const struct sdirk2_arrays *arrays,
                         newton_solver *solve, double t, double h, double *x, double *v,
                         bool *accepted);

#endif
