/* Two-step backward differentiation, by Newton or by one linear solve.
 *
 * For y = (x, v), y' = F(t, y), and y_ one step of the same length before y:
 *   y' = y + (y - y_)/3 + 2/3 h F(t + h, y')
 * from the start v' = 2 v - v_. solve=linear stops after the first Newton step, whose error is
 * of order h^3 (Choi and Ko 2002 linearise at the old state instead); it has no line search,
 * and a step that turns springs by more than half their length is refused and halved.
 *
 * A step without history - the first, after a refused one, and after every commit that moved
 * the state, in contact thus most - is one of SDIRK2, which has order 2 and is L-stable as
 * well.
 */
#include "newton_methods.h"

#include <string.h>

enum { SOLVE_NEWTON, SOLVE_LINEAR };
static const char *const solves[] = {"newton", "linear", NULL};

struct bdf2_options {
    NEWTON_FIELDS;
    int32_t solve;
};

static const struct cs_option rows[] = {
    NEWTON_ROWS(struct bdf2_options),
    CS_OPTION_CHOICE(struct bdf2_options, solve, solves, SOLVE_NEWTON,
                     "newton: to rtol; linear: one Newton step, whose linear solve has the "
                     "relative residual rtol"),
};

struct method {
    struct newton_method base;
    bool linear;
    struct sdirk2_arrays arrays;
    double *xl, *vl; /* (3,n) one step before */
    double *xn, *vn; /* (3,n) the step's result until it is accepted */
};

static enum cs_step step_on(struct method *self, double t, double h, double *x, double *v,
                            bool *accepted) {
    struct newton *newton = &self->base.newton;
    const size_t n3 = 3 * (size_t)newton->host->view->n;
    double *u = self->arrays.u, *xb = self->arrays.xb, *ub = self->arrays.ub;
    for (size_t k = 0; k < n3; k++) {
        xb[k] = x[k] + (x[k] - self->xl[k]) / 3;
        ub[k] = v[k] + (v[k] - self->vl[k]) / 3;
        u[k] = v[k] + (v[k] - self->vl[k]);
    }
    const double g = 2 * h / 3;
    const struct newton_stage stage = {
        .t = t + h, .s = g, .gx = g, .gv = 1, .xb = xb, .ub = ub, .c = h, .x0 = x, .v0 = v};
    const enum cs_step status = self->linear ? newton_step(newton, &stage, u, accepted)
                                             : newton_solve(newton, &stage, u, accepted);
    memcpy(x, newton->x, n3 * sizeof *x);
    memcpy(v, u, n3 * sizeof *v);
    return status;
}

static enum cs_step step(struct step_halving *object, double t, double h, double *x, double *v,
                         bool *accepted) {
    struct method *self = (struct method *)object;
    const struct cs_view *view = object->fixed.host->view;
    const size_t bytes = 3 * sizeof(double) * view->n;
    /* on copies: a refused step leaves x and v as they were */
    memcpy(self->xn, x, bytes);
    memcpy(self->vn, v, bytes);
    const enum cs_step status = step_halving_is_fresh(object, h)
                                    ? sdirk2_step(&self->base.newton, &self->arrays,
                                                  self->linear ? newton_step : newton_solve, t,
                                                  h, self->xn, self->vn, accepted)
                                    : step_on(self, t, h, self->xn, self->vn, accepted);
    object->refused_by_rotation =
        *accepted && self->linear && springs_rotated_far(view, x, self->xn);
    *accepted &= !object->refused_by_rotation;
    if (status != CS_STEP_OK || !*accepted)
        return status;
    /* the old state is the history of the next step */
    memcpy(self->xl, x, bytes);
    memcpy(self->vl, v, bytes);
    memcpy(x, self->xn, bytes);
    memcpy(v, self->vn, bytes);
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct bdf2_options *asked = options;
    struct newton_method *base = newton_method_create(host, sizeof(struct method), asked->dt,
                                                      asked->rtol, asked->iterations, step);
    if (!(*out = base))
        return CS_STEP_FAIL;
    struct method *self = (struct method *)base;
    self->linear = asked->solve == SOLVE_LINEAR;
    double **const arrays[] = {&self->xl, &self->vl, &self->xn, &self->vn};
    if (step_halving_alloc(host, arrays, 4) != CS_STEP_OK)
        return CS_STEP_FAIL;
    return sdirk2_alloc(host, &self->arrays);
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct method *self = object;
    const size_t n3 = 3 * (size_t)self->base.base.fixed.host->view->n;
    archive->reals(archive->ctx, self->xl, n3);
    archive->reals(archive->ctx, self->vl, n3);
    return step_halving_archive(self, archive);
}

const struct cs_integrator bdf2 = {
    STEP_HALVING_METHOD(struct bdf2_options, rows, archive),
    .name = "bdf2",
    .summary = "two-step backward differentiation, by Newton or by one linear solve per step",
    .source = "Gear 1971; Choi, Ko 2002",
    .order = 2,
    .order_damped = 2,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION | CS_NEED_SPRINGS,
    .traits = CS_IMPLICIT | CS_MULTISTEP,
    .create = create,
};
