/* local_global.h - common parts of methods on one constant matrix: the begin of a step, the
 * pull of the springs, and calls of the descriptor. */
#ifndef LOCAL_GLOBAL_H
#define LOCAL_GLOBAL_H

#include "constant_matrix.h"
#include "fixed_step.h"

struct local_global_options {
    double dt;
    int64_t iterations;
};

struct local_global {
    struct fixed_step loop; /* first: the loop's functions take it for the whole */
    int64_t iterations;
    struct constant_matrix matrix;
    double *f;       /* (3,n) in N: outer forces */
    double *old;     /* (3,n) in m: where the step began */
    double *y;       /* (3,n) in m */
    double *b;       /* (4,n) in kg m: right-hand side; the last row is 0 */
    uint64_t passes; /* iterations */
    uint64_t pulls;  /* of projective-dynamics: times that the springs were gone over */
};

/* Fills a zeroed *self; [create]. */
enum cs_step local_global_init(struct local_global *self, const struct cs_host *host,
                               const struct local_global_options *asked,
                               fixed_step_callback *callback);

/* Begins a step: outer forces, the matrix, old, and y = x. v becomes (y - old)/h. */
enum cs_step local_global_begin(struct local_global *self, double t, double step_length,
                                double *x, double *v);

/* self->b = the pull of springs and dampers in kg m, 0 for pinned particles: projected at x,
 * linear part at z. With z = y it is the right-hand side of the global half, with z = x the
 * force on the particles times h^2. */
void local_global_pull(struct local_global *self, const double *x, const double *z);

/* Calls of the descriptor. */
enum cs_step local_global_restart(void *self, double t, const double *x, const double *v);
enum cs_step local_global_advance(void *self, double t0, double t1, double *x, double *v);
enum cs_step local_global_save(void *self, const struct cs_archive *archive);
enum cs_step local_global_load(void *self, const struct cs_archive *archive);
void local_global_destroy(void *self);

/* a number of the preprocessor as a text */
#define TEXT_OF(number) #number
#define TEXT(number)    TEXT_OF(number)
#define LOCAL_GLOBAL_LIBRARY                                                                   \
    "CHOLMOD " TEXT(CHOLMOD_MAIN_VERSION) "." TEXT(CHOLMOD_SUB_VERSION) "." TEXT(              \
        CHOLMOD_SUBSUB_VERSION)

/* Claims that these methods fail: where the error changes the length of steps, CHOLMOD takes
 * memory for another factor. With a dt it is factored once. */
extern const char *const local_global_fails[];

#endif
