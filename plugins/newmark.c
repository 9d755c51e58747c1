/* newmark.c - Newmark's family: average acceleration, HHT, generalised-alpha.
 *
 *   M ((1 - am) a' + am a) = f(t + (1 - af) h, (1 - af) x' + af x, (1 - af) v' + af v)
 *   x' = x + h v + h^2 ((1/2 - beta) a + beta a'),   v' = v + h ((1 - gamma) a + gamma a')
 * of order 2 where gamma = 1/2 - am + af. By r = rho_inf, the fraction of their amplitude
 * that the fastest modes keep in a step:
 *   newmark            am = af = 0: beta = 1/4, gamma = 1/2, nothing is damped (Newmark 1959)
 *   hht                am = 0, af = (1 - r)/(1 + r), r >= 1/2 (Hilber, Hughes, Taylor 1977)
 *   generalised-alpha  am = (2 r - 1)/(r + 1), af = r/(r + 1) (Chung, Hulbert 1993)
 * with gamma as above and beta = (1/2 + gamma)^2 / 4. With v' as the unknown,
 *   a' = (v' - v)/(gamma h) - (1 - gamma)/gamma a
 * a is stored from step to step, and computed again as M^-1 f after a change of the state from
 * outside.
 */
#include "newton_methods.h"

#include <math.h>
#include <string.h>

enum { VARIANT_NEWMARK, VARIANT_HHT, VARIANT_ALPHA, VARIANT_OWN };
static const char *const variants[] = {"newmark", "hht", "generalised-alpha", "own", NULL};

struct newmark_options {
    NEWTON_FIELDS;
    int32_t variant;
    double rho_inf, beta, gamma, alpha_m, alpha_f;
};

static const struct cs_option rows[] = {
    NEWTON_ROWS(struct newmark_options),
    CS_OPTION_CHOICE(struct newmark_options, variant, variants, VARIANT_NEWMARK,
                     "parameters: by their names, or own: the four below"),
    CS_OPTION(struct newmark_options, rho_inf, "", 0.8, 0, 1,
              "for hht (at least 0.5) and generalised-alpha: fraction of its amplitude that "
              "the fastest mode keeps per step"),
    CS_OPTION(struct newmark_options, beta, "", 0.25, 1e-3, 1, "with variant=own"),
    CS_OPTION(struct newmark_options, gamma, "", 0.5, 0.1, 2,
              "with variant=own; order 2 needs 1/2 - alpha_m + alpha_f"),
    CS_OPTION(struct newmark_options, alpha_m, "", 0, -1, 0.9, "with variant=own"),
    CS_OPTION(struct newmark_options, alpha_f, "", 0, 0, 0.9, "with variant=own"),
};

enum { OWN = 1u << VARIANT_OWN };
static const struct cs_option_use uses[] = {
    {"rho_inf", "variant", 1u << VARIANT_HHT | 1u << VARIANT_ALPHA},
    {"beta", "variant", OWN},
    {"gamma", "variant", OWN},
    {"alpha_m", "variant", OWN},
    {"alpha_f", "variant", OWN},
};

struct method {
    struct newton_method base;
    double beta, gamma, am, af;
    double *a;            /* (3,n) in m/s2 */
    double *u;            /* (3,n) in m/s: the new velocity */
    double *xb, *ub, *vb; /* (3,n) known part of the stage */
};

static enum cs_step step(struct step_halving *object, double t, double h, double *x, double *v,
                         bool *accepted) {
    struct method *self = (struct method *)object;
    const struct cs_host *host = object->fixed.host;
    const struct cs_view *view = host->view;
    const size_t n = view->n;
    const double beta = self->beta, gamma = self->gamma, am = self->am, af = self->af;
    double *a = self->a, *u = self->u;
    if (object->fixed.history_void) {
        host->force(host->ctx, t, x, v, CS_PART_ALL, a);
        for (size_t c = 0, k = 0; c < 3; c++)
            for (size_t i = 0; i < n; i++, k++)
                a[k] *= view->inv_mass[i];
        object->fixed.history_void = false;
    }

    // x' = x + d + (beta/gamma) h v', and the equation times s = gamma h / (1 - am)
    const double s = gamma * h / (1 - am), old = 1 - gamma - gamma * am / (1 - am);
    for (size_t k = 0; k < 3 * n; k++) {
        const double d = h * (1 - beta / gamma) * v[k] + h * h * (0.5 - beta / gamma) * a[k];
        self->xb[k] = x[k] + (1 - af) * d;
        self->vb[k] = af * v[k];
        self->ub[k] = v[k] + h * old * a[k];
    }
    const struct newton_stage stage = {.t = t + (1 - af) * h,
                                       .s = s,
                                       .gx = (1 - af) * beta / gamma * h,
                                       .gv = 1 - af,
                                       .xb = self->xb,
                                       .ub = self->ub,
                                       .vb = self->vb,
                                       .c = (1 - af) * h,
                                       .x0 = x,
                                       .v0 = v};
    memcpy(u, v, 3 * n * sizeof *u);
    const enum cs_step status = newton_solve(&self->base.newton, &stage, u, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;
    for (size_t k = 0; k < 3 * n; k++) {
        const double next = (u[k] - v[k]) / (gamma * h) - (1 - gamma) / gamma * a[k];
        x[k] += h * v[k] + h * h * ((0.5 - beta) * a[k] + beta * next);
        v[k] = u[k];
        a[k] = next;
    }
    return CS_STEP_OK;
}

static enum cs_step set_parameters(struct method *self, const struct newmark_options *asked) {
    const double r = asked->rho_inf;
    const struct cs_host *host = self->base.base.fixed.host;
    if (asked->variant == VARIANT_HHT && r < 0.5)
        return host->fail(host->ctx, "rho_inf = %g, expected at least 0.5 with variant=hht", r);
    switch (asked->variant) {
    case VARIANT_OWN:
        self->am = asked->alpha_m, self->af = asked->alpha_f;
        self->gamma = asked->gamma, self->beta = asked->beta;
        if (fabs(self->gamma - (0.5 - self->am + self->af)) > 1e-12)
            host->note(host->ctx, "order 1: gamma is %g, order 2 needs %g", self->gamma,
                       0.5 - self->am + self->af);
        return CS_STEP_OK;
    case VARIANT_HHT:
        self->am = 0, self->af = (1 - r) / (1 + r);
        break;
    case VARIANT_ALPHA:
        self->am = (2 * r - 1) / (r + 1), self->af = r / (r + 1);
        break;
    default: // am = af = 0
        break;
    }
    self->gamma = 0.5 - self->am + self->af;
    self->beta = 0.25 * (0.5 + self->gamma) * (0.5 + self->gamma);
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct newmark_options *asked = options;
    struct newton_method *base = newton_method_create(host, sizeof(struct method), asked->dt,
                                                      asked->rtol, asked->iterations, step);
    if (!(*out = base))
        return CS_STEP_FAIL;
    struct method *self = (struct method *)base;
    double **const arrays[] = {&self->a, &self->u, &self->xb, &self->ub, &self->vb};
    if (step_halving_alloc(host, arrays, 5) != CS_STEP_OK)
        return CS_STEP_FAIL;
    return set_parameters(self, asked);
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct method *self = object;
    archive->reals(archive->ctx, self->a, 3 * (size_t)self->base.base.fixed.host->view->n);
    return step_halving_archive(self, archive);
}

const struct cs_integrator newmark = {
    STEP_HALVING_METHOD(struct newmark_options, rows, archive),
    .uses = uses,
    .n_uses = sizeof uses / sizeof *uses,
    .name = "newmark",
    .summary =
        "Newmark's average acceleration, HHT or generalised-alpha, by Newton; makes energy at "
        "long steps where springs are pressed hard",
    .source = "Newmark 1959; Hilber et al. 1977; Chung, Hulbert 1993",
    .order = 2,
    .order_damped = 2,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION,
    .traits = CS_IMPLICIT | CS_MULTISTEP,
    .create = create,
};
