/* Runge-Kutta methods of SUNDIALS ARKODE, with error control or a fixed step.
 *
 *   ark-erk   explicit
 *   ark-dirk  diagonally implicit: one Newton iteration a stage
 *   ark-imex  additive pairs: x' = v and all forces that can be stiff by
 *             the implicit table, the other forces by the explicit one
 * After a change of the state one-step methods lose nothing but a slope.
 */
#include "arkode_calls.h"
#include "arkode_ends.h"
#include "arkode_tables.h"
#include "fixed_step.h"
#include "sundials_common.h"
#include "sundials_overstep.h"

#include <string.h>

_Static_assert(ARK_ERR_FAILURE == SUNDIALS_ERROR_TEST &&
                   ARK_CONV_FAILURE == SUNDIALS_CONVERGENCE &&
                   ARK_REPTD_RHSFUNC_ERR == SUNDIALS_REFUSED,
               "codes of sundials.h");

#define EXPLICIT_PARTS (CS_PART_ALL & ~CS_PART_STIFF)

/* Vectors besides the slopes of stages: state, error weights, scratch, interpolation, Newton,
 * and some spare. */
enum { WORK_VECTORS = 20 };

/* Rejections of a step before the run fails. The library's default of 7 is too few after a
 * jump of the forces. */
enum { ERROR_FAILURES_MAX = 20 };

/* Newton iterations of a stage. The library's default of 3 rejects steps at a loose
 * tolerance, and ends runs of fixed step. */
enum { NEWTON_MAX = 20 };

/* With a fixed step the tolerances are those of Newton's iteration alone. Its error must lie
 * below that of the step: at 1 times rtol = 1e-4 the orders end at 1e-9 of a sheet's size, at
 * 1e-3 times they hold to 1e-11. Solves fail below 1e-11. */
#define FIXED_STEP_RTOL_RATIO 1e-3
#define FIXED_STEP_RTOL_MIN   1e-11

struct ark_options {
    double rtol, atol, dt;
    int64_t order, max_steps;
    double linear_rtol;
};

#define COMMON_ROWS(order_, least, most)                                                       \
    CS_OPTION(struct ark_options, rtol, "", 1e-4, 1e-14, 0.1,                                  \
              "local error of a step, relative to the value"),                                 \
        CS_OPTION(struct ark_options, atol, "", 0, 0, 1,                                       \
                  "absolute local error in m and m/s; 0: rtol of the scene's own"),            \
        CS_OPTION(struct ark_options, dt, "s", 0, 0, 10,                                       \
                  "maximum step without error control; 0: with error control"),                \
        CS_OPTION(struct ark_options, order, "", order_, least, most,                          \
                  "order, which selects the table"),                                           \
        CS_OPTION(struct ark_options, max_steps, "", 1000000, 1, 1e9,                          \
                  "maximum steps per frame before the run fails")
#define LINEAR_ROW                                                                             \
    CS_OPTION(struct ark_options, linear_rtol, "", 0, 0, 0.5,                                  \
              "relative residual of the linear solves; 0: what SUNDIALS allows, 1e-4 to 0.05")

static const struct cs_option erk_rows[] = {COMMON_ROWS(5, 2, 8)};
static const struct cs_option dirk_rows[] = {COMMON_ROWS(4, 2, 5), LINEAR_ROW};
static const struct cs_option imex_rows[] = {COMMON_ROWS(4, 3, 5), LINEAR_ROW};

/* The object of a method. */
struct ark {
    struct sundials base; /* first: its functions take it for the whole */
    struct ark_options asked;
    struct fixed_step steps; /* only to cut frames into steps of dt */
    struct arkode_ends ends; /* where steps pass frames */
};

/* sundials_slope, which takes from the last end what is known there, and leaves it the rest. */
static int slope_of(struct ark *self, sunrealtype t, N_Vector y, uint32_t parts, bool moves,
                    N_Vector slope) {
    const size_t n3 = 3 * (size_t)self->base.host->view->n;
    const double *state = sundials_data(y);
    double *v = sundials_data(slope), *a = v + n3;
    const int part = parts == EXPLICIT_PARTS;
    struct arkode_end *end = arkode_ends_find(&self->ends, t, state);
    if (!end || !end->known[part]) {
        const int code = sundials_slope(&self->base, t, y, parts, moves, slope);
        if (end && code == 0)
            memcpy(end->a[part], a, n3 * sizeof *a);
        if (end)
            end->known[part] = code == 0;
        return code;
    }
    memcpy(a, end->a[part], n3 * sizeof *a);
    if (moves)
        memcpy(v, state + n3, n3 * sizeof *v);
    else
        memset(v, 0, n3 * sizeof *v);
    return 0;
}

/* The whole force, or the two parts of ark-imex: x' = v and the forces that can be stiff; the
 * other forces. */
static int whole_slope(sunrealtype t, N_Vector y, N_Vector slope, void *object) {
    return slope_of(object, t, y, CS_PART_ALL, true, slope);
}

static int implicit_slope(sunrealtype t, N_Vector y, N_Vector slope, void *object) {
    return slope_of(object, t, y, CS_PART_STIFF, true, slope);
}

static int explicit_slope(sunrealtype t, N_Vector y, N_Vector slope, void *object) {
    return slope_of(object, t, y, EXPLICIT_PARTS, false, slope);
}

/* `system` of struct sundials_library: time, state and g of the running Newton iteration. */
static int newton_system(void *memory, double *t, N_Vector *y, double *g) {
    N_Vector unused;
    void *object;
    return ARK(GetNonlinearSystemData)(memory, t, &unused, y, &unused, g, &unused, &object);
}

static void stats(const void *object, struct cs_stats *out) {
    void *memory = ((const struct ark *)object)->base.memory;
    long error_failures = 0, solve_failures = 0, newton = 0, setups = 0;
    if (memory) {
        ARK(GetNumErrTestFails)(memory, &error_failures);
        ARK(GetNumStepSolveFails)(memory, &solve_failures);
        ARK(GetNumNonlinSolvIters)(memory, &newton);
        ARK(GetNumLinSolvSetups)(memory, &setups);
    }
    out->rejected = (uint64_t)(error_failures + solve_failures);
    out->newton = (uint64_t)newton;
    out->setups = (uint64_t)setups;
}

/* on_state_changed: a reset keeps counts and step length. For a state from outside (dt 0)
 * with error control the library chooses the first step again. */
static int moved(struct sundials *base, double t, double dt) {
    struct ark *self = (struct ark *)base;
    int code = ARK(Reset)(base->memory, t, base->state);
    if (base->interpolated)
        arkode_ends_restart(&self->ends, t, sundials_data(base->state));
    if (code == ARK_SUCCESS && dt <= 0 && self->asked.dt <= 0)
        code = ARK(SetInitStep)(base->memory, 0);
    return code;
}

/* One step, whose end is kept. */
static int evolve(void *memory, sunrealtype t1, N_Vector y, sunrealtype *reached, int task) {
    void *object = NULL;
    const int code = ARK(Evolve)(memory, t1, y, reached, task);
    if (code >= 0 && ARK(GetUserData)(memory, &object) == ARK_SUCCESS &&
        ((struct ark *)object)->base.interpolated)
        arkode_ends_add(&((struct ark *)object)->ends, *reached, sundials_data(y));
    return code;
}

/* `interpolate` of struct sundials_library, for k = 0. */
static int state_at(void *memory, sunrealtype t, int k, N_Vector y) {
    void *object = NULL;
    const int code = ARK(GetUserData)(memory, &object);
    (void)k;
    if (code == ARK_SUCCESS)
        arkode_ends_state(&((struct ark *)object)->ends, t, sundials_data(y));
    return code;
}

static const struct sundials_library library = {
    .name = "ARKODE",
    .code_name = ARK(GetReturnFlagName),
    .set_stop = ARK(SetStopTime),
    .evolve = evolve,
    .one_step = ARK_ONE_STEP,
    .interpolate = state_at,
    .system = newton_system,
    .on_state_changed = moved,
};

/* With fixed steps, sets their length to cut the advance into equal ones not longer than dt. */
static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct ark *self = object;
    if (self->asked.dt > 0) {
        double n;
        if (fixed_step_count(&self->steps, t1 - t0, &n) != CS_STEP_OK)
            return CS_STEP_FAIL;
        const int code = ARK(SetFixedStep)(self->base.memory, (t1 - t0) / n);
        if (code != ARK_SUCCESS)
            return sundials_fail(&self->base, code, t0);
    }
    return sundials_advance(object, t0, t1, x, v);
}

/* ARKODE over the vectors that were taken; the first code that is not ARK_SUCCESS. */
static int open_memory(struct ark *self, ARKRhsFn explicit_part, ARKRhsFn implicit_part,
                       const struct ark_table *table) {
    struct sundials *base = &self->base;
    const struct ark_options *asked = &self->asked;
    base->memory = ARKStepCreate(explicit_part, implicit_part, 0, base->state, base->context);
    if (!base->memory)
        return ARK_MEM_FAIL;
    const double ratio = asked->dt > 0 ? FIXED_STEP_RTOL_RATIO : 1;
    base->tolerance = tolerance_of(
        base->host, fmax(ratio * asked->rtol, fmin(asked->rtol, FIXED_STEP_RTOL_MIN)),
        ratio * asked->atol);
    int code = ARK_SUCCESS;
#if SUNDIALS_VERSION_MAJOR < 7
    code = ARKStepSetErrHandlerFn(base->memory, sundials_keep_message, base);
#endif
    if (code == ARK_SUCCESS)
        code = ARK(SetUserData)(base->memory, base);
    if (code == ARK_SUCCESS)
        code = ARK(WFtolerances)(base->memory, sundials_weigh);
    if (code == ARK_SUCCESS)
        code = ARK(SetMaxErrTestFails)(base->memory, ERROR_FAILURES_MAX);
    // arkode_ends.h gives frames: the default interpolant would cost an evaluation per step
    if (code == ARK_SUCCESS)
        code = ARK(SetInterpolantType)(base->memory, ARK_INTERP_LAGRANGE);
    if (code == ARK_SUCCESS)
        code = ARK(SetInterpolantDegree)(base->memory, 1);
    if (code == ARK_SUCCESS && base->interpolated)
        code = ARK(SetMaxStep)(base->memory, LONGEST_PAST_FRAMES);
    if (code == ARK_SUCCESS && implicit_part)
        code = ARK(SetLinearSolver)(base->memory, &base->solver, NULL);
    if (code == ARK_SUCCESS && implicit_part)
        code = ARK(SetMaxNonlinIters)(base->memory, NEWTON_MAX);
    if (code == ARK_SUCCESS)
        code = ARKStepSetTableName(base->memory, table->implicit, table->explicit);
    return code;
}

/* Lets steps pass frames, where the host does and their length is free. */
static enum cs_step pass_frames(struct ark *self, bool is_additive) {
    const struct cs_host *host = self->base.host;
    const uint32_t parts[] = {is_additive ? CS_PART_STIFF : CS_PART_ALL,
                              is_additive ? EXPLICIT_PARTS : 0};
    if (self->asked.dt > 0 || self->asked.atol >= 1)
        return CS_STEP_OK;
    sundials_overstep_begin(&self->base);
    return self->base.interpolated
               ? arkode_ends_init(&self->ends, host, hermite_ends_for(self->asked.order), parts)
               : CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options,
                           ARKRhsFn explicit_part, ARKRhsFn implicit_part,
                           const struct ark_table *tables, void **out) {
    struct ark *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->asked = *(const struct ark_options *)options;
    self->steps = fixed_step_of(host, self->asked.dt, NULL);
    self->base.max_steps = self->asked.max_steps;
    self->base.equal_steps = self->asked.dt > 0;
    const struct ark_table *table = tables + self->asked.order;
    if (!table->stages)
        return host->fail(host->ctx,
                          "SUNDIALS %s has no table of order %d: choose another order",
                          SUNDIALS_VERSION, (int)self->asked.order);
    /* each stage keeps a slope, of an additive pair two */
    const int slopes =
        (explicit_part ? table->stages : 0) + (implicit_part ? table->stages : 0);
    if (sundials_open(&self->base, host, &library, slopes + WORK_VECTORS,
                      implicit_part ? &self->asked.linear_rtol : NULL) != CS_STEP_OK ||
        pass_frames(self, explicit_part && implicit_part) != CS_STEP_OK)
        return CS_STEP_FAIL;
    const int code = open_memory(self, explicit_part, implicit_part, table);
    return code == ARK_SUCCESS ? CS_STEP_OK : sundials_fail(&self->base, code, 0);
}

static enum cs_step create_erk(const struct cs_host *host, const void *options, void **out) {
    return create(host, options, whole_slope, NULL, ark_erk_tables, out);
}

static enum cs_step create_dirk(const struct cs_host *host, const void *options, void **out) {
    return create(host, options, NULL, whole_slope, ark_dirk_tables, out);
}

static enum cs_step create_imex(const struct cs_host *host, const void *options, void **out) {
    return create(host, options, explicit_slope, implicit_slope, ark_imex_tables, out);
}

static void destroy(void *object) {
    struct ark *self = object;
    if (!self)
        return;
    if (self->base.memory)
        ARK(Free)(&self->base.memory);
    sundials_close(&self->base);
}

#define ARKODE(rows_)                                                                          \
    .size = sizeof(struct cs_integrator), .fidelity = CS_FIDELITY_ODE, .options = rows_,       \
    .n_options = sizeof rows_ / sizeof rows_[0], .options_size = sizeof(struct ark_options),   \
    .restart = sundials_restart, .advance = advance, .stats = stats, .destroy = destroy,       \
    .library = "SUNDIALS " SUNDIALS_VERSION

static const char *const erk_orders[] = {"order=3", "order=4", "order=6", "order=8", NULL};
static const char *const implicit_orders[] = {"order=3", "order=5", NULL};

static const struct cs_integrator ark_erk = {
    ARKODE(erk_rows),
    .name = "ark-erk",
    .summary = "explicit Runge-Kutta of orders 2 to 8 with error control, by SUNDIALS ARKODE",
    .source = "Cash, Karp 1990 (order 5); Fehlberg 1968 (order 8); Reynolds et al. 2023",
    .order = 5,
    .order_damped = 5,
    .traits = CS_ADAPTIVE | CS_LIBRARY_BITS,
    .create = create_erk,
    .variants = erk_orders,
};

static const struct cs_integrator ark_dirk = {
    ARKODE(dirk_rows),
    .name = "ark-dirk",
    .summary =
        "diagonally implicit Runge-Kutta of orders 2 to 5 with error control, by SUNDIALS "
        "ARKODE",
    .source = "Kennedy, Carpenter 2016, 2019; Reynolds et al. 2023",
    .order = 4,
    .order_damped = 4,
    .needs = CS_NEED_JVP | CS_NEED_SOLVE,
    .traits = CS_IMPLICIT | CS_ADAPTIVE | CS_LIBRARY_BITS,
    .create = create_dirk,
    .variants = implicit_orders,
};

static const struct cs_integrator ark_imex = {
    ARKODE(imex_rows),
    .name = "ark-imex",
    .summary = "additive Runge-Kutta of orders 3 to 5, stiff forces implicit, the rest "
               "explicit, by SUNDIALS ARKODE",
    .source = "Kennedy, Carpenter 2003, 2019; Reynolds et al. 2023",
    .order = 4,
    .order_damped = 4,
    .needs = CS_NEED_JVP | CS_NEED_SOLVE,
    .traits = CS_IMPLICIT | CS_ADAPTIVE | CS_LIBRARY_BITS,
    .create = create_imex,
    .variants = implicit_orders,
};

static const struct cs_integrator *const integrators[] = {&ark_dirk, &ark_erk, &ark_imex};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};
