#include "study/conform/conform_probe.h"

#include "base/options.h"
#include "model/force/measure.h"
#include "model/plan.h"
#include "model/system_build.h"
#include "sim/host.h"
#include "study/conform/conform_checks.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* no check needs more processor time in one run; a method that crawls is told so */
#define BUDGET 60

/* tight enough that what is measured is the method, loose enough to be reached in doubles */
#define INNER_RTOL 1e-12
#define ITERATIONS 200

bool cs_method_has(const struct cs_integrator *method, const char *name) {
    const struct cs_table table = {.rows = method->options, .n = method->n_options};
    const struct cs_option *row = cs_option_find(&table, name);
    return row && (row->type == CS_REAL || row->type == CS_INT);
}

bool cs_probe_set(struct cs_probe *probe, const char *name, double value) {
    if (!probe->options || !cs_method_has(probe->method, name))
        return false;
    const struct cs_option *row = cs_option_find(&probe->table, name);
    const double allowed = fmin(fmax(value, row->min), row->max);
    cs_option_set_number(row, probe->options, allowed, name, CS_ERR_USAGE, &probe->error);
    return true;
}

static void set_inner(struct cs_probe *probe) {
    cs_probe_set(probe, "linear_rtol", INNER_RTOL);
    cs_probe_set(probe, "newton_rtol", INNER_RTOL);
    // that method's order is a claim about its limit; others stand by their default
    if (probe->method->fidelity == CS_FIDELITY_IMPLICIT_EULER)
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

bool cs_probe_can_be_set(const struct cs_conform *card, struct cs_conform_row *row) {
    const bool adaptive = card->method->traits & CS_ADAPTIVE;
    if (cs_method_has(card->method, adaptive ? "rtol" : "dt"))
        return true;
    cs_row_skip(row, adaptive ? "it has no option rtol" : "it has no option dt");
    return false;
}

double cs_probe_set_level(struct cs_probe *probe, double h, double w, uint32_t order,
                          int level) {
    if (probe->method->traits & CS_ADAPTIVE) {
        const double rtol = level ? 1e-7 : 1e-5;
        cs_probe_set_tolerance(probe, rtol);
        return CS_TOLERANCE_FACTOR * rtol;
    }
    const double dt = level ? h / 8 : h;
    cs_probe_set_step(probe, dt);
    return pow(dt * w, order);
}

/* the method's defaults, then the card's "key=value,key=value" */
static enum cs_status fill(const struct cs_conform *card, const struct cs_table *table,
                           void *options, struct cs_error *error) {
    const char *settings = card->settings;
    cs_options_default(table, options);
    while (settings && *settings && !error->status) {
        char pair[256];
        const size_t length = strcspn(settings, ",");
        snprintf(pair, sizeof pair, "%.*s", (int)length, settings);
        char *equals = strchr(pair, '=');
        if (equals)
            *equals = 0;
        const struct cs_option *row = cs_option_find(table, pair);
        if (!equals)
            cs_fail(error, CS_ERR_USAGE, "found \"%s\", expected key=value", pair);
        else if (!row)
            cs_fail(error, CS_ERR_USAGE,
                    "integrator \"%s\" has no option \"%s\" (see: clothsim integrators %s)",
                    card->method->name, pair, card->method->name);
        else
            cs_option_set(row, options, equals + 1, pair, CS_ERR_USAGE, error);
        settings += length + (settings[length] == ',');
    }
    return error->status;
}

static struct cs_table table_of(const struct cs_integrator *method) {
    return (struct cs_table){
        .rows = method->options, .n = method->n_options, .size = method->options_size};
}

enum cs_status cs_probe_check_settings(const struct cs_conform *card, struct cs_error *error) {
    const struct cs_table table = table_of(card->method);
    void *options = calloc(1, table.size + 1);
    if (!options)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory");
    fill(card, &table, options, error);
    free(options);
    return error->status;
}

uint32_t cs_probe_order(const struct cs_conform *card, bool damped) {
    const struct cs_integrator *method = card->method;
    const struct cs_table table = table_of(method);
    const struct cs_option *row = cs_option_find(&table, "order");
    uint32_t order = damped ? method->order_damped : method->order;
    struct cs_error error = {0};
    char *options = row && row->type == CS_INT ? calloc(1, table.size) : NULL;
    if (options && !fill(card, &table, options, &error)) {
        int64_t asked;
        memcpy(&asked, options + row->offset, sizeof asked);
        order = (uint32_t)asked;
    }
    free(options);
    return order;
}

static void build(struct cs_probe *probe, const struct cs_conform *card, const char *text) {
    const struct cs_integrator *method = probe->method;
    const struct cs_conform defaults = {.method = method};
    // what is made for bodies that keep their shape gets the checks' body as such a one
    const struct cs_override matched = {"bodies[0].shape_matching.alpha", "0.5"};
    const bool matches = method->needs & CS_NEED_CLUSTERS;
    if (cs_scene_read_text(&probe->scene, "conform", text, strlen(text), &matched, matches,
                           &probe->error))
        return;
    probe->table = table_of(method);
    probe->options = calloc(1, probe->table.size + 1);
    if (!probe->options)
        cs_fail(&probe->error, CS_ERR_MEMORY, "out of memory");
    else if (!fill(method == card->method ? card : &defaults, &probe->table, probe->options,
                   &probe->error)) {
        cs_plan_make(&probe->plan, &probe->scene, method->needs, false);
        cs_system_build(&probe->system, &probe->scene, &probe->plan, &probe->error);
    }
}

bool cs_probe_open(struct cs_probe *probe, const struct cs_conform *card,
                   const struct cs_integrator *method, const char *format, ...) {
    char text[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    *probe = (struct cs_probe){.method = method};
    build(probe, card, text);
    probe->ended = probe->error.status;
    if (probe->ended)
        return false;
    probe->n = probe->system.view.n;
    probe->x = probe->system.state;
    probe->v = probe->x + 3 * probe->n;
    probe->frame = 1 / probe->scene.time.fps;
    return true;
}

void cs_probe_close(struct cs_probe *probe) {
    cs_run_finish(&probe->run);
    cs_system_finish(&probe->system);
    cs_scene_finish(&probe->scene);
    free(probe->options);
}

/* the host's commit, then the check's own look at the state */
static enum cs_step watched_commit(void *ctx, double t, double dt, double *x, double *v,
                                   bool *changed) {
    struct cs_run *run = ((struct cs_run_host *)ctx)->run;
    struct cs_probe *probe =
        (struct cs_probe *)(void *)((char *)run - offsetof(struct cs_probe, run));
    const enum cs_step step = probe->commit(ctx, t, dt, x, v, changed);
    if (probe->watch(probe, t, dt, x, v))
        *changed = true;
    return step;
}

static bool begin(struct cs_probe *probe) {
    if (cs_run_begin(&probe->run, &probe->system, probe->method, probe->options, false, NULL,
                     &probe->error))
        return false;
    cs_run_set_budget(&probe->run, BUDGET);
    if (probe->watch) {
        probe->commit = probe->run.host->calls.commit;
        probe->run.host->calls.commit = watched_commit;
    }
    return true;
}

bool cs_probe_run(struct cs_probe *probe, uint32_t frames) {
    if (!probe->ended && !probe->run.host)
        probe->ended = !begin(probe);
    for (uint32_t k = 0; k < frames && !probe->ended; k++) {
        if (!cs_run_frame(&probe->run, &probe->error) && probe->run.outcome != CS_RUNNING)
            cs_fail(&probe->error, CS_ERR_CHECK, "%s at t = %.6g s",
                    cs_outcome_text(probe->run.outcome), probe->run.blow_up.time);
        probe->ended = probe->error.status;
    }
    return !probe->ended;
}

double cs_probe_energy(const struct cs_probe *probe) {
    const struct cs_energy energy =
        cs_measure_energy(&probe->system, probe->run.t, probe->x, probe->v);
    return cs_energy_whole(&energy);
}

double cs_probe_rms(const double *a, const double *b, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(sum / (double)n);
}

void cs_probe_stir(struct cs_probe *probe, double place, double speed) {
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < probe->n; i++) {
            const double free = probe->system.inv_mass[i] > 0;
            const double phase = 1.7 * (double)i + 2.3 * (double)c;
            probe->x[c * probe->n + i] += free * place * sin(phase);
            probe->v[c * probe->n + i] += free * speed * cos(2.1 * phase);
        }
}
