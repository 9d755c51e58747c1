/* Linear multistep methods of variable order and step, by SUNDIALS CVODE: backward
 * differentiation with a Newton iteration, and Adams-Moulton with a fixed-point iteration.
 * CVODE goes on across frames, and after commits that moved the state: see cvode_history.h.
 */
#include "cvode_history.h"
#include "cvode_order_control.h"

#include "sundials_common.h"
#include "sundials_overstep.h"

#include <cvode/cvode.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

_Static_assert(CV_ERR_FAILURE == SUNDIALS_ERROR_TEST &&
                   CV_CONV_FAILURE == SUNDIALS_CONVERGENCE &&
                   CV_REPTD_RHSFUNC_ERR == SUNDIALS_REFUSED,
               "codes of sundials.h");

/* Below this damping ratio, stability near the imaginary axis holds back the orders above 2
 * of BDF: see cvode_order_control.h. Chosen by trial. */
#define WEAK_DAMPING 0.05

/* A step whose best length is within these factors of the last keeps its length. CVODE's
 * default lets steps grow by 1.5 at least, to save factorisations; here a change of length
 * costs nothing. Chosen by trial. */
#define KEPT_FROM 0.9
#define KEPT_TO   1.2

/* The fraction of the local error that the nonlinear iteration may leave. CVODE's default 0.1
 * suits an outdated matrix; here each iteration has its own, and 0.1 takes 1.08 to 1.45 times
 * the work for about the same error or more (docs/notes/sundials-calls.md). */
#define NONLINEAR_SHARE 1

/* The largest growth of a step after a restart. CVODE allows 1e4 there, and the step is then
 * mostly rejected. */
#define GROWTH_MAX 10

/* Vectors: history of orders 0 to 5 (BDF) or 12 (Adams), CVODE's scratch (7), the nonlinear
 * solver's (3), the state, one for checks, and some spare. */
enum { BDF_VECTORS = 19, ADAMS_VECTORS = 27 };

struct cvode_options {
    double rtol, atol;
    int64_t max_order, max_steps;
    double linear_rtol;
};

#define COMMON_ROWS(least)                                                                     \
    CS_OPTION(struct cvode_options, rtol, "", 1e-4, least, 0.1,                                \
              "local error of a step, relative to the value"),                                 \
        CS_OPTION(struct cvode_options, atol, "", 0, 0, 1,                                     \
                  "absolute local error in m and m/s; 0: rtol of the scene's own"),            \
        CS_OPTION(struct cvode_options, max_steps, "", 1000000, 1, 1e9,                        \
                  "maximum steps per frame before the run fails")

static const struct cs_option bdf_rows[] = {
    COMMON_ROWS(1e-14),
    CS_OPTION(struct cvode_options, max_order, "", 0, 0, 5,
              "maximum order; 0: 5 if damping is strong and rtol below 1e-3, else 2, and 5 "
              "while steps are well below 1/omega; orders above 2 by request or for strong "
              "damping use stability limit detection"),
    CS_OPTION(struct cvode_options, linear_rtol, "", 0, 0, 0.5,
              "relative residual of the linear solves; 0: what SUNDIALS allows, 1e-4 to 0.05"),
};

static const struct cs_option adams_rows[] = {
    COMMON_ROWS(1e-14),
    CS_OPTION(struct cvode_options, max_order, "", 12, 1, 12, "maximum order"),
};

struct cvode {
    struct sundials base; /* first: its functions take it for the whole */
    struct cvode_options asked;
    SUNNonlinearSolver iteration; /* owned: of Adams; NULL: CVODE's own Newton */
    struct cvode_history history;
    struct cvode_order order;
    struct cs_stats done; /* counted before the last start */
};

/* `system` of struct sundials_library: time, state and g of the running Newton iteration. */
static int newton_system(void *memory, double *t, N_Vector *y, double *g) {
    N_Vector unused;
    void *object;
    double rl1;
    return CVodeGetNonlinearSystemData(memory, t, &unused, y, &unused, g, &rl1, &unused,
                                       &object);
}

/* out = the counts of the runs of CVODE before its last restart, plus those since. */
static void add_counts(const struct cvode *self, struct cs_stats *out) {
    long error_failures = 0, solve_failures = 0, newton = 0, setups = 0;
    if (self->base.memory) {
        CVodeGetNumErrTestFails(self->base.memory, &error_failures);
        CVodeGetNumStepSolveFails(self->base.memory, &solve_failures);
        CVodeGetNumNonlinSolvIters(self->base.memory, &newton);
        CVodeGetNumLinSolvSetups(self->base.memory, &setups);
    }
    out->rejected = self->done.rejected + (uint64_t)(error_failures + solve_failures);
    out->newton = self->done.newton + (uint64_t)newton;
    out->setups = self->done.setups + (uint64_t)setups;
}

static void stats(const void *object, struct cs_stats *out) {
    add_counts(object, out);
}

/* CVODE forgets its history, and its counts with it. step: the first to try in s; 0: CVODE's
 * own careful choice. */
static int reinit_cvode(struct cvode *self, double t, double step) {
    struct sundials *base = &self->base;
    add_counts(self, &self->done);
    cvode_history_update(&self->history, base);
    int code = CVodeReInit(base->memory, t, base->state);
    cvode_history_find(&self->history, base);
    cvode_order_reset(&self->order);
    if (code == CV_SUCCESS && self->order.is_automatic)
        code = CVodeSetMaxOrd(base->memory, CVODE_ORDER_LOW);
    return code == CV_SUCCESS ? CVodeSetInitStep(base->memory, step) : code;
}

/* Where a history cannot be moved along, a new start goes on with the step that CVODE had in
 * mind, or a scene in contact would crawl from one tiny first step to the next. */
static int moved(struct sundials *base, double t, double dt) {
    struct cvode *self = (struct cvode *)base;
    if (dt <= 0)
        return reinit_cvode(self, t, 0);
    if (cvode_history_move(&self->history, base))
        return CV_SUCCESS;
    double next = 0;
    const int code = CVodeGetCurrentStep(base->memory, &next);
    next = next < GROWTH_MAX * dt ? next : GROWTH_MAX * dt;
    return code == CV_SUCCESS ? reinit_cvode(self, t, next) : code;
}

/* CVODE cannot lower its order without a new start; h: the last step's length in s. */
static int change_order(struct cvode *self, double t, double h, double stop) {
    if (self->order.is_high)
        return CVodeSetMaxOrd(self->base.memory, CVODE_ORDER_HIGH);
    const int code = reinit_cvode(self, t, h);
    stop = self->base.interpolated ? self->base.host->overstep_until : stop;
    return code == CV_SUCCESS && stop < HUGE_VAL ? CVodeSetStopTime(self->base.memory, stop)
                                                 : code;
}

/* One step from *reached. The length of the last step may change the order first, and only
 * here: right after that step its interpolant may still be needed. */
static int evolve(void *memory, sunrealtype t1, N_Vector y, sunrealtype *reached, int task) {
    void *object = NULL;
    double h = 0; // before the first step since a start it is 0
    int code = CVodeGetUserData(memory, &object);
    if (code == CV_SUCCESS)
        code = CVodeGetLastStep(memory, &h);
    struct cvode *self = object;
    if (code == CV_SUCCESS && self->order.is_automatic && h > 0 &&
        cvode_order_update(&self->order, h * self->base.host->view->omega))
        code = change_order(self, *reached, h, t1);
    return code == CV_SUCCESS ? CVode(memory, t1, y, reached, task) : code;
}

static const struct sundials_library library = {
    .can_retry = true,
    .name = "CVODE",
    .code_name = CVodeGetReturnFlagName,
    .set_stop = CVodeSetStopTime,
    .evolve = evolve,
    .one_step = CV_ONE_STEP,
    .interpolate = CVodeGetDky,
    .system = newton_system,
    .on_state_changed = moved,
};

/* The highest order to start with: the user's; else 2 with automatic control, if damping is
 * weak or the tolerance loose; else 5. */
static int choose_bdf_order(struct cvode *self) {
    const struct cs_host *host = self->base.host;
    const double omega = host->view->omega, delta = host->view->delta;
    const bool weak = delta < WEAK_DAMPING * omega;
    if (self->asked.max_order > 0)
        return (int)self->asked.max_order;
    if (weak || self->asked.rtol >= 1e-3)
        cvode_order_begin(&self->order, omega > 0 ? delta / omega : 0);
    host->note(host->ctx, "max_order automatic: %s (rtol %g, damping %s)",
               self->order.is_automatic ? "2, and 5 while steps are short" : "5",
               self->asked.rtol, weak ? "weak" : "strong");
    return self->order.is_automatic ? CVODE_ORDER_LOW : CVODE_ORDER_HIGH;
}

/* BDF: Newton with the host's solver; stability-limit detection for orders above 2, unless the
 * order is automatic. Returns the first code that is not CV_SUCCESS. */
static int set_bdf_solver(struct cvode *self, int order) {
    void *memory = self->base.memory;
    int code = CVodeSetLinearSolver(memory, &self->base.solver, NULL);
    if (code == CV_SUCCESS && order > 2)
        code = CVodeSetStabLimDet(memory, SUNTRUE);
    if (code == CV_SUCCESS && self->order.is_automatic)
        code = CVodeSetEtaFixedStepBounds(memory, KEPT_FROM, KEPT_TO);
    return code == CV_SUCCESS ? CVodeSetNonlinConvCoef(memory, NONLINEAR_SHARE) : code;
}

/* Adams: fixed-point iteration, without a matrix. */
static int set_adams_solver(struct cvode *self) {
    self->iteration = SUNNonlinSol_FixedPoint(self->base.state, 0, self->base.context);
    return self->iteration ? CVodeSetNonlinearSolver(self->base.memory, self->iteration)
                           : CV_MEM_FAIL;
}

/* CVODE over the vectors that were taken; the first code that is not CV_SUCCESS. */
static int open_memory(struct cvode *self, int family) {
    struct sundials *base = &self->base;
    const struct cvode_options *asked = &self->asked;
    if (!(base->memory = CVodeCreate(family, base->context)))
        return CV_MEM_FAIL;
    int code = CV_SUCCESS;
#if SUNDIALS_VERSION_MAJOR < 7
    code = CVodeSetErrHandlerFn(base->memory, sundials_keep_message, base);
#endif
    base->tolerance = tolerance_of(base->host, asked->rtol, asked->atol);
    const int order = family == CV_BDF ? choose_bdf_order(self) : (int)asked->max_order;
    if (code == CV_SUCCESS)
        code = CVodeInit(base->memory, sundials_whole_slope, 0, base->state);
    if (code == CV_SUCCESS)
        code = CVodeSetMaxOrd(base->memory, order);
    if (code == CV_SUCCESS)
        code = CVodeSetUserData(base->memory, base);
    if (code == CV_SUCCESS)
        code = CVodeWFtolerances(base->memory, sundials_weigh);
    if (code == CV_SUCCESS)
        code = family == CV_BDF ? set_bdf_solver(self, order) : set_adams_solver(self);
    return code;
}

/* family: CV_BDF or CV_ADAMS. */
static enum cs_step create(const struct cs_host *host, const void *options, int family,
                           void **out) {
    struct cvode *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->asked = *(const struct cvode_options *)options;
    self->base.max_steps = self->asked.max_steps;
    const bool bdf = family == CV_BDF;
    // the norm of Newton's iteration and of the error test may pass a state deep in contact: it
    // is off by less than the tolerance, and the energy by a factor of thousands
    self->base.judges_contact = bdf;
    if (sundials_open(&self->base, host, &library, bdf ? BDF_VECTORS : ADAMS_VECTORS,
                      bdf ? &self->asked.linear_rtol : NULL) != CS_STEP_OK)
        return CS_STEP_FAIL;
    // not up to events or in contact: there a step that began beyond a frame met a matrix that
    // the solver could not solve
    if (bdf && host->may_overstep)
        sundials_overstep_begin(&self->base);
    self->history.scratch = sundials_vectors_acquire(&self->base.vectors);
    const int code = open_memory(self, family);
    return code == CV_SUCCESS ? CS_STEP_OK : sundials_fail(&self->base, code, 0);
}

static enum cs_step create_bdf(const struct cs_host *host, const void *options, void **out) {
    return create(host, options, CV_BDF, out);
}

static enum cs_step create_adams(const struct cs_host *host, const void *options, void **out) {
    return create(host, options, CV_ADAMS, out);
}

static void destroy(void *object) {
    struct cvode *self = object;
    if (!self)
        return;
    if (self->base.memory)
        CVodeFree(&self->base.memory);
    if (self->iteration)
        SUNNonlinSolFree(self->iteration);
    sundials_close(&self->base);
}

#define CVODE(rows_)                                                                           \
    .size = sizeof(struct cs_integrator),                                                      \
    .source = "Hindmarsh et al. 2005; Gardner et al. 2022", .fidelity = CS_FIDELITY_ODE,       \
    .options = rows_, .n_options = sizeof rows_ / sizeof rows_[0],                             \
    .options_size = sizeof(struct cvode_options), .restart = sundials_restart,                 \
    .advance = sundials_advance, .stats = stats, .destroy = destroy,                           \
    .library = "SUNDIALS " SUNDIALS_VERSION

static const char *const bdf_orders[] = {"max_order=2", "max_order=5", NULL};

static const struct cs_integrator cvode_bdf = {
    CVODE(bdf_rows),
    .name = "cvode-bdf",
    .summary = "backward differentiation with error control, by SUNDIALS CVODE",
    .order = 5,
    .order_damped = 5,
    .needs = CS_NEED_JVP | CS_NEED_SOLVE,
    .traits = CS_IMPLICIT | CS_ADAPTIVE | CS_MULTISTEP | CS_LIBRARY_BITS,
    .create = create_bdf,
    .variants = bdf_orders,
};

static const struct cs_integrator cvode_adams = {
    CVODE(adams_rows),
    .name = "cvode-adams",
    .summary = "Adams-Moulton by fixed-point iteration with error control, by SUNDIALS CVODE",
    .order = 12,
    .order_damped = 12,
    .traits = CS_ADAPTIVE | CS_MULTISTEP | CS_LIBRARY_BITS,
    .create = create_adams,
};

static const struct cs_integrator *const integrators[] = {&cvode_adams, &cvode_bdf};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};
