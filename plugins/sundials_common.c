/* sundials_common.c - context, right-hand side, messages, and the loop over steps of the
 * methods on SUNDIALS.
 *
 * The decisions of one step of sundials_advance, in order:
 * 1. Stop time: the end of the advance; earlier if contact by projection bounds the step
 *    (host->longest_step) and the library controls its steps. It is set again after every
 *    step then, and after every change of the state, because a restart can forget it.
 * 2. More than max_steps steps in the advance: the run fails.
 * 3. Save the state, if the host can refuse displacements, and let the library take one step.
 * 4. The step carries surfaces through each other: restore the saved state, restart the
 *    library there, and go to 1. The run fails if the step was shorter than 1/65536 of the
 *    advance, or if the library has steps of equal length, which would only be repeated.
 * 5. Commit. If it changed the state, tell the library: CVODE moves its history, the others
 *    restart.
 *
 * Contact by force is not among the refusals: error control sees it through the forces. */
#include "sundials_common.h"

#include "sundials_overstep.h"
#include "sundials_solver.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Messages of the library go to self->message, the last one counts, instead of to stderr. Since
 * version 7 the context has the handler, before each library has its own. */
#if SUNDIALS_VERSION_MAJOR >= 7
static void store_message(int line, const char *function, const char *file, const char *message,
                          SUNErrCode code, void *object, SUNContext context) {
    struct sundials *self = object;
    (void)line, (void)function, (void)file, (void)code, (void)context;
    strncpy(self->message, message, sizeof self->message - 1);
}

static bool open_context(struct sundials *self) {
    return !SUNContext_Create(SUN_COMM_NULL, &self->context) &&
           !SUNContext_ClearErrHandlers(self->context) &&
           !SUNContext_PushErrHandler(self->context, store_message, self);
}
#else
void sundials_keep_message(int code, const char *module, const char *function, char *message,
                           void *object) {
    struct sundials *self = object;
    (void)module, (void)function;
    // codes above 0 are warnings
    if (code <= 0)
        strncpy(self->message, message, sizeof self->message - 1);
}

static bool open_context(struct sundials *self) {
    return !SUNContext_Create(NULL, &self->context);
}
#endif

/* Turns forces into accelerations; true if one is NaN or infinite. Without a branch, for
 * vector units. */
CS_CLONES static bool accelerate(size_t n, const double *restrict inv_mass,
                                 double *restrict f) {
    int broken = 0;
    for (size_t i = 0; i < n; i++) {
        f[i] *= inv_mass[i];
        broken |= !(fabs(f[i]) <= DBL_MAX);
    }
    return broken;
}

int sundials_slope(const struct sundials *self, double t, N_Vector y, uint32_t parts,
                   bool moves, N_Vector slope) {
    const struct cs_host *host = self->host;
    const size_t n = host->view->n;
    const double *x = sundials_data(y), *v = x + 3 * n;
    double *dx = sundials_data(slope), *dv = dx + 3 * n;
    if (self->library->can_retry && sundials_passes_through(self, t, t, x))
        return 1;
    host->force(host->ctx, t, x, v, parts, dv);
    if (moves)
        memcpy(dx, v, 3 * n * sizeof *dx);
    else
        memset(dx, 0, 3 * n * sizeof *dx);
    bool broken = false;
    for (size_t c = 0; c < 3; c++)
        broken |= accelerate(n, host->view->inv_mass, dv + c * n);
    return broken;
}

int sundials_whole_slope(sunrealtype t, N_Vector y, N_Vector slope, void *object) {
    return sundials_slope(object, t, y, CS_PART_ALL, true, slope);
}

int sundials_weigh(N_Vector y, N_Vector weight, void *object) {
    const struct sundials *self = object;
    tolerance_weigh(&self->tolerance, 3 * (size_t)self->host->view->n, sundials_data(y),
                    sundials_data(y), sundials_data(weight));
    return 0;
}

enum cs_step sundials_restart(void *object, double t, const double *x, const double *v) {
    (void)v; // is x + 3n
    struct sundials *self = object;
    self->failed_solves = 0;
    if (self->interpolated)
        sundials_overstep_restart(self, t, x);
    else
        sundials_wrap(self->state, (double *)x);
    self->status = CS_STEP_OK;
    self->message[0] = 0;
    const int code = self->library->on_state_changed(self, t, 0);
    return code < 0 ? sundials_fail(self, code, t) : CS_STEP_OK;
}

/* Sets the stop time: t1, or earlier by host->longest_step if `limited`. A stop time holds
 * for the very next step, while a library applies a new maximal step length only one step
 * later. */
static int set_stop(const struct sundials *self, bool limited, double t, double t1,
                    const double *x) {
    const struct cs_host *host = self->host;
    const double *v = x + 3 * (size_t)host->view->n;
    const double most = limited ? host->longest_step(host->ctx, t, x, v) : HUGE_VAL;
    return self->library->set_stop(self->memory, most < t1 - t ? t + most : t1);
}

enum cs_step sundials_advance(void *object, double t0, double t1, double *x, double *v) {
    struct sundials *self = object;
    const struct cs_host *host = self->host;
    const struct sundials_library *library = self->library;
    self->status = CS_STEP_OK;
    self->message[0] = 0;
    if (self->interpolated)
        return sundials_overstep_advance(self, t0, t1, x, v);
    sundials_wrap(self->state, x);
    const bool limited = !self->equal_steps && CS_HAS(host, longest_step) && host->longest_step;
    int code = set_stop(self, limited, t0, t1, x);
    if (code < 0)
        return sundials_fail(self, code, t0);
    double t = t0;
    for (int64_t steps = 0; t < t1; steps++) {
        if (steps >= self->max_steps)
            return sundials_fail_by_count(self, t0, t);
        const double before = t;
        bool changed = false;
        code = sundials_try(self, t1, t1 - t0, x, &t);
        if (code >= 0 && t == before)
            code = set_stop(self, limited, before, t1, x);
        if (code < 0 || self->status != CS_STEP_OK)
            return sundials_fail(self, code, before);
        if (t == before)
            continue;
        const enum cs_step status = host->commit(host->ctx, t, t - before, x, v, &changed);
        if (status != CS_STEP_OK)
            return status;
        if (changed && (code = library->on_state_changed(self, t, t - before)) < 0)
            return sundials_fail(self, code, t);
        // with its history a library can forget where to stop
        if ((changed || limited) && t < t1 && (code = set_stop(self, limited, t, t1, x)) < 0)
            return sundials_fail(self, code, t);
    }
    return CS_STEP_OK;
}

enum cs_step sundials_open(struct sundials *self, const struct cs_host *host,
                           const struct sundials_library *library, int n_vectors,
                           const double *linear_rtol) {
    self->host = host;
    self->library = library;
    self->linear_rtol = linear_rtol ? *linear_rtol : 0;
    if (!open_context(self))
        return host->fail(host->ctx, "SUNDIALS made no context: out of memory");
    if (sundials_vectors_init(&self->vectors, host, n_vectors, self->context) != CS_STEP_OK)
        return CS_STEP_FAIL;
    self->state = sundials_vectors_acquire(&self->vectors);
    if (CS_HAS(host, max_step_fraction) && host->max_step_fraction &&
        !(self->y_before = host->alloc(host->ctx, 6 * sizeof(double) * host->view->n)))
        return CS_STEP_FAIL;
    return linear_rtol ? sundials_solver_init(self) : CS_STEP_OK;
}

void sundials_close(struct sundials *self) {
    if (self->context)
        SUNContext_Free(&self->context);
}
