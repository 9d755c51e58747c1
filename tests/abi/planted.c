/* planted.c - symplectic Euler with one thing wrong: PLANT says which. Each is a module of its
 * own, for the tests of what clothsim refuses and of what its conformance card finds. */
#include <clothsim/integrator.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

enum plant {
    /* against the contract: refused, or ended with a message */
    WRONG_ABI,
    SMALL_STRUCTS,
    NO_INTEGRATORS,
    NO_ADVANCE,
    DEFAULT_OUTSIDE,
    OPTION_OUTSIDE,
    RENAMES_NOTHING,
    BAD_NAME,
    NO_SYMBOL,
    CRASHES,
    ABORTS,
    FAILS_SILENTLY,
    RETURNS_NAN,
    FLUSHES_AT_LOAD,
    FLUSHES_IN_ADVANCE,
    CRASHES_AT_LOAD,
    EXITS_AT_LOAD,
    CRASHES_IN_RESTART,
    CRASHES_IN_ADVANCE,
    OVERFLOWS_ITS_STACK,
    EXITS_IN_ADVANCE,
    NOT_FINITE_BEHIND_COMMIT,
    /* against its own claims: found by the card */
    NOTHING_WRONG,
    OLDER, /* built before the calls goals, save and load were there */
    WRONG_ORDER,
    LEAKS_MOMENTUM,
    TAKES_MEMORY,
    KEEPS_MEMORY,
    MOVES_PINS,
    COUNTS_RUNS,
    STALE_CLAIM,
    UNKNOWN_CHECK,
    FORGETS_COMMIT,
    IGNORES_FAILURE,
    IGNORES_WIND,
    IGNORES_DRAG,
    DOUBLES_DRAG,
    SINGLE_MASS,
    WRONG_STAGE_TIME, /* Heun's method, whose second stage asks for the forces of the first's */
    TIME_STANDS_STILL,
    READS_CLOCK,      /* the seconds of the calendar, in a bit */
    SUMS_PIECES,      /* a sum by the pieces of parallel_for, of short arrays alone */
    PASSES_THROUGH,   /* never asks max_step_fraction */
    IGNORES_FRACTION, /* asks, and takes the whole step */
    HANGS,            /* where there are two particles */
    FLIPS_A_BIT,      /* the last one of y of particle 7, in its 21st step */
    FORGETS_STEPS     /* saves nothing of what it remembers */
};

static void crash(void) {
    volatile int *volatile nowhere = NULL;
    *nowhere = 1;
}

struct options {
    double dt;
};

struct planted {
    const struct cs_host *host;
    double dt, *f;   /* (3,n) in N */
    double *b, *u;   /* (3,n) of IGNORES_FAILURE, faulty_force and heun */
    double *xs, *vs; /* (3,n) of heun: the second stage */
    double *before;  /* (6,n): the state before a step */
    uint32_t steps;  /* since the restart, of FORGETS_STEPS and READS_CLOCK */
    double second;   /* of READS_CLOCK: by the calendar, at the first step */
};

static const struct cs_option rows[] = {
    {.name = "dt",
     .unit = "s",
     .help = "longest step",
     .type = CS_REAL,
     .count = 1,
     .offset = PLANT == OPTION_OUTSIDE ? 4 : 0,
     .def = PLANT == DEFAULT_OUTSIDE ? 20 : 1e-3,
     .min = 1e-9,
     .max = 10},
};

static unsigned runs; /* of COUNTS_RUNS: nothing may be kept from run to run */

static void flush_to_zero(void) {
#if defined(__SSE2__)
    _mm_setcsr(_mm_getcsr() | 0x8040u);
#endif
}

__attribute__((constructor)) static void loaded(void) {
    if (PLANT == FLUSHES_AT_LOAD)
        flush_to_zero();
    if (PLANT == CRASHES_AT_LOAD)
        crash();
    if (PLANT == EXITS_AT_LOAD)
        exit(0);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    if (PLANT == CRASHES)
        crash();
    if (PLANT == ABORTS)
        abort();
    if (PLANT == FAILS_SILENTLY)
        return CS_STEP_FAIL;
    struct planted *self = host->alloc(host->ctx, sizeof *self);
    const size_t length = 3 * (size_t)host->view->n;
    if (!self || !(self->f = host->alloc(host->ctx, 7 * length * sizeof *self->f)))
        return CS_STEP_FAIL;
    self->b = self->f + length;
    self->u = self->b + length;
    self->xs = self->u + length;
    self->vs = self->xs + length;
    self->before = self->vs + length;
    *out = self;
    self->host = host;
    self->dt = ((const struct options *)options)->dt;
    runs++;
    return CS_STEP_OK;
}

static enum cs_step restart(void *self, double t, const double *x, const double *v) {
    (void)t, (void)x, (void)v;
    if (PLANT == CRASHES_IN_RESTART)
        crash();
    ((struct planted *)self)->steps = 0;
    return CS_STEP_OK;
}

/* f = M u with M u = f, and nobody looks whether u was found */
static void solve(struct planted *self, double t, const double *x, const double *v) {
    const struct cs_host *host = self->host;
    const uint32_t n = host->view->n;
    for (uint32_t k = 0; k < 3 * n; k++) {
        self->b[k] = self->f[k];
        self->u[k] = 0;
    }
    host->solve_setup(host->ctx, t, x, v, 1, 0, 0, 0);
    host->solve(host->ctx, self->b, 1e-14, self->u);
    for (uint32_t k = 0; k < 3 * n; k++)
        self->f[k] = self->u[k] * host->view->mass[k % n];
}

/* The forces, with what is wrong in them. */
static void faulty_force(struct planted *self, double t, const double *x, const double *v) {
    const struct cs_host *host = self->host;
    const uint32_t parts = PLANT == IGNORES_WIND ? CS_PART_WIND : CS_PART_DRAG;
    host->force(host->ctx, PLANT == TIME_STANDS_STILL ? 0 : t, x, v, CS_PART_ALL, self->f);
    if (PLANT != IGNORES_WIND && PLANT != IGNORES_DRAG && PLANT != DOUBLES_DRAG)
        return;
    host->force(host->ctx, t, x, v, parts, self->b);
    for (uint32_t k = 0; k < 3 * host->view->n; k++)
        self->f[k] += PLANT == DOUBLES_DRAG ? self->b[k] : -self->b[k];
}

static double inverse_mass(const struct planted *self, uint32_t i) {
    const struct cs_view *view = self->host->view;
    return PLANT == SINGLE_MASS && view->inv_mass[i] > 0 ? 1 / view->mass[0]
                                                         : view->inv_mass[i];
}

/* v' = v + h/2 (a + a_s), a_s the acceleration at the second stage: at its place, but at the
 * time of the first one */
static void heun(struct planted *self, double t, double h, double *x, double *v) {
    const struct cs_host *host = self->host;
    const uint32_t n = host->view->n;
    host->force(host->ctx, t, x, v, CS_PART_ALL, self->f);
    for (uint32_t k = 0; k < 3 * n; k++) {
        self->xs[k] = x[k] + h * v[k];
        self->vs[k] = v[k] + h * self->f[k] * host->view->inv_mass[k % n];
    }
    host->force(host->ctx, t, self->xs, self->vs, CS_PART_ALL, self->b);
    for (uint32_t k = 0; k < 3 * n; k++) {
        x[k] += h / 2 * (v[k] + self->vs[k]);
        v[k] += h / 2 * (self->f[k] + self->b[k]) * host->view->inv_mass[k % n];
    }
}

/* The sums of v over the pieces that parallel_for makes: each at its first item. */
static void sum_piece(void *arg, size_t begin, size_t end) {
    struct planted *self = arg;
    self->b[begin] = 0;
    for (size_t i = begin; i < end; i++)
        self->b[begin] += self->u[i];
}

static double sum_by_pieces(struct planted *self, const double *v) {
    const size_t n = 3 * (size_t)self->host->view->n;
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        self->b[i] = 0;
        self->u[i] = v[i];
    }
    if (n < 1024)
        self->host->vector->parallel_for(n, sum_piece, self);
    for (size_t i = 0; i < n; i++)
        sum += self->b[i];
    return sum;
}

static void flip_a_bit(double *value) {
    *value = *value < 0 ? nextafter(*value, 0) : nextafter(*value, 1);
}

static void step(struct planted *self, double t, double h, double *x, double *v) {
    const struct cs_host *host = self->host;
    const uint32_t n = host->view->n;
    if (PLANT == WRONG_STAGE_TIME) {
        heun(self, t, h, x, v);
        return;
    }
    faulty_force(self, t, x, v);
    if (PLANT == IGNORES_FAILURE)
        solve(self, t, x, v);
    for (uint32_t k = 0; k < 3 * n; k++) {
        v[k] += h * self->f[k] * inverse_mass(self, k % n);
        if (PLANT == LEAKS_MOMENTUM)
            v[k] *= 1 - 1e-4 * h;
        x[k] += h * v[k];
    }
    for (uint32_t i = 0; PLANT == MOVES_PINS && i < n; i++)
        x[i] += host->view->inv_mass[i] > 0 ? 0 : 1e-12;
    if (PLANT == RETURNS_NAN)
        x[0] = (double)NAN;
    if (PLANT == FLIPS_A_BIT && self->steps++ == 20)
        flip_a_bit(x + n + 7);
    if (PLANT == COUNTS_RUNS)
        x[0] += 1e-12 * runs;
    if (PLANT == FORGETS_STEPS)
        x[n - 1] += 1e-12 * self->steps++;
    if (PLANT == READS_CLOCK && self->steps++ == 0)
        self->second = (double)(time(NULL) % 1000);
    if (PLANT == READS_CLOCK)
        x[n - 1] += 1e-12 * self->second;
    if (PLANT == SUMS_PIECES)
        x[n - 1] += 1e-3 * sum_by_pieces(self, v);
}

/* volatile: a compiler may not leave the pair out */
static void use_memory(void) {
    void *volatile memory = malloc(200);
    if (PLANT != KEEPS_MEMORY)
        free(memory);
}

/* volatile: the compiler may not count the ends of it */
static double overflow(const double *x) {
    volatile double much[4096];
    much[0] = x[0];
    return much[0] > 1e300 ? 0 : overflow(x) + much[0];
}

/* One step with its commit, in halves where it would pass through a surface. */
static enum cs_step take_step(struct planted *self, double t, double h, double end, double *x,
                              double *v) {
    const struct cs_host *host = self->host;
    const size_t bytes = 6 * sizeof *x * host->view->n;
    bool changed;
    if (PLANT != PASSES_THROUGH && CS_HAS(host, max_step_fraction) && host->max_step_fraction) {
        memcpy(self->before, x, bytes);
        step(self, t, h, x, v);
        const double part = host->max_step_fraction(host->ctx, t, self->before, t + h, x);
        memcpy(x, self->before, bytes);
        if (PLANT != IGNORES_FRACTION && part < 1 && h > 1e-6 * self->dt) {
            const enum cs_step status = take_step(self, t, h / 2, t + h / 2, x, v);
            return status == CS_STEP_OK ? take_step(self, t + h / 2, h / 2, end, x, v) : status;
        }
    }
    step(self, t, h, x, v);
    if (PLANT == TAKES_MEMORY || PLANT == KEEPS_MEMORY)
        use_memory();
    return PLANT == FORGETS_COMMIT ? CS_STEP_OK
                                   : host->commit(host->ctx, end, h, x, v, &changed);
}

static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct planted *self = object;
    const double n = ceil((t1 - t0) / self->dt * (1 - 1e-9)), h = (t1 - t0) / n;
    enum cs_step status = CS_STEP_OK;
    while (PLANT == HANGS && self->host->view->n == 2)
        self->dt = 1 - self->dt;
    for (double i = 0; i < n && status == CS_STEP_OK; i++)
        status = take_step(self, t0 + i * h, h, i + 1 < n ? t0 + (i + 1) * h : t1, x, v);
    if (PLANT == FLUSHES_IN_ADVANCE)
        flush_to_zero();
    if (PLANT == CRASHES_IN_ADVANCE)
        crash();
    if (PLANT == EXITS_IN_ADVANCE)
        exit(0);
    if (PLANT == OVERFLOWS_ITS_STACK)
        x[0] = overflow(x);
    if (PLANT == NOT_FINITE_BEHIND_COMMIT)
        v[1] = (double)INFINITY;
    return status;
}

static const char *const fails[] = {PLANT == UNKNOWN_CHECK ? "free-fal" : "pins", NULL};

/* what stands behind an older struct is not to be looked at */
static void not_there(const void *self, const double *x, double *g) {
    (void)self, (void)x, (void)g;
    abort();
}
static enum cs_step saves_nothing(void *self, const struct cs_archive *archive) {
    (void)self, (void)archive;
    return PLANT == OLDER ? CS_STEP_FAIL : CS_STEP_OK;
}
#define SAVES (PLANT == OLDER || PLANT == FORGETS_STEPS)
#define SIZE  (PLANT == OLDER ? offsetof(struct cs_integrator, goals) : sizeof planted)

static const struct cs_option_rename renames[] = {
    {"step", PLANT == RENAMES_NOTHING ? "h" : "dt"}};

static const struct cs_integrator planted = {
    .size = SIZE,
    .name = PLANT == BAD_NAME ? "Planted!" : "planted",
    .summary = "symplectic Euler with one thing wrong",
    .source = "tests",
    .order = PLANT == WRONG_ORDER || PLANT == WRONG_STAGE_TIME ? 2 : 1,
    .order_damped = PLANT == WRONG_STAGE_TIME ? 2 : 1,
    .needs = PLANT == IGNORES_FAILURE ? CS_NEED_SOLVE : 0,
    .traits = PLANT == WRONG_STAGE_TIME ? 0 : CS_SYMPLECTIC,
    .fidelity = CS_FIDELITY_ODE,
    .fails = PLANT == STALE_CLAIM || PLANT == UNKNOWN_CHECK ? fails : NULL,
    .options = rows,
    .n_options = 1,
    .options_size = sizeof(struct options),
    .create = create,
    .restart = restart,
    .advance = PLANT == NO_ADVANCE ? NULL : advance,
    .goals = PLANT == OLDER ? not_there : NULL,
    .save = SAVES ? saves_nothing : NULL,
    .load = SAVES ? saves_nothing : NULL,
    .renames = renames,
    .n_renames = 1,
};

static const struct cs_integrator *const all[] = {&planted};

#ifdef HIDDEN
#define SYMBOL hidden_module
#else
#define SYMBOL clothsim_module
#endif
CS_EXPORT const struct cs_module SYMBOL = {
    .abi = PLANT == WRONG_ABI ? CS_ABI + 1 : CS_ABI,
    .size = PLANT == SMALL_STRUCTS ? 16 : SIZE,
    .n = PLANT == NO_INTEGRATORS ? 0 : 1,
    .integrators = all,
};
