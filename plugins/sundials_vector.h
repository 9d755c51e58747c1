/* sundials_vector.h - SUNDIALS vectors over the host's kernels, cloned from a pool.
 *
 * The sums then run in the host's one order, and a clone cannot fail half-way through the
 * library: all vectors are taken when the method is made.
 */
#ifndef SUNDIALS_VECTOR_H
#define SUNDIALS_VECTOR_H

#include <clothsim/integrator.h>
#include <sundials/sundials_nvector.h>

struct sundials_vectors;

struct sundials_slot {
    struct _generic_N_Vector vector;
    double *data;                  /* 6n: x (3,n), then v (3,n) */
    struct sundials_vectors *pool; /* borrowed */
    bool in_use;
};

struct sundials_vectors {
    const struct cs_host *host; /* borrowed */
    struct _generic_N_Vector_Ops ops;
    struct sundials_slot *slots; /* (n) */
    int n;
    N_Vector copied_from, copied_to; /* of the last plain copy; NULL: none */
};

/* Takes the memory of n vectors. CS_STEP_FAIL: the host has said why. */
enum cs_step sundials_vectors_init(struct sundials_vectors *pool, const struct cs_host *host,
                                   int n, SUNContext context);

/* A free vector, or NULL. */
N_Vector sundials_vectors_acquire(struct sundials_vectors *pool);

static inline double *sundials_data(N_Vector vector) {
    return ((struct sundials_slot *)vector->content)->data;
}

/* Lets a vector stand over other memory of 6n. */
static inline void sundials_wrap(N_Vector vector, double *data) {
    ((struct sundials_slot *)vector->content)->data = data;
}

#endif
