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

static void rate(struct method *self, double t, const double *y, uint32_t parts, double *k) {
    const struct cs_host *host = self->host;
    const size_t half = self->length / 2, n = host->view->n;
    host->force(host->ctx, t, y, y + half, parts, k + half);
    for (size_t i = 0; i < half; i++) {
        k[i] = y[half + i];
        k[half + i] *= host->view->inv_mass[i % n];
    }
}

/* out = y + a k */
static void add(const struct method *self, const double *y, double a, const double *k,
                double *out) {
    for (size_t i = 0; i < self->length; i++)
        out[i] = y[i] + a * k[i];
}

static void classical(struct method *self, double t, double h, double *y, double *first) {
    static const double reach[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};
    double *k = self->k[3], *sum = self->k[4];
    for (int i = 0; i < 4; i++) {
        add(self, y, i ? reach[i] * h : 0, i ? k : y, self->z);
        rate(self, t + reach[i] * h, self->z, CS_PART_ALL, k);
        if (i == 0)
            memcpy(first, k, self->length * sizeof *k);
        for (size_t j = 0; j < self->length; j++)
            sum[j] = (i ? sum[j] : 0) + weight[i] * k[j];
    }
    add(self, y, h / 6, sum, y);
}

static void extrapolate_euler(struct method *self, double t, double h, double *y) {
    for (int m = 0; m < 4; m++) {
        double *end = self->k[m];
        memcpy(end, y, self->length * sizeof *end);
        for (int j = 0; j <= m; j++) {
            const double part = h / (m + 1);
            rate(self, t + j * part, end, CS_PART_ALL, self->z);
            add(self, end, part, self->z, end);
        }
    }
    for (int column = 1; column < 4; column++)
        for (int m = 3; m >= column; m--)
            for (size_t i = 0; i < self->length; i++)
                self->k[m][i] += (self->k[m][i] - self->k[m - 1][i]) /
                                 ((m + 1) / (double)(m + 1 - column) - 1);
    memcpy(y, self->k[3], self->length * sizeof *y);
}

static void gragg(struct method *self, double t, double h, double *y) {
    for (int m = 0; m < 2; m++) {
        const int parts = 2 * (m + 1);
        const double part = h / parts;
        double *old = self->k[2], *now = self->k[3];
        memcpy(old, y, self->length * sizeof *y);
        rate(self, t, y, CS_PART_ALL, self->z);
        add(self, y, part, self->z, now);
        for (int j = 1; j <= parts; j++) {
            rate(self, t + j * part, now, CS_PART_ALL, self->z);
            if (j < parts) {
                add(self, old, 2 * part, self->z, old);
                double *const swap = old;
                old = now;
                now = swap;
            }
        }
        for (size_t i = 0; i < self->length; i++)
            self->k[m][i] = (now[i] + old[i] + part * self->z[i]) / 2;
    }
    for (size_t i = 0; i < self->length; i++)
        y[i] = self->k[1][i] + (self->k[1][i] - self->k[0][i]) / 3;
}

/* k has the slopes of earlier steps, the newest first; k[3] and k[4] serve the first steps. */
static void adams(struct method *self, double t, double h, double *y) {
    static const double ahead[2][4] = {{23, -16, 5, 0}, {55, -59, 37, -9}},
                        behind[4] = {9, 19, -5, 1};
    const uint64_t back = KIND == ADAMS3 ? 2 : 3;
    const double *w = ahead[KIND != ADAMS3], all = KIND == ADAMS3 ? 12 : 24;
    if (fabs(h - self->last_h) > 1e-9 * h)
        self->known = 0;
    self->last_h = h;
    double *now = self->before; /* the advance's own copy is not needed here */
    if (self->known < back)
        classical(self, t, h, y, now);
    else {
        rate(self, t, y, CS_PART_ALL, now);
        for (size_t i = 0; i < self->length; i++) {
            double sum = w[0] * now[i];
            for (uint64_t j = 1; j <= back; j++)
                sum += w[j] * self->k[j - 1][i];
            self->z[i] = y[i] + h / all * sum;
        }
        if (KIND == PECE) {
            rate(self, t + h, self->z, CS_PART_ALL, self->k[3]);
            for (size_t i = 0; i < self->length; i++)
                self->z[i] = y[i] + h / 24 *
                                        (behind[0] * self->k[3][i] + behind[1] * now[i] +
                                         behind[2] * self->k[0][i] + behind[3] * self->k[1][i]);
        }
        memcpy(y, self->z, self->length * sizeof *y);
    }
    double *const oldest = self->k[2];
    self->k[2] = self->k[1];
    self->k[1] = self->k[0];
    self->k[0] = now;
    self->before = oldest;
    self->known += self->known < back;
}

/* v *= exp(-c h / m), c from the drag of a unit velocity. */
static void decay(struct method *self, double t, double h, double *y) {
    const struct cs_host *host = self->host;
    const size_t half = self->length / 2, n = host->view->n;
    for (size_t i = 0; i < half; i++)
        self->z[i] = 1;
    host->force(host->ctx, t, y, self->z, CS_PART_DRAG, self->k[0]);
    for (size_t i = 0; i < half; i++)
        if (host->view->inv_mass[i % n] > 0)
            y[half + i] *= exp(self->k[0][i] * h * host->view->inv_mass[i % n]);
}

static void exponential_drag(struct method *self, double t, double h, double *y) {
    const uint32_t parts = CS_PART_ALL & ~(uint32_t)CS_PART_DRAG;
    decay(self, t, h / 2, y);
    rate(self, t, y, parts, self->k[0]);
    add(self, y, h / 2, self->k[0], self->z);
    rate(self, t + h / 2, self->z, parts, self->k[0]);
    add(self, y, h, self->k[0], y);
    decay(self, t + h, h / 2, y);
}

/* Drifts of d h and kicks of c h in turn; time goes with the drifts. */
static void drifts_and_kicks(struct method *self, double t, double h, double *y, int n,
                             const double *d, const double *c) {
    const size_t half = self->length / 2;
    for (int j = 0; j < n; j++) {
        for (size_t i = 0; i < half; i++)
            y[i] += d[j] * h * y[half + i];
        t += d[j] * h;
        if (c[j] == 0)
            continue;
        rate(self, t, y, CS_PART_ALL, self->k[0]);
        for (size_t i = half; i < self->length; i++)
            y[i] += c[j] * h * self->k[0][i];
    }
}

static void forest_ruth(struct method *self, double t, double h, double *y) {
    const double theta = 1 / (2 - cbrt(2));
    drifts_and_kicks(self, t, h, y, 4,
                     (const double[]){theta / 2, (1 - theta) / 2, (1 - theta) / 2, theta / 2},
                     (const double[]){theta, 1 - 2 * theta, theta, 0});
}

static enum cs_step trapezoid(struct method *self, double t, double h, double *y) {
    double change = 1;
    rate(self, t, y, CS_PART_ALL, self->k[0]);
    add(self, y, h, self->k[0], self->z);
    for (int j = 0; j < ITERATIONS && change > 1e-15; j++) {
        double largest = 0;
        change = 0;
        rate(self, t + h, self->z, CS_PART_ALL, self->k[1]);
        for (size_t i = 0; i < self->length; i++) {
            const double z = y[i] + h / 2 * (self->k[0][i] + self->k[1][i]);
            change = fmax(change, fabs(z - self->z[i]));
            largest = fmax(largest, fabs(z));
            self->z[i] = z;
        }
        change = largest > 0 ? change / largest : 0;
    }
    if (!(change <= 1e-13))
        return self->host->fail(self->host->ctx, "the iteration does not converge at %g s", h);
    memcpy(y, self->z, self->length * sizeof *y);
    return CS_STEP_OK;
}

static void low_storage(struct method *self, double t, double h, double *y) {
    static const double a[] = {0, -5. / 9, -153. / 128}, b[] = {1. / 3, 15. / 16, 8. / 15},
                        c[] = {0, 1. / 3, 3. / 4};
    for (int j = 0; j < 3; j++) {
        rate(self, t + c[j] * h, y, CS_PART_ALL, self->z);
        add(self, self->z, j ? a[j] : 0, j ? self->k[0] : self->z, self->k[0]);
        add(self, y, b[j] * h, self->k[0], y);
    }
}

/* One step of the pair, and its error in units of the tolerance. */
static double pair(struct method *self, double t, double h, double *y) {
    double **k = self->k, sum = 0;
    rate(self, t, y, CS_PART_ALL, k[0]);
    add(self, y, h / 2, k[0], self->z);
    rate(self, t + h / 2, self->z, CS_PART_ALL, k[1]);
    add(self, y, 3 * h / 4, k[1], self->z);
    rate(self, t + 3 * h / 4, self->z, CS_PART_ALL, k[2]);
    for (size_t i = 0; i < self->length; i++)
        y[i] += h / 9 * (2 * k[0][i] + 3 * k[1][i] + 4 * k[2][i]);
    rate(self, t + h, y, CS_PART_ALL, k[3]);
    for (size_t i = 0; i < self->length; i++) {
        const double error =
            h * (-5. / 72 * k[0][i] + k[1][i] / 12 + k[2][i] / 9 - k[3][i] / 8);
        const double allowed = self->asked.rtol * (1e-3 + fabs(y[i]));
        sum += error / allowed * (error / allowed);
    }
    return sqrt(sum / (double)self->length);
}

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
    case TRAPEZOID:
        return trapezoid(self, t, h, y);
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
    LINEAR = KIND == EXPONENTIAL_DRAG || KIND == TRAPEZOID || KIND == DRIFT_KICK,
    ORDER = LINEAR                                                        ? 2
            : KIND == ADAMS3 || KIND == LOW_STORAGE || KIND == CONTROLLED ? 3
                                                                          : 4,
    HAS_HISTORY = KIND == ADAMS3 || KIND == ADAMS4 || KIND == PECE,
    BY_KICKS = KIND == FOREST_RUTH || KIND == DRIFT_KICK
};

static const struct cs_integrator method = {
    .size = sizeof method,
    .name = "right",
    .summary = "a right method of a kind that is not shipped",
    .source = "tests",
    .order = ORDER,
    /* a kick sees the velocity before it */
    .order_damped = BY_KICKS ? 1 : ORDER,
    .traits = BY_KICKS             ? CS_SYMPLECTIC
              : HAS_HISTORY        ? CS_MULTISTEP
              : KIND == CONTROLLED ? CS_ADAPTIVE
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
