/* sundials.h - a library of SUNDIALS (CVODE or ARKODE), and the state of a method on it.
 *
 * The loop over steps, steps that pass frames, and the linear solver use it, each in its own
 * file. */
#ifndef SUNDIALS_H
#define SUNDIALS_H

#include "step_control.h"
#include "sundials_vector.h"

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
    /* where the nonlinear solver stands, and its g: see sundials_solver.c */
    int (*system)(void *memory, double *t, N_Vector *y, double *g);
    /* the state was changed at t after a step of dt in s; dt 0: from outside, forget all */
    int (*on_state_changed)(struct sundials *self, double t, double dt);
};

/* The common part of a method's object, which starts with it. */
struct sundials {
    const struct cs_host *host; /* borrowed */
    const struct sundials_library *library;
    SUNContext context; /* owned */
    void *memory;       /* owned by the method */
    struct sundials_vectors vectors;
    N_Vector state;        /* wraps the host's x and v, unless steps pass frames */
    N_Vector interpolated; /* that wraps them then; NULL: steps end at frames */
    double t_internal;     /* s, where the state is then */
    struct _generic_SUNLinearSolver solver;
    struct _generic_SUNLinearSolver_Ops solver_ops;
    struct tolerance tolerance;
    double linear_rtol; /* relative residual of the linear solves; 0: what the library allows */
    double *b;          /* (3,n), right-hand side of the reduced system */
    uint32_t failed_solves; /* in a row, up to FAILED_SOLVES_MAX */
    int64_t max_steps;      /* in an advance */
    double
        *y_before; /* (6n) the state before the step; NULL: no step is refused for its move */
    bool equal_steps;    /* without error control: no step is cut but to meet a frame */
    bool judges_contact; /* a finished step is refused if it passes over contact by force */
    enum cs_step status; /* of the host's solver within the running call */
    char message[256];   /* the library's last */
};

/* Codes of both libraries, for a step that has become as short as it may be: the error test
 * failed, the nonlinear solver did, the right-hand side was refused. */
enum { SUNDIALS_ERROR_TEST = -3, SUNDIALS_CONVERGENCE = -4, SUNDIALS_REFUSED = -10 };

/* True if the displacement from the state before the step, at t0, to x at t carries surfaces
 * through each other, or passes over contact. With t for t0 max_step_fraction tests the first
 * alone, and contact by force is left to error control. False without limits. */
bool sundials_passes_through(const struct sundials *self, double t0, double t, const double *x);

/* Tries a step from *t, where x (6n) is the state, and moves *t to its end. One that
 * max_step_fraction refuses is undone, and *t stays; frame: s, how short it may become is a
 * part of that. Returns the library's code. */
int sundials_try(struct sundials *self, double t1, double frame, double *x, double *t);

/* Fails with the library's code and last message at t, unless the host's own calls failed
 * before: their status is returned then. CS_STEP_HALT if no step was short enough. */
enum cs_step sundials_fail(struct sundials *self, int code, double t);
/* Ends an advance from t0 at t, after max_steps steps. */
enum cs_step sundials_fail_by_count(struct sundials *self, double t0, double t);

#endif
