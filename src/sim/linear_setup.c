/* Sets up the host's linear systems.
 *
 * A linearised step of implicit Euler solves, with K = df/dx and D = df/dv at (t, x, v),
 *
 *   M dv = h f(x + h (v + dv), v + dv) ~ h (f + h K (v - w) + h K dv + D dv)
 *
 * where w is the velocity of the surface that a force comes from: what counts for contact is
 * how the distance changes, and a moving obstacle changes it too. So
 *
 *   A dv = b,   A = M - h D - h^2 K,   b = h f + h^2 K (v - w)
 *
 * with one K in A and b, the clamped one if A is clamped. The force at t + h instead would not
 * be linear, and the exact df/dt by the obstacle's motion has another K: with either, a cloth
 * thrown at an obstacle would differ from the obstacle thrown at it.
 *
 * h D v, which the slope of friction brings into f(v + dv) ~ f + D dv, is in no b: D stands at
 * dv alone. So D may be any slope that serves the step: for contact, friction has its chord
 * (contact/friction_chord.h), which needs the forces before A.
 *
 * Forces whose part of A is a number, and springs, are in b by h^2 K v = M v - h D v - A v.
 * Forces with blocks give h^2 K (v - w) themselves (add_approach of term.h), so that no D that
 * is only near the derivative, as that of clamped friction, gets into b. */
#include "sim/run_host.h"

#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/rebound.h"
#include "model/force/terms.h"
#include "scene/body_pairs.h"
#include "scene/scene.h"

#include <clothsim/clones.h>

/* m/s: friction between surfaces whose friction_speed is smaller has its chord to the end of a
 * solution. Ten sheets in a stack rest without that at the default of 1e-3, and chatter at 1e-4
 * with 0.06 m/s; a check takes up to a third of a step. */
#define SETTLED_BELOW 5e-4

/* Takes the next step towards a definite matrix; false: both are taken. */
static bool clamp(struct cs_matrix *matrix) {
    if (matrix->psd && matrix->bound)
        return false;
    matrix->bound = matrix->psd;
    matrix->psd = true;
    return true;
}

/* The failure of a set-up that was not declared, or whose coefficients are wrong. */
static enum cs_step refuse_setup(struct cs_run_host *host, double cm, double cd, double ck) {
    if (!host->linear.system)
        return host->table.fail(host, "solve was used without CS_NEED_SOLVE");
    if (!(cm > 0) || !(cd <= 0) || !(ck <= 0))
        return host->table.fail(
            host, "solve needs cm > 0, cd <= 0 and ck <= 0, found %g, %g, %g", cm, cd, ck);
    return CS_STEP_OK;
}

/* b = h (f - D v) + (M v - A v), of springs and the forces whose part of A is a number. */
CS_CLONES static void add_scalar_parts(const struct cs_view *view, double h, const double *v,
                                       const double *f, const double *av, double *b) {
    const size_t n = view->n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++)
            b[k] = h * (f[k] - b[k]) + (view->mass[i] * v[k] - av[k]);
}

/* b -= y, both (3,n). */
static void subtract(size_t n, const double *y, double *b) {
    for (size_t k = 0; k < 3 * n; k++)
        b[k] -= y[k];
}

/* Sets b for the A of the last set-up, by way of q. f: all forces at the step's begin. */
static void build_rhs(struct cs_run_host *host, const double *f) {
    const struct cs_system *system = host->run->system;
    const struct cs_euler_step *step = &host->euler;
    double *work = host->linear.q;
    cs_terms_scalar_damping(system, step->t, step->x, step->v, step->b);
    cs_linear_mul_scalar(&host->linear, step->v, work);
    add_scalar_parts(&system->view, step->h, step->v, f, work, step->b);
    host->run->counts.jvps += 2;
    if (!cs_terms_have_blocks(system))
        return;
    cs_terms_approach(system, &host->linear.matrix, work);
    subtract(system->view.n, work, step->b);
    if (host->linear.matrix.rebounds && system->rebounds->any) {
        cs_linear_mul(&host->linear, system->rebounds->change, work);
        subtract(system->view.n, work, step->b);
        host->run->counts.jvps++;
    }
}

/* True if friction is in A by its chord. */
static bool has_chord(const struct cs_run_host *host) {
    const struct cs_system *system = host->run->system;
    return cs_terms_have_blocks(system) && cs_scene_has_friction(system->scene) &&
           !host->euler.tangent;
}

/* f = M dv / h. */
static void find_mean_force(const struct cs_system *system, const struct cs_euler_step *step,
                            double *f) {
    const size_t n = system->view.n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            f[c * n + i] = system->mass[i] * step->dv[c * n + i] / step->h;
}

/* A of the step, and with rhs its b. A diagonal block that is not definite clamps at once. */
static void set_up(struct cs_run_host *host, const struct cs_matrix *matrix, bool rhs) {
    const struct cs_system *system = host->run->system;
    const struct cs_euler_step *step = &host->euler;
    struct cs_matrix clamped = *matrix;
    struct cs_eval at = {.t = step->t, .x = step->x, .v = step->v, .parts = CS_PART_POTENTIAL};
    double *f = host->linear.r, *contact = host->linear.p;
    const struct cs_chord_forces chord = {
        .all = step->dv ? contact : f, .contact = contact, .is_end_known = step->dv};
    // A and b leave r and p alone, so that their friction may know the forces, and b follow A
    host->table.force(host, at.t, at.x, at.v, CS_PART_ALL, f);
    const struct cs_stage_start begin = cs_stage_begin(host);
    if (has_chord(host)) {
        if (step->dv)
            find_mean_force(system, step, contact);
        else
            cs_terms_force(system, &at, contact);
        clamped.chord = &chord;
    }
    clamped.rebounds = system->rebounds != NULL;
    if (clamped.rebounds)
        cs_rebounds_find(system, step->t, step->h, step->x, step->v, f);
    while (!cs_linear_setup(&host->linear, &clamped) && clamp(&clamped))
        host->run->counts.clamped_setups++;
    if (rhs)
        build_rhs(host, f);
    host->linear.matrix.chord = NULL;
    cs_stage_end(host, CS_STAGE_SETUP, begin);
}

enum cs_step cs_host_euler_setup(void *ctx, double t, double h, const double *x,
                                 const double *v, uint32_t flags, double *b) {
    struct cs_run_host *host = ctx;
    cs_move_values(host, t);
    if (refuse_setup(host, 1, -h, -h * h))
        return CS_STEP_FAIL;
    cs_trace_state(host, "solve set-up", t, x, v);
    host->run->counts.solve_setups++;
    host->solve_may_fail = flags & CS_SOLVE_MAY_FAIL;
    // no copies: the method keeps all three until it has solved
    host->euler = (struct cs_euler_step){
        .t = t, .h = h, .x = x, .v = v, .b = b, .tangent = flags & CS_SOLVE_TANGENT};
    set_up(host,
           &(struct cs_matrix){.t = t,
                               .x = x,
                               .v = v,
                               .cm = 1,
                               .cd = -h,
                               .ck = -h * h,
                               .psd = flags & CS_SOLVE_PSD,
                               .bound = flags & CS_SOLVE_BOUND},
           true);
    return CS_STEP_OK;
}

void cs_host_euler_finish(void *ctx, double *x, double *v) {
    struct cs_run_host *host = ctx;
    const struct cs_stage_start begin = cs_stage_begin(host);
    if (host->power) {
        host->has_impact = host->run->system->rebounds->any;
        host->impact_work = cs_rebounds_work(host->run->system, host->euler.t, x);
    }
    cs_rebounds_move(host->run->system, host->euler.h, x, v);
    cs_stage_end(host, CS_STAGE_CONTACT, begin);
}

/* Sets the last system up again with a matrix that is closer to positive definite: first
 * CS_SOLVE_PSD, which drops the transverse part of compressed springs, then CS_SOLVE_BOUND
 * for friction on curved surfaces too. If b is that of the last euler_setup, it follows.
 * Returns false if both are already set. */
static bool clamp_system(struct cs_run_host *host, const double *b) {
    struct cs_matrix matrix = host->linear.matrix;
    if (!clamp(&matrix))
        return false;
    host->run->counts.clamped_setups++;
    if (host->euler.b)
        set_up(host, &matrix, b == host->euler.b);
    else
        cs_linear_setup(&host->linear, &matrix);
    return true;
}

/* Prepares A at (t, x, v). Copies the state, because host_solve may have to set up again
 * after the method has moved on. A diagonal block that is not definite clamps at once. */
enum cs_step cs_host_solve_setup(void *ctx, double t, const double *x, const double *v,
                                 double cm, double cd, double ck, uint32_t flags) {
    struct cs_run_host *host = ctx;
    const size_t bytes = 3 * sizeof *x * host->run->system->view.n;
    cs_host_state_at(host, t, &x, &v);
    if (refuse_setup(host, cm, cd, ck))
        return CS_STEP_FAIL;
    cs_trace_state(host, "solve set-up", t, x, v);
    const struct cs_stage_start begin = cs_stage_begin(host);
    host->run->counts.solve_setups++;
    // the b of a former euler_setup belongs to another A
    host->euler.b = NULL;
    host->solve_may_fail = flags & CS_SOLVE_MAY_FAIL;
    memcpy(host->setup_x, x, bytes);
    if (host->setup_v)
        memcpy(host->setup_v, v, bytes);
    const struct cs_matrix matrix = {.t = t,
                                     .x = host->setup_x,
                                     .v = host->setup_v,
                                     .cm = cm,
                                     .cd = cd,
                                     .ck = ck,
                                     .psd = flags & CS_SOLVE_PSD,
                                     .bound = flags & CS_SOLVE_BOUND};
    if (!cs_linear_setup(&host->linear, &matrix))
        clamp_system(host, NULL);
    cs_stage_end(host, CS_STAGE_SETUP, begin);
    return CS_STEP_OK;
}

/* Sets the last euler_setup up again with friction by its chord to where the solution dv (3,n)
 * of its b ends. Returns false if nothing depends on it. */
static bool set_end(struct cs_run_host *host, const double *b, const double *dv) {
    const struct cs_matrix matrix = host->linear.matrix;
    if (!host->settled || !host->euler.b || b != host->euler.b || !has_chord(host) ||
        !host->run->system->pairs->current_contacts->n)
        return false;
    memcpy(host->settled, dv, 3 * sizeof *dv * host->run->system->view.n);
    host->euler.dv = dv;
    set_up(host, &matrix, true);
    host->euler.dv = NULL;
    return true;
}

/* Residual, relative to that of the system, at which friction by its chord is settled, and the
 * largest number of solves for it. Ten sheets in a stack come to rest with 0.03 to 0.5, and a
 * block is dragged beyond the speed of its conveyor with 0.1. */
#define FRICTION_RESIDUAL 0.3
#define FRICTION_SOLVES   8

enum cs_status cs_host_init_settling(struct cs_run_host *host, struct cs_error *error) {
    const struct cs_system *system = host->run->system;
    if (system->pairs && system->scene->contact->friction_speed < SETTLED_BELOW &&
        !cs_scene_friction_sticks(system->scene) &&
        !(host->run->integrator->needs & CS_NEED_LAGGED_FRICTION))
        CS_ARENA_ARRAY(&host->arena, host->settled, 3 * (size_t)system->view.n, error);
    return error->status;
}

/* Solves A u = b by conjugate gradients. If these meet p.Ap <= 0, A is clamped, the b of
 * euler_setup with it, u starts again from 0, and all iterations count. */
static enum cs_linear_end solve_clamped(struct cs_run_host *host, const double *b, double rtol,
                                        double *u, struct cs_solve_result *result) {
    result->end =
        cs_linear_solve(&host->linear, b, rtol, u, &result->iterations, &result->residual);
    host->run->counts.solve_iterations += result->iterations;
    // set-up tests diagonal blocks alone: an indefinite matrix may show only here
    while (result->end == CS_LINEAR_INDEFINITE && clamp_system(host, b)) {
        memset(u, 0, 3 * sizeof *u * host->run->system->view.n);
        result->end =
            cs_linear_solve(&host->linear, b, rtol, u, &result->iterations, &result->residual);
        host->run->counts.solve_iterations += result->iterations;
    }
    return result->end;
}

enum cs_linear_end cs_host_solve_settled(struct cs_run_host *host, const double *b, double rtol,
                                         double *u, struct cs_solve_result *result) {
    bool settled = solve_clamped(host, b, rtol, u, result) != CS_LINEAR_DONE;
    const double near = rtol > FRICTION_RESIDUAL ? rtol : FRICTION_RESIDUAL;
    for (int k = 0; k < FRICTION_SOLVES && !settled && set_end(host, b, u); k++) {
        settled = solve_clamped(host, b, near, u, result) != CS_LINEAR_DONE ||
                  !result->iterations ||
                  solve_clamped(host, b, rtol, u, result) != CS_LINEAR_DONE;
        if (result->end == CS_LINEAR_DONE)
            continue;
        // the solution so far is good; only its friction is not settled
        memcpy(u, host->settled, 3 * sizeof *u * host->run->system->view.n);
        result->end = CS_LINEAR_DONE;
    }
    return result->end;
}

/* The replacement of host_solve by cs_run_host_fail_solves. */
static enum cs_step failing_solve(void *ctx, const double *b, double rtol, double *u) {
    struct cs_run_host *host = ctx;
    (void)b, (void)rtol, (void)u;
    return host->table.fail(ctx, "the linear solver was told to fail");
}

void cs_run_host_fail_solves(struct cs_run_host *host) {
    host->table.solve = failing_solve;
}
