/* faulty.c - right methods, and the same with one fault: BASE and FAULT say which. mutants.py
 * has the table; without FAULT the card must pass. */
#include <clothsim/integrator.h>

#include <math.h>
#include <string.h>

/* The method: midpoint and Heun (Runge 1895), velocity-verlet with the force of the last step,
 * Adams and Bashforth of two steps that begins with Heun. */
enum base { MIDPOINT, HEUN, VERLET, ADAMS };

/* The fault; SIZE is its relative size or its bound, PART the parts of the force it is in. */
enum fault {
    NONE,
    STAGE_TIME,     /* the second stage is earlier by SIZE of a step */
    STALE_MASS,     /* masses of create */
    OTHER_MASS,     /* the last particle has the mass of the first */
    FROM_INDEX,     /* forces of particles from SIZE on are those of the first stage */
    LAST_PARTICLE,  /* the last particle gets no force */
    EVERY_64TH,     /* forces of every 64th particle are off by SIZE */
    CLAMP_SPEED,    /* m/s */
    CLAMP_BACK,     /* m/s, of negative velocities alone */
    CLAMP_FORCE,    /* N */
    FLOAT_PLACE,    /* of the stage */
    FLOAT_FORCE,    /* of the stage */
    FLOAT_SPEED,    /* of the result */
    PART_WEAK,      /* by SIZE */
    PART_LAGS,      /* SIZE of it is that of the first stage */
    HELD_STAY,      /* moved pins stay behind in the stage */
    FIRST_WEIGHT,   /* of the result, by SIZE */
    SECOND_WEIGHT,  /* of the result, by SIZE */
    STAGE_STEP,     /* by SIZE */
    DRIFT,          /* of the position, by SIZE */
    NO_RESTART,     /* history goes on after the state was changed by a commit */
    NO_RESTART_SET, /* after it was set from outside */
    SAVES_LESS,     /* the history is not in a checkpoint */
    SUM_ORDER,      /* an error that depends on the particles before */
    Z_ONLY          /* SIZE of the force along z alone */
};

#ifndef FAULT
#define FAULT NONE
#define SIZE  0.
#endif
#ifndef PART
#define PART CS_PART_ALL
#endif

struct options {
    double dt;
};
static const struct cs_option rows[] = {
    CS_OPTION(struct options, dt, "s", 5e-4, 1e-9, 1, "step"),
};

struct method {
    const struct cs_host *host;
    double dt;
    double *f, *g, *part, *stage; /* (3,n), (3,n), (3,n), (6,n) */
    double *later;                /* (3,n) the part at the second stage */
    double *mass;                 /* (n) inverse masses of create */
    double *last;                 /* (3,n) force, (3,n) velocity of the last step */
    double last_h;                /* s; 0: there is none */
};

static double inverse_mass(const struct method *self, uint32_t k) {
    const struct cs_view *view = self->host->view;
    const uint32_t i = k % view->n;
    if (FAULT == STALE_MASS)
        return self->mass[i];
    const bool other = FAULT == OTHER_MASS && i + 1 == view->n && view->inv_mass[i] > 0;
    return other && view->inv_mass[0] > 0 ? view->inv_mass[0] : view->inv_mass[i];
}

/* Force at a state, with what is wrong in it at the second stage. */
static void force(struct method *self, double t, const double *x, const double *v, double *f,
                  bool second) {
    const struct cs_host *host = self->host;
    const uint32_t n = host->view->n;
    host->force(host->ctx, t, x, v, CS_PART_ALL, f);
    if (FAULT == PART_WEAK) {
        host->force(host->ctx, t, x, v, PART, self->part);
        for (uint32_t k = 0; k < 3 * n; k++)
            f[k] -= SIZE * self->part[k];
    }
    for (uint32_t k = 0; k < 3 * n; k++) {
        if (FAULT == CLAMP_FORCE)
            f[k] = fmax(fmin(f[k], SIZE), -SIZE);
        if (FAULT == EVERY_64TH && k % n % 64 == 63)
            f[k] *= 1 + SIZE;
        if (FAULT == LAST_PARTICLE && k % n == n - 1)
            f[k] = 0;
        if (FAULT == Z_ONLY && k >= 2 * n)
            f[k] *= 1 + SIZE;
        if (FAULT == SUM_ORDER && k % n > 0)
            f[k] += SIZE * f[k - 1];
        if (FAULT == FLOAT_FORCE && second)
            f[k] = (double)(float)f[k];
    }
}

/* The second stage's force in g: at x + a v, v + a f/m and the time t + a. */
static void second_stage(struct method *self, double t, double a, const double *x,
                         const double *v) {
    const struct cs_host *host = self->host;
    const uint32_t n = host->view->n;
    double *xs = self->stage, *vs = xs + 3 * n;
    const double step = FAULT == STAGE_STEP ? a * (1 + SIZE) : a;
    if (FAULT == PART_LAGS)
        host->force(host->ctx, t, x, v, PART, self->part);
    for (uint32_t k = 0; k < 3 * n; k++) {
        xs[k] = x[k] + step * v[k];
        vs[k] = v[k] + step * self->f[k] * inverse_mass(self, k);
        if (FAULT == HELD_STAY && inverse_mass(self, k) == 0)
            xs[k] = x[k];
        if (FAULT == FLOAT_PLACE)
            xs[k] = (double)(float)xs[k];
    }
    force(self, FAULT == STAGE_TIME ? t + a - SIZE * a : t + a, xs, vs, self->g, true);
    for (uint32_t k = 0; k < 3 * n && FAULT == FROM_INDEX; k++)
        if (k % n >= (uint32_t)SIZE)
            self->g[k] = self->f[k];
    if (FAULT == PART_LAGS) {
        host->force(host->ctx, t + a, xs, vs, PART, self->later);
        for (uint32_t k = 0; k < 3 * n; k++)
            self->g[k] -= SIZE * (self->later[k] - self->part[k]);
    }
}

/* x += h (p v + q vs), v += h (p f + q g) / m */
static void finish(struct method *self, double h, double p, double q, double *x, double *v) {
    const uint32_t n3 = 3 * self->host->view->n;
    const double *vs = self->stage + n3;
    p *= FAULT == FIRST_WEIGHT ? 1 + SIZE : 1;
    q *= FAULT == SECOND_WEIGHT ? 1 + SIZE : 1;
    const double drift = FAULT == DRIFT ? h * (1 + SIZE) : h;
    for (uint32_t k = 0; k < n3; k++) {
        const double held = inverse_mass(self, k) > 0 ? drift : h;
        x[k] += inverse_mass(self, k) > 0 ? held * (p * v[k] + q * vs[k]) : h * v[k];
        v[k] += h * (p * self->f[k] + q * self->g[k]) * inverse_mass(self, k);
        if (FAULT == CLAMP_SPEED)
            v[k] = fmax(fmin(v[k], SIZE), -SIZE);
        if (FAULT == CLAMP_BACK)
            v[k] = fmax(v[k], -SIZE);
        if (FAULT == FLOAT_SPEED)
            v[k] = (double)(float)v[k];
    }
}

/* Steps of two evaluations, and the first one of ADAMS. */
static void runge_kutta(struct method *self, double t, double h, double *x, double *v) {
    force(self, t, x, v, self->f, false);
    second_stage(self, t, BASE == MIDPOINT ? h / 2 : h, x, v);
    finish(self, h, BASE == MIDPOINT ? 0 : 0.5, BASE == MIDPOINT ? 1 : 0.5, x, v);
}

/* y' = y + h ((1 + r/2) F - r/2 F_last), r = h / h_last (Bashforth, Adams 1883) */
static void adams(struct method *self, double t, double h, double *x, double *v) {
    const uint32_t n3 = 3 * self->host->view->n;
    double now[2] = {1, 0};
    if (self->last_h > 0) {
        const double r = h / self->last_h;
        now[1] = -r / 2;
        now[0] = 1 + r / 2;
        force(self, t, x, v, self->f, true);
        memcpy(self->g, self->last, n3 * sizeof *x);
        memcpy(self->stage + n3, self->last + n3, n3 * sizeof *x);
    }
    if (self->last_h <= 0)
        force(self, t, x, v, self->f, false);
    memcpy(self->last, self->f, n3 * sizeof *x);
    memcpy(self->last + n3, v, n3 * sizeof *x);
    if (self->last_h > 0)
        finish(self, h, now[0], now[1], x, v);
    else
        runge_kutta(self, t, h, x, v);
    self->last_h = h;
}

/* Kick, drift, kick; damping sees v + h a. The force of the end is that of the next start. */
static void verlet(struct method *self, double t, double h, double *x, double *v) {
    const uint32_t n3 = 3 * self->host->view->n;
    double *vs = self->stage + n3;
    if (self->last_h <= 0)
        force(self, t, x, v, self->last, false);
    memcpy(self->f, self->last, n3 * sizeof *x);
    second_stage(self, t, h, x, v);
    for (uint32_t k = 0; k < n3; k++) {
        self->stage[k] = x[k] + h * (v[k] + h / 2 * self->f[k] * inverse_mass(self, k));
        if (FAULT == HELD_STAY && inverse_mass(self, k) == 0)
            self->stage[k] = x[k];
    }
    force(self, FAULT == STAGE_TIME ? t + h - SIZE * h : t + h, self->stage, vs, self->g, true);
    finish(self, h, 0.5, 0.5, x, v);
    memcpy(self->last, self->g, n3 * sizeof *x);
    self->last_h = h;
}

/* Equal steps, not longer than dt. It never asks max_step_fraction, which is right. */
static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct method *self = (struct method *)object;
    const double n = ceil((t1 - t0) / self->dt * (1 - 1e-9)), h = (t1 - t0) / n;
    enum cs_step status = CS_STEP_OK;
    for (double i = 0; i < n && status == CS_STEP_OK; i++) {
        const double t = t0 + i * h;
        bool changed = false;
        if (BASE == VERLET)
            verlet(self, t, h, x, v);
        else if (BASE == ADAMS)
            adams(self, t, h, x, v);
        else
            runge_kutta(self, t, h, x, v);
        status = self->host->commit(self->host->ctx, i + 1 < n ? t + h : t1, h, x, v, &changed);
        if (changed && FAULT != NO_RESTART)
            self->last_h = 0;
    }
    return status;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    struct method *self = (struct method *)host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->host = host;
    self->dt = ((const struct options *)options)->dt;
    self->f = (double *)host->alloc(host->ctx, 8 * bytes);
    self->mass = (double *)host->alloc(host->ctx, bytes);
    if (!self->f || !self->mass)
        return CS_STEP_FAIL;
    self->g = self->f + bytes / sizeof(double);
    self->part = self->g + bytes / sizeof(double);
    self->stage = self->part + bytes / sizeof(double);
    self->last = self->stage + 2 * bytes / sizeof(double);
    self->later = self->last + 2 * bytes / sizeof(double);
    memcpy(self->mass, host->view->inv_mass, bytes / 3);
    return CS_STEP_OK;
}

static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    (void)t, (void)x, (void)v;
    if (FAULT != NO_RESTART_SET)
        ((struct method *)object)->last_h = 0;
    return CS_STEP_OK;
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct method *self = (struct method *)object;
    if (FAULT != SAVES_LESS) {
        archive->reals(archive->ctx, &self->last_h, 1);
        archive->reals(archive->ctx, self->last, 6 * (size_t)self->host->view->n);
    }
    return CS_STEP_OK;
}

static const struct cs_integrator method = {
    .size = sizeof method,
    .name = "faulty",
    .summary = "a method of order 2, with a fault or without",
    .source = "tests",
    .order = 2,
    .order_damped = 2,
    .traits = BASE == VERLET  ? CS_SYMPLECTIC
              : BASE == ADAMS ? CS_MULTISTEP
                              : 0,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = 1,
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
