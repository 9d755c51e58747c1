/* theory.h - the largest stable step of a method on a system, as linear theory has it.
 *
 * Each motion of the linearised system is a damped oscillator (stiffest_modes.h); the method's
 * own 2x2 matrix says which steps are stable for one (amplification.h). The mode that limits
 * the step is not always the fastest: it is searched along the normal of the method's stable
 * set.
 */
#ifndef CS_THEORY_H
#define CS_THEORY_H

#include "study/stability/amplification.h"
#include "study/stability/stiffest_modes.h"

struct cs_theory {
    struct cs_amplification amplification;
    struct cs_stiffest_modes modes;
    double stiffness_damping_direction[2]; /* of the search: a square + b rate */
};

/* A step limit and the motion that sets it. */
struct cs_theory_limit {
    double dt; /* s; 0: no step is stable; HUGE_VAL: theory knows no limit */
    struct cs_mode mode;
};

/* The system is read whenever a limit is asked for; it may be built anew in between, as long as
 * it is the same scene. CS_ERR_MEMORY. */
enum cs_status cs_theory_init(struct cs_theory *theory, const struct cs_system *system,
                              const struct cs_integrator *integrator, const void *options,
                              double growth, struct cs_error *error);
void cs_theory_finish(struct cs_theory *theory);

/* Lowers *dt to the limit by Gershgorin bounds: of springs and dampers while no spring is
 * shorter than half its rest length, and of contact by force as it is at the positions x, with
 * friction as of what rests. The smaller of the limits with and without damping. */
enum cs_status cs_theory_gershgorin(struct cs_theory *theory, const double *x, double *dt,
                                    struct cs_error *error);

/* At the positions x: of all motions the one with the smallest limit. */
enum cs_status cs_theory_at(struct cs_theory *theory, const double *x,
                            struct cs_theory_limit *limit, struct cs_error *error);

/* Lowers *limit where a motion at x has a smaller one: one search, for states on a way. */
enum cs_status cs_theory_tighten(struct cs_theory *theory, const double *x,
                                 struct cs_theory_limit *limit, struct cs_error *error);

#endif
