#include "sim/host.h"

#include "base/clock.h"
#include "model/contact.h"
#include "model/limit.h"
#include "model/measure.h"
#include "model/normals.h"
#include "model/terms.h"
#include "model/vector.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static double stage_begin(const struct cs_run_host *host) {
    return host->timed ? cs_clock_wall() : 0;
}

static void stage_end(struct cs_run_host *host, enum cs_stage stage, double begin) {
    if (host->timed)
        host->run->stage_seconds[stage] += cs_clock_wall() - begin;
}

static void *host_alloc(void *ctx, size_t bytes) {
    struct cs_run_host *host = ctx;
    if (!host->creating) {
        cs_fail(&host->error, CS_ERR_MODULE, "the method asked for memory outside create");
        return NULL;
    }
    return cs_arena_take(&host->arena, bytes, &host->error);
}

static enum cs_step host_fail(void *ctx, const char *format, ...) {
    struct cs_run_host *host = ctx;
    char message[512];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    cs_fail(&host->error, CS_ERR_MODULE, "%s", message);
    return CS_STEP_FAIL;
}

static void host_note(void *ctx, const char *format, ...) {
    struct cs_run *run = ((struct cs_run_host *)ctx)->run;
    char message[sizeof run->notes[0]];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    for (uint32_t k = 0; k < run->n_notes; k++)
        if (!strcmp(run->notes[k], message))
            return;
    if (run->n_notes < CS_NOTES_MAX)
        memcpy(run->notes[run->n_notes++], message, sizeof message);
}

/* ramps move on with every time that the method asks about */
static void move_values(struct cs_run_host *host, double t) {
    if (host->run->system->events)
        cs_events_move_values(host->run->system, t);
}

static void update_normals(struct cs_run_host *host, const double *x, uint32_t parts) {
    if (!cs_terms_need_normals(host->run->system, parts))
        return;
    const double begin = stage_begin(host);
    cs_normals_update(host->run->system, x);
    host->run->counts.normals++;
    stage_end(host, CS_STAGE_NORMALS, begin);
}

static void host_force(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                       double *f) {
    struct cs_run_host *host = ctx;
    move_values(host, t);
    update_normals(host, x, parts);
    const double begin = stage_begin(host);
    cs_terms_force(host->run->system, t, x, v, parts, f);
    host->run->counts.forces++;
    stage_end(host, CS_STAGE_FORCE, begin);
}

static double host_energy(void *ctx, double t, const double *x, const double *v) {
    struct cs_run_host *host = ctx;
    move_values(host, t);
    host->run->counts.energies++;
    const struct cs_energy energy = cs_measure_energy(host->run->system, x, v);
    return energy.kinetic + energy.elastic + energy.gravity;
}

static void host_jvp(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                     const double *dx, const double *dv, double *df) {
    struct cs_run_host *host = ctx;
    move_values(host, t);
    update_normals(host, x, parts);
    const double begin = stage_begin(host);
    cs_terms_jvp(host->run->system, t, x, v, parts, dx, dv, df);
    host->run->counts.jvps++;
    stage_end(host, CS_STAGE_FORCE, begin);
}

static void host_diagonal(void *ctx, double t, const double *x, const double *v, double *kxx,
                          double *dvv) {
    struct cs_run_host *host = ctx;
    (void)v;
    move_values(host, t);
    const double begin = stage_begin(host);
    cs_terms_diagonal(host->run->system, x, kxx, dvv);
    host->run->counts.diagonals++;
    stage_end(host, CS_STAGE_FORCE, begin);
}

/* an exact matrix that is not positive definite is made so, and that is counted */
static void clamp(struct cs_run_host *host) {
    struct cs_linear *linear = &host->linear;
    host->run->counts.clamped++;
    host->clamped = true;
    cs_linear_setup(linear, host->kept_x, linear->cm, linear->cd, linear->ck, true);
}

static enum cs_step host_solve_setup(void *ctx, double t, const double *x, const double *v,
                                     double cm, double cd, double ck, uint32_t flags) {
    struct cs_run_host *host = ctx;
    (void)v;
    move_values(host, t);
    if (!host->linear.system)
        return host_fail(ctx, "solve was used without CS_NEED_SOLVE");
    if (!(cm > 0) || !(cd <= 0) || !(ck <= 0))
        return host_fail(ctx, "solve wants cm > 0, cd <= 0 and ck <= 0, found %g, %g, %g", cm,
                         cd, ck);
    const double begin = stage_begin(host);
    host->run->counts.solve_setups++;
    host->clamped = flags & CS_SOLVE_PSD;
    memcpy(host->kept_x, x, 3 * sizeof *x * host->run->system->view.n);
    if (!cs_linear_setup(&host->linear, x, cm, cd, ck, host->clamped) && !host->clamped)
        clamp(host);
    stage_end(host, CS_STAGE_SOLVE, begin);
    return CS_STEP_OK;
}

static enum cs_step host_solve(void *ctx, const double *b, double rtol, double *u) {
    struct cs_run_host *host = ctx;
    uint64_t iterations;
    double residual = 0;
    if (!host->linear.system)
        return host_fail(ctx, "solve was used without CS_NEED_SOLVE");
    const double begin = stage_begin(host);
    host->run->counts.solves++;
    enum cs_linear_end end = cs_linear_solve(&host->linear, b, rtol, u, &iterations, &residual);
    host->run->counts.solve_iterations += iterations;
    if (end == CS_LINEAR_INDEFINITE && !host->clamped) {
        clamp(host);
        memset(u, 0, 3 * sizeof *u * host->run->system->view.n);
        end = cs_linear_solve(&host->linear, b, rtol, u, &iterations, &residual);
        host->run->counts.solve_iterations += iterations;
    }
    stage_end(host, CS_STAGE_SOLVE, begin);
    if (end == CS_LINEAR_LIMIT)
        return host_fail(
            ctx, "the linear solver stopped after %llu iterations at a residual of %.3g",
            (unsigned long long)iterations, residual);
    if (end == CS_LINEAR_INDEFINITE)
        return host_fail(ctx,
                         "the linear solver met a direction without stiffness: numbers out "
                         "of the range of doubles");
    return CS_STEP_OK;
}

static void host_apply(void *ctx, const double *p, double *y) {
    struct cs_run_host *host = ctx;
    const double begin = stage_begin(host);
    cs_linear_mul(&host->linear, p, y);
    host->run->counts.jvps++;
    stage_end(host, CS_STAGE_SOLVE, begin);
}

/* Kinetic energy that no passive system of this kind can reach by time t: a hundred times what
 * the start holds, what every spring would hold at twice its length, and what the outer forces
 * can give in free flight, sum m (|v| + a t)^2. */
static double blow_up_bound(const struct cs_run_host *host, double t) {
    return 100 * (host->bound_start + host->bound_speed +
                  host->bound_push * (t - host->bound_since) * (t - host->bound_since));
}

static void set_bound(struct cs_run_host *host) {
    const struct cs_system *system = host->run->system;
    const struct cs_forces *forces = &system->scene->forces;
    const size_t n = system->view.n;
    const double *x = system->state, *v = x + 3 * n, *g = forces->gravity;
    const double *a = system->events ? system->events->push : NULL;
    const struct cs_energy energy = cs_measure_energy(system, x, v);
    host->bound_start = energy.elastic + cs_springs_energy_at_twice(&system->springs);
    host->bound_speed = 2 * energy.kinetic;
    host->bound_push = 0;
    for (size_t i = 0; i < n; i++) {
        double push = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
        if (system->normals)
            push += forces->wind.strength * system->inv_mass[i] *
                    (forces->wind.strength_unit == CS_WIND_PA ? system->area[i] : 1);
        if (a)
            push += sqrt(a[i] * a[i] + a[n + i] * a[n + i] + a[2 * n + i] * a[2 * n + i]);
        host->bound_push += system->mass[i] * push * push;
    }
}

typedef double lanes __attribute__((vector_size(2 * sizeof(double))));

static inline lanes load(const double *from) {
    lanes out;
    memcpy(&out, from, sizeof out);
    return out;
}

/* Kinetic energy, and 0 or not a number by the places. In lanes: it runs after every step. */
static void watch(size_t n, const double *mass, const double *x, const double *v,
                  double *energy, double *places) {
    enum { LANES = sizeof(lanes) / sizeof(double) };
    // two sums of each, so that one addition need not wait for the one before
    lanes e[2] = {{0}}, p[2] = {{0}};
    size_t i = 0;
    for (; i + 2 * LANES <= n; i += 2 * LANES)
        for (size_t k = 0; k < 2; k++) {
            const size_t at = i + k * LANES;
            const lanes a = load(v + at), b = load(v + n + at), c = load(v + 2 * n + at);
            const lanes sum = load(x + at) + load(x + n + at) + load(x + 2 * n + at);
            e[k] += load(mass + at) * (a * a + b * b + c * c);
            p[k] += sum - sum;
        }
    *energy = e[0][0] + e[0][1] + e[1][0] + e[1][1];
    *places = p[0][0] + p[0][1] + p[1][0] + p[1][1];
    for (; i < n; i++) {
        const double sum = x[i] + x[n + i] + x[2 * n + i];
        *energy += mass[i] * (v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i]);
        *places += sum - sum;
    }
    *energy *= 0.5;
}

/* Kinetic energy decides: a number that is not finite anywhere makes it so. */
static bool has_blown_up(struct cs_run_host *host, double t, const double *x, const double *v) {
    struct cs_run *run = host->run;
    const size_t n = run->system->view.n;
    const double *mass = run->system->mass;
    double energy = 0, places = 0;
    watch(n, mass, x, v, &energy, &places);
    const double bound = blow_up_bound(host, t);
    if (places == 0 && energy <= bound)
        return false;

    uint32_t worst = 0;
    double fastest = -1;
    run->outcome = CS_UNBOUNDED;
    for (size_t i = 0; i < n && run->outcome == CS_UNBOUNDED; i++) {
        const double speed = v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i];
        const double place = x[i] + x[n + i] + x[2 * n + i];
        if (speed > fastest || !isfinite(speed + place)) {
            fastest = speed;
            worst = (uint32_t)i;
        }
        if (!isfinite(speed + place))
            run->outcome = CS_NOT_FINITE;
    }
    run->blow_up = (struct cs_blow_up){t, worst, energy, bound};
    return true;
}

static void limit_strain(struct cs_run_host *host, double dt, double *x, double *v,
                         bool *changed) {
    const double begin = stage_begin(host);
    const uint64_t moves = cs_limit_apply(host->run->system, dt, x, v);
    host->run->counts.limit_moves += moves;
    *changed |= moves > 0;
    stage_end(host, CS_STAGE_LIMIT, begin);
}

static void resolve_contact(struct cs_run_host *host, double *x, double *v, bool *changed) {
    const double begin = stage_begin(host);
    const struct cs_contact_counts counts = cs_contact_resolve(host->run->system, x, v);
    host->run->counts.contact_tests += counts.tests;
    host->run->counts.contacts += counts.pushed;
    *changed |= counts.pushed > 0;
    stage_end(host, CS_STAGE_CONTACT, begin);
}

static void lose_velocity(struct cs_run_host *host, double *v, bool *changed) {
    const double kept = 1 - host->run->system->scene->forces.velocity_loss;
    for (size_t i = 0; i < 3 * (size_t)host->run->system->view.n; i++)
        v[i] *= kept;
    *changed = true;
}

/* The clock of the process is a system call: it is read about once a millisecond. */
static bool is_over(struct cs_budget *budget) {
    enum { MOST_BETWEEN = 1024 };
    if (budget->end == 0 || ++budget->steps < budget->between)
        return false;
    const double now = cs_clock_wall();
    const bool seldom = now - budget->last > 1e-3;
    budget->between = seldom ? budget->between / 2 : budget->between * 2;
    budget->between = budget->between < 1              ? 1
                      : budget->between > MOST_BETWEEN ? MOST_BETWEEN
                                                       : budget->between;
    budget->last = now;
    budget->steps = 0;
    return cs_clock_cpu() > budget->end;
}

static enum cs_step host_commit(void *ctx, double t, double dt, double *x, double *v,
                                bool *changed) {
    struct cs_run_host *host = ctx;
    const struct cs_plan_row *rows = host->run->system->plan.rows;
    *changed = false;
    host->run->counts.steps++;
    move_values(host, t);
    if (rows[CS_FEATURE_STRAIN_LIMIT].built)
        limit_strain(host, dt, x, v, changed);
    if (rows[CS_FEATURE_CONTACT].built)
        resolve_contact(host, x, v, changed);
    if (rows[CS_FEATURE_VELOCITY_LOSS].built)
        lose_velocity(host, v, changed);
    if (rows[CS_FEATURE_EVENTS].built)
        cs_events_place(host->run->system, t, x, v);
    if (has_blown_up(host, t, x, v))
        return CS_STEP_HALT;
    if (host->stop && *host->stop) {
        host->run->outcome = CS_INTERRUPTED;
        return CS_STEP_HALT;
    }
    if (is_over(&host->budget)) {
        host->run->outcome = CS_OVER_BUDGET;
        return CS_STEP_HALT;
    }
    return CS_STEP_OK;
}

enum cs_status cs_run_host_init(struct cs_run_host *host, struct cs_run *run,
                                struct cs_error *error) {
    struct cs_system *system = run->system;
    host->run = run;
    host->calls = (struct cs_host){
        .size = sizeof host->calls,
        .ctx = host,
        .view = &system->view,
        .vector = &cs_vector_kernels,
        .alloc = host_alloc,
        .fail = host_fail,
        .note = host_note,
        .force = host_force,
        .energy = host_energy,
        .jvp = host_jvp,
        .diagonal = host_diagonal,
        .solve_setup = host_solve_setup,
        .solve = host_solve,
        .apply = host_apply,
        .commit = host_commit,
    };
    set_bound(host);
    if (!system->plan.rows[CS_FEATURE_SOLVER].built)
        return CS_OK;
    host->kept_x =
        cs_arena_take_n(&host->arena, 3 * (size_t)system->view.n, sizeof(double), error);
    return cs_linear_init(&host->linear, system, &host->arena, error);
}

void cs_run_host_apply_events(struct cs_run_host *host, double t) {
    struct cs_system *system = host->run->system;
    cs_events_apply(system, t);
    /* from the state that the event leaves, with the larger of what holds now and what ramps
     * come to; a grab may pull all particles along */
    set_bound(host);
    const double start = host->bound_start, push = host->bound_push;
    cs_events_move_values(system, system->events->end);
    set_bound(host);
    cs_events_move_values(system, t);
    host->bound_since = t;
    host->bound_start = fmax(host->bound_start, start);
    host->bound_push = fmax(host->bound_push, push);
    const double speed = cs_events_speed(system->events);
    for (size_t i = 0; i < system->view.n; i++)
        host->bound_speed += 2 * system->mass[i] * speed * speed;
}
