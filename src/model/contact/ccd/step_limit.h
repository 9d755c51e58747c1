/* step_limit.h - where contact by force cuts the time step: the admissible fraction of a step
 * with respect to unresolved contact and to surface crossings. With contact by projection see
 * post_step/step_bound.c. */
#ifndef CS_STEP_LIMIT_H
#define CS_STEP_LIMIT_H

#include "base/text.h"
#include "model/system/particle_system.h"

/* Returns whether contact by force or crossings limit steps; otherwise every step may be whole.
 */
bool cs_step_limit_applies(const struct cs_system *system);

/* Admissible fraction of the step from x0 (3,n) at t0 to x1 at t1: 1, or less if it must be
 * rejected. Unresolved contact gives 0.5, a step to try next, because it has no fraction of its
 * own; it is not tested if t1 is t0, as within an iteration. */
double cs_step_limit_fraction(const struct cs_system *system, double t0, const double *x0,
                              double t1, const double *x1);

/* Returns whether contact ran out of memory: forces are incomplete, and the run must end. */
bool cs_step_limit_failed(const struct cs_system *system);

/* Returns whether the scene ends the run at the first crossing and x (3,n) at t has one. Then
 * one line about it is appended to *why. */
bool cs_step_limit_ends_run(const struct cs_system *system, double t, const double *x,
                            struct cs_text *why);

/* --- the last step that was rejected, to report where a method that gives up was stopped ---
 */

/* Both ends of the last step that was tested. */
struct cs_blocked_step {
    /* times in s; positions (2,3,n) in m, NULL if the scene does not limit steps */
    double t[2], *x;
    /* it was rejected; a step was tested, and before that the first end is where one begins */
    bool is_set, asked;
};

/* Allocates memory in the arena if the scene limits steps. CS_ERR_MEMORY. */
enum cs_status cs_blocked_step_init(struct cs_blocked_step *blocked,
                                    const struct cs_system *system, struct cs_arena *arena,
                                    struct cs_error *error);

/* Stores a step from x[0] (3,n) at t[0] to x[1] at t[1] with the fraction that methods were
 * given; a fraction of 1 forgets the last one. */
void cs_blocked_step_store(struct cs_blocked_step *blocked, const struct cs_system *system,
                           const double t[2], const double *const x[2], double share);

/* Asks the questions of cs_step_limit_fraction again and appends what rejected the stored step,
 * which must be set: "; there ... would cross ..." or "; there ... comes to ...", with the
 * distance, the energy that contact takes up there, the energy that comes, and the stiffness or
 * range that would hold it. */
void cs_blocked_step_print(const struct cs_blocked_step *blocked,
                           const struct cs_system *system, struct cs_text *out);

/* Appends the same of the contact that is deepest in its range at (t, x, v), for a method that
 * gives up without a rejected step: that one is the stiffest. Nothing if none is in range, or
 * the scene does not limit steps. The stored step is lost. */
void cs_blocked_step_print_deepest(struct cs_blocked_step *blocked,
                                   const struct cs_system *system, double t, const double *x,
                                   const double *v, struct cs_text *out);

#endif
