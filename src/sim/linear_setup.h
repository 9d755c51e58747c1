/* linear_setup.h - the host's linear systems: the matrix of solve_setup, and matrix and
 * right-hand side of a linearised step of implicit Euler. host.c solves them. */
#ifndef CS_LINEAR_SETUP_H
#define CS_LINEAR_SETUP_H

#include "sim/run_host.h"

/* The calls solve_setup and euler_setup of a method. */
enum cs_step cs_host_solve_setup(void *ctx, double t, const double *x, const double *v,
                                 double cm, double cd, double ck, uint32_t flags);
enum cs_step cs_host_euler_setup(void *ctx, double t, double h, const double *x,
                                 const double *v, uint32_t flags, double *b);
/* The call euler_finish. */
void cs_host_euler_finish(void *ctx, double *x, double *v);

/* Sets the last system up again with a matrix that is closer to positive definite: first
 * CS_SOLVE_PSD, which drops the transverse part of compressed springs, then CS_SOLVE_BOUND
 * for friction on curved surfaces too. If b is that of the last euler_setup, it follows.
 * Returns false if both are already set. */
bool cs_host_clamp(struct cs_run_host *host, const double *b);

/* Replaces the call solve by one that always fails, to test what a method does then. */
void cs_run_host_fail_solves(struct cs_run_host *host);

#endif
