/* The parts of a step on one constant matrix, and the calls around it. */
#include "local_global.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The forces that neither the springs nor the matrix contain. */
#define EXPLICIT_PARTS (CS_PART_OUTER & ~CS_PART_DRAG)

/* d = x_b - x_a of the ends of a spring. */
static void difference(size_t n, const uint32_t ends[2], const double *x, double d[3]) {
    for (size_t c = 0; c < 3; c++)
        d[c] = x[c * n + ends[1]] - x[c * n + ends[0]];
}

/* The pull of spring s on its second end, in kg m: h^2 k (L n - e_z), and of its damper - h c
 * (e_z - e_old). An axial damper gets h c (I - n n^T)(e - e_old) back. The first end gets the
 * opposite. */
static void spring_impulse(const struct local_global *self, size_t s, const double *x,
                           const double *z, double pull[3]) {
    const struct cs_view *view = self->loop.host->view;
    const size_t n = view->n;
    const uint32_t *ends = view->ends + 2 * s;
    const double h = self->matrix.h, hc = h * view->damping[s];
    const double h2k = h * h * view->stiffness[s];
    double e[3], e_z[3], e_old[3], squared = DBL_MIN, along = 0;
    difference(n, ends, x, e);
    difference(n, ends, z, e_z);
    difference(n, ends, self->old, e_old);
    for (int c = 0; c < 3; c++)
        squared += e[c] * e[c];
    // two particles in one place have no direction: n is 0
    const double inverse = 1 / sqrt(squared);
    for (int c = 0; c < 3; c++)
        along += e[c] * inverse * (e[c] - e_old[c]);
    for (int c = 0; c < 3; c++) {
        const double unit = e[c] * inverse;
        pull[c] = h2k * (view->length[s] * unit - e_z[c]) - hc * (e_z[c] - e_old[c]);
        if (view->axial[s])
            pull[c] += hc * (e[c] - e_old[c] - along * unit);
    }
}

void local_global_pull(struct local_global *self, const double *x, const double *z) {
    const struct cs_view *view = self->loop.host->view;
    const size_t n = view->n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++)
            self->b[k] = -self->matrix.h * self->matrix.drag[i] * (z[k] - self->old[k]);
    for (size_t s = 0; s < view->n_springs; s++) {
        double pull[3];
        spring_impulse(self, s, x, z, pull);
        for (size_t c = 0; c < 3; c++) {
            self->b[c * n + view->ends[2 * s]] -= pull[c];
            self->b[c * n + view->ends[2 * s + 1]] += pull[c];
        }
    }
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (view->inv_mass[i] <= 0)
                self->b[c * n + i] = 0;
}

enum cs_step local_global_begin(struct local_global *self, double t, double step_length,
                                double *x, double *v) {
    const struct cs_host *host = self->loop.host;
    const size_t n = host->view->n;
    // implicit in time: what ramps change, springs too, is as at the end of the step
    host->force(host->ctx, t + step_length, x, v, EXPLICIT_PARTS, self->f);
    const enum cs_step status = constant_matrix_prepare(&self->matrix, t, step_length);
    const double h = self->matrix.h;
    memcpy(self->old, x, 3 * n * sizeof *x);
    for (size_t c = 0; c < 3 && status == CS_STEP_OK; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++) {
            v[k] += h * self->f[k] * host->view->inv_mass[i];
            self->y[k] = x[k] += h * v[k];
        }
    return status;
}

const char *const local_global_fails[] = {"allocation", NULL};

enum cs_step local_global_restart(void *object, double t, const double *x, const double *v) {
    constant_matrix_restart(&((struct local_global *)object)->matrix);
    return fixed_step_restart(object, t, x, v);
}

enum cs_step local_global_advance(void *object, double t0, double t1, double *x, double *v) {
    struct local_global *self = object;
    constant_matrix_read_drag(&self->matrix, t0, t1, x, self->b, self->f);
    return fixed_step_advance(object, t0, t1, x, v);
}

enum cs_step local_global_init(struct local_global *self, const struct cs_host *host,
                               const struct local_global_options *asked,
                               fixed_step_callback *callback) {
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    self->loop = fixed_step_of(host, asked->dt, callback);
    self->iterations = asked->iterations;
    if (!(self->f = host->alloc(host->ctx, bytes)) ||
        !(self->old = host->alloc(host->ctx, bytes)) ||
        !(self->y = host->alloc(host->ctx, bytes)) ||
        !(self->b = host->alloc(host->ctx, bytes / 3 * 4)))
        return CS_STEP_FAIL;
    if (constant_matrix_init(&self->matrix, host) != CS_STEP_OK)
        return CS_STEP_FAIL;
    return fixed_step_guard(&self->loop, NULL);
}

void local_global_destroy(void *object) {
    constant_matrix_finish(&((struct local_global *)object)->matrix);
}

enum cs_step local_global_save(void *object, const struct cs_archive *archive) {
    struct local_global *self = object;
    constant_matrix_archive(&self->matrix, archive);
    archive->integers(archive->ctx, &self->passes, 1);
    archive->integers(archive->ctx, &self->pulls, 1);
    return fixed_step_archive(self, archive);
}

enum cs_step local_global_load(void *object, const struct cs_archive *archive) {
    struct local_global *self = object;
    const enum cs_step status = constant_matrix_load(&self->matrix, archive);
    archive->integers(archive->ctx, &self->passes, 1);
    archive->integers(archive->ctx, &self->pulls, 1);
    return status == CS_STEP_OK ? fixed_step_archive(self, archive) : status;
}
