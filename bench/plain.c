/* The explicit step beside a peer: what a person with an afternoon would write in C, each
 * spring once, a row moved as soon as its springs are summed, compiled for the same processors.
 *
 * Both make the same steps in turns, and their states must agree but for rounding. */
#include "sheet.h"
#include "timing.h"

#include <clothsim/clones.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Springs that are alike, of one row of a sheet: a + i to b + i. */
struct row_springs {
    size_t a, b, count;
    double stiffness, damping, length; /* N/m, N s/m, m */
};

/* A sheet under gravity that steps by symplectic Euler: each spring once, row by row, and a
 * row moves as soon as its springs are summed. Arrays are (3,n) and not owned. */
struct plain_sheet {
    const struct row_springs *springs; /* (n_springs) by rows of a; none leads upwards */
    uint32_t n_springs, columns;
    size_t n;
    double *x, *v, *f;      /* m, m/s, N; f is zero between steps */
    const double *inv_mass; /* (n) 1/kg, 0: held */
    double *results;        /* (3, columns) N, of one row of springs */
    double gravity, step;   /* m/s2 along y, s */
};

/* Forces of a row of springs on their first ends. */
CS_INLINE void compute(const struct plain_sheet *s, const struct row_springs *row,
                       double *restrict out) {
    const size_t n = s->n, m = s->columns;
    const double *restrict xa = s->x + row->a, *restrict xb = s->x + row->b;
    const double *restrict va = s->v + row->a, *restrict vb = s->v + row->b;
    const double k = row->stiffness, c = row->damping, length = row->length;
    for (size_t i = 0; i < row->count; i++) {
        const double dx = xb[i] - xa[i], dy = xb[i + n] - xa[i + n],
                     dz = xb[i + 2 * n] - xa[i + 2 * n];
        const double ux = vb[i] - va[i], uy = vb[i + n] - va[i + n],
                     uz = vb[i + 2 * n] - va[i + 2 * n];
        const double inverse = 1 / sqrt(dx * dx + dy * dy + dz * dz);
        const double rate = (ux * dx + uy * dy + uz * dz) * inverse;
        const double scale = k - (k * length - c * rate) * inverse;
        out[i] = scale * dx;
        out[i + m] = scale * dy;
        out[i + 2 * m] = scale * dz;
    }
}

CS_INLINE void add(const struct plain_sheet *s, const struct row_springs *row,
                   const double *restrict results) {
    for (size_t axis = 0; axis < 3; axis++) {
        const double *restrict from = results + axis * s->columns;
        double *restrict to = s->f + axis * s->n;
        for (size_t i = 0; i < row->count; i++)
            to[row->a + i] += from[i];
        for (size_t i = 0; i < row->count; i++)
            to[row->b + i] -= from[i];
    }
}

CS_INLINE void move(const struct plain_sheet *s, size_t first) {
    const double *restrict inv_mass = s->inv_mass + first;
    for (size_t axis = 0; axis < 3; axis++) {
        double *restrict x = s->x + axis * s->n + first,
                         *restrict v = s->v + axis * s->n + first,
                         *restrict f = s->f + axis * s->n + first;
        const double gravity = axis == 1 ? s->gravity : 0;
        for (size_t i = 0; i < s->columns; i++) {
            v[i] += inv_mass[i] > 0 ? s->step * (f[i] * inv_mass[i] + gravity) : 0;
            x[i] += s->step * v[i];
            f[i] = 0;
        }
    }
}

CS_CLONES static void step_plain(const struct plain_sheet *sheet) {
    uint32_t k = 0;
    for (size_t first = 0; first < sheet->n; first += sheet->columns) {
        for (; k < sheet->n_springs && sheet->springs[k].a < first + sheet->columns; k++) {
            compute(sheet, sheet->springs + k, sheet->results);
            add(sheet, sheet->springs + k, sheet->results);
        }
        move(sheet, first);
    }
}

/* The same sheet both ways, from the same start. */
struct contest {
    struct cs_session session;
    struct plain_sheet plain;
    struct row_springs *springs;
    double *start, *room; /* (6n) state of the start; (10n) of the peer */
    double time;          /* s that both advance by */
    struct cs_error error;
};

/* steps in one call */
enum { STEPS = 20 };

static void advance_clothsim(void *object) {
    struct contest *contest = object;
    bench_sheet_advance(&contest->session.run, contest->start, contest->time, &contest->error);
}

static void advance_plain(void *object) {
    const struct contest *contest = object;
    memcpy(contest->plain.x, contest->start, 6 * sizeof(double) * contest->plain.n);
    for (uint32_t s = 0; s < STEPS; s++)
        step_plain(&contest->plain);
}

static enum cs_status make_plain(struct contest *contest, double h) {
    const struct cs_system *system = &contest->session.system;
    const size_t n = system->view.n;
    const struct cs_springs *springs = &system->springs;
    contest->start = malloc(6 * sizeof(double) * n);
    contest->room = calloc(10 * n, sizeof(double));
    contest->springs = malloc(sizeof *contest->springs * springs->n_runs);
    if (!contest->start || !contest->room || !contest->springs)
        return cs_fail(&contest->error, CS_ERR_MEMORY, "out of memory for a peer's sheet");
    memcpy(contest->start, system->state, 6 * sizeof(double) * n);
    // a grid's runs go row by row, each of springs that are alike
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        contest->springs[r] = (struct row_springs){.a = run->first_a,
                                                   .b = run->first_b,
                                                   .count = run->count,
                                                   .stiffness = run->stiffness,
                                                   .damping = run->damping,
                                                   .length = run->length};
    }
    contest->plain = (struct plain_sheet){.springs = contest->springs,
                                          .n_springs = springs->n_runs,
                                          .columns = springs->runs[0].columns,
                                          .n = n,
                                          .x = contest->room,
                                          .v = contest->room + 3 * n,
                                          .f = contest->room + 6 * n,
                                          .inv_mass = system->inv_mass,
                                          .results = contest->room + 9 * n,
                                          .gravity = -9.81, // as scenes have it; agree tells
                                          .step = h};
    return CS_OK;
}

/* Fails where the two states are apart by more than rounding. */
static enum cs_status agree(struct contest *contest) {
    const struct plain_sheet *plain = &contest->plain;
    const double *x = contest->session.run.x;
    double apart = 0;
    advance_clothsim(contest);
    advance_plain(contest);
    for (size_t i = 0; i < 3 * plain->n; i++)
        apart = fmax(apart, fabs(x[i] - plain->x[i]));
    if (!contest->error.status && !(apart < 1e-12))
        cs_fail(&contest->error, CS_ERR_MODULE, "sheet %u: %g m apart from the peer's",
                plain->columns, apart);
    return contest->error.status;
}

static void compare(const struct bench_settings *settings, uint32_t r,
                    struct bench_table *table, struct cs_error *error) {
    struct contest contest = {0};
    const struct bench_model model = {.r = r, .stiffness = 1e4, .fps = 60};
    const double h = bench_model_step(&model);
    char method[64];
    snprintf(method, sizeof method, "symplectic-euler:dt=%.17g", h);
    contest.time = STEPS * h;
    if (!bench_sheet_open(&contest.session, settings, &model, method, 0, &contest.error)) {
        bench_sheet_perturb(&contest.session.system);
        if (!make_plain(&contest, h) &&
            !cs_session_begin(&contest.session, NULL, &contest.error) && !agree(&contest)) {
            // the peer first: the ratio tells how many times as fast clothsim is
            struct bench_task tasks[] = {{.run = advance_plain, .object = &contest},
                                         {.run = advance_clothsim, .object = &contest}};
            bench_measure(settings, tasks, 2);
            const double ns = 1e9 / STEPS / (double)contest.plain.n;
            bench_table_add(table, "%u,%.2f,%.2f,%.2f,%.2f,%.2f", r, ns * tasks[0].time.median,
                            ns * tasks[1].time.median, ns * tasks[1].time.min,
                            ns * tasks[1].time.max,
                            tasks[0].time.median / tasks[1].time.median);
        }
        cs_session_close(&contest.session);
    }
    *error = contest.error;
    free(contest.springs);
    free(contest.room);
    free(contest.start);
}

static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    static const uint32_t sizes[] = {16, 64, 256, 1000};
    for (uint32_t s = 0; s < sizeof sizes / sizeof *sizes && !error->status; s++)
        if (sizes[s] <= 64 || !settings->quick) {
            bench_report("sheet %u beside a loop in plain C", sizes[s]);
            compare(settings, sizes[s], table, error);
        }
    return error->status;
}

static const char *const columns[] = {"sheet",  "plain_ns", "median_ns", "min_ns",
                                      "max_ns", "ratio",    NULL};
const struct bench_section bench_plain = {
    .name = "plain",
    .summary = "ns a particle and step of an explicit method, beside a loop in plain C",
    .columns = columns,
    .n_keys = 1,
    .measured = "median_ns",
    .run = run,
};
