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

#include "sundials_vector.h"

#include <math.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_version.h>

struct sundials;

/* The calls of a library; all return its codes, of which those below 0 are failures. */
struct sundials_library {
    const char *name;
    char *(*code_name)(long code); /* to be freed */
    int (*set_stop)(void *memory, sunrealtype t);
    int (*evolve)(void *memory, sunrealtype t, N_Vector y, sunrealtype *reached, int task);
    int one_step;   /* the task */
    bool can_retry; /* from a right-hand side that fails at a stage: by a smaller step */
    /* the k-th derivative of the last step's interpolant at t; NULL: never asked */
    int (*interpolate)(void *memory, sunrealtype t, int k, N_Vector y);
    /* where the nonlinear solver stands, and its g: see solve_reduced */
    int (*system)(void *memory, double *t, N_Vector *y, double *g);
    /* the state was moved at t after a step of dt; 0: from outside, forget all */
    int (*on_state_changed)(struct sundials *self, double t, double dt);
};

struct sundials {
    const struct cs_host *host;
    const struct sundials_library *library;
    SUNContext context; /* owned */
    void *memory;       /* owned by the method */
    struct sundials_vectors vectors;
    N_Vector state;        /* wraps the host's x and v, unless steps pass frames */
    N_Vector interpolated; /* that wraps them then; NULL: steps end at frames */
    double t_internal;     /* s, where the state is then */
    struct _generic_SUNLinearSolver solver;
    struct _generic_SUNLinearSolver_Ops solver_ops;
    double linear_rtol; /* relative residual of the linear solves */
    double *b;          /* (3,n), right-hand side of the reduced system */
    int64_t max_steps;  /* in a frame */
    double
        *y_before; /* (6n) the state before the step; NULL: no step is refused for its move */
    bool equal_steps;    /* without error control: no step is cut but to meet a frame */
    enum cs_step status; /* of the host's solver within the running call */
    char message[256];   /* the library's last */
};

/* Makes context, vectors and state. linear_rtol above 0: the linear solver too. CS_STEP_FAIL:
 * the host was told. */
enum cs_step sundials_open(struct sundials *self, const struct cs_host *host,
                           const struct sundials_library *library, int n_vectors,
                           double linear_rtol);
/* After the library's memory was freed; self may be half made. */
void sundials_close(struct sundials *self);

/* The library's code as the method's failure, unless the host's solver has failed before. */
enum cs_step sundials_fail(struct sundials *self, int code, double t);

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
