/* Runs a small scene with one method for a check, at a given step or tolerance, and fills the
 * rows of a card. Of several figures a row keeps the most significant one. */
#include "conform/conform_checks.h"

#include "base/options.h"
#include "session/scene_view.h"
#include "session/session.h"
#include "study/stability_verdict.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *cs_verdict_text(enum cs_verdict verdict) {
    static const char *const texts[] = {
#define X(name, text) text,
        CS_VERDICT_LIST(X)
#undef X
    };
    return texts[verdict];
}

static void note(struct cs_conform_row *row, const char *format, va_list args) {
    vsnprintf(row->note, sizeof row->note, format, args);
}

/* Used fraction of the bound. A figure that fails with a bound of 0, or is NAN, uses HUGE_VAL;
 * a figure of 0 with a bound of 0 uses nothing. */
static double used(double figure, double bound) {
    return !(figure <= bound) ? (figure > bound && bound > 0 ? figure / bound : HUGE_VAL)
           : bound > 0        ? figure / bound
                              : 0;
}

void cs_row_state(struct cs_conform_row *row, double figure, double bound, const char *format,
                  ...) {
    // the first that fails is the plainest
    if (row->verdict == CS_VERDICT_FAIL)
        return;
    if (!isnan(row->bound) && used(figure, bound) <= used(row->figure, row->bound))
        return;
    row->figure = figure;
    row->bound = bound;
    row->verdict = figure <= bound ? CS_VERDICT_PASS : CS_VERDICT_FAIL;
    va_list args;
    va_start(args, format);
    note(row, format, args);
    va_end(args);
}

void cs_row_skip(struct cs_conform_row *row, const char *reason) {
    row->verdict = CS_VERDICT_NONE;
    snprintf(row->note, sizeof row->note, "%s", reason);
}

void cs_row_fail(struct cs_conform_row *row, const char *format, ...) {
    if (row->verdict == CS_VERDICT_FAIL)
        return;
    row->verdict = CS_VERDICT_FAIL;
    row->figure = row->bound = (double)NAN;
    va_list args;
    va_start(args, format);
    note(row, format, args);
    va_end(args);
}

/* s of processor time for one run; a slower method fails the check. */
#define BUDGET 60

/* Tolerance and iterations of inner solves: tight enough to leave the error of the method,
 * loose enough to be reachable in double precision. */
#define INNER_RTOL 1e-12
#define ITERATIONS 50

bool cs_method_has(const struct cs_integrator *method, const char *name) {
    const struct cs_table table = {.rows = method->options, .n = method->n_options};
    const struct cs_option *row = cs_option_find(&table, name);
    return row && (row->type == CS_REAL || row->type == CS_INT);
}

bool cs_probe_set(struct cs_probe *probe, const char *name, double value) {
    struct cs_method *method = &probe->session.method;
    if (!method->options || !cs_method_has(method->integrator, name))
        return false;
    const struct cs_option *row = cs_option_find(&method->table, name);
    const double allowed = fmin(fmax(value, row->min), row->max);
    cs_option_set_number(row, method->options, allowed, name, CS_ERR_USAGE, &probe->error);
    return true;
}

/* Sets the tolerances of inner solves. The iterations of an iteration-limited method are raised
 * only if it claims implicit Euler as its limit; other fidelities are tested with the default.
 */
static void set_inner(struct cs_probe *probe) {
    const struct cs_integrator *method = probe->session.method.integrator;
    cs_probe_set(probe, "linear_rtol", INNER_RTOL);
    cs_probe_set(probe, "newton_rtol", INNER_RTOL);
    // that method's order is a claim about its limit; others stand by their default
    if (method && method->fidelity == CS_FIDELITY_IMPLICIT_EULER)
        cs_probe_set(probe, "iterations", ITERATIONS);
}

void cs_probe_set_step(struct cs_probe *probe, double dt) {
    cs_probe_set(probe, "dt", dt);
    cs_probe_set(probe, "rtol", INNER_RTOL);
    set_inner(probe);
}

void cs_probe_set_tolerance(struct cs_probe *probe, double rtol) {
    cs_probe_set(probe, "rtol", rtol);
    set_inner(probe);
}

/* Sets an option `order` that is a choice to the claimed order, which is one digit: by its
 * default a method may take lower ones at loose tolerances. */
static void set_claimed_order(const struct cs_method *method) {
    const struct cs_option *row = cs_option_find(&method->table, "order");
    const char order[] = {(char)('0' + method->integrator->order), 0};
    struct cs_error ignored = {0};
    if (row && row->type == CS_CHOICE)
        cs_option_set_choice(row, method->options, order, row->name, CS_ERR_USAGE, &ignored);
}

void cs_probe_set_frames(struct cs_probe *probe, double dt) {
    cs_probe_set_step(probe, dt);
    if (!probe->session.method.options || cs_method_has(probe->session.method.integrator, "dt"))
        return;
    cs_probe_set(probe, "rtol", HUGE_VAL);
    cs_probe_set(probe, "atol", HUGE_VAL);
    set_claimed_order(&probe->session.method);
}

double cs_probe_tightest_tolerance(const struct cs_conform *conform) {
    return cs_conform_order(conform, true) > 2 ? 1e-11 : 1e-10;
}

bool cs_probe_can_be_set(const struct cs_conform *conform, struct cs_conform_row *row) {
    const bool adaptive = conform->method->traits & CS_ADAPTIVE;
    if (cs_method_has(conform->method, adaptive ? "rtol" : "dt"))
        return true;
    cs_row_skip(row, adaptive ? "it has no option rtol" : "it has no option dt");
    return false;
}

double cs_probe_set_level(struct cs_probe *probe, double h, double w, uint32_t order,
                          int level) {
    if (probe->session.method.integrator->traits & CS_ADAPTIVE) {
        const double rtol = level ? 1e-7 : 1e-5;
        cs_probe_set_tolerance(probe, rtol);
        return CS_TOLERANCE_FACTOR * rtol;
    }
    const double dt = level ? h / 8 : h;
    cs_probe_set_step(probe, dt);
    return pow(dt * w, order);
}

/* Passes each commit on to the check's callback. */
static bool observe(void *ctx, double t, double dt, double *x, double *v) {
    struct cs_probe *probe = ctx;
    return probe->on_commit && probe->on_commit(probe, t, dt, x, v);
}

/* Notes which calls of the host the method makes. */
static void note_call(void *ctx, const struct cs_trace_record *record) {
    struct cs_probe *probe = ctx;
    probe->asks_step_fraction |= !strcmp(record->phase, "longest move");
}

bool cs_probe_open(struct cs_probe *probe, const struct cs_conform *conform,
                   const struct cs_integrator *method, const char *format, ...) {
    *probe = (struct cs_probe){.card_error = conform->card_error,
                               .trace = {.emit = note_call, .ctx = probe}};
    va_list args;
    va_start(args, format);
    vsnprintf(probe->text, sizeof probe->text, format, args);
    va_end(args);
    // what is made for bodies that keep their shape gets the checks' body as such a one
    const struct cs_override matched = {"bodies[0].shape_matching.alpha", "0.5"};
    const struct cs_session_settings settings = {
        .scene = "conform",
        .text = probe->text,
        .overrides = &matched,
        .n_overrides = method->needs & CS_NEED_CLUSTERS ? 1 : 0,
        .method = method,
        .options = method == conform->method ? conform->options : NULL,
        .run = {.skip_advance_check = true,
                .budget = BUDGET,
                .stop = conform->stop,
                .after_commit = observe,
                .trace = &probe->trace,
                .ctx = probe}};
    probe->has_ended = cs_session_open_system(&probe->session, &settings, &probe->error);
    if (probe->has_ended)
        return false;
    if (method->traits & CS_SMOOTH_ONLY &&
        cs_plan_check(probe->session.scene, method, &probe->error)) {
        *conform->refused = probe->has_ended = true;
        return false;
    }
    probe->n = probe->session.system.view.n;
    probe->x = probe->session.system.state;
    probe->v = probe->x + 3 * probe->n;
    probe->frame = 1 / probe->session.scene->time.fps;
    return true;
}

void cs_probe_close(struct cs_probe *probe) {
    if (probe->error.status == CS_ERR_MEMORY && probe->card_error)
        cs_fail(probe->card_error, CS_ERR_MEMORY, "%s", probe->error.message);
    if (probe->session.run.outcome == CS_INTERRUPTED && probe->card_error)
        cs_fail(probe->card_error, CS_ERR_INTERRUPT, "interrupted");
    cs_session_close(&probe->session);
}

/* Says how the run ended; where a force is singular, that it is not the method's fault. */
static void name_end(struct cs_probe *probe) {
    const struct cs_run *run = &probe->session.run;
    const double end = run->reason ? run->t : run->blow_up.time;
    const struct cs_session_settings settings = {
        .scene = "conform", .text = probe->text, .run.budget = BUDGET};
    struct cs_singular_force cause = {.text = ""};
    struct cs_error ignored = {0};
    if (cs_outcome_is_blow_up(run->outcome) || run->outcome == CS_GAVE_UP)
        cs_singular_force_find(&settings, end + probe->frame, 4.0 * (double)run->counts.forces,
                               &cause, &ignored);
    cs_fail(&probe->error, CS_ERR_CHECK, "%s at t = %.6g s%s%s%s%s",
            cs_outcome_text(run->outcome), end, run->reason ? ": " : "",
            run->reason ? run->reason : "", *cause.text ? "; " : "", cause.text);
}

bool cs_probe_run(struct cs_probe *probe, uint32_t frames) {
    struct cs_run *run = &probe->session.run;
    if (!probe->has_ended && !run->host)
        probe->has_ended = cs_session_begin(&probe->session, NULL, &probe->error);
    struct cs_follow follow = {.run = run, .last = run->frame + frames};
    if (!probe->has_ended)
        cs_follow_next(&follow, &probe->error);
    if (run->outcome != CS_RUNNING)
        name_end(probe);
    probe->has_ended = probe->error.status;
    return !probe->has_ended;
}

double cs_probe_energy(const struct cs_probe *probe) {
    const struct cs_energy energy =
        cs_diagnostics_energy(&probe->session.system, probe->session.run.t, probe->x, probe->v);
    return cs_energy_total(&energy);
}

void cs_extrapolate(double *states, int levels, size_t stride, size_t n, uint32_t order) {
    for (int column = 1; column < levels; column++) {
        const double power = ldexp(1, (int)order + column - 1);
        for (int k = levels - 1; k >= column; k--) {
            double *state = states + (size_t)k * stride;
            const double *coarser = state - stride;
            for (size_t i = 0; i < n; i++)
                state[i] += (state[i] - coarser[i]) / (power - 1);
        }
    }
}
