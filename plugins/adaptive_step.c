/* adaptive_step.c - steps of a length that the error allows.
 *
 * One turn of the loop in adaptive_step_advance:
 * 1. Evaluate the slope at the state, if the last step did not leave it; choose a first step
 *    after a restart.
 * 2. Take the smallest of: what the error allowed, dt_max, what the method can take, what
 *    contact lets pass, the rest of the advance.
 * 3. Try it. A step whose error is too large, or that contact refuses, is tried again shorter.
 * 4. Accept the new state and commit it.
 * Where steps may pass the end of the advance, 2 takes the rest up to the next event, and 4
 * commits each step in parts: the interpolant's state at every end of an advance within the
 * step, then the rest.
 */
#include "adaptive_step.h"

#include <float.h>
#include <string.h>

/* Growth per step of what contact lets pass, and how much a refused step is cut at most;
 * chosen on contact_compare and self_compare. */
#define CONTACT_GROWTH 1.1
#define CONTACT_CUT    0.2

enum cs_step adaptive_step_init(struct adaptive_step *self, const struct cs_host *host,
                                const struct adaptive_options *options, int power) {
    self->host = host;
    self->asked = *options;
    self->tolerance = tolerance_of(host, options->rtol, options->atol);
    self->control.power = power;
    self->length = 6 * (size_t)host->view->n;
    /* pinned particles have no error: the norm is a mean over the others */
    for (size_t i = 0; i < host->view->n; i++)
        self->free += host->view->inv_mass[i] > 0 ? 6 : 0;
    self->free = self->free > 1 ? self->free : 1;
    double **const arrays[] = {&self->slope, &self->next, &self->error, &self->weight};
    for (int k = 0; k < 4; k++)
        if (!(*arrays[k] = (double *)host->alloc(host->ctx, self->length * sizeof(double))))
            return CS_STEP_FAIL;
    // with the largest atol, 1 m, nothing but the caller's frames bounds steps
    const bool passes = !options->fixed && CS_HAS(host, overstep_until) &&
                        host->overstep_until > 0 && self->asked.atol < 1;
    self->ends = !passes ? 0 : hermite_ends_for(power);
    for (int k = 0; k < self->ends - 1; k++)
        if (!(self->start[k] = host->alloc(host->ctx, 9 * sizeof(double) * host->view->n)))
            return CS_STEP_FAIL;
    return CS_STEP_OK;
}

void adaptive_step_evaluate(const struct adaptive_step *self, double t, const double *x,
                            const double *v, double *a) {
    const struct cs_host *host = self->host;
    const size_t n = host->view->n;
    host->force(host->ctx, t, x, v, CS_PART_ALL, a);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            a[c * n + i] *= host->view->inv_mass[i];
}

void adaptive_step_weigh(struct adaptive_step *self, const double *y, const double *z) {
    tolerance_weigh(&self->tolerance, self->length / 2, y, z, self->weight);
}

double adaptive_step_norm(const struct adaptive_step *self, const double *values) {
    const struct cs_vector_kernels *vector = self->host->vector;
    return sqrt(vector->weighted_sum_of_squares(self->length, values, self->weight) /
                self->free);
}

/* A first step whose explicit Euler step changes y by a hundredth, and whose term of the
 * method's power would be near the tolerance (Hairer, Norsett, Wanner 1993, sec. II.4). */
static double first_step(struct adaptive_step *self, double t, double span, const double *y) {
    const size_t half = self->length / 2;
    const double *v = y + half;
    double *slope = self->error, *next = self->next; /* (v, a), and the state after h */
    adaptive_step_weigh(self, y, y);
    memcpy(slope, v, half * sizeof *slope);
    memcpy(slope + half, self->slope, half * sizeof *slope);
    const double size = adaptive_step_norm(self, y), speed = adaptive_step_norm(self, slope);
    double h = size < 1e-5 || speed < 1e-5 ? 1e-6 : 0.01 * size / speed;
    h = h < span ? h : span;
    self->host->vector->linear_sum(self->length, 1, y, h, slope, next);
    adaptive_step_evaluate(self, t + h, next, next + half, slope + half);
    for (size_t i = 0; i < half; i++) {
        slope[i] = next[half + i] - v[i];
        slope[half + i] -= self->slope[i];
    }
    const double bend = adaptive_step_norm(self, slope) / h;
    const double largest = bend > speed ? bend : speed;
    const double other =
        largest > 1e-15 ? step_root(0.01 / largest, self->control.power) : 1000 * h;
    return other < 100 * h ? other : 100 * h;
}

static double least(double a, double b) {
    return a < b ? a : b;
}

/* s: half a radian of the fastest mode for a method without a limit of its own. In the first
 * step from rest odd terms of the error vanish, and an estimate that compares two orders passes
 * a step that is far too long: dop853 on the drum without damping was 3e-8 m off at any rtol
 * below 1e-6. */
static double trusted_step(const struct adaptive_step *self) {
    const struct cs_view *view = self->host->view;
    double radians = 0.5;
    // within it are two ends alone: the error at a frame is up to (h w)^6 / (6! 4^3)
    if (self->ends > 2)
        radians = least(radians, step_root(46080 * self->asked.rtol, 6));
    return self->limit || !(view->omega > 0) ? HUGE_VAL : radians / view->omega;
}

static void prepare(struct adaptive_step *self, double t, double span, const double *y) {
    if (self->fresh)
        adaptive_step_evaluate(self, t, y, y + self->length / 2, self->slope);
    self->fresh = false;
    if (!self->started)
        self->control.h = least(first_step(self, t, span, y), trusted_step(self));
    self->started = true;
}

/* The length of the next step: the rest of the advance in one step, at most 0.1 % longer than
 * planned; in two equal ones if it is less than two planned steps; else the planned step. No
 * step before a frame is then much shorter than planned. */
static double cut(double planned, double left) {
    if (left <= planned * 1.001)
        return left;
    return left < 2 * planned ? left / 2 : planned;
}

/* The longest step in s from y at t that dt_max, contact and the method let pass. */
static double longest_step(struct adaptive_step *self, double t, const double *y) {
    const struct cs_host *host = self->host;
    const double span = self->ends ? LONGEST_PAST_FRAMES : self->end - self->begin;
    double most = self->asked.dt_max > 0 ? self->asked.dt_max : span;
    if (self->asked.fixed) // equal parts of an advance
        most = span / ceil(span / most * (1 - 1e-9));
    most = least(self->contact, most);
    if (self->limit && !self->asked.fixed)
        most = least(most, self->limit(self, t, y));
    if (CS_HAS(host, longest_step) && host->longest_step)
        most = least(most, host->longest_step(host->ctx, t, y, y + self->length / 2));
    return most;
}

/* True if the step passes over contact by force, or through a surface: an error estimate
 * cannot see contact that no stage lies in. Shortens what contact lets pass. */
static bool is_refused(struct adaptive_step *self, double t, double h, const double *x) {
    const struct cs_host *host = self->host;
    if (!CS_HAS(host, max_step_fraction) || !host->max_step_fraction)
        return false;
    const double fraction = host->max_step_fraction(host->ctx, t, x, t + h, self->next);
    if (fraction >= 1)
        return false;
    self->contact = h * (fraction > CONTACT_CUT ? 0.95 * fraction : CONTACT_CUT);
    return true;
}

/* s, where the present step has to end at the latest. */
static double stop_of(const struct adaptive_step *self) {
    return self->ends ? self->host->overstep_until : self->end;
}

/* Tries steps from y at t until one holds. *h: its length in s. */
static enum cs_step try_steps(struct adaptive_step *self, double t, const double *y,
                              double *h) {
    const struct cs_host *host = self->host;
    struct step_control *control = &self->control;
    for (;; self->rejected++) {
        if (self->tries++ >= self->asked.max_steps) {
            host->fail(host->ctx, "more than %lld steps from t = %.9g s to %.9g s",
                       (long long)self->asked.max_steps, self->begin, t);
            return CS_STEP_HALT;
        }
        self->bound = longest_step(self, t, y);
        *h = least(control->h, self->bound);
        *h = cut(*h, stop_of(self) - t);
        /* a shorter step is lost in the rounding of t; NaN is refused too */
        if (!(*h > 4 * DBL_EPSILON * self->end)) {
            host->fail(host->ctx, "the step fell to %.3g s at t = %.9g s", *h, t);
            return CS_STEP_HALT;
        }
        double error = HUGE_VAL;
        const enum cs_step status = self->attempt(self, t, *h, y, &error);
        if (status != CS_STEP_OK)
            return status;
        if (self->asked.fixed && isfinite(error))
            error = 0;
        if (error <= 1 && is_refused(self, t, *h, y))
            continue;
        if (step_control_judge(control, *h, error, *h < control->h)) {
            self->local_error += error * self->tolerance.length;
            return CS_STEP_OK;
        }
    }
}

/* One accepted step of *h s from y at t, which leaves the new state in next. span: s, that the
 * first step may have. */
static enum cs_step step(struct adaptive_step *self, double t, double span, const double *y,
                         double *h) {
    prepare(self, t, span, y);
    const enum cs_step status = try_steps(self, t, y, h);
    if (status != CS_STEP_OK)
        return status;
    self->contact *= CONTACT_GROWTH;
    self->fresh = !self->accept(self);
    return CS_STEP_OK;
}

/* One step from y at t, whose state and slope it keeps for the interpolant. */
static enum cs_step step_past_frames(struct adaptive_step *self, double t, const double *y) {
    double *const oldest = self->start[self->ends - 2];
    for (int k = self->ends - 2; k > 0; k--) {
        self->start[k] = self->start[k - 1];
        self->length_of[k] = self->length_of[k - 1];
    }
    self->start[0] = oldest;
    prepare(self, t, LONGEST_PAST_FRAMES, y);
    memcpy(oldest, y, self->length * sizeof *y);
    memcpy(oldest + self->length, self->slope, self->length / 2 * sizeof *y);
    const enum cs_step status = step(self, t, LONGEST_PAST_FRAMES, y, self->length_of);
    // ends at an event itself, not at a sum that rounds beside it
    const double h = self->length_of[0], stop = stop_of(self);
    self->reached = h < stop - t ? t + h : stop;
    return status;
}

/* y (6n) = the state at t within the last step. */
static void interpolate(const struct adaptive_step *self, double t, double *y) {
    struct hermite_end ends[HERMITE_ENDS];
    int n = 0;
    double begin = self->reached;
    for (; n < self->ends - 1 && self->length_of[n] > 0; n++) {
        begin -= self->length_of[n];
        ends[n] = (struct hermite_end){begin, self->start[n], self->start[n] + self->length};
    }
    ends[n++] = (struct hermite_end){self->reached, self->next, self->slope};
    hermite_state(self->host, n, ends, t, y);
}

/* advance with steps that pass t1: those that reach beyond t go on in the next advance. */
static enum cs_step pass_frames(struct adaptive_step *self, double t0, double t1, double *x,
                                double *v) {
    const struct cs_host *host = self->host;
    enum cs_step status = CS_STEP_OK;
    for (double t = t0, next; t < t1 && status == CS_STEP_OK; t = next) {
        if (self->reached <= t)
            status = step_past_frames(self, t, x);
        if (status != CS_STEP_OK)
            return status;
        // the host sees the part of the step that lies in this advance
        next = least(self->reached, t1);
        if (next < self->reached)
            interpolate(self, next, x);
        else
            memcpy(x, self->next, self->length * sizeof *x);
        self->changed = false;
        status = host->commit(host->ctx, next, next - t, x, v, &self->changed);
        if (self->changed) {
            // the rest of the step began at another state
            self->reached = next;
            self->length_of[0] = 0;
            self->fresh = true;
        }
    }
    return status;
}

enum cs_step adaptive_step_advance(void *object, double t0, double t1, double *x, double *v) {
    struct adaptive_step *self = object;
    const struct cs_host *host = self->host;
    enum cs_step status = CS_STEP_OK;
    self->begin = t0;
    self->end = t1;
    self->tries = 0;
    if (self->ends)
        return pass_frames(self, t0, t1, x, v);
    for (double t = t0, h = 0; t < t1 && status == CS_STEP_OK;) {
        status = step(self, t, t1 - t, x, &h);
        if (status != CS_STEP_OK)
            return status;
        memcpy(x, self->next, self->length * sizeof *x);
        /* ends at t1 itself, not at a sum that rounds beside it */
        t = h < t1 - t ? t + h : t1;
        self->changed = false;
        status = host->commit(host->ctx, t, h, x, v, &self->changed);
        self->fresh = self->fresh || self->changed;
    }
    return status;
}

enum cs_step adaptive_step_restart(void *object, double t, const double *x, const double *v) {
    (void)x, (void)v;
    struct adaptive_step *self = object;
    self->reached = t;
    self->length_of[0] = 0;
    self->started = self->asked.fixed;
    self->control = (struct step_control){.power = self->control.power,
                                          .h = self->started ? self->asked.dt_max : 0};
    self->contact = HUGE_VAL;
    self->fresh = true;
    self->changed = false;
    return CS_STEP_OK;
}

void adaptive_step_stats(const void *object, struct cs_stats *out) {
    const struct adaptive_step *self = object;
    out->rejected = self->rejected;
    if (CS_HAS(out, local_error))
        out->local_error = self->local_error;
}

enum cs_step adaptive_step_archive(void *object, const struct cs_archive *archive) {
    struct adaptive_step *self = object;
    struct step_control *control = &self->control;
    uint64_t marks[] = {self->fresh, self->changed, self->started, control->rejected};
    archive->integers(archive->ctx, marks, 4);
    self->fresh = marks[0] != 0;
    self->changed = marks[1] != 0;
    self->started = marks[2] != 0;
    control->rejected = marks[3] != 0;
    archive->integers(archive->ctx, &self->rejected, 1);
    archive->reals(archive->ctx, &control->h, 1);
    archive->reals(archive->ctx, &control->last_error_root, 1);
    archive->reals(archive->ctx, &self->contact, 1);
    archive->reals(archive->ctx, &self->local_error, 1);
    archive->reals(archive->ctx, self->slope, self->length / 2);
    if (self->ends) {
        archive->reals(archive->ctx, &self->reached, 1);
        archive->reals(archive->ctx, self->length_of, HERMITE_ENDS - 1);
        archive->reals(archive->ctx, self->next, self->length);
    }
    for (int k = 0; k < self->ends - 1; k++)
        archive->reals(archive->ctx, self->start[k], self->length / 2 * 3);
    return CS_STEP_OK;
}
