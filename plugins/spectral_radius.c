/* spectral_radius.c - bounds of the host, and the power method; see spectral_radius.h. */
#include "spectral_radius.h"

#include <math.h>

enum { STEPS = 25, TURNS = 40 }; /* an estimate is good for; it takes at most */
#define CHANGE 0.03              /* of an estimate in its last turn, at most */
#define ADDED  1.2

bool spectral_radius_init(struct spectral_radius *self, const struct cs_host *host) {
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    self->host = host;
    self->p = host->alloc(host->ctx, bytes);
    self->q = self->p ? host->alloc(host->ctx, bytes) : NULL;
    return self->q;
}

/* The direction has a part of any mode: its numbers follow no pattern. */
void spectral_radius_restart(struct spectral_radius *self) {
    const struct cs_view *view = self->host->view;
    for (uint32_t k = 0; k < 3 * view->n; k++)
        self->p[k] = view->inv_mass[k % view->n] > 0 ? (k * 2654435761u >> 16) - 32768.0 : 0;
    self->rate = 0;
    self->age = 0;
}

/* Turns the direction; returns |q|, p having the length 1 after a first turn. */
static double turn(struct spectral_radius *self, double t, const double *x, const double *v) {
    const struct cs_host *host = self->host;
    const size_t n = host->view->n;
    host->jvp(host->ctx, t, x, v, CS_PART_INTERNAL, NULL, self->p, self->q);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            self->q[c * n + i] *= -host->view->inv_mass[i];
    const double length = sqrt(host->vector->dot(3 * n, self->q, self->q));
    if (length > 0)
        host->vector->linear_sum(3 * n, 1 / length, self->q, 0, self->q, self->p);
    return length;
}

static void estimate(struct spectral_radius *self, double t, const double *x, const double *v) {
    double last, now = turn(self, t, x, v);
    int turns = 1;
    do {
        last = now;
        now = turn(self, t, x, v);
    } while (fabs(now - last) > CHANGE * now && ++turns < TURNS);
    self->age = 0;
    self->rate = ADDED * now;
}

double spectral_radius_at(struct spectral_radius *self, double t, const double *x,
                          const double *v, bool again) {
    const struct cs_host *host = self->host;
    self->omega = host->view->omega;
    self->delta = host->view->delta;
    if (CS_HAS(host, bounds_at) && host->bounds_at)
        host->bounds_at(host->ctx, t, x, v, &self->omega, &self->delta);
    if (!(2 * self->delta > self->omega))
        return self->omega;
    if (!(self->rate > 0) || self->age++ >= STEPS || again)
        estimate(self, t, x, v);
    const double contact = 2 * (self->delta - host->view->delta);
    return fmax(fmin(2 * self->delta, contact + self->rate), self->omega);
}

void spectral_radius_archive(struct spectral_radius *self, const struct cs_archive *archive) {
    archive->reals(archive->ctx, self->p, 3 * (size_t)self->host->view->n);
    archive->reals(archive->ctx, &self->rate, 1);
    archive->integers(archive->ctx, &self->age, 1);
}
