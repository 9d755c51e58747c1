/* damping_rate.c - the power method on the dampers within bodies; see damping_rate.h. */
#include "damping_rate.h"

#include <math.h>

enum { STEPS = 25, TURNS = 40 }; /* an estimate is good for; it takes at most */
#define CHANGE 0.03              /* of an estimate in its last turn, at most */
#define ADDED  1.2

bool damping_rate_init(struct damping_rate *self, const struct cs_host *host) {
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    self->p = host->alloc(host->ctx, bytes);
    self->q = self->p ? host->alloc(host->ctx, bytes) : NULL;
    return self->q;
}

/* The direction has a part of any mode: its numbers follow no pattern. */
void damping_rate_restart(struct damping_rate *self, const struct cs_view *view) {
    for (uint32_t k = 0; k < 3 * view->n; k++)
        self->p[k] = view->inv_mass[k % view->n] > 0 ? (k * 2654435761u >> 16) - 32768.0 : 0;
    self->estimate = 0;
    self->age = 0;
}

/* Turns the direction; returns |q|, p having the length 1 after a first turn. */
static double turn(struct damping_rate *self, const struct cs_host *host, double t,
                   const double *x, const double *v) {
    const struct cs_view *view = host->view;
    const size_t n = view->n;
    host->jvp(host->ctx, t, x, v, CS_PART_INTERNAL, NULL, self->p, self->q);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            self->q[c * n + i] *= -view->inv_mass[i];
    const double length = sqrt(host->vector->dot(3 * n, self->q, self->q));
    if (length > 0)
        host->vector->linear_sum(3 * n, 1 / length, self->q, 0, self->q, self->p);
    return length;
}

double damping_rate_at(struct damping_rate *self, const struct cs_host *host, double t,
                       const double *x, const double *v, bool again) {
    if (self->estimate > 0 && self->age++ < STEPS && !again)
        return self->estimate;
    double last, now = turn(self, host, t, x, v);
    int turns = 1;
    do {
        last = now;
        now = turn(self, host, t, x, v);
    } while (fabs(now - last) > CHANGE * now && ++turns < TURNS);
    self->age = 0;
    self->estimate = ADDED * now;
    return self->estimate;
}

void damping_rate_archive(struct damping_rate *self, const struct cs_host *host,
                          const struct cs_archive *archive) {
    archive->reals(archive->ctx, self->p, 3 * (size_t)host->view->n);
    archive->reals(archive->ctx, &self->estimate, 1);
    archive->integers(archive->ctx, &self->age, 1);
}
