/* fixed_step.h - the loop over steps of equal length that fixed-step methods share.
 *
 * A method's own struct starts with struct fixed_step and gives it the step. The span of an
 * advance is cut into the fewest equal steps that are not longer than dt.
 *
 * In scenes with contact by force (fixed_step_guard) a step may be cut (step_subdivision.h):
 * where it would pass over contact that it cannot see (host->max_step_fraction), or where a
 * method that chose dt by its stability limit has a smaller limit in contact (host->bounds_at).
 * Each part is committed by itself.
 */
#ifndef FIXED_STEP_H
#define FIXED_STEP_H

#include "step_subdivision.h"

struct fixed_step;

/* from (x, v) at t to t + h, without the commit */
typedef enum cs_step fixed_step_callback(struct fixed_step *self, double t, double h, double *x,
                                         double *v);
/* the same; *cut: the step was not taken, x and v are as they were, it has to be shorter */
typedef enum cs_step fixed_step_try_callback(struct fixed_step *self, double t, double h,
                                             double *x, double *v, bool *cut);

struct fixed_step {
    const struct cs_host *host;
    double dt;         /* longest step in s; HUGE_VAL: one step an advance */
    bool history_void; /* the state was moved from outside: what the method remembers is void */
    bool noted;        /* that dt was shortened */
    bool dt_automatic; /* dt was chosen here, not asked for */
    fixed_step_callback *step;

    struct step_subdivision subdivision;
    uint64_t rejected;                 /* steps that were worked out and thrown away */
    fixed_step_try_callback *try_step; /* takes a step, or refuses it */
    /* says why a step cannot be cut any more, for host->fail */
    enum cs_step (*report_failure)(struct fixed_step *self, double t, double h);
    uint32_t max_depth; /* a step has 2^most_cuts parts at most */

    /* only in scenes with contact by force, see fixed_step_guard */
    double *saved_state; /* (6n) the state before a step; NULL: none is judged */
    double (*limit)(const struct fixed_step *self, double omega, double delta); /* s, or NULL */
};

/* dt as options have it: 0 is one step an advance. */
struct fixed_step fixed_step_of(const struct cs_host *host, double dt,
                                fixed_step_callback *step);

/* Lets steps be judged where the scene has contact by force; [create]. limit: the method's
 * largest stable step where it chose dt by it, else NULL. */
enum cs_step fixed_step_guard(struct fixed_step *self,
                              double (*limit)(const struct fixed_step *, double, double));

/* Into how many equal steps a span is cut; tells once where that shortens dt. */
enum cs_step fixed_step_count(struct fixed_step *self, double span, double *n);

enum cs_step fixed_step_restart(void *self, double t, const double *x, const double *v);
enum cs_step fixed_step_advance(void *self, double t0, double t1, double *x, double *v);
void fixed_step_stats(const void *self, struct cs_stats *out);
/* What the loop remembers, for save and load. */
enum cs_step fixed_step_archive(void *self, const struct cs_archive *archive);

#endif
