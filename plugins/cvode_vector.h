/* cvode_vector.h - SUNDIALS vectors over the host's kernels, cloned from a pool.
 *
 * The sums then run in the host's one order, and a clone cannot fail half-way through the
 * library: all vectors are taken when the method is made.
 */
#ifndef CVODE_VECTOR_H
#define CVODE_VECTOR_H

#include <clothsim/integrator.h>
#include <sundials/sundials_nvector.h>

/* CVODE's history of orders 0..5 (6), its work (7), Newton's and the linear solver's (3), the
 * wrapped state, and one to spare. */
enum { CVODE_VECTORS = 18 };

struct cvode_vectors;

struct cvode_slot {
    struct _generic_N_Vector vector;
    double *data;               /* 6n: x (3,n), then v (3,n) */
    struct cvode_vectors *pool; /* borrowed */
    bool taken;
};

struct cvode_vectors {
    const struct cs_host *host; /* borrowed */
    struct _generic_N_Vector_Ops ops;
    struct cvode_slot slots[CVODE_VECTORS];
};

/* Takes the memory of all vectors. CS_STEP_FAIL: the host has said why. */
enum cs_step cvode_vectors_init(struct cvode_vectors *pool, const struct cs_host *host,
                                SUNContext context);

/* A free vector, or NULL. */
N_Vector cvode_vectors_take(struct cvode_vectors *pool);

static inline double *cvode_data(N_Vector vector) {
    return ((struct cvode_slot *)vector->content)->data;
}

/* Lets a vector stand over other memory of 6n. */
static inline void cvode_wrap(N_Vector vector, double *data) {
    ((struct cvode_slot *)vector->content)->data = data;
}

#endif
