/* right.c - right methods of kinds that are not shipped: KIND says which. The card must pass
 * each.
 *
 * y is (x, v), 6n numbers, and F(t, y) = (v, M^-1 f(t, x, v)). None asks max_step_fraction. */
#include <clothsim/integrator.h>

#include <math.h>
#include <string.h>

enum kind {
    EXTRAPOLATED_EULER, /* Aitken and Neville on 1, 2, 3 and 4 Euler steps */
    GRAGG,              /* modified midpoint steps, extrapolated in h^2 (Gragg 1965) */
    ADAMS3, /* Adams and Bashforth of 3 and 4 steps, begun by the classical method */
    ADAMS4,
    PECE,             /* the same as predictor, Adams and Moulton as corrector */
    TAYLOR,           /* of order 2, by the derivative of the force along the motion */
    DEFERRED,         /* corrections on Lobatto's nodes (Dutt, Greengard, Rokhlin 2000) */
    SSP104,           /* ten stages of order 4, two registers (Ketcheson 2008) */
    SUZUKI,           /* five leapfrog steps, of order 4 (Suzuki 1990) */
    LOBATTO,          /* IIIA of order 4, by fixed-point iteration */
    EXPONENTIAL_DRAG, /* Strang's splitting, drag by its exponential */
    FOREST_RUTH,      /* a composition of order 4 (Forest, Ruth 1990) */
    DRIFT_KICK,       /* half a drift, a kick, half a drift */
    TRAPEZOID,        /* by fixed-point iteration */
    LOW_STORAGE,      /* two registers, order 3 (Williamson 1980) */
    CONTROLLED        /* pair 3(2) with error control (Bogacki, Shampine 1989) */
};

enum { SLOPES = 5, ITERATIONS = 400 };

struct options {
    double dt, rtol;
};
static const struct cs_option rows[] = {
    CS_OPTION(struct options, dt, "s", KIND == CONTROLLED ? 0 : 5e-4,
              KIND == CONTROLLED ? 0 : 1e-9, 1, "step; 0: by the error"),
    CS_OPTION(struct options, rtol, "", 1e-5, 1e-13, 1, "local error, relative to the value"),
};

struct method {
    const struct cs_host *host;
    struct options asked;
    size_t length;      /* 6n */
    double *k[SLOPES];  /* (6n): slopes, or what a method makes of them */
    double *z, *before; /* (6n) */
    double last_h, h;   /* s: the last step, and the next one of CONTROLLED */
    uint64_t known;     /* slopes of earlier steps in k */
};

#include "right_steps.h"

static enum cs_step step(struct method *self, double t, double h, double *y) {
    switch (KIND) {
    case EXTRAPOLATED_EULER:
        extrapolate_euler(self, t, h, y);
        break;
    case GRAGG:
        gragg(self, t, h, y);
        break;
    case EXPONENTIAL_DRAG:
        exponential_drag(self, t, h, y);
        break;
    case FOREST_RUTH:
        forest_ruth(self, t, h, y);
        break;
    case DRIFT_KICK:
        drifts_and_kicks(self, t, h, y, 2, (const double[]){0.5, 0.5}, (const double[]){1, 0});
        break;
    case TAYLOR:
        taylor(self, t, h, y);
        break;
    case DEFERRED:
        deferred(self, t, h, y);
        break;
    case SSP104:
        ssp104(self, t, h, y);
        break;
    case SUZUKI:
        suzuki(self, t, h, y);
        break;
    case LOBATTO:
    case TRAPEZOID:
        return iterate(self, t, h, y);
    case LOW_STORAGE:
        low_storage(self, t, h, y);
        break;
    case CONTROLLED:
        pair(self, t, h, y);
        break;
    default:
        adams(self, t, h, y);
    }
    return CS_STEP_OK;
}

/* Equal steps, not longer than dt. */
static enum cs_step take_equal(struct method *self, double t0, double t1, double *y) {
    const struct cs_host *host = self->host;
    const double n = ceil((t1 - t0) / self->asked.dt * (1 - 1e-9)), h = (t1 - t0) / n;
    enum cs_step status = CS_STEP_OK;
    for (double i = 0; i < n && status == CS_STEP_OK; i++) {
        const double t = t0 + i * h;
        bool changed = false;
        if ((status = step(self, t, h, y)) == CS_STEP_OK)
            status = host->commit(host->ctx, i + 1 < n ? t + h : t1, h, y, y + self->length / 2,
                                  &changed);
        if (changed)
            self->known = 0;
    }
    return status;
}

static enum cs_step take_controlled(struct method *self, double t, double t1, double *y) {
    const struct cs_host *host = self->host;
    enum cs_step status = CS_STEP_OK;
    if (!(self->h > 0))
        self->h = 1e-3 * (t1 - t);
    while (t < t1 && status == CS_STEP_OK) {
        const double parts = ceil((t1 - t) / self->h * (1 - 1e-9)), h = (t1 - t) / parts;
        bool changed;
        memcpy(self->before, y, self->length * sizeof *y);
        const double error = pair(self, t, h, y);
        self->h = h * (isfinite(error) ? fmin(5, fmax(0.2, 0.9 / cbrt(error + 1e-12))) : 0.1);
        if (error <= 1) {
            t = parts > 1 ? t + h : t1;
            status = host->commit(host->ctx, t, h, y, y + self->length / 2, &changed);
        } else if (h < 1e-10)
            return host->fail(host->ctx, "no step is short enough at t = %g s", t);
        else
            memcpy(y, self->before, self->length * sizeof *y);
    }
    return status;
}

static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct method *self = (struct method *)object;
    (void)v; /* follows x */
    return self->asked.dt > 0 ? take_equal(self, t0, t1, x) : take_controlled(self, t0, t1, x);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const size_t length = 6 * (size_t)host->view->n;
    struct method *self = (struct method *)host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->host = host;
    self->asked = *(const struct options *)options;
    self->length = length;
    self->z = (double *)host->alloc(host->ctx, (SLOPES + 2) * length * sizeof(double));
    if (!self->z)
        return CS_STEP_FAIL;
    self->before = self->z + length;
    for (size_t j = 0; j < SLOPES; j++)
        self->k[j] = self->before + (j + 1) * length;
    return CS_STEP_OK;
}

static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    struct method *self = (struct method *)object;
    (void)t, (void)x, (void)v;
    self->known = 0;
    self->last_h = self->h = 0;
    return CS_STEP_OK;
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct method *self = (struct method *)object;
    archive->integers(archive->ctx, &self->known, 1);
    archive->reals(archive->ctx, &self->last_h, 1);
    archive->reals(archive->ctx, &self->h, 1);
    for (int j = 0; j < 3; j++)
        archive->reals(archive->ctx, self->k[j], self->length);
    return CS_STEP_OK;
}

enum {
    SECOND =
        KIND == EXPONENTIAL_DRAG || KIND == TRAPEZOID || KIND == DRIFT_KICK || KIND == TAYLOR,
    ORDER = SECOND                                                        ? 2
            : KIND == ADAMS3 || KIND == LOW_STORAGE || KIND == CONTROLLED ? 3
                                                                          : 4,
    BY_ITERATION = KIND == LOBATTO || KIND == TRAPEZOID,
    HAS_HISTORY = KIND == ADAMS3 || KIND == ADAMS4 || KIND == PECE,
    BY_KICKS = KIND == FOREST_RUTH || KIND == DRIFT_KICK || KIND == SUZUKI
};

static const struct cs_integrator method = {
    .size = sizeof method,
    .name = "right",
    .summary = "a right method of a kind that is not shipped",
    .source = "tests",
    .order = ORDER,
    /* a kick sees the velocity before it */
    .order_damped = BY_KICKS ? 1 : ORDER,
    .needs = KIND == TAYLOR ? CS_NEED_JVP : 0,
    .traits = BY_KICKS             ? CS_SYMPLECTIC
              : HAS_HISTORY        ? CS_MULTISTEP
              : KIND == CONTROLLED ? CS_ADAPTIVE
              : BY_ITERATION       ? CS_IMPLICIT
                                   : 0,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = KIND == CONTROLLED ? 2 : 1,
    .options_size = sizeof(struct options),
    .create = create,
    .restart = restart,
    .advance = advance,
    .save = archive,
    .load = archive,
};

static const struct cs_integrator *const all[] = {&method};
CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI, .size = sizeof method, .n = 1, .integrators = all};
