/* sundials_overstep.h - steps that pass frames, where nothing acts between steps.
 *
 * A step that ends at each frame costs a library up to several times its steps where the
 * tolerance would let it go farther, the more the more frames a second. The library's own
 * interpolant gives the state at the frame instead, to the order of the step; steps do not
 * depend on frames then. The host sees a step in parts, each of them committed once, with what
 * the interpolant says at its end.
 *
 * For BDF alone, whose interpolant is its own polynomial: figures are in docs/speed.md. Adams
 * is held by its stability, far below a frame. ARKODE's methods lose by it at equal error:
 * their interpolant is of order 4 at most, and what a shorter step of order 4 costs it is
 * worth.
 */
#ifndef CS_SUNDIALS_OVERSTEP_H
#define CS_SUNDIALS_OVERSTEP_H

#include "sundials.h"

/* Where steps may pass frames in this run, sets self->shown: the state has memory of its own
 * then. To be called once, in create, by a method whose library can interpolate. */
void sundials_overstep_begin(struct sundials *self);

/* The state was set from outside, at t. */
void sundials_overstep_restart(struct sundials *self, double t, const double *x);

/* advance of the contract. */
enum cs_step sundials_overstep_advance(struct sundials *self, double t0, double t1, double *x,
                                       double *v);

#endif
