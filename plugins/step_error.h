/* step_error.h - the local error of a fixed-step method, from the velocities that its steps
 * leave, and the lengths of steps that keep it small.
 *
 * A step of h changes the velocity by dv. With accelerations a = dv/h of successive steps, the
 * position after a step is off by about
 *
 *   order 1              e = h |dv| / 2            half of h^2 a, what x + h v has too much
 *   order 2 and higher   e = h^2 |a - a_old| / 6   h^3 |da/dt| / 6 (Hairer, Norsett, Wanner
 *                                                  1993, sec. II.4), too much for most methods
 *
 * as a root of the mean square over the particles. Errors add up: a step is accurate if e/h,
 * the error per second, is at most the tolerance. Both are differences of velocities, which
 * cost no evaluation, and which see of stiff forces only what the method made of them. */
#ifndef STEP_ERROR_H
#define STEP_ERROR_H

#include <clothsim/integrator.h>
#include <math.h>

/* Error per second over the size of the scene. */
#define STEP_ERROR_TOLERANCE 0.005

/* Zeroed: steps are not judged. */
struct step_error {
    double tolerance;      /* m/s; 0: steps are not judged */
    bool is_second_order;  /* or of a higher order */
    double *change;        /* (3,n) dv in m/s of the step that is judged */
    double *last_change;   /* (3,n) of the last accepted step */
    double *difference;    /* (3,n) scratch */
    double last_h;         /* s, length of that step; 0: none since the restart */
    double ratio;          /* error of the step that was judged last over the tolerance */
    double sum;            /* m, errors of accepted steps, added up */
    double free_particles; /* at least 1 */
};

/* Allocates the arrays; [create]. */
static inline enum cs_step step_error_init(struct step_error *self,
                                           const struct cs_host *host) {
    const size_t bytes = 3 * sizeof(double) * host->view->n;
    double **const arrays[] = {&self->change, &self->last_change, &self->difference};
    for (int k = 0; k < 3; k++)
        if (!(*arrays[k] = (double *)host->alloc(host->ctx, bytes)))
            return CS_STEP_FAIL;
    for (size_t i = 0; i < host->view->n; i++)
        self->free_particles += host->view->inv_mass[i] > 0 ? 1 : 0;
    self->free_particles = fmax(self->free_particles, 1);
    self->tolerance = STEP_ERROR_TOLERANCE * host->length_scale;
    return CS_STEP_OK;
}

/* Estimates the error of a step of h from velocity `before` to `after` (3,n); true: it is
 * accurate. The first step has the estimate of order 1 in any case. */
static inline bool step_error_judge(struct step_error *self, const struct cs_host *host,
                                    double h, const double *before, const double *after) {
    const size_t n3 = 3 * (size_t)host->view->n;
    const struct cs_vector_kernels *vector = host->vector;
    const bool differs = self->is_second_order && self->last_h > 0;
    const double *change = self->change;
    vector->linear_sum(n3, 1, after, -1, before, self->change);
    if (differs) {
        vector->linear_sum(n3, 1, change, -h / self->last_h, self->last_change,
                           self->difference);
        change = self->difference;
    }
    const double squared = vector->dot(n3, change, change) / self->free_particles;
    self->ratio = sqrt(squared) / (differs ? 6 : 2) / self->tolerance;
    return self->ratio <= 1;
}

/* Makes the step that was judged the one before the next. */
static inline void step_error_accept(struct step_error *self, double h) {
    double *change = self->change;
    self->change = self->last_change;
    self->last_change = change;
    self->last_h = h;
    self->sum += self->ratio * self->tolerance * h;
}

/* True if a step of twice the length is expected to be accurate: the ratio grows as h for order
 * 1, as h^2 for order 2. */
static inline bool step_error_admits_twice(const struct step_error *self) {
    return !(self->tolerance > 0) || self->ratio * (self->is_second_order ? 4 : 2) <= 0.7;
}

/* save and load of what is left to the next step. */
static inline void step_error_archive(struct step_error *self, const struct cs_host *host,
                                      const struct cs_archive *archive) {
    if (!(self->tolerance > 0))
        return;
    archive->reals(archive->ctx, &self->last_h, 1);
    archive->reals(archive->ctx, &self->ratio, 1);
    archive->reals(archive->ctx, &self->sum, 1);
    archive->reals(archive->ctx, self->last_change, 3 * (size_t)host->view->n);
}

#endif
