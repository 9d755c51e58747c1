/* sundials_common.h - shared by the methods on SUNDIALS: context, state, right-hand side,
 * error messages, the loop over steps, and the linear solver of the implicit ones.
 *
 * y = (x, v), y' = (v, f/m). A library is driven step by step, and the commit follows each
 * step. If something acts between steps, the end of the advance is the library's stop time.
 * If nothing does, it is the next event, and frames are interpolated: see
 * sundials_overstep.h. It keeps its history across frames, and is told when the state was
 * changed from outside. */
#ifndef SUNDIALS_COMMON_H
#define SUNDIALS_COMMON_H

#include "sundials.h"

/* Creates context, n_vectors vectors and the state; unless linear_rtol is NULL the linear
 * solver too. Returns CS_STEP_FAIL after a failure that the host has reported; call
 * sundials_close then too. */
enum cs_step sundials_open(struct sundials *self, const struct cs_host *host,
                           const struct sundials_library *library, int n_vectors,
                           const double *linear_rtol);
/* Frees the context; call it after the library's memory was freed. self may be half made. */
void sundials_close(struct sundials *self);

/* slope = y' with the chosen parts of the force; moves: x' = v, else x' = 0. Returns 1, a
 * recoverable failure after which the library tries a smaller step, if a force is not finite.
 * Likewise if the displacement to y carries surfaces through each other, for a library that
 * recovers from that at a stage. */
int sundials_slope(const struct sundials *self, double t, N_Vector y, uint32_t parts,
                   bool moves, N_Vector slope);
/* The same of the whole force, as SUNDIALS calls it; object is the struct sundials. */
int sundials_whole_slope(sunrealtype t, N_Vector y, N_Vector slope, void *object);
/* The weights of errors at y by self->tolerance, as SUNDIALS asks for them. */
int sundials_weigh(N_Vector y, N_Vector weight, void *object);

#if SUNDIALS_VERSION_MAJOR < 7
/* For the libraries' SetErrHandlerFn; since 7 the context has it. */
void sundials_keep_message(int code, const char *module, const char *function, char *message,
                           void *object);
#endif

/* Calls of the descriptor: restart forgets the library's history, advance is the loop over
 * steps. */
enum cs_step sundials_restart(void *object, double t, const double *x, const double *v);
enum cs_step sundials_advance(void *object, double t0, double t1, double *x, double *v);

#endif
