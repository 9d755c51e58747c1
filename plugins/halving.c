/* halving.c - see halving.h. */
#include "halving.h"

#include <math.h>
#include <string.h>

static enum cs_step give_up(struct fixed_step *loop, double t, double h) {
    const struct halving *self = (const struct halving *)loop;
    const struct cs_host *host = loop->host;
    if (self->passed || (self->newton && self->newton->blocked))
        return host->fail(host->ctx,
                          "a step of %.3g s at t = %.9g s, halved %u times, still passes over "
                          "contact or through a surface",
                          h, t, loop->most_cuts);
    if (self->turned)
        return host->fail(host->ctx,
                          "a step of %.3g s at t = %.9g s, halved %u times, still turns a "
                          "spring by more than half its length",
                          h, t, loop->most_cuts);
    return host->fail(host->ctx,
                      "Newton's iteration fails in a step of %.3g s at t = %.9g s, halved %u "
                      "times: the residual is %.3g of the impulse, asked %.3g",
                      h, t, loop->most_cuts, self->newton->norm / self->newton->impulse,
                      self->newton->rtol);
}

/* The step, refused also where it passes over contact. */
static enum cs_step take_step(struct halving *self, double t, double h, double *x, double *v,
                              bool *accepted) {
    const struct cs_host *host = self->loop.host;
    const size_t bytes = 6 * sizeof *x * host->view->n;
    double *saved = self->loop.saved;
    if (saved)
        memcpy(saved, x, bytes);
    const enum cs_step status = self->step(self, t, h, x, v, accepted);
    if (saved && status == CS_STEP_OK && *accepted &&
        host->max_share(host->ctx, t, saved, t + h, x) < 1) {
        memcpy(x, saved, bytes);
        *accepted = false;
        self->passed = true;
        self->loop.fresh = true; // what the method kept is of the step that was taken back
    }
    return status;
}

static enum cs_step attempt(struct fixed_step *loop, double t, double h, double *x, double *v,
                            bool *cut) {
    struct halving *self = (struct halving *)loop;
    bool accepted = false;
    self->passed = false;
    const enum cs_step status = take_step(self, t, h, x, v, &accepted);
    *cut = status == CS_STEP_OK && !accepted;
    self->before = accepted ? h : self->before;
    return status;
}

struct halving *halving_create(const struct cs_host *host, size_t bytes, double dt,
                               halving_step *step) {
    struct halving *self = host->alloc(host->ctx, bytes);
    if (!self)
        return NULL;
    self->loop = fixed_step_of(host, dt, NULL);
    self->loop.fresh = true;
    self->loop.attempt = attempt;
    self->loop.give_up = give_up;
    self->step = step;
    if (fixed_step_guard(&self->loop, NULL) != CS_STEP_OK)
        return NULL;
    self->loop.most_cuts = self->loop.saved ? HALVINGS_IN_CONTACT : HALVINGS_MAX;
    return self;
}

struct newton_method *newton_method_create(const struct cs_host *host, size_t bytes, double dt,
                                           double rtol, int64_t iterations,
                                           halving_step *step) {
    struct newton_method *self = (struct newton_method *)halving_create(host, bytes, dt, step);
    if (!self || newton_init(&self->newton, host, rtol, iterations) != CS_STEP_OK)
        return NULL;
    self->base.newton = &self->newton;
    return self;
}

enum cs_step halving_take(const struct cs_host *host, double **const arrays[], size_t n) {
    for (size_t k = 0; k < n; k++)
        if (!(*arrays[k] = host->alloc(host->ctx, 3 * sizeof(double) * host->view->n)))
            return CS_STEP_FAIL;
    return CS_STEP_OK;
}

void halving_stats(const void *object, struct cs_stats *out) {
    const struct halving *self = object;
    fixed_step_stats(object, out);
    out->newton = self->newton ? self->newton->done : 0;
}

enum cs_step halving_archive(void *object, const struct cs_archive *archive) {
    struct halving *self = object;
    archive->reals(archive->ctx, &self->before, 1);
    if (self->newton)
        archive->wholes(archive->ctx, &self->newton->done, 1);
    return fixed_step_archive(self, archive);
}

bool halving_is_fresh(const struct halving *self, double h) {
    // frames of 1/60 s differ in their last bits
    return self->loop.fresh || fabs(h - self->before) > 1e-9 * h;
}

/* m2, of two particles */
static double square_between(const double *x, size_t n, size_t a, size_t b) {
    double squared = 0;
    for (size_t c = 0; c < 3 * n; c += n)
        squared += (x[c + b] - x[c + a]) * (x[c + b] - x[c + a]);
    return squared;
}

bool springs_turned(const struct cs_view *view, const double *x0, const double *x1) {
    const size_t n = view->n;
    for (size_t s = 0; s < view->n_springs; s++) {
        const size_t a = view->ends[2 * s], b = view->ends[2 * s + 1];
        double squared = 0;
        for (size_t c = 0; c < 3 * n; c += n) {
            const double d = (x1[c + b] - x1[c + a]) - (x0[c + b] - x0[c + a]);
            squared += d * d;
        }
        // not >, so that it is true of what is not a number
        if (!(squared <= 0.25 * view->length[s] * view->length[s]) &&
            !(squared <= 0.25 * square_between(x0, n, a, b)))
            return true;
    }
    return false;
}
