/* arkode_ends.h - the last ends of ARKODE's steps, from which hermite.h gives frames.
 *
 * ARKODE's interpolants are of lower order than the methods, or evaluate slopes of their own.
 * Most tables begin a step with the slope at its begin: it is kept, and where a frame asks for
 * the slope at the end first, the library gets it from here. A frame then costs no evaluation.
 */
#ifndef ARKODE_ENDS_H
#define ARKODE_ENDS_H

#include "hermite.h"

enum { ARKODE_PARTS = 2 };

/* An end, and the accelerations there by the parts of the force. */
struct arkode_end {
    double t;                /* s */
    double *y;               /* (6n) */
    double *a[ARKODE_PARTS]; /* (3,n) in m/s2 each */
    bool known[ARKODE_PARTS];
    double *whole; /* (3,n): their sum, where there are two */
};

/* Zeroed: steps end at frames. */
struct arkode_ends {
    const struct cs_host *host;   /* borrowed */
    uint32_t parts[ARKODE_PARTS]; /* set of enum cs_part; 0: no second part */
    int n, n_max;                 /* ends that there are: the latest first */
    struct arkode_end end[HERMITE_ENDS];
};

/* Takes the arrays for n_max ends; [create]. */
enum cs_step arkode_ends_init(struct arkode_ends *self, const struct cs_host *host, int n_max,
                              const uint32_t parts[ARKODE_PARTS]);

/* y (6n) at t is the only end. */
void arkode_ends_restart(struct arkode_ends *self, double t, const double *y);
/* A step ended at t in y (6n). */
void arkode_ends_add(struct arkode_ends *self, double t, const double *y);

/* The latest end, if that is (t, y), else NULL. */
struct arkode_end *arkode_ends_find(struct arkode_ends *self, double t, const double *y);

/* z (6n) = the state at t within the last step. Evaluates what is not known yet. */
void arkode_ends_state(struct arkode_ends *self, double t, double *z);

#endif
