/* Springs by an augmented Lagrangian: multipliers, penalties, and the springs they come to. */
#include "augmented_springs.h"

#include <math.h>
#include <string.h>

enum cs_step augmented_springs_init(struct augmented_springs *self,
                                    const struct cs_host *host) {
    double **const arrays[] = {&self->multiplier, &self->penalty, &self->stiffness,
                               &self->length};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        if (!(*arrays[k] = host->alloc(host->ctx, sizeof(double) * host->view->n_springs)))
            return CS_STEP_FAIL;
    return CS_STEP_OK;
}

void augmented_springs_restart(struct augmented_springs *self, const struct cs_view *view) {
    memset(self->multiplier, 0, sizeof(double) * view->n_springs);
    memset(self->penalty, 0, sizeof(double) * view->n_springs);
}

/* k' and L' of spring s. */
static void set_spring(struct augmented_springs *self, const struct cs_view *view, double h,
                       size_t s) {
    const double lightness =
        view->inv_mass[view->ends[2 * s]] + view->inv_mass[view->ends[2 * s + 1]];
    // between two held particles any k does, as they do not move
    const double k = self->penalty[s] / (h * h * (lightness > 0 ? lightness : 1));
    self->stiffness[s] = view->stiffness[s] * k / (view->stiffness[s] + k);
    self->length[s] = view->length[s] - self->multiplier[s] / k;
}

void augmented_springs_begin(struct augmented_springs *self, const struct cs_view *view,
                             double h) {
    for (size_t s = 0; s < view->n_springs; s++) {
        self->penalty[s] = fmax(self->gamma * self->penalty[s], self->start);
        set_spring(self, view, h, s);
    }
}

void augmented_springs_update(struct augmented_springs *self, const struct cs_view *view,
                              double h, const double *x) {
    const size_t n = view->n;
    for (size_t s = 0; s < view->n_springs; s++) {
        const double *a = x + view->ends[2 * s], *b = x + view->ends[2 * s + 1];
        const double dx = a[0] - b[0], dy = a[n] - b[n], dz = a[2 * n] - b[2 * n];
        const double r = sqrt(dx * dx + dy * dy + dz * dz), length = view->length[s];
        const double pull = self->stiffness[s] * (r - self->length[s]);
        self->multiplier[s] = pull;
        // |e| / (L + r) = off / scale; a spring of no stiffness has no multiplier
        const double scale = view->stiffness[s] * (length + r);
        const double off = fabs(view->stiffness[s] * (r - length) - pull);
        if (scale > 0)
            self->penalty[s] = fmin(self->penalty[s] + self->beta * off / scale, self->most);
        set_spring(self, view, h, s);
    }
}

void augmented_springs_archive(struct augmented_springs *self, const struct cs_view *view,
                               const struct cs_archive *archive) {
    archive->reals(archive->ctx, self->multiplier, view->n_springs);
    archive->reals(archive->ctx, self->penalty, view->n_springs);
}
