/* fixed_step.h - the loop over steps of equal length that fixed-step methods share.
 *
 * A method's own struct starts with struct fixed_step and gives it the step. The span of an
 * advance is cut into the fewest equal steps that are not longer than dt.
 *
 * A dt of 0 stands for the longest steps whose error is small (step_error.h), unless the method
 * has a stability limit to take them from. They are parts of an advance, so that a frame may
 * shorten a step and never sets its length; dt=frame is one step per advance.
 *
 * In scenes with contact by force (fixed_step_guard) a step may be cut into parts
 * (step_subdivision.h) for three reasons:
 * 1. It would pass over contact that it cannot see, or through a surface
 *    (host->max_step_fraction from the state before the step to the one after).
 * 2. The motion without forces, x to x + h v, would (free_motion). A step that enters
 *    contact and leaves it again has both its ends outside, and is seen by this test alone.
 * 3. The method chose dt by its stability limit, which is shorter in contact
 *    (host->bounds_at), at the state before the step or at the one after. A long step that
 *    ends just inside of contact has an impulse of h F/2 there, with less energy in the
 *    contact than the host would refuse.
 *
 * Each part is committed by itself. */
#ifndef FIXED_STEP_H
#define FIXED_STEP_H

#include "step_error.h"
#include "step_subdivision.h"

/* The option dt of such a method; help says what 0 stands for. */
#define FIXED_STEP_DT(struct_, help)                                                           \
    CS_OPTION_OR_NAME(struct_, dt, step_names, "s", 0, 0, 10,                                  \
                      "maximum step; frame: one step per frame; 0: " help)
#define FIXED_STEP_DT_BY_ERROR(struct_)                                                        \
    FIXED_STEP_DT(struct_, "by an error of half a hundredth of the scene's size per second")
static const char *const step_names[] = {"frame", NULL};

struct fixed_step;

/* Steps from (x, v) at t to t + h, in place, without the commit. */
typedef enum cs_step fixed_step_callback(struct fixed_step *self, double t, double h, double *x,
                                         double *v);
/* The same for a step that may be refused. *cut: it was refused, x and v are unchanged, and
 * it must be shorter. */
typedef enum cs_step fixed_step_try_callback(struct fixed_step *self, double t, double h,
                                             double *x, double *v, bool *cut);

/* The loop of one method; made by fixed_step_of. */
struct fixed_step {
    const struct cs_host *host; /* borrowed */
    double dt;                  /* longest step in s; HUGE_VAL: a whole advance */
    bool history_void; /* the state was changed from outside: the method's history is void */
    bool refused; /* the last part was refused: the state is that before it, history_void too */
    bool noted;   /* the report says already that dt was reduced */
    bool dt_automatic; /* dt was chosen here, not by the user */
    fixed_step_callback *step;

    struct step_subdivision subdivision;
    uint64_t rejected;                 /* steps that were computed and then refused */
    fixed_step_try_callback *try_step; /* takes a step, or refuses it */
    /* fails by host->fail, with the reason why a part of length h was refused */
    enum cs_step (*report_failure)(struct fixed_step *self, double t, double h);
    uint32_t max_depth; /* a step has 2^max_depth parts at most */

    struct step_error error; /* chooses the length where dt is 0 and nothing else does */

    /* only where steps are chosen by error, and in scenes with contact by force, see
     * fixed_step_guard */
    double *saved_state; /* (6n) the state before a step; NULL: no step is judged */
    bool is_guarded;     /* host->max_step_fraction judges steps */
    /* For a method whose result depends on contact that is neither at the begin of a step nor
     * at its end: one with stages, or with an iteration. The motion without forces is judged
     * over so many lengths of the step; 0: it is not. (The force at the begin alone does not
     * move a particle into contact and out of it.) */
    double free_motion;
    bool refused_by_contact; /* the last part that was refused passed over contact */
    double
        longest; /* s, 0.9 of the longest stable step at the state that was asked about last */
    bool longest_is_current; /* that is the present state */
    double (*limit)(const struct fixed_step *self, double omega,
                    double delta); /* s; NULL: none */
};

/* The loop of a method of order 1 with step length dt in s, as options have it: 0 means steps
 * chosen by their error. */
struct fixed_step fixed_step_of(const struct cs_host *host, double dt,
                                fixed_step_callback *step);

/* Makes steps subject to their error, if dt is 0 and nothing has chosen another one, and to
 * host->max_step_fraction, if the host has it; [create]. limit: the method's largest stable
 * step in s for bounds omega and delta, if it chose dt by that; else NULL. CS_STEP_FAIL if out
 * of memory. */
enum cs_step fixed_step_guard(struct fixed_step *self,
                              double (*limit)(const struct fixed_step *, double, double));

/* Sets *n to the number of equal steps of a span in s. Notes once in the report if that
 * reduces dt. Fails if there are more than 1e9. */
enum cs_step fixed_step_count(struct fixed_step *self, double span, double *n);

/* Calls of the descriptor. */
enum cs_step fixed_step_restart(void *self, double t, const double *x, const double *v);
enum cs_step fixed_step_advance(void *self, double t0, double t1, double *x, double *v);
void fixed_step_stats(const void *self, struct cs_stats *out);
/* save and load of the loop: what survives from one advance to the next. */
enum cs_step fixed_step_archive(void *self, const struct cs_archive *archive);

#endif
