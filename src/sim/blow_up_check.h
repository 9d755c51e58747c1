/* blow_up_check.h - detects a blow-up: numbers that are not finite, or more kinetic energy
 * than the scene can give. */
#ifndef CS_BLOW_UP_CHECK_H
#define CS_BLOW_UP_CHECK_H

#include "sim/run_state.h"

/* The bound on kinetic energy at time t, in J:
 *   100 (start_energy + speed + (force_gain + sqrt(force_rate) (t - t_forces))^2)
 * start_energy is potential: the one of the start, the springs at twice their length, and
 * shape matching. The other two bound free flight under outer forces, sum m (|v| + a t)^2 /
 * 2, by (p + q)^2 <= 2 p^2 + 2 q^2 with speed = sum m v^2 and force_rate = sum m a^2. Where
 * the outer forces change, sqrt(sum m (a1 t1 + a2 t2)^2) <= sqrt(sum m a1^2) t1 + sqrt(sum m
 * a2^2) t2: force_gain adds up the pieces. The factor 100 is a margin, chosen by trial. */
struct cs_blow_up_check {
    double start_energy; /* J */
    double speed;        /* J: twice the kinetic energy of the start */
    double force_rate;   /* J/s2: sum of F^2 / m of the outer forces since t_forces */
    double force_gain;   /* sqrt(J), by the pieces before t_forces */
    double t_forces;     /* s, when the forces were last evaluated */
};

/* Sets the bound from the state and the forces that the system has at time t. */
void cs_blow_up_check_set(struct cs_blow_up_check *bound, const struct cs_system *system,
                          double t);

/* Sets the bound again after the events at time t. It starts from the state that they leave,
 * with the larger of the values now and those at the end of the segment; a grab may pull all
 * particles along. If viewpoint forces only tested visibility again, the bound continues with
 * the new forces: a fresh start at each test would follow a blow-up. */
void cs_blow_up_check_after_events(struct cs_blow_up_check *bound, struct cs_system *system,
                                   double t);

/* Checks the state (x, v) after a step. Returns true on a blow-up; run->outcome and
 * run->blow_up then say which, where and by how much. */
bool cs_blow_up_check_step(const struct cs_blow_up_check *bound, struct cs_run *run, double t,
                           const double *x, const double *v);

#endif
