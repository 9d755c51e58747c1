/* cvode.c - backward differentiation formulae of variable order and step, by SUNDIALS CVODE.
 *
 * y = (x, v), y' = (v, f/m). A Newton iteration solves (I - g J) z = b, which CVODE leaves to
 * the embedded solver below; eliminating z_x leaves half the unknowns and the host's matrix:
 *   (M - g D - g^2 K) z_v = M b_v + g K b_x,   z_x = b_x + g z_v,   K = df/dx, D = df/dv.
 * Nothing is kept from one iteration to the next. CVODE goes on across frames; it starts anew
 * only where the state was moved from outside.
 */
#include "cvode_vector.h"

#include <cvode/cvode.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_version.h>

/* Below this damping ratio the orders above 2 are held back by their stability near the
 * imaginary axis, and follow no tolerance. */
#define WEAK_DAMPING 0.05

/* Most that a step may grow by after a new start; CVODE allows 1e4 there, after which the next
 * is mostly thrown away. */
#define GROWTH_MAX 10

struct cvode_options {
    double rtol, atol;
    int64_t max_order, max_steps;
    double linear_rtol;
};

static const struct cs_option rows[] = {
    CS_OPTION(struct cvode_options, rtol, "", 1e-4, 1e-14, 0.1,
              "local error of a step, relative to the value"),
    CS_OPTION(struct cvode_options, atol, "", 0, 0, 1,
              "absolute local error in m and m/s; 0: rtol of 1 m and 1 m/s"),
    CS_OPTION(struct cvode_options, max_order, "", 0, 0, 5,
              "highest order; 0: 2 where rtol is at least 1e-3 or damping is weak, else 5; "
              "above 2 with detection of the stability limit"),
    CS_OPTION(struct cvode_options, max_steps, "", 1000000, 1, 1e9,
              "most steps in a frame before the run is given up"),
    CS_OPTION(struct cvode_options, linear_rtol, "", 1e-4, 1e-14, 0.5,
              "relative residual of the linear solves"),
};

struct cvode {
    const struct cs_host *host;
    struct cvode_options asked;
    struct cvode_vectors *vectors;
    SUNContext context; /* owned */
    void *memory;       /* owned: CVODE's */
    N_Vector state;     /* wraps the host's x and v */
    struct _generic_SUNLinearSolver solver;
    struct _generic_SUNLinearSolver_Ops solver_ops;
    double *b;            /* (3,n), right-hand side of the reduced system */
    enum cs_step status;  /* of the host's solver within the running call */
    char message[256];    /* CVODE's last */
    struct cs_stats done; /* counted before the last start */
};

#if SUNDIALS_VERSION_MAJOR >= 7
static void keep_message(int line, const char *function, const char *file, const char *message,
                         SUNErrCode code, void *object, SUNContext context) {
    (void)line, (void)function, (void)file, (void)code, (void)context;
#else
static void keep_message(int code, const char *module, const char *function, char *message,
                         void *object) {
    (void)module, (void)function;
    if (code > 0)
        return;
#endif
    struct cvode *self = object;
    strncpy(self->message, message, sizeof self->message - 1);
}

/* CVODE's return code as the method's failure, unless the host's solver has failed before. */
static enum cs_step fail(struct cvode *self, int code, double t) {
    if (self->status != CS_STEP_OK)
        return self->status;
    char *name = CVodeGetReturnFlagName(code);
    self->host->fail(self->host->ctx, "CVODE gave up at t = %.9g s: %s%s%s", t,
                     name ? name : "out of memory", self->message[0] ? ": " : "",
                     self->message);
    free(name);
    return CS_STEP_FAIL;
}

static int right_hand_side(sunrealtype t, N_Vector y, N_Vector ydot, void *object) {
    const struct cvode *self = object;
    const struct cs_host *host = self->host;
    const size_t n = host->view->n;
    const double *x = cvode_data(y), *v = x + 3 * n;
    double *dx = cvode_data(ydot), *dv = dx + 3 * n;
    host->force(host->ctx, t, x, v, CS_PART_ALL, dv);
    double finite = 0; /* 0, or not a number */
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            dx[c * n + i] = v[c * n + i];
            dv[c * n + i] *= host->view->inv_mass[i];
            finite += 0 * dv[c * n + i];
        }
    // a step too large can overflow: CVODE then tries a smaller one
    return finite == 0 ? 0 : 1;
}

static SUNLinearSolver_Type solver_type(SUNLinearSolver solver) {
    (void)solver;
    return SUNLINEARSOLVER_MATRIX_EMBEDDED;
}

static int solve_reduced(SUNLinearSolver solver, SUNMatrix none, N_Vector z, N_Vector b,
                         sunrealtype tolerance) {
    (void)none, (void)tolerance;
    struct cvode *self = solver->content;
    const struct cs_host *host = self->host;
    const size_t n = host->view->n;
    N_Vector y, unused;
    void *object;
    double t, g, rl1;
    const int code = CVodeGetNonlinearSystemData(self->memory, &t, &unused, &y, &unused, &g,
                                                 &rl1, &unused, &object);
    if (code != CV_SUCCESS)
        return -1;

    const double *x = cvode_data(y), *v = x + 3 * n;
    const double *bx = cvode_data(b), *bv = bx + 3 * n;
    double *zx = cvode_data(z), *zv = zx + 3 * n;
    host->jvp(host->ctx, t, x, v, CS_PART_LINEARISED, bx, NULL, self->b);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            self->b[c * n + i] = host->view->mass[i] * bv[c * n + i] + g * self->b[c * n + i];
    memset(zv, 0, 3 * n * sizeof *zv);
    self->status = host->solve_setup(host->ctx, t, x, v, 1, -g, -g * g, 0);
    if (self->status == CS_STEP_OK)
        self->status = host->solve(host->ctx, self->b, self->asked.linear_rtol, zv);
    if (self->status != CS_STEP_OK)
        return -1;

    // pinned rows of b are 0, for their derivatives are, and so are those of z
    host->vector->linear_sum(3 * n, 1, bx, g, zv, zx);
    return 0;
}

static void add_counts(const struct cvode *self, struct cs_stats *out) {
    long error_failures = 0, solve_failures = 0, newton = 0, setups = 0;
    if (self->memory) {
        CVodeGetNumErrTestFails(self->memory, &error_failures);
        CVodeGetNumStepSolveFails(self->memory, &solve_failures);
        CVodeGetNumNonlinSolvIters(self->memory, &newton);
        CVodeGetNumLinSolvSetups(self->memory, &setups);
    }
    out->rejected = self->done.rejected + (uint64_t)(error_failures + solve_failures);
    out->newton = self->done.newton + (uint64_t)newton;
    out->setups = self->done.setups + (uint64_t)setups;
}

static void stats(const void *object, struct cs_stats *out) {
    add_counts(object, out);
}

/* The state was moved: CVODE forgets its history, and its counts with it. step: the first to
 * try in s; 0: CVODE's own careful choice. */
static enum cs_step start_anew(struct cvode *self, double t, double step) {
    add_counts(self, &self->done);
    int code = CVodeReInit(self->memory, t, self->state);
    if (code == CV_SUCCESS)
        code = CVodeSetInitStep(self->memory, step);
    return code == CV_SUCCESS ? CS_STEP_OK : fail(self, code, t);
}

/* After commit has moved the state: goes on with the step that CVODE had in mind, or a scene in
 * contact would crawl from one tiny first step to the next. */
static enum cs_step go_on(struct cvode *self, double t, double dt) {
    double next = 0;
    const int code = CVodeGetCurrentStep(self->memory, &next);
    if (code != CV_SUCCESS)
        return fail(self, code, t);
    return start_anew(self, t, next < GROWTH_MAX * dt ? next : GROWTH_MAX * dt);
}

static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    (void)v; // is x + 3n
    struct cvode *self = object;
    cvode_wrap(self->state, (double *)x);
    return start_anew(self, t, 0);
}

static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct cvode *self = object;
    const struct cs_host *host = self->host;
    cvode_wrap(self->state, x);
    self->status = CS_STEP_OK;
    self->message[0] = 0;
    int code = CVodeSetStopTime(self->memory, t1);
    enum cs_step status = code == CV_SUCCESS ? CS_STEP_OK : fail(self, code, t0);
    double t = t0;
    for (int64_t steps = 0; t < t1 && status == CS_STEP_OK; steps++) {
        if (steps >= self->asked.max_steps)
            return host->fail(host->ctx, "more than %lld steps from t = %.9g s to %.9g s",
                              (long long)self->asked.max_steps, t0, t);
        const double before = t;
        bool changed = false;
        code = CVode(self->memory, t1, self->state, &t, CV_ONE_STEP);
        if (code < 0)
            return fail(self, code, before);
        status = host->commit(host->ctx, t, t - before, x, v, &changed);
        if (status == CS_STEP_OK && changed)
            status = go_on(self, t, t - before);
    }
    return status;
}

static int64_t choose_order(const struct cvode *self) {
    const struct cs_host *host = self->host;
    const bool weak = host->view->delta < WEAK_DAMPING * host->view->omega;
    if (self->asked.max_order > 0)
        return self->asked.max_order;
    const int64_t order = self->asked.rtol >= 1e-3 || weak ? 2 : 5;
    host->note(host->ctx, "max_order automatic: %d (rtol %g, damping %s)", (int)order,
               self->asked.rtol, weak ? "weak" : "strong");
    return order;
}

static int open_context(struct cvode *self) {
#if SUNDIALS_VERSION_MAJOR >= 7
    if (SUNContext_Create(SUN_COMM_NULL, &self->context))
        return CV_MEM_FAIL;
    if (SUNContext_ClearErrHandlers(self->context))
        return CV_CONTEXT_ERR;
    return SUNContext_PushErrHandler(self->context, keep_message, self) ? CV_CONTEXT_ERR
                                                                        : CV_SUCCESS;
#else
    return SUNContext_Create(NULL, &self->context) ? CV_MEM_FAIL : CV_SUCCESS;
#endif
}

/* CVODE over the vectors that were taken; the first code that is not CV_SUCCESS. */
static int open_cvode(struct cvode *self) {
    const struct cvode_options *asked = &self->asked;
    if (!(self->memory = CVodeCreate(CV_BDF, self->context)))
        return CV_MEM_FAIL;
    int code = CV_SUCCESS;
#if SUNDIALS_VERSION_MAJOR < 7
    code = CVodeSetErrHandlerFn(self->memory, keep_message, self);
#endif
    const int order = (int)choose_order(self);
    const double atol = asked->atol > 0 ? asked->atol : asked->rtol;
    if (code == CV_SUCCESS)
        code = CVodeInit(self->memory, right_hand_side, 0, self->state);
    if (code == CV_SUCCESS)
        code = CVodeSetMaxOrd(self->memory, order);
    if (code == CV_SUCCESS)
        code = CVodeSetUserData(self->memory, self);
    if (code == CV_SUCCESS)
        code = CVodeSStolerances(self->memory, asked->rtol, atol);
    if (code == CV_SUCCESS)
        code = CVodeSetLinearSolver(self->memory, &self->solver, NULL);
    if (code == CV_SUCCESS && order > 2)
        code = CVodeSetStabLimDet(self->memory, SUNTRUE);
    return code;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    struct cvode *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->host = host;
    self->asked = *(const struct cvode_options *)options;
    const int code = open_context(self);
    if (code != CV_SUCCESS)
        return fail(self, code, 0);

    self->vectors = host->alloc(host->ctx, sizeof *self->vectors);
    self->b = host->alloc(host->ctx, 3 * sizeof(double) * host->view->n);
    if (!self->vectors || !self->b)
        return CS_STEP_FAIL;
    if (cvode_vectors_init(self->vectors, host, self->context) != CS_STEP_OK)
        return CS_STEP_FAIL;
    self->state = cvode_vectors_take(self->vectors);
    self->solver_ops.gettype = solver_type;
    self->solver_ops.solve = solve_reduced;
    self->solver.content = self;
    self->solver.ops = &self->solver_ops;
    self->solver.sunctx = self->context;
    const int opened = open_cvode(self);
    return opened == CV_SUCCESS ? CS_STEP_OK : fail(self, opened, 0);
}

static void destroy(void *object) {
    struct cvode *self = object;
    if (!self)
        return;
    if (self->memory)
        CVodeFree(&self->memory);
    if (self->context)
        SUNContext_Free(&self->context);
}

static const struct cs_integrator cvode_bdf = {
    .size = sizeof(struct cs_integrator),
    .name = "cvode-bdf",
    .summary = "backward differentiation with error control, by SUNDIALS CVODE",
    .source = "Hindmarsh et al. 2005; Gardner et al. 2022",
    .order = 5,
    .order_damped = 5,
    .needs = CS_NEED_JVP | CS_NEED_SOLVE,
    .traits = CS_IMPLICIT | CS_ADAPTIVE | CS_MULTISTEP | CS_LIBRARY_BITS,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct cvode_options),
    .create = create,
    .restart = restart,
    .advance = advance,
    .stats = stats,
    .destroy = destroy,
};

static const struct cs_integrator *const integrators[] = {&cvode_bdf};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};
