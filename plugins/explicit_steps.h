/* explicit_steps.h - the steps of the explicit methods, and the struct that they share. */
#ifndef EXPLICIT_STEPS_H
#define EXPLICIT_STEPS_H

#include "fixed_step.h"

/* The object of an explicit method. */
struct explicit_method {
    struct fixed_step fixed; /* first: the loop's functions take it for the whole */
    double *a;               /* (3,n) in m/s2 of the last evaluation, or still in N */
    double *history;         /* (3,n): old a of velocity-verlet;
                              * (6,n): (x - x_old)/h of position-verlet, and that before its step;
                              * (12,n): a stage's x and v, and the sums of both slopes, of rk4 */
    size_t n_history;        /* arrays (3,n) in history */
    double h;           /* s, of the last step of position-verlet; 0: none since the restart */
    double h_before;    /* s, h before its last step */
    bool u_was_unknown; /* (x - x_old)/h was, before its last step */
    double velocity_loss;
};

/* Each steps (x, v) from t to t + h in place, without the commit; formulas are in
 * explicit_steps.c. */
enum cs_step step_explicit_euler(struct fixed_step *loop, double t, double h, double *x,
                                 double *v);
enum cs_step step_symplectic_euler(struct fixed_step *loop, double t, double h, double *x,
                                   double *v);
enum cs_step step_averaged_euler(struct fixed_step *loop, double t, double h, double *x,
                                 double *v);
enum cs_step step_velocity_verlet(struct fixed_step *loop, double t, double h, double *x,
                                  double *v);
enum cs_step step_position_verlet(struct fixed_step *loop, double t, double h, double *x,
                                  double *v);
enum cs_step step_rk4(struct fixed_step *loop, double t, double h, double *x, double *v);

/* Forgets the last step too. */
enum cs_step restart_position_verlet(void *object, double t, const double *x, const double *v);

#endif
