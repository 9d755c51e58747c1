/* fixed_step.c - cuts an advance into equal steps, and steps into parts if they must be
 * shorter.
 *
 * The decisions of one step, in order:
 * 1. Choose the length of the part: as the part before; twice as long if that is aligned,
 *    stable, accurate and looks admissible; halved until it is not longer than 0.9 of the
 * stability limit at the state, and, with free_motion, until the host admits the motion without
 *    forces. After a refusal step 1 is left out, because the state is the same.
 * 2. More than max_depth halvings: the run ends with the reason of the last refusal.
 * 3. Take the part. If the host does not admit the displacement, the part is longer than 0.9 of
 *    the stability limit at its end, or its error is too large, restore the state, halve, and
 *    go to 2.
 * 4. Commit the part. If the commit changed the state, the method's history is void.
 * 5. Continue until all parts are done.
 *
 * Times are computed from the begin of the step and of the advance, not summed: the last is
 * t1 to the bit. */
#include "fixed_step.h"

#include <math.h>
#include <string.h>

/* More steps in one advance mean a wrong dt. */
#define MOST_STEPS 1e9
/* A dt that misses a whole number of steps by this fraction was meant to meet it: 1/120 typed
 * as 0.0083333 misses by 4e-6. */
#define TYPED 1e-5

/* Halvings of a step before the run fails: parts of 1/65536. Chosen by trial. */
enum { MOST_CUTS = 16 };
/* Halvings of an advance for the sake of the error alone: to a thousandth, of 1/60 s where it
 * is longer. A method whose iteration leaves noise in its velocities is taken as it is then. */
enum { ERROR_CUTS_MAX = 10 };
#define ERROR_PART (1e-3 / 60)

/* Finds 0.9 of the longest stable step at a state, in s: the margin of the automatic dt.
 * HUGE_VAL for a method that did not choose dt by its limit. */
static void find_longest(struct fixed_step *self, double t, const double *x, const double *v) {
    double omega, delta;
    self->longest = HUGE_VAL;
    if (self->limit) {
        self->host->bounds_at(self->host->ctx, t, x, v, &omega, &delta);
        self->longest = 0.9 * self->limit(self, omega, delta);
    }
}

/* True if a step from the saved state at t to (x, v) at t + h may stand. */
static bool is_step_admissible(struct fixed_step *self, double t, double h, const double *x,
                               const double *v) {
    const struct cs_host *host = self->host;
    if (host->max_step_fraction(host->ctx, t, self->saved_state, t + h, x) < 1)
        return false;
    find_longest(self, t + h, x, v);
    // a limit that is not a number is left to the blow-up check
    return !(self->longest < h);
}

/* try_step of a method whose steps cannot fail by themselves: the host may refuse them. */
static enum cs_step take(struct fixed_step *self, double t, double h, double *x, double *v,
                         bool *cut) {
    const enum cs_step status = self->step(self, t, h, x, v);
    if (status != CS_STEP_OK || !self->is_guarded)
        return status;
    self->longest_is_current = is_step_admissible(self, t, h, x, v);
    *cut = !self->longest_is_current;
    return status;
}

/* Returns whether the error of a part refuses it; the others are stored for the next. */
static bool is_inaccurate(struct fixed_step *self, double h, const double *v) {
    const double *before = self->saved_state + 3 * (size_t)self->host->view->n;
    if (!(self->error.tolerance > 0))
        return false;
    const uint32_t depth = self->subdivision.depth;
    if (!step_error_judge(&self->error, self->host, h, before, v) &&
        (depth < ERROR_CUTS_MAX || (h > ERROR_PART && depth < self->max_depth)))
        return true;
    step_error_accept(&self->error, h);
    return false;
}

/* Takes a part, and restores the state if the method, the host or the error refuses it. What
 * the method has stored then belongs to the step that was undone. */
static enum cs_step try_part(struct fixed_step *self, double t, double h, double *x, double *v,
                             bool *cut) {
    const size_t bytes = 6 * sizeof *x * self->host->view->n;
    if (!self->saved_state)
        return self->try_step(self, t, h, x, v, cut);
    memcpy(self->saved_state, x, bytes);
    const enum cs_step status = self->try_step(self, t, h, x, v, cut);
    if (status != CS_STEP_OK)
        return status;
    *cut = *cut || is_inaccurate(self, h, v);
    self->refused = *cut;
    if (*cut) {
        memcpy(x, self->saved_state, bytes);
        self->history_void = true;
    }
    return status;
}

/* The failure of a step that was refused at the shortest length. */
static enum cs_step fail_at_shortest_part(struct fixed_step *self, double t, double h) {
    if (h > self->longest)
        return self->host->fail(
            self->host->ctx,
            "a stable step at t = %.9g s is shorter than %.3g s, which is "
            "the step after %d halvings: contact is too stiff or too damped "
            "there for an explicit method; less contact.damping, an implicit "
            "method or one with error control may get through",
            t, h, MOST_CUTS);
    return self->host->fail(self->host->ctx,
                            "a step of %.3g s at t = %.9g s, after %d halvings, still misses "
                            "contact or crosses a surface",
                            h, t, MOST_CUTS);
}

struct fixed_step fixed_step_of(const struct cs_host *host, double dt,
                                fixed_step_callback *step) {
    return (struct fixed_step){.host = host,
                               .dt = dt > 0 ? dt : HUGE_VAL,
                               .dt_automatic = dt <= 0,
                               .longest = HUGE_VAL,
                               .step = step,
                               .try_step = take,
                               .report_failure = fail_at_shortest_part,
                               .max_depth = MOST_CUTS};
}

enum cs_step fixed_step_guard(struct fixed_step *self,
                              double (*limit)(const struct fixed_step *, double, double)) {
    const struct cs_host *host = self->host;
    const bool by_error = self->dt_automatic && self->dt == HUGE_VAL;
    self->is_guarded = CS_HAS(host, max_step_fraction) && host->max_step_fraction;
    self->limit = self->is_guarded ? limit : NULL;
    if (by_error && step_error_init(&self->error, host) != CS_STEP_OK)
        return CS_STEP_FAIL;
    if (!by_error && !self->is_guarded)
        return CS_STEP_OK;
    self->saved_state = (double *)host->alloc(host->ctx, 6 * sizeof(double) * host->view->n);
    return self->saved_state ? CS_STEP_OK : CS_STEP_FAIL;
}

enum cs_step fixed_step_restart(void *self, double t, const double *x, const double *v) {
    (void)t, (void)x, (void)v;
    struct fixed_step *loop = self;
    loop->history_void = true;
    loop->error.last_h = 0;
    return CS_STEP_OK;
}

void fixed_step_stats(const void *object, struct cs_stats *out) {
    const struct fixed_step *self = object;
    out->rejected = self->rejected;
    if (CS_HAS(out, local_error))
        out->local_error = self->error.sum;
}

enum cs_step fixed_step_archive(void *object, const struct cs_archive *archive) {
    struct fixed_step *self = object;
    uint64_t marks[] = {self->history_void, self->noted, self->subdivision.depth,
                        self->subdivision.accepted_in_row};
    archive->integers(archive->ctx, marks, 4);
    archive->integers(archive->ctx, &self->rejected, 1);
    step_error_archive(&self->error, self->host, archive);
    self->history_void = marks[0] != 0;
    self->noted = marks[1] != 0;
    self->subdivision.depth = (uint32_t)marks[2];
    self->subdivision.accepted_in_row = (uint32_t)marks[3];
    return CS_STEP_OK;
}

enum cs_step fixed_step_count(struct fixed_step *self, double span, double *n) {
    // a frame of 1/60 s with dt = 1/120 is two steps, also where 1/120 was typed as 0.0083333
    *n = ceil(span / (self->dt * (1 + TYPED)));
    if (!(*n <= MOST_STEPS))
        return self->host->fail(self->host->ctx, "dt = %g s needs more than %g steps in %g s",
                                self->dt, MOST_STEPS, span);
    if (*n < 1)
        *n = 1;
    const double h = span / *n;
    if (!self->noted && !self->dt_automatic && self->dt < HUGE_VAL &&
        h < self->dt * (1 - 1e-9)) {
        self->host->note(self->host->ctx,
                         "dt reduced from %.6g to %.6g s to end steps on frames%s", self->dt, h,
                         self->is_guarded ? ", or as contact cuts them" : "");
        self->noted = true;
    }
    return CS_STEP_OK;
}

/* True if the host admits the straight displacement h v, the motion without forces, or that
 * over free_motion lengths of the step. Uses saved_state as scratch. */
static bool is_free_motion_admissible(const struct fixed_step *self, double t, double h,
                                      const double *x, const double *v) {
    const struct cs_host *host = self->host;
    const double span = self->free_motion > 0 ? self->free_motion * h : h;
    for (size_t i = 0; i < 3 * (size_t)host->view->n; i++)
        self->saved_state[i] = x[i] + span * v[i];
    return host->max_step_fraction(host->ctx, t, x, t + span, self->saved_state) >= 1;
}

/* True if a part of length h may be tried after shorter ones. The free motion predicts the
 * step's own: one that the host refuses would mostly be refused afterwards. Many accepted parts
 * in a row earn a try without this test, except where every part needs it. */
static bool is_growth_admissible(const struct fixed_step *self, double t, double h,
                                 const double *x, const double *v) {
    return !self->is_guarded ||
           (!(self->free_motion > 0) &&
            self->subdivision.accepted_in_row >= STEP_SUBDIVISION_GROW_ALWAYS_AFTER) ||
           is_free_motion_admissible(self, t, h, x, v);
}

/* Chooses the length of the next part, step 1 of the list above. Stops one halving past
 * max_depth, for the caller to fail. */
static void choose_cuts(struct fixed_step *self, double t, double h, const double *x,
                        const double *v) {
    if (!self->longest_is_current)
        find_longest(self, t, x, v);
    const double longest = self->longest;
    struct step_subdivision *cuts = &self->subdivision;
    const double twice = 2 * step_subdivision_length(cuts, h);
    bool admitted = !self->is_guarded || !(self->free_motion > 0);
    if (step_subdivision_may_grow(cuts) && twice <= longest &&
        step_error_admits_twice(&self->error) && is_growth_admissible(self, t, twice, x, v)) {
        step_subdivision_grow(cuts);
        admitted = true;
    }
    for (; cuts->depth <= self->max_depth; step_subdivision_refuse(cuts)) {
        const double part = step_subdivision_length(cuts, h);
        if (part > longest)
            continue;
        if (admitted || is_free_motion_admissible(self, t, part, x, v))
            return;
        self->refused_by_contact = true;
    }
}

/* One step of length h from t, whole or in parts. It ends at `end`, which is t + h up to
 * rounding. */
static enum cs_step take_step_in_parts(struct fixed_step *self, double t, double h, double end,
                                       double *x, double *v) {
    const struct cs_host *host = self->host;
    struct step_subdivision *cuts = &self->subdivision;
    bool moved = true;
    for (cuts->parts_done = 0; !step_subdivision_are_over(cuts);) {
        const double begin = t + cuts->parts_done * step_subdivision_length(cuts, h);
        bool cut = false, changed = false;
        if (moved)
            choose_cuts(self, begin, h, x, v);
        if (cuts->depth > self->max_depth) {
            self->report_failure(self, begin, 2 * step_subdivision_length(cuts, h));
            return CS_STEP_HALT;
        }
        const double part = step_subdivision_length(cuts, h),
                     from = t + cuts->parts_done * part;
        enum cs_step status = try_part(self, from, part, x, v, &cut);
        moved = !cut;
        self->rejected += cut;
        if (cut)
            step_subdivision_refuse(cuts);
        else
            step_subdivision_accept(cuts);
        if (status == CS_STEP_OK && !cut) {
            const double to =
                step_subdivision_are_over(cuts) ? end : t + cuts->parts_done * part;
            status = host->commit(host->ctx, to, part, x, v, &changed);
            self->history_void = changed;
            self->longest_is_current &= !changed;
        }
        if (status != CS_STEP_OK)
            return status;
    }
    return CS_STEP_OK;
}

enum cs_step fixed_step_advance(void *object, double t0, double t1, double *x, double *v) {
    struct fixed_step *self = object;
    double n;
    enum cs_step status = fixed_step_count(self, t1 - t0, &n);
    const double h = (t1 - t0) / n;
    self->longest_is_current = false; // events may have changed forces
    for (double i = 0; i < n && status == CS_STEP_OK; i++)
        // times from t0, not summed up: the last is t1 to the bit
        status =
            take_step_in_parts(self, t0 + i * h, h, i + 1 == n ? t1 : t0 + (i + 1) * h, x, v);
    return status;
}
