/* stiffest_modes.h - the stiffest modes of a system, which limit the step: frequency and
 * damping.
 *
 * With K = -df/dx and C = -df/dv of springs, dampers, drag and contact by force at
 * one state, with every velocity 0 (friction as of what rests), and p of length 1
 * in the masses (p^T M p = 1), a motion along p swings with square = p^T K p and is damped at
 * rate = p^T C p, as in s'' + rate s' + square s = 0.
 */
#ifndef CS_STIFFEST_MODES_H
#define CS_STIFFEST_MODES_H

#include "model/system/system.h"

struct cs_mode {
    double omega_squared; /* 1/s2; below 0: the state is not stable there */
    double damping_rate;  /* 1/s */
    uint32_t particle;    /* that moves most */
    double participation; /* of the motion's kinetic energy in it, 0..1 */
};

/* Memory of the search; zeroed: empty. */
struct cs_stiffest_modes {
    const struct cs_system *system; /* borrowed */
    double t;                       /* s, at which forces are taken */
    double *basis;                  /* (CS_STIFFEST_MODES_BASIS + 1, 3n) */
    double *dx, *dv, *zeros;        /* (3,n) each: arguments of the products */
    double *root;                   /* (n) root of 1/m */
    double *last_vector;            /* (3,n) the motion found last, where the next starts */
    bool has_start;
    struct cs_arena arena;
};
enum { CS_STIFFEST_MODES_BASIS = 24 };

/* CS_ERR_MEMORY. */
enum cs_status cs_stiffest_modes_init(struct cs_stiffest_modes *modes,
                                      const struct cs_system *system, struct cs_error *error);
void cs_stiffest_modes_finish(struct cs_stiffest_modes *modes);

/* The motion with the largest a square + b rate at the positions x, by power iteration
 * accelerated over its Krylov space (Lanczos 1950; Golub and Van Loan 2013, ch. 10), to a
 * relative 1e-4. Starts where the last search ended. Only + - * / sqrt: the same everywhere. */
struct cs_mode cs_stiffest_modes_largest(struct cs_stiffest_modes *modes, const double *x,
                                         double a, double b);

#endif
