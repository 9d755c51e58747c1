/* Times whole steps, through the same calls into a module that a run makes. */
#include "child.h"
#include "limits.h"
#include "sheet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* steps in one call of an explicit method: its start is not to count */
enum { EXPLICIT_STEPS = 20, CASES_MAX = 8 };

/* One method on one sheet. */
struct stepping {
    struct cs_session session;
    double *kept; /* 6n: the state that each call starts from; owned */
    double time;  /* s that a call advances by */
    struct cs_error error;
};

static void advance(void *object) {
    struct stepping *stepping = object;
    bench_sheet_advance(&stepping->session.run, stepping->kept, stepping->time,
                        &stepping->error);
}

struct method_case {
    const char *method;
    uint32_t r;
    double stiffness, h; /* h 0: the model's own for explicit methods */
    uint32_t steps;      /* in what is timed as one */
    bool slow;
};

#define FRAME (1 / 60.0)
static const struct method_case cases[] = {
    {"symplectic-euler", 16, 1e4, 0, 1, false},
    {"velocity-verlet", 16, 1e4, 0, 1, false},
    {"rk4", 16, 1e4, 0, 1, false},
    {"symplectic-euler", 64, 1e4, 0, 1, false},
    {"velocity-verlet", 64, 1e4, 0, 1, false},
    {"rk4", 64, 1e4, 0, 1, false},
    {"symplectic-euler", 0, 1e4, 0, 1, false},
    {"velocity-verlet", 0, 1e4, 0, 1, false},
    {"rk4", 0, 1e4, 0, 1, false},
    {"symplectic-euler", 256, 1e4, 0, 1, true},
    {"velocity-verlet", 256, 1e4, 0, 1, true},
    {"rk4", 256, 1e4, 0, 1, true},
    {"symplectic-euler", 1000, 1e4, 0, 1, true},
    {"velocity-verlet", 1000, 1e4, 0, 1, true},
    {"rk4", 1000, 1e4, 0, 1, true},
    {"implicit-block", 64, 1e4, FRAME / 10, 10, false},
    {"xpbd:iterations=20", 64, 1e4, FRAME, 1, false},
    {"vbd:iterations=20", 64, 1e4, FRAME, 1, false},
    {"implicit-linearised", 16, 1e4, FRAME, 1, false},
    {"implicit-linearised", 64, 1e2, FRAME, 1, false},
    {"implicit-linearised", 64, 1e4, FRAME, 1, true},
    {"implicit-linearised", 64, 1e6, FRAME, 1, true},
    {"implicit-linearised", 64, 1e8, FRAME, 1, true},
    {"implicit-linearised", 0, 1e4, FRAME, 1, false},
    {"implicit-linearised", 256, 1e4, FRAME, 1, true},
};
enum { CASES = sizeof cases / sizeof *cases };

static double step_of(const struct method_case *one, const struct bench_model *model) {
    return one->h > 0 ? one->h : bench_model_step(model);
}

static uint32_t steps_of(const struct method_case *one) {
    return one->h > 0 ? one->steps : EXPLICIT_STEPS;
}

static enum cs_status open_case(struct stepping *stepping, const struct method_case *one,
                                const struct bench_settings *settings, struct cs_error *error) {
    const struct bench_model model = {.r = one->r, .stiffness = one->stiffness, .fps = 60};
    const double h = step_of(one, &model);
    char method[96];
    snprintf(method, sizeof method, "%s%cdt=%.17g", one->method,
             strchr(one->method, ':') ? ',' : ':', h);
    struct cs_session *session = &stepping->session;
    if (bench_sheet_open(session, settings, &model, method, 0, error))
        return error->status;
    const size_t bytes = 6 * sizeof *stepping->kept * session->system.view.n;
    bench_sheet_perturb(&session->system);
    stepping->kept = malloc(bytes);
    if (!stepping->kept)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a state of %zu bytes", bytes);
    memcpy(stepping->kept, session->system.state, bytes);
    stepping->time = h * steps_of(one);
    return cs_session_begin(session, NULL, error);
}

static void close_case(struct stepping *stepping) {
    cs_session_close(&stepping->session);
    free(stepping->kept);
}

/* Calls of the force and iterations of a solve are exact, whatever the number of calls. The
 * limit of a method that neither solves nor iterates is that of its forces: the divider. */
static void add_row(const struct method_case *one, const struct stepping *stepping,
                    const struct bench_task *task, double divide_ns,
                    struct bench_table *table) {
    const struct bench_model model = {.r = one->r, .stiffness = one->stiffness};
    const struct cs_counts *counts = &stepping->session.run.counts;
    /* explicit steps are timed in twenties, but a row is about one unit of the case */
    const double units = (double)steps_of(one) / one->steps, ms = 1e3 / units;
    const struct cs_system *system = &stepping->session.system;
    const double ns = 1e9 * task->time.median / steps_of(one) / system->view.n;
    const double forces = (double)counts->forces / (double)counts->steps;
    const double least = forces * divide_ns * system->springs.n / system->view.n;
    char name[16], iterations[32] = "", to_limit[32] = "";
    bench_model_name(&model, name);
    if (counts->solves)
        snprintf(iterations, sizeof iterations, "%.1f",
                 (double)counts->solve_iterations / (double)counts->solves);
    else if (!strchr(one->method, ':'))
        snprintf(to_limit, sizeof to_limit, "%.2f", ns / least);
    bench_table_add(table, "%s,%s,%g,%.4g,%u,%.4f,%.4f,%.4f,%.2f,%.2f,%s,%s,", one->method,
                    name, one->stiffness, step_of(one, &model), one->steps,
                    ms * task->time.median, ms * task->time.min, ms * task->time.max, ns,
                    forces, to_limit, iterations);
}

/* Measures some cases in turns. */
static enum cs_status measure(const struct bench_settings *settings,
                              const struct method_case *first, uint32_t n,
                              struct bench_table *table, struct cs_error *error) {
    struct stepping steppings[CASES_MAX] = {0};
    struct bench_task tasks[CASES_MAX + 1];
    struct bench_loop loop;
    bench_loop_init(&loop, BENCH_LOOP_BYTES, error);
    for (uint32_t k = 0; k < n && !error->status; k++) {
        open_case(steppings + k, first + k, settings, error);
        tasks[k] = (struct bench_task){.run = advance, .object = steppings + k};
    }
    /* the divider in turn with the cases, so that the same machine is seen by both */
    tasks[n] = (struct bench_task){.run = bench_sqrt_divide, .object = &loop};
    if (!error->status)
        bench_measure(settings, tasks, n + 1);
    for (uint32_t k = 0; k < n && !error->status; k++) {
        const struct stepping *stepping = steppings + k;
        const enum cs_outcome outcome = stepping->session.run.outcome;
        if (stepping->error.status || outcome != CS_RUNNING)
            cs_fail(error, CS_ERR_MODULE, "%s on sheet %u: %s", first[k].method, first[k].r,
                    stepping->error.status ? stepping->error.message
                                           : cs_outcome_text(outcome));
        else
            add_row(first + k, stepping, tasks + k, bench_loop_ns(tasks + n), table);
    }
    for (uint32_t k = 0; k < n; k++)
        close_case(steppings + k);
    bench_loop_finish(&loop);
    return error->status;
}

/* One step of a million particles in a program of its own: its memory is then the whole
 * program's. The start, stretched and with a bump, is what a scene can say. */
static enum cs_status million(const struct bench_settings *settings, struct bench_table *table,
                              struct cs_error *error) {
    const struct bench_model model = {.r = 1000, .stiffness = 1e4, .fps = 60};
    struct cs_session session;
    struct bench_run run;
    bench_report("implicit-linearised, a million particles (minutes)");
    /* writes the scene; the program opens it for itself */
    if (bench_sheet_open(&session, settings, &model, "implicit-linearised", 0, error))
        return error->status;
    const double particles = session.system.view.n;
    cs_session_close(&session);
    const char *const arguments[] = {"--integrator",
                                     "implicit-linearised:dt=frame",
                                     "--set",
                                     "bodies[0].cloth.stretch=[1.02,0.99]",
                                     "--set",
                                     "bodies[0].cloth.bump=0.02",
                                     "--no-render",
                                     "--frames",
                                     "1",
                                     NULL};
    if (bench_program_run(&run, settings, "scene.json", arguments, error))
        return error->status;
    /* one thread: of the processor, for all that the program does */
    const double ms = 1e3 * (settings->threads > 1 ? bench_run_number(&run, "seconds", "method")
                                                   : run.usage.cpu);
    bench_table_add(table, "implicit-linearised,1000,10000,%.4g,1,%.1f,,,%.1f,%.2f,,%.0f,%.0f",
                    FRAME, ms, 1e6 * ms / particles, bench_run_number(&run, "counts", "forces"),
                    bench_run_number(&run, "counts", "solve_iterations"), run.usage.peak_mib);
    bench_run_finish(&run);
    return error->status;
}

/* Cases that stand side by side in the table are measured in turns: those of one sheet. */
static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    for (uint32_t k = 0, n; k < CASES && !error->status; k += n) {
        n = 1;
        while (k + n < CASES && n < CASES_MAX && cases[k + n].r == cases[k].r &&
               cases[k + n].slow == cases[k].slow)
            n++;
        if (cases[k].slow && settings->quick)
            continue;
        char name[16];
        bench_model_name(&(struct bench_model){.r = cases[k].r}, name);
        bench_report("sheet %s, from %s on", name, cases[k].method);
        measure(settings, cases + k, n, table, error);
    }
    return error->status || settings->quick ? error->status : million(settings, table, error);
}

static const char *const columns[] = {
    "method", "sheet",       "stiffness", "h",        "steps",      "median_ms", "min_ms",
    "max_ms", "ns_particle", "forces",    "to_limit", "iterations", "peak_mib",  NULL};
const struct bench_section bench_steps = {
    .name = "steps",
    .summary = "ms of whole steps, and ns a particle and step",
    .columns = columns,
    .n_keys = 5,
    .measured = "median_ms",
    .run = run,
};
