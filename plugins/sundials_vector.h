/* sundials_vector.h - SUNDIALS vectors over the host's kernels, cloned from a pool.
 *
 * The sums then run in the host's one order. A clone cannot fail half-way through the
 * library, because all vectors are taken when the method is created. */
#ifndef SUNDIALS_VECTOR_H
#define SUNDIALS_VECTOR_H

#include <clothsim/integrator.h>
#include <sundials/sundials_nvector.h>

struct sundials_vectors;

/* One vector of the pool; vector.content points to it. */
struct sundials_slot {
    struct _generic_N_Vector vector;
    double *data;                  /* 6n: x (3,n), then v (3,n) */
    struct sundials_vectors *pool; /* borrowed */
    bool in_use;
};

/* The pool of a method. */
struct sundials_vectors {
    const struct cs_host *host; /* borrowed */
    struct _generic_N_Vector_Ops ops;
    struct sundials_slot *slots; /* (n) */
    int n;
    /* Source and target of the last scaling by 1, for cvode_history.h; NULL: none. */
    N_Vector copied_from, copied_to;
};

/* Takes the memory of n vectors of length 6n. Returns CS_STEP_FAIL if out of memory, which
 * the host has reported. */
enum cs_step sundials_vectors_init(struct sundials_vectors *pool, const struct cs_host *host,
                                   int n, SUNContext context);

/* A free vector, which N_VDestroy returns to the pool; NULL if all are in use. */
N_Vector sundials_vectors_acquire(struct sundials_vectors *pool);

/* The 6n numbers of a vector: x (3,n), then v (3,n). */
static inline double *sundials_data(N_Vector vector) {
    return ((struct sundials_slot *)vector->content)->data;
}

/* Makes a vector use other memory of 6n, which must outlive its use. */
static inline void sundials_wrap(N_Vector vector, double *data) {
    ((struct sundials_slot *)vector->content)->data = data;
}

#endif
