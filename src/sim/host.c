/* host.c - the model's functions as the calls of a method: checked, timed and counted.
 *
 * Every call follows one pattern: move ramped values to the time asked for, start the clock
 * of its stage, call the model, count, stop the clock, trace arguments and results. Neither
 * clock nor trace reaches a number that the method sees. */
#include "base/vector.h"
#include "model/contact/ccd/step_limit.h"
#include "model/contact/lagged_friction.h"
#include "model/contact/rebound.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "sim/energy_ledger.h"
#include "sim/run_host.h"

#include <math.h>
#include <string.h>

/* Memory of the run, in create alone: no step allocates. */
static void *host_alloc(void *ctx, size_t bytes) {
    struct cs_run_host *host = ctx;
    if (!host->creating) {
        cs_fail(&host->error, CS_ERR_MODULE, "the method allocated memory outside create");
        return NULL;
    }
    return cs_arena_alloc(&host->arena, bytes, &host->error);
}

/* Stores the first message, with the pair that blocked the last rejected step, if any. */
static enum cs_step host_fail(void *ctx, const char *format, ...) {
    struct cs_run_host *host = ctx;
    char message[512];
    CS_FORMAT(message, format);
    struct cs_text where = {0};
    if (host->blocked_step.is_set)
        cs_blocked_step_print(&host->blocked_step, host->run->system, &where);
    cs_fail(&host->error, CS_ERR_MODULE, "%s%s", message, cs_text_get(&where));
    cs_text_finish(&where);
    return CS_STEP_FAIL;
}

/* Adds a remark, unless it is there already or there is no room. */
static void host_note(void *ctx, const char *format, ...) {
    struct cs_run *run = ((struct cs_run_host *)ctx)->run;
    char message[sizeof run->notes[0]];
    CS_FORMAT(message, format);
    for (uint32_t k = 0; k < run->n_notes; k++)
        if (!strcmp(run->notes[k], message))
            return;
    if (run->n_notes < CS_NOTES_MAX)
        memcpy(run->notes[run->n_notes++], message, sizeof message);
}

/* Normals of x, if one of the parts needs them (wind). */
static void update_normals(struct cs_run_host *host, const double *x, uint32_t parts) {
    if (!cs_terms_need_normals(host->run->system, parts))
        return;
    const struct cs_stage_start begin = cs_stage_begin(host);
    cs_normals_update(host->run->system, x);
    host->run->counts.normals++;
    cs_stage_end(host, CS_STAGE_NORMALS, begin);
}

/* f = the chosen parts at (t, x, v). */
static void host_force(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                       double *f) {
    struct cs_run_host *host = ctx;
    cs_host_state_at(host, t, &x, &v);
    update_normals(host, x, parts);
    const struct cs_stage_start begin = cs_stage_begin(host);
    const struct cs_eval at = cs_energy_input_eval(host, t, x, v, parts);
    cs_terms_force_then(host->run->system, &at, f, host->loop);
    host->run->counts.forces++;
    cs_stage_end(host, CS_STAGE_FORCE, begin);
    cs_trace_state(host, "force", t, x, v);
    cs_trace_vector(host, "force", "f", t, f);
}

/* host_force of all parts and a loop after it, timed with it; not in traced runs. */
static void host_force_then(void *ctx, double t, const double *x, const double *v, double *f,
                            const struct cs_loop *loop) {
    struct cs_run_host *host = ctx;
    host->loop = loop;
    host_force(ctx, t, x, v, CS_PART_ALL, f);
    host->loop = NULL;
}

/* Kinetic and potential energy in J at (t, x, v). */
static double host_energy(void *ctx, double t, const double *x, const double *v) {
    struct cs_run_host *host = ctx;
    cs_host_state_at(host, t, &x, &v);
    host->run->counts.energies++;
    const struct cs_energy energy = cs_diagnostics_energy(host->run->system, t, x, v);
    cs_trace_state(host, "energy", t, x, v);
    cs_trace_number(host, "energy", "E", t, cs_energy_total(&energy));
    return cs_energy_total(&energy);
}

/* df = (df/dx) dx + (df/dv) dv at (t, x, v). */
static void host_jvp(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                     const double *dx, const double *dv, double *df) {
    struct cs_run_host *host = ctx;
    cs_host_state_at(host, t, &x, &v);
    update_normals(host, x, parts);
    const struct cs_stage_start begin = cs_stage_begin(host);
    const struct cs_eval at = {.t = t, .x = x, .v = v, .parts = parts, .dx = dx, .dv = dv};
    cs_terms_jvp(host->run->system, &at, df);
    host->run->counts.jvps++;
    cs_stage_end(host, CS_STAGE_FORCE, begin);
    cs_trace_vector(host, "force derivative", "dx", t, dx);
    cs_trace_vector(host, "force derivative", "dv", t, dv);
    cs_trace_vector(host, "force derivative", "df", t, df);
}

/* The 3x3 diagonal blocks of the derivatives at (t, x, v). */
static void host_diagonal(void *ctx, double t, const double *x, const double *v, double *kxx,
                          double *dvv) {
    struct cs_run_host *host = ctx;
    cs_host_state_at(host, t, &x, &v);
    const struct cs_stage_start begin = cs_stage_begin(host);
    const struct cs_eval at = {.t = t, .x = x, .v = v, .parts = CS_PART_LINEARISED};
    cs_terms_diagonal(host->run->system, &at, kxx, dvv);
    host->run->counts.diagonals++;
    cs_stage_end(host, CS_STAGE_FORCE, begin);
}

/* host_force of all parts and host_diagonal in one pass over the springs; blocks (12,n) is
 * kxx, then dvv. */
static void host_force_diagonal(void *ctx, double t, const double *x, const double *v,
                                double *f, double *blocks) {
    struct cs_run_host *host = ctx;
    cs_host_state_at(host, t, &x, &v);
    update_normals(host, x, CS_PART_ALL);
    const struct cs_stage_start begin = cs_stage_begin(host);
    const struct cs_eval at = cs_energy_input_eval(host, t, x, v, CS_PART_ALL);
    cs_terms_force_diagonal(host->run->system, &at, f, blocks);
    host->run->counts.forces++;
    host->run->counts.diagonals++;
    cs_stage_end(host, CS_STAGE_FORCE, begin);
    cs_trace_state(host, "force", t, x, v);
    cs_trace_vector(host, "force", "f", t, f);
}

/* The solver that methods call. Fails at the iteration limit, if a clamped A is still
 * indefinite, or if a number is not finite. Ends a run of studies that is over budget: a step
 * may take many solves. */
static enum cs_step host_solve(void *ctx, const double *b, double rtol, double *u) {
    struct cs_run_host *host = ctx;
    struct cs_solve_result result = {0};
    if (!host->linear.system)
        return host_fail(ctx, "solve was used without CS_NEED_SOLVE");
    if (cs_run_host_end_over_budget(host))
        return CS_STEP_HALT;
    const struct cs_stage_start begin = cs_stage_begin(host);
    host->run->counts.solves++;
    const enum cs_linear_end end = cs_host_solve_settled(host, b, rtol, u, &result);
    cs_stage_end(host, CS_STAGE_SOLVE, begin);
    cs_trace_vector(host, "solve", "b", host->advance_check.last_commit, b);
    cs_trace_vector(host, "solve", "u", host->advance_check.last_commit, u);
    if (end != CS_LINEAR_DONE && host->solve_may_fail)
        return CS_STEP_FAIL;
    if (end != CS_LINEAR_DONE)
        return cs_run_host_fail_solve(host, end, b, result.iterations, result.residual);
    return CS_STEP_OK;
}

/* y = A p with the last A, counted as a Jacobian product. */
static void host_matrix_product(void *ctx, const double *p, double *y) {
    struct cs_run_host *host = ctx;
    const struct cs_stage_start begin = cs_stage_begin(host);
    cs_linear_mul(&host->linear, p, y);
    host->run->counts.jvps++;
    cs_stage_end(host, CS_STAGE_SOLVE, begin);
}

/* z = B^-1 r with the preconditioner of the last A. */
static void host_precondition(void *ctx, const double *r, double *z) {
    struct cs_run_host *host = ctx;
    const struct cs_stage_start begin = cs_stage_begin(host);
    const size_t n3 = 3 * (size_t)host->run->system->view.n;
    cs_linear_precondition(&host->linear, r, sqrt(cs_vector_kernels.dot(n3, r, r)), z);
    cs_stage_end(host, CS_STAGE_SOLVE, begin);
}

/* Bounds on frequency and half damping rate at a state, contact included. */
static void host_bounds_at(void *ctx, double t, const double *x, const double *v, double *omega,
                           double *delta) {
    struct cs_run_host *host = ctx;
    cs_host_state_at(host, t, &x, &v);
    const struct cs_eval at = {.t = t, .x = x, .v = v, .parts = CS_PART_ALL};
    const struct cs_stage_start begin = cs_stage_begin(host);
    cs_spectral_bounds_rate(host->run->system, &at, cs_host_is_explicit(host),
                            host->bounds_work, omega, delta);
    cs_stage_end(host, CS_STAGE_CONTACT, begin);
}

/* The admissible fraction of a displacement; stores the blocking pair for host_fail. */
static double host_max_step_fraction(void *ctx, double t0, const double *x0, double t1,
                                     const double *x1) {
    struct cs_run_host *host = ctx;
    cs_host_held_at(host, 0, t0, &x0, NULL);
    cs_host_held_at(host, 1, t1, &x1, NULL);
    const struct cs_stage_start begin = cs_stage_begin(host);
    double share = cs_step_limit_fraction(host->run->system, t0, x0, t1, x1);
    if (share == 1 && host->contact.limits_steps)
        share = cs_contact_projection_fraction(&host->contact, t0, x0, t1, x1);
    host->run->counts.subdivided_steps += share < 1;
    cs_blocked_step_store(&host->blocked_step, host->run->system, (const double[2]){t0, t1},
                          (const double *const[2]){x0, x1}, share);
    cs_stage_end(host, CS_STAGE_CONTACT, begin);
    cs_trace_vector(host, "longest move", "x", t1, x1);
    cs_trace_number(host, "longest move", "share", t1, share);
    return share;
}

/* -h df/dv - h^2 df/dx of contact at each particle, clamped and with the bound of friction. */
static void host_contact_blocks(void *ctx, double t, const double *x, const double *v, double h,
                                double *blocks) {
    struct cs_run_host *host = ctx;
    cs_host_state_at(host, t, &x, &v);
    const struct cs_matrix matrix = {
        .t = t, .x = x, .v = v, .cd = -h, .ck = -h * h, .psd = true, .bound = true};
    const struct cs_stage_start begin = cs_stage_begin(host);
    cs_terms_blocks(host->run->system, &matrix, CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
                    blocks);
    host->run->counts.diagonals++;
    cs_stage_end(host, CS_STAGE_FORCE, begin);
}

/* Tells if a feature is built. Memory taken from now on counts in its row of the plan. */
static bool begin_feature(struct cs_run_host *host, enum cs_feature feature) {
    struct cs_plan_row *row = host->run->plan.rows + feature;
    host->arena.part = &row->bytes;
    return row->built;
}

/* Offers bounds_at, max_step_fraction and contact_blocks, only if the scene needs them. */
static enum cs_status add_rate(struct cs_run_host *host, struct cs_error *error) {
    const struct cs_system *system = host->run->system;
    const bool judged = cs_step_limit_applies(system) || host->contact.limits_steps;
    if (judged)
        host->table.max_step_fraction = host_max_step_fraction;
    begin_feature(host, CS_FEATURE_CROSSINGS);
    if (cs_blocked_step_init(&host->blocked_step, system, &host->arena, error))
        return error->status;
    host->arena.part = &host->run->plan.state_bytes;
    if (system->collider_params || system->pairs || system->seams)
        host->table.contact_blocks = host_contact_blocks;
    // who asks for one may ask for the other
    if (!judged && !cs_spectral_bounds_depend_on_state(system) &&
        !(host->run->integrator->needs & CS_NEED_BOUNDS))
        return CS_OK;
    CS_ARENA_ARRAY(&host->arena, host->bounds_work, 2 * (size_t)system->view.n, error);
    host->table.bounds_at = host_bounds_at;
    return error->status;
}

/* Friction of the contacts at (t, x) from now on; x NULL: true friction. */
static void host_lag_friction(void *ctx, double t, const double *x) {
    struct cs_run_host *host = ctx;
    struct cs_lagged_friction *lagged = host->run->system->lagged_friction;
    const struct cs_stage_start begin = cs_stage_begin(host);
    if (x) {
        cs_host_state_at(host, host->lag_time = t, &x, NULL);
        cs_lagged_friction_begin(lagged, t, x);
    } else
        cs_lagged_friction_end(lagged);
    cs_stage_end(host, CS_STAGE_CONTACT, begin);
    cs_trace_vector(host, "lagged friction", "x", t, x);
}

static double host_friction_potential(void *ctx, const double *v, double *f) {
    struct cs_run_host *host = ctx;
    const double *x = host->run->x;
    cs_host_held_at(host, 0, host->lag_time, &x, &v);
    const struct cs_stage_start begin = cs_stage_begin(host);
    const double sum = cs_lagged_friction_potential(host->run->system->lagged_friction, v, f);
    cs_stage_end(host, CS_STAGE_CONTACT, begin);
    return sum;
}

static enum cs_status add_lagged_friction(struct cs_run_host *host, struct cs_error *error) {
    if (!begin_feature(host, CS_FEATURE_LAGGED_FRICTION))
        return CS_OK;
    host->table.lag_friction = host_lag_friction;
    host->table.friction_potential = host_friction_potential;
    return cs_lagged_friction_build(host->run->system, &host->arena, error);
}

/* The longest step in s that moves no free particle deeper than penetration_max behind a
 * collider, or by that much deeper than it is. */
static double host_longest_step(void *ctx, double t, const double *x, const double *v) {
    struct cs_run_host *host = ctx;
    struct cs_contact_projection *contact = &host->contact;
    const struct cs_stage_start begin = cs_stage_begin(host);
    cs_move_values(host, t);
    cs_posed_colliders_at(contact->system, t, contact->colliders);
    const double step =
        cs_step_bound_step(contact->system, contact->colliders, host->penetration_max, x, v);
    cs_stage_end(host, CS_STAGE_CONTACT, begin);
    cs_trace_state(host, "longest step", t, x, v);
    cs_trace_number(host, "longest step", "h", t, step);
    return step;
}

/* Contact by projection; for CS_FIDELITY_OTHER no force decides static friction. */
static enum cs_status add_contact(struct cs_run_host *host, struct cs_error *error) {
    struct cs_system *system = host->run->system;
    if (!begin_feature(host, CS_FEATURE_CONTACT))
        return CS_OK;
    if (cs_contact_projection_init(&host->contact, system, &host->arena, error))
        return error->status;
    host->contact.depth_max = CS_PROJECTION_DEPTH * host->table.length_scale;
    host->contact.static_friction.disabled =
        host->run->integrator->fidelity == CS_FIDELITY_OTHER;
    cs_contact_start(&host->contact, 0, host->run->x, host->run->v);
    host->penetration_max = cs_step_bound_depth(system);
    if (host->penetration_max < HUGE_VAL)
        host->table.longest_step = host_longest_step;
    return CS_OK;
}

/* Takes from a system what the host of a former run has added; that host's memory is gone. */
static void forget_former_run(struct cs_system *system) {
    system->rebounds = NULL;
    // its term is the last one
    system->n_terms -= system->lagged_friction ? 1 : 0;
    system->lagged_friction = NULL;
}

enum cs_status cs_run_host_init(struct cs_run_host *host, struct cs_run *run,
                                struct cs_error *error) {
    struct cs_system *system = run->system;
    host->run = run;
    forget_former_run(system);
    host->table = (struct cs_host){
        .size = sizeof host->table,
        .ctx = host,
        .view = &system->view,
        .vector = host->settings.vector ? host->settings.vector : &cs_vector_kernels,
        .alloc = host_alloc,
        .fail = host_fail,
        .note = host_note,
        .force = host_force,
        .energy = host_energy,
        .jvp = host_jvp,
        .diagonal = host_diagonal,
        .force_diagonal = host_force_diagonal,
        .force_then = host->settings.trace ? NULL : host_force_then,
        .solve_setup = cs_host_solve_setup,
        .solve = host_solve,
        .matrix_product = host_matrix_product,
        .precondition = host_precondition,
        .forces_depend_on_time =
            system->events || system->plan.rows[CS_FEATURE_KEY_FRAMES].built,
        .commit = cs_host_commit,
        .euler_setup = cs_host_euler_setup,
    };
    if (system->events && cs_events_turn_particles(system->scene))
        CS_ARENA_ARRAY(&host->arena, host->held, 12 * (size_t)system->view.n, error);
    cs_blow_up_check_set(&host->blow_up, system, 0);
    cs_run_host_set_scales(host);
    cs_run_host_set_overstep(host);
    if (error->status || add_contact(host, error) || add_rate(host, error) ||
        add_lagged_friction(host, error) || cs_energy_input_init(host, error))
        return error->status;
    // only methods with CS_NEED_SOLVE pay for the solver's memory and the copies of the state
    if (!begin_feature(host, CS_FEATURE_SOLVER))
        return CS_OK;
    const size_t n3 = 3 * (size_t)system->view.n;
    host->setup_x = cs_arena_alloc_array(&host->arena, n3, sizeof(double), error);
    if (cs_terms_have_blocks(system))
        host->setup_v = cs_arena_alloc_array(&host->arena, n3, sizeof(double), error);
    if (cs_linear_init(&host->linear, system, &host->arena, error) ||
        cs_host_init_settling(host, error) || !begin_feature(host, CS_FEATURE_REBOUNDS))
        return error->status;
    host->table.euler_finish = cs_host_euler_finish;
    return cs_rebounds_init(system, &host->arena, error);
}

/* An event also updates the blow-up bound, the ledger, the trace and static friction. */
bool cs_run_host_apply_events(struct cs_run_host *host, double t) {
    struct cs_system *system = host->run->system;
    if (!cs_energy_input_events(host, t))
        return false;
    cs_blow_up_check_after_events(&host->blow_up, system, t);
    if (host->settings.ledger)
        cs_energy_ledger_store_state(host->settings.ledger, t, host->run->x, host->run->v);
    cs_trace_state(host, "events", t, host->run->x, host->run->v);
    if (system->plan.rows[CS_FEATURE_CONTACT].built)
        cs_contact_start(&host->contact, t, host->run->x, host->run->v);
    return true;
}
