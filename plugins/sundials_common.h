/* sundials_common.h - what the methods on SUNDIALS share: context, state, right-hand side,
 * error messages, the loop over steps, and the linear solver of the implicit ones.
 *
 * y = (x, v), y' = (v, f/m). A library is driven step by step, and after each step comes the
 * commit. Where something acts between steps the frame time is its stop time; where nothing
 * does it steps as it likes, and frames are interpolated: see sundials_overstep.h. It keeps its
 * history across frames, and hears of it where the state was moved from outside.
 */
#ifndef SUNDIALS_COMMON_H
#define SUNDIALS_COMMON_H

#include "sundials.h"

/* Makes context, vectors and state. linear_rtol above 0: the linear solver too. CS_STEP_FAIL:
 * the host was told. */
enum cs_step sundials_open(struct sundials *self, const struct cs_host *host,
                           const struct sundials_library *library, int n_vectors,
                           double linear_rtol);
/* After the library's memory was freed; self may be half made. */
void sundials_close(struct sundials *self);

/* y' with the chosen parts of the force; moves: x' = v, else 0. Returns 1, which lets the
 * library try a smaller step, where it is not finite, or where the way to y carries surfaces
 * through each other and the library recovers from that. */
int sundials_slope(const struct sundials *self, double t, N_Vector y, uint32_t parts,
                   bool moves, N_Vector slope);
/* The same of the whole force, as SUNDIALS calls it; object is the struct sundials. */
int sundials_whole_slope(sunrealtype t, N_Vector y, N_Vector slope, void *object);

#if SUNDIALS_VERSION_MAJOR < 7
/* For the libraries' SetErrHandlerFn; since 7 the context has it. */
void sundials_keep_message(int code, const char *module, const char *function, char *message,
                           void *object);
#endif

enum cs_step sundials_restart(void *object, double t, const double *x, const double *v);
enum cs_step sundials_advance(void *object, double t0, double t1, double *x, double *v);

#endif
