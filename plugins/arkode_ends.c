/* Keeps the ends of steps and their slopes, see arkode_ends.h. */
#include "arkode_ends.h"

#include <string.h>

static size_t bytes_of(const struct arkode_ends *self) {
    return 6 * sizeof(double) * (size_t)self->host->view->n;
}

enum cs_step arkode_ends_init(struct arkode_ends *self, const struct cs_host *host, int n_max,
                              const uint32_t parts[ARKODE_PARTS]) {
    self->host = host;
    memcpy(self->parts, parts, sizeof self->parts);
    self->n_max = n_max;
    for (int k = 0; k < n_max; k++) {
        struct arkode_end *end = self->end + k;
        if (!(end->y = host->alloc(host->ctx, bytes_of(self))))
            return CS_STEP_FAIL;
        double **const arrays[] = {end->a, end->a + 1, &end->whole};
        for (int part = 0; part <= ARKODE_PARTS; part++)
            if ((part == 0 || parts[1]) &&
                !(*arrays[part] = host->alloc(host->ctx, bytes_of(self) / 2)))
                return CS_STEP_FAIL;
    }
    return CS_STEP_OK;
}

void arkode_ends_restart(struct arkode_ends *self, double t, const double *y) {
    self->n = 0;
    arkode_ends_add(self, t, y);
}

void arkode_ends_add(struct arkode_ends *self, double t, const double *y) {
    const struct arkode_end oldest = self->end[self->n_max - 1];
    memmove(self->end + 1, self->end, (size_t)(self->n_max - 1) * sizeof *self->end);
    self->end[0] = oldest;
    self->end[0].t = t;
    memcpy(self->end[0].y, y, bytes_of(self));
    memset(self->end[0].known, 0, sizeof self->end[0].known);
    self->n += self->n < self->n_max;
}

struct arkode_end *arkode_ends_find(struct arkode_ends *self, double t, const double *y) {
    struct arkode_end *end = self->end;
    return self->n > 0 && end->t == t && memcmp(end->y, y, bytes_of(self)) == 0 ? end : NULL;
}

/* Evaluates a part of the acceleration at an end. */
static void evaluate(const struct arkode_ends *self, struct arkode_end *end, int part) {
    const struct cs_host *host = self->host;
    const size_t n = host->view->n;
    double *a = end->a[part];
    host->force(host->ctx, end->t, end->y, end->y + 3 * n, self->parts[part], a);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            a[c * n + i] *= host->view->inv_mass[i];
    end->known[part] = true;
}

void arkode_ends_state(struct arkode_ends *self, double t, double *z) {
    const size_t n3 = 3 * (size_t)self->host->view->n;
    struct hermite_end ends[HERMITE_ENDS];
    for (int k = 0; k < self->n; k++) {
        struct arkode_end *end = self->end + k;
        for (int part = 0; part < ARKODE_PARTS; part++)
            if (self->parts[part] && !end->known[part])
                evaluate(self, end, part);
        if (self->parts[1])
            self->host->vector->linear_sum(n3, 1, end->a[0], 1, end->a[1], end->whole);
        ends[k] = (struct hermite_end){end->t, end->y, self->parts[1] ? end->whole : end->a[0]};
    }
    hermite_state(self->host, self->n, ends, t, z);
}
