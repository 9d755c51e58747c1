/* blow_up_check.h - tells a blow-up: numbers that are not finite, or energy beyond all bound.
 */
#ifndef CS_BLOW_UP_CHECK_H
#define CS_BLOW_UP_CHECK_H

#include "sim/run_state.h"

/* Kinetic energy that no passive system of this kind can reach by time t: a hundred times what
 * the start holds, what every spring would hold at twice its length, and what the outer forces
 * can give in free flight, sum m (|v| + a (t - since))^2. Where the outer forces change on the
 * way, a t is the sum over the pieces. */
struct cs_blow_up_check {
    double start_energy, speed, force_rate; /* J, J, J/s2 */
    double force_gain;                      /* sqrt(J), by the pieces before this one */
    double t_forces;                        /* s, when the forces were last looked at */
};

/* From the state of the system now, at time t. */
void cs_blow_up_check_set(struct cs_blow_up_check *bound, const struct cs_system *system,
                          double t);

/* After the events at time t were applied: from the state that they leave, with the larger of
 * what holds now and what ramps come to; a grab may pull all particles along. Where viewpoint
 * forces only tested visibility again, the bound goes on with other forces: it would else
 * follow a blow-up from test to test. */
void cs_blow_up_check_after_events(struct cs_blow_up_check *bound, struct cs_system *system,
                                   double t);

/* Runs after every step. true: run->outcome and run->blow_up say what happened. */
bool cs_blow_up_check_step(const struct cs_blow_up_check *bound, struct cs_run *run, double t,
                           const double *x, const double *v);

#endif
