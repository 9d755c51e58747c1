/* step_halving.c - tries a step, undoes one that is refused, and names the reason if no part
 * of it can be taken.
 *
 * One part of a step, in order:
 * 1. The method steps. It refuses by leaving *accepted false, with x and v unchanged.
 * 2. The host judges the displacement.
 * 3. fixed_step.c restores the state and halves a refused part, or commits an accepted one.
 *
 * The factor of shortening is 1/2 whatever the admissible fraction is: times of parts stay
 * exact multiples of a power of 1/2, and a part of twice the length can be tried again where
 * two parts end. */
#include "step_halving.h"

#include <math.h>
#include <string.h>

/* Ends the run with the reason of the last refusal: contact, rotation, else Newton's residual.
 * h: the length in s of the part that was refused. */
static enum cs_step fail_at_shortest_part(struct fixed_step *loop, double t, double h) {
    const struct step_halving *self = (const struct step_halving *)loop;
    const struct cs_host *host = loop->host;
    if (loop->refused_by_contact || (self->newton && self->newton->line_search_blocked))
        return host->fail(host->ctx,
                          "a step of %.3g s at t = %.9g s, after %u halvings, still misses "
                          "contact or crosses a surface",
                          h, t, loop->max_depth);
    if (self->refused_by_rotation)
        return host->fail(host->ctx,
                          "a step of %.3g s at t = %.9g s, after %u halvings, still moves a "
                          "spring's ends by more than half its length",
                          h, t, loop->max_depth);
    if (self->newton->linear_failed)
        return host->fail(host->ctx,
                          "the linear solver fails in a step of %.3g s at t = %.9g s, after %u "
                          "halvings",
                          h, t, loop->max_depth);
    return host->fail(host->ctx,
                      "Newton's iteration fails in a step of %.3g s at t = %.9g s, after %u "
                      "halvings: the residual is %.3g of the impulse, expected %.3g",
                      h, t, loop->max_depth, self->newton->norm / self->newton->impulse,
                      self->newton->rtol);
}

/* Takes the method's step, and refuses it if the host does not admit the whole displacement. */
static enum cs_step take_step(struct step_halving *self, double t, double h, double *x,
                              double *v, bool *accepted) {
    const struct cs_host *host = self->fixed.host;
    const enum cs_step status = self->step(self, t, h, x, v, accepted);
    if (self->fixed.is_guarded && status == CS_STEP_OK && *accepted &&
        host->max_step_fraction(host->ctx, t, self->fixed.saved_state, t + h, x) < 1) {
        *accepted = false;
        self->fixed.refused_by_contact = true;
    }
    return status;
}

/* try_step of fixed_step.h: *cut for any refusal. */
static enum cs_step attempt(struct fixed_step *loop, double t, double h, double *x, double *v,
                            bool *cut) {
    struct step_halving *self = (struct step_halving *)loop;
    bool accepted = false;
    loop->refused_by_contact = false;
    const enum cs_step status = take_step(self, t, h, x, v, &accepted);
    *cut = status == CS_STEP_OK && !accepted;
    self->last_h = accepted ? h : self->last_h;
    return status;
}

struct step_halving *step_halving_create(const struct cs_host *host, size_t bytes, double dt,
                                         step_halving_callback *step) {
    struct step_halving *self = host->alloc(host->ctx, bytes);
    if (!self)
        return NULL;
    self->fixed = fixed_step_of(host, dt, NULL);
    self->fixed.history_void = true;
    self->fixed.error.is_second_order = true;
    self->fixed.try_step = attempt;
    self->fixed.report_failure = fail_at_shortest_part;
    self->step = step;
    if (fixed_step_guard(&self->fixed, NULL) != CS_STEP_OK)
        return NULL;
    self->fixed.free_motion = 1;
    self->fixed.max_depth = STEP_HALVINGS_MAX;
    return self;
}

struct newton_method *newton_method_create(const struct cs_host *host, size_t bytes, double dt,
                                           double rtol, int64_t iterations,
                                           step_halving_callback *step) {
    struct newton_method *self =
        (struct newton_method *)step_halving_create(host, bytes, dt, step);
    if (!self || newton_init(&self->newton, host, rtol, iterations) != CS_STEP_OK)
        return NULL;
    self->base.newton = &self->newton;
    return self;
}

enum cs_step step_halving_alloc(const struct cs_host *host, double **const arrays[], size_t n) {
    for (size_t k = 0; k < n; k++)
        if (!(*arrays[k] = host->alloc(host->ctx, 3 * sizeof(double) * host->view->n)))
            return CS_STEP_FAIL;
    return CS_STEP_OK;
}

void step_halving_stats(const void *object, struct cs_stats *out) {
    const struct step_halving *self = object;
    fixed_step_stats(object, out);
    out->newton = self->newton ? self->newton->converged : 0;
}

enum cs_step step_halving_archive(void *object, const struct cs_archive *archive) {
    struct step_halving *self = object;
    archive->reals(archive->ctx, &self->last_h, 1);
    if (self->newton)
        archive->integers(archive->ctx, &self->newton->converged, 1);
    return fixed_step_archive(self, archive);
}

bool step_halving_is_fresh(const struct step_halving *self, double h) {
    // the lengths of frames of 1/60 s differ by rounding
    return self->fixed.history_void || fabs(h - self->last_h) > 1e-9 * h;
}

/* Squared distance in m2 of two particles. */
static double square_between(const double *x, size_t n, size_t a, size_t b) {
    double squared = 0;
    for (size_t c = 0; c < 3 * n; c += n)
        squared += (x[c + b] - x[c + a]) * (x[c + b] - x[c + a]);
    return squared;
}

bool springs_rotated_far(const struct cs_view *view, const double *x0, const double *x1) {
    const size_t n = view->n;
    for (size_t s = 0; s < view->n_springs; s++) {
        const size_t a = view->ends[2 * s], b = view->ends[2 * s + 1];
        double squared = 0;
        for (size_t c = 0; c < 3 * n; c += n) {
            const double d = (x1[c + b] - x1[c + a]) - (x0[c + b] - x0[c + a]);
            squared += d * d;
        }
        // !(<=) instead of >: true for NaN too
        if (!(squared <= 0.25 * view->length[s] * view->length[s]) &&
            !(squared <= 0.25 * square_between(x0, n, a, b)))
            return true;
    }
    return false;
}
