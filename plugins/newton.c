/* newton.c - Newton's method with a line search for one implicit stage; formulas: newton.h.
 *
 * One iteration, in order:
 * 1. Converged if |r| <= goal = rtol impulse + absolute + residual_floor times the rounding
 *    floor. Also if the last iteration gained less than a factor 2 with that share of it 1.
 * 2. The linear solve gets the tolerance 1e-3, or a looser one that suffices: half of goal /
 *    |r|. The impulse, and with it the goal, moves with u.
 * 3. du from A du = -r. A is clamped while |r| >= 0.1 impulse, else exact.
 * 4. The line search accepts a length, or the iteration ends.
 *
 * Where that fails and contact has friction, the same with lagged friction goes on from the
 * last u (iterate_lags). Where a linear solve fails the method tries a shorter step. */
#include "newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Relative residual of the linear solves; the last one may be looser. Chosen by trial. */
#define LINEAR_RTOL 1e-3

/* Below this residual, relative to the impulse, A is the exact matrix: near the solution it
 * converges quadratically, and far from it it may not point downhill. Chosen by trial. */
#define NEAR 0.1

/* Halvings of a line search, and the fraction of the promised decrease that it asks for:
 * small, so that nearly any decrease is accepted. */
#define LINE_HALVINGS 12
#define LINE_DECREASE 1e-4

/* Share of P below which a slope is lost in its rounding: P sums 1e4 and more numbers. */
#define MERIT_NOISE 1e-11

/* A move is doubled, so often at most, where P falls by more than this share of what its slope
 * promises. With an exact A it falls by half of that. Chosen by trial. */
#define STRAIGHT      0.9
#define DOUBLINGS_MAX 10

/* An iteration with friction ends if so many steps do not lower |r| to this share of its
 * smallest value. With true friction it is then in a circle, mostly of two states. Chosen by
 * trial (docs/notes/contact-newton.md). */
#define IDLE_GAIN   0.9
#define IDLE        2
#define IDLE_LAGGED 10

/* Outer iterations, and the residual to which each solves, relative to the one that it starts
 * from: they gain a factor of 5 to 60 each, so that more would be lost at the next. */
#define OUTER_MAX   20
#define OUTER_SHARE 0.05

enum cs_step newton_init(struct newton *newton, const struct cs_host *host, double rtol,
                         int64_t iterations) {
    const size_t n = host->view->n;
    *newton = (struct newton){
        .host = host, .rtol = rtol, .iterations = iterations, .residual_floor = 1};
    double **arrays[] = {&newton->x,   &newton->v,  &newton->r,       &newton->f,
                         &newton->rhs, &newton->du, &newton->u_start, &newton->zeros};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        if (!(*arrays[k] = host->alloc(host->ctx, 3 * n * sizeof(double))))
            return CS_STEP_FAIL;
    // a host without lagged friction does not know the flag
    newton->may_fail = CS_HAS(host, lag_friction) ? CS_SOLVE_MAY_FAIL : 0;
    if (newton->may_fail && host->lag_friction &&
        !(newton->friction = host->alloc(host->ctx, 3 * n * sizeof(double))))
        return CS_STEP_FAIL;
    for (size_t i = 0; i < n; i++)
        newton->mass += host->view->inv_mass[i] > 0 ? host->view->mass[i] : 0;
    return CS_STEP_OK;
}

/* X = xb + gx u, V = vb + gv u. */
static void set_positions(struct newton *newton, const struct newton_stage *stage,
                          const double *u) {
    const size_t n3 = 3 * (size_t)newton->host->view->n;
    const struct cs_vector_kernels *vector = newton->host->vector;
    vector->linear_sum(n3, 1, stage->xb, stage->gx, u, newton->x);
    vector->linear_sum(n3, 1, stage->vb ? stage->vb : newton->zeros, stage->gv, u, newton->v);
}

/* Sets X, V, r, |r| and the impulse for u. Norms weight with 1/m: pinned particles count 0. */
static void evaluate(struct newton *newton, const struct newton_stage *stage, const double *u) {
    const struct cs_host *host = newton->host;
    const size_t n = host->view->n;
    set_positions(newton, stage, u);
    host->force(host->ctx, stage->t, newton->x, newton->v, CS_PART_ALL, newton->f);
    if (stage->exchange)
        stage->exchange(newton, stage);
    double squared = 0, impulse = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            const size_t k = c * n + i;
            const double dp = host->view->mass[i] * (u[k] - stage->ub[k]);
            const double r = dp - stage->s * newton->f[k];
            newton->r[k] = r;
            squared += r * r * host->view->inv_mass[i];
            impulse += dp * dp * host->view->inv_mass[i];
        }
    newton->norm = sqrt(squared);
    newton->impulse = sqrt(impulse);
}

double newton_rounding_floor(const struct newton *newton, const struct newton_stage *stage,
                             const double *u) {
    const struct cs_view *view = newton->host->view;
    const size_t n3 = 3 * (size_t)view->n;
    const double length = newton->host->vector->max_norm(n3, newton->x);
    const double speed = newton->host->vector->max_norm(n3, u);
    double omega = view->omega, delta = view->delta;
    if (CS_HAS(newton->host, bounds_at) && newton->host->bounds_at)
        newton->host->bounds_at(newton->host->ctx, stage->t, newton->x, newton->v, &omega,
                                &delta);
    return 4 * DBL_EPSILON * sqrt(newton->mass) *
           (stage->s * omega * omega * length + (1 + 2 * stage->s * stage->gv * delta) * speed);
}

/* du from A du = -r. In free fall M du = -r: this du starts the linear solver, instead of 0,
 * if it halves |r|. No tolerance can spoil a free fall then. */
static enum cs_step find_direction(struct newton *newton, const struct newton_stage *stage,
                                   double rtol) {
    const struct cs_host *host = newton->host;
    const struct cs_view *view = host->view;
    const size_t n = view->n;
    const bool near = newton->norm < NEAR * newton->impulse;
    // lagged friction is convex: its own slope goes downhill
    const uint32_t flags = newton->may_fail | (near ? 0 : CS_SOLVE_PSD) |
                           (near || newton->lagged ? 0 : CS_SOLVE_BOUND);
    enum cs_step status =
        host->solve_setup(host->ctx, stage->t, newton->x, newton->v, 1, -stage->s * stage->gv,
                          -stage->s * stage->gx, flags);
    if (status != CS_STEP_OK)
        return status;
    newton->converged++;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            newton->rhs[c * n + i] = -newton->r[c * n + i];
            newton->du[c * n + i] = view->inv_mass[i] * newton->rhs[c * n + i];
        }
    host->matrix_product(host->ctx, newton->du, newton->f);
    host->vector->linear_sum(3 * n, 1, newton->rhs, -1, newton->f, newton->f);
    const double left = host->vector->dot(3 * n, newton->f, newton->f);
    if (!(left < host->vector->dot(3 * n, newton->rhs, newton->rhs) / 4))
        memset(newton->du, 0, 3 * n * sizeof *newton->du);
    return host->solve(host->ctx, newton->rhs, rtol, newton->du);
}

/* P(u) + s w.(u - u0): inertia, (s/gx) times the potential energy at X, and (s/gv) times that
 * of lagged friction at V, whose force goes to newton->friction. Sets X and V. */
static double potential(struct newton *newton, const struct newton_stage *stage,
                        const double *u) {
    const struct cs_host *host = newton->host;
    const size_t n = host->view->n;
    set_positions(newton, stage, u);
    double inertia = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            const double du = u[c * n + i] - stage->ub[c * n + i];
            inertia += 0.5 * host->view->mass[i] * du * du;
        }
    if (newton->lagged)
        inertia += stage->s / stage->gv *
                   host->friction_potential(host->ctx, newton->v, newton->friction);
    return inertia +
           stage->s / stage->gx * host->energy(host->ctx, stage->t, newton->x, newton->zeros);
}

/* True if steps must not carry surfaces through each other, or pass over contact. */
static bool is_limited(const struct newton *newton) {
    return CS_HAS(newton->host, max_step_fraction) && newton->host->max_step_fraction;
}

/* True if two vectors of positions (n3) differ by no more than rounding. */
static bool are_equal(size_t n3, const double *x, const double *y) {
    double apart = 0, most = 0;
    for (size_t k = 0; k < n3; k++) {
        apart = fmax(apart, fabs(x[k] - y[k]));
        most = fmax(most, fabs(x[k]));
    }
    return apart <= 8 * DBL_EPSILON * most;
}

/* Moves the start u towards the free motion until nothing crosses between the positions of
 * both. Particles on paths keep their velocity. */
static void shorten_start(struct newton *newton, const struct newton_stage *stage, double *u) {
    const struct cs_host *host = newton->host;
    const size_t n = host->view->n;
    double *free_motion = newton->rhs, *guess = newton->f;
    host->vector->linear_sum(3 * n, 1, stage->x0, stage->c, stage->v0, free_motion);
    host->vector->linear_sum(3 * n, 1, stage->xb, stage->gx, u, guess);
    newton->line_search_blocked = false;
    if (are_equal(3 * n, free_motion, guess))
        return;
    const double share =
        host->max_step_fraction(host->ctx, stage->t, free_motion, stage->t, guess);
    newton->line_search_blocked = share < 1;
    for (size_t c = 0; share < 1 && c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++)
            if (host->view->inv_mass[i] > 0)
                u[k] -= (1 - share) * (guess[k] - free_motion[k]) / stage->gx;
}

/* The largest a in 0..1 for which u0 + a du carries no surface through another. */
static double longest_move(struct newton *newton, const struct newton_stage *stage) {
    const struct cs_host *host = newton->host;
    const size_t n3 = 3 * (size_t)host->view->n;
    if (!is_limited(newton))
        return 1;
    host->vector->linear_sum(n3, 1, stage->xb, stage->gx, newton->u_start, newton->rhs);
    host->vector->linear_sum(n3, 1, newton->rhs, stage->gx, newton->du, newton->f);
    const double share =
        host->max_step_fraction(host->ctx, stage->t, newton->rhs, stage->t, newton->f);
    newton->line_search_blocked |= share < 1;
    return share;
}

/* The merit along du: P at the start of a search, and s w.du of the frozen forces. */
struct merit {
    double start, work;
};

/* Lagged friction is among the forces without energy, but P has its potential. */
static struct merit merit_at_start(struct newton *newton, const struct newton_stage *stage) {
    const struct cs_host *host = newton->host;
    const size_t n3 = 3 * (size_t)host->view->n;
    struct merit merit = {.start = potential(newton, stage, newton->u_start)};
    host->force(host->ctx, stage->t, newton->x, newton->v, CS_PART_WITHOUT_ENERGY, newton->f);
    merit.work = host->vector->dot(n3, newton->f, newton->du);
    if (newton->lagged)
        merit.work -= host->vector->dot(n3, newton->friction, newton->du);
    merit.work *= stage->s;
    return merit;
}

/* P at u_start + a du, less P at u_start; sets u, X and V. */
static double change_of(struct newton *newton, const struct newton_stage *stage,
                        const struct merit *merit, double a, double *u) {
    const size_t n3 = 3 * (size_t)newton->host->view->n;
    newton->host->vector->linear_sum(n3, 1, newton->u_start, a, newton->du, u);
    return potential(newton, stage, u) - a * merit->work - merit->start;
}

/* Doubles du, which P has accepted with this change, while P falls nearly straight and no
 * surface is in the way. Under load in a sharp fold the clamped A may be a thousand times too
 * stiff. */
static void lengthen(struct newton *newton, const struct newton_stage *stage,
                     struct merit *merit, double slope, double change, double *u) {
    const size_t n3 = 3 * (size_t)newton->host->view->n;
    const bool blocked = newton->line_search_blocked;
    for (int k = 0; k < DOUBLINGS_MAX && change < STRAIGHT * slope; k++) {
        newton->host->vector->linear_sum(n3, 2, newton->du, 0, newton->du, newton->du);
        merit->work *= 2;
        slope *= 2;
        const double longer =
            longest_move(newton, stage) < 1 ? HUGE_VAL : change_of(newton, stage, merit, 1, u);
        if (!(longer < change)) {
            change_of(newton, stage, merit, 0.5, u);
            break;
        }
        change = longer;
    }
    newton->line_search_blocked = blocked;
    evaluate(newton, stage, u);
}

/* Line search from u along du: accepts the first a that lowers |r| by 1e-4 a, or P by 1e-4 of
 * what its slope promises. P is evaluated only if |r| fails at first: it costs an energy and
 * a force more. With lagged friction P alone decides: with both tests an iteration may run in
 * circles. |r| then decides only where the slope is lost in the rounding of P. A whole move is
 * lengthened where P falls straight. False: no length is accepted, u is the last one tried. */
static bool search(struct newton *newton, const struct newton_stage *stage, double *u) {
    const struct cs_host *host = newton->host;
    const size_t n3 = 3 * (size_t)host->view->n;
    const double norm = newton->norm;
    const double slope = host->vector->dot(n3, newton->r, newton->du);
    struct merit merit = {.start = (double)NAN};
    memcpy(newton->u_start, u, n3 * sizeof *u);
    double a = longest_move(newton, stage);
    for (int k = 0; a > 0 && k <= LINE_HALVINGS; k++, a /= 2) {
        host->vector->linear_sum(n3, 1, newton->u_start, a, newton->du, u);
        evaluate(newton, stage, u);
        const bool falls = newton->norm <= (1 - LINE_DECREASE * a) * norm;
        if (falls && !newton->lagged)
            return true;
        if (isnan(merit.start)) // only now: most searches end above
            merit = merit_at_start(newton, stage);
        const double change = change_of(newton, stage, &merit, a, u);
        if (falls && -slope < MERIT_NOISE * fabs(merit.start))
            return true;
        if (change <= LINE_DECREASE * a * slope && isfinite(newton->norm)) {
            if (a == 1 && change < STRAIGHT * slope)
                lengthen(newton, stage, &merit, slope, change, u);
            return true;
        }
    }
    return false;
}

/* True if the residual is as small as asked, or as rounding lets it be: below the rounding
 * floor an iteration that gains little is the last. before: |r| one iteration ago. */
static bool is_solved(const struct newton *newton, const struct newton_stage *stage,
                      const double *u, double before, double *goal) {
    const double noise = newton_rounding_floor(newton, stage, u);
    const double enough = newton->rtol * newton->impulse + newton->absolute;
    *goal = enough + newton->residual_floor * noise;
    return newton->norm <= *goal ||
           (newton->norm <= enough + noise && newton->norm > before / 2);
}

/* Newton's iteration with true friction, or with lagged friction. Where contact has friction it
 * ends early if it gains nothing. */
static enum cs_step iterate(struct newton *newton, const struct newton_stage *stage, double *u,
                            bool *converged) {
    const int idle_max = newton->lagged ? IDLE_LAGGED : IDLE;
    double before = HUGE_VAL, best = HUGE_VAL, goal;
    int idle = 0;
    *converged = false;
    evaluate(newton, stage, u);
    for (int64_t k = 0; isfinite(newton->norm); k++) {
        *converged = is_solved(newton, stage, u, before, &goal);
        idle = newton->norm < IDLE_GAIN * best ? 0 : idle + 1;
        best = idle ? best : newton->norm;
        if (*converged || k == newton->iterations || (newton->friction && idle == idle_max))
            break;
        before = newton->norm;
        // the goal moves with the impulse: aim at half of it
        const double enough = fmax(0.5 * goal / newton->norm, LINEAR_RTOL);
        const enum cs_step status = find_direction(newton, stage, enough);
        newton->linear_failed = newton->may_fail && status == CS_STEP_FAIL;
        if (status != CS_STEP_OK)
            return newton->linear_failed ? CS_STEP_OK : status;
        if (!search(newton, stage, u)) {
            *converged = is_solved(newton, stage, u, 0, &goal);
            break;
        }
    }
    return CS_STEP_OK;
}

/* Solves with friction lagged at newton->x, until |r| <= rtol |M (u - ub)|. */
static enum cs_step solve_lagged(struct newton *newton, const struct newton_stage *stage,
                                 double rtol, double *u, bool *converged) {
    const struct cs_host *host = newton->host;
    const double asked = newton->rtol;
    host->lag_friction(host->ctx, stage->t, newton->x);
    newton->lagged = true;
    newton->rtol = rtol;
    const enum cs_step status = iterate(newton, stage, u, converged);
    newton->lagged = false;
    newton->rtol = asked;
    host->lag_friction(host->ctx, stage->t, NULL);
    return status;
}

/* Outer iterations from u, where true friction has failed: each solves with friction lagged at
 * the last solution, until the residual with true friction is small. They end early if they
 * gain nothing. */
static enum cs_step iterate_lags(struct newton *newton, const struct newton_stage *stage,
                                 double *u, bool *converged) {
    double before = HUGE_VAL, goal;
    evaluate(newton, stage, u);
    for (int k = 0; k < OUTER_MAX && newton->norm < before; k++) {
        before = k ? newton->norm : HUGE_VAL;
        const double rtol =
            fmax(newton->rtol / 2, OUTER_SHARE * newton->norm / newton->impulse);
        const enum cs_step status = solve_lagged(newton, stage, rtol, u, converged);
        if (status != CS_STEP_OK || !*converged)
            return status;
        evaluate(newton, stage, u);
        if ((*converged = is_solved(newton, stage, u, 0, &goal)))
            break;
    }
    return CS_STEP_OK;
}

enum cs_step newton_solve(struct newton *newton, const struct newton_stage *stage, double *u,
                          bool *converged) {
    newton->linear_failed = false;
    if (is_limited(newton))
        shorten_start(newton, stage, u);
    const enum cs_step status = iterate(newton, stage, u, converged);
    if (status != CS_STEP_OK || *converged || !newton->friction || !isfinite(newton->norm))
        return status;
    return iterate_lags(newton, stage, u, converged);
}

enum cs_step newton_step(struct newton *newton, const struct newton_stage *stage, double *u,
                         bool *converged) {
    const size_t n3 = 3 * (size_t)newton->host->view->n;
    *converged = newton->linear_failed = false;
    evaluate(newton, stage, u);
    if (!isfinite(newton->norm))
        return CS_STEP_OK;
    const enum cs_step status = find_direction(newton, stage, newton->rtol);
    newton->linear_failed = newton->may_fail && status == CS_STEP_FAIL;
    if (status != CS_STEP_OK)
        return newton->linear_failed ? CS_STEP_OK : status;
    newton->host->vector->linear_sum(n3, 1, u, 1, newton->du, u);
    set_positions(newton, stage, u);
    *converged = isfinite(newton->host->vector->dot(n3, newton->x, newton->v));
    return CS_STEP_OK;
}
