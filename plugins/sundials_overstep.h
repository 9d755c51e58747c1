/* sundials_overstep.h - steps that pass frames, where the host lets them.
 *
 * A library that must stop at each frame takes up to several times the steps, if the
 * tolerance would let it go farther: the more, the more frames per second. Instead its own
 * interpolant gives the state at the frame, to the order of the step, and steps do not depend
 * on frames. The host sees a step in parts. Each is committed once, with the interpolant's
 * state at its end.
 *
 * BDF's interpolant is its own polynomial, that of ARKODE's methods is hermite.h; figures are
 * in docs/notes. Adams is limited by its stability, far below a frame. */
#ifndef CS_SUNDIALS_OVERSTEP_H
#define CS_SUNDIALS_OVERSTEP_H

#include "sundials.h"

/* Sets self->interpolated if steps may pass frames in this run; the state then has memory of
 * its own. Call it once, in create, in a method whose library can interpolate. */
void sundials_overstep_begin(struct sundials *self);

/* Takes the state x (6n) that was set from outside, at t. */
void sundials_overstep_restart(struct sundials *self, double t, const double *x);

/* advance of the contract, for such a run. */
enum cs_step sundials_overstep_advance(struct sundials *self, double t0, double t1, double *x,
                                       double *v);

#endif
