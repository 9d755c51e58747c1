/* chebyshev_step.c - arrays, stages, radius and history; see chebyshev_step.h. */
#include "chebyshev_step.h"
#include "parallel.h"

/* The last evaluation is at the new state. */
static bool accept(struct adaptive_step *base) {
    struct chebyshev_step *self = (struct chebyshev_step *)base;
    double *old = base->slope;
    base->slope = self->a;
    self->a = old;
    return true;
}

enum cs_step chebyshev_step_init(struct chebyshev_step *self, const struct cs_host *host,
                                 const void *options, int power) {
    self->base.accept = accept;
    if (!spectral_radius_init(&self->spectrum, host) ||
        adaptive_step_init(&self->base, host, options, power) != CS_STEP_OK)
        return CS_STEP_FAIL;
    double **const arrays[] = {&self->last, &self->older, &self->a};
    for (int k = 0; k < 3; k++)
        if (!(*arrays[k] = host->alloc(host->ctx, self->base.length * sizeof(double))))
            return CS_STEP_FAIL;
    return CS_STEP_OK;
}

void chebyshev_step_find_radius(struct chebyshev_step *self, double t, const double *y) {
    const struct adaptive_step *base = &self->base;
    self->radius =
        spectral_radius_at(&self->spectrum, t, y, y + base->length / 2, base->control.rejected);
}

void chebyshev_step_evaluate(const struct chebyshev_step *self, double t, double *a) {
    const double *x = self->base.next;
    adaptive_step_evaluate(&self->base, t, x, x + self->base.length / 2, a);
}

/* One row of the state: positions with the velocities as slopes, and velocities. */
struct row {
    size_t count;
    struct chebyshev_stage of;
    const double *x0, *v0, *a0, *a;
    double *x, *v;         /* of the stage */
    double *dx[2], *dv[2]; /* D_(j-1), and D_(j-2), which becomes D_j */
};

CS_CLONES static void stage_row(const struct row *row) {
    const struct chebyshev_stage of = row->of;
    const double *restrict x0 = row->x0, *restrict v0 = row->v0;
    const double *restrict a0 = row->a0, *restrict a = row->a;
    const double *restrict dx = row->dx[0], *restrict dv = row->dv[0];
    double *restrict x = row->x, *restrict v = row->v;
    double *restrict ex = row->dx[1], *restrict ev = row->dv[1];
    for (size_t i = 0; i < row->count; i++) {
        ex[i] = of.last * dx[i] + of.older * ex[i] + of.new *(v0[i] + dv[i]) + of.old *v0[i];
        ev[i] = of.last * dv[i] + of.older * ev[i] + of.new *a[i] + of.old *a0[i];
        x[i] = x0[i] + ex[i];
        v[i] = v0[i] + ev[i];
    }
}

/* The arguments of a stage on the host's threads. */
struct job {
    const struct chebyshev_step *self;
    struct chebyshev_stage of;
    const double *y, *a;
};

static void stage_part(void *arg, size_t begin, size_t end) {
    const struct job *job = arg;
    const struct chebyshev_step *self = job->self;
    const size_t v = self->base.length / 2 + begin;
    stage_row(&(struct row){.count = end - begin,
                            .of = job->of,
                            .x0 = job->y + begin,
                            .v0 = job->y + v,
                            .a0 = self->base.slope + begin,
                            .a = job->a + begin,
                            .x = self->base.next + begin,
                            .v = self->base.next + v,
                            .dx = {self->last + begin, self->older + begin},
                            .dv = {self->last + v, self->older + v}});
}

void chebyshev_step_take(struct chebyshev_step *self, struct chebyshev_stage of,
                         const double *y, const double *a) {
    struct job job = {self, of, y, a};
    parallel_for(self->base.host, self->base.length / 2, stage_part, &job);
    double *swapped = self->last;
    self->last = self->older;
    self->older = swapped;
}

enum cs_step chebyshev_step_restart(void *object, double t, const double *x, const double *v) {
    struct chebyshev_step *self = object;
    spectral_radius_restart(&self->spectrum);
    return adaptive_step_restart(object, t, x, v);
}

enum cs_step chebyshev_step_archive(void *object, const struct cs_archive *archive) {
    struct chebyshev_step *self = object;
    spectral_radius_archive(&self->spectrum, archive);
    return adaptive_step_archive(object, archive);
}
