/* explicit_steps.c - one step of each explicit method.
 *
 * With a = f(t, x, v) / m and step h, ' marking the new state:
 *   explicit-euler    x' = x + h v,              v' = v + h a    (cloth thesis, eq. 5.15)
 *   symplectic-euler  v' = v + h a,              x' = x + h v'   (flag thesis; HLW 2006, I.1.2)
 *   averaged-euler    v' = v + h a,              x' = x + h (v + v')/2   (cloth article)
 *   velocity-verlet   x' = x + h v + h^2/2 a,    v' = v + h/2 (a + a'),
 *                     a' = a(x', v + h a): one evaluation per step, a' is stored for the next
 *   position-verlet   x' = (2 - l) x - (1 - l) x_old + h^2 a(x, (x - x_old)/h)
 *                     (flag thesis, with its loss l), v' = (x' - x)/h + h/2 a; where h changes,
 *                     by (h + h_old)/2 times a instead, and x - x_old as h_old would have it
 *   rk4               y' = y + h/6 (k1 + 2 k2 + 2 k3 + k4), y = (x, v), k1 = F(t, y),
 *                     k2 = F(t + h/2, y + h/2 k1), k3 = F(t + h/2, y + h/2 k2),
 *                     k4 = F(t + h, y + h k3)   (Kutta 1901)
 */
#include "explicit_steps.h"
#include "parallel.h"

#include <math.h>

static struct explicit_method *method_of(struct fixed_step *loop) {
    return (struct explicit_method *)loop;
}

/* One component of a range of particles, as a loop over a row reads and writes it. */
struct row {
    size_t count;
    const double *inv_mass;
    double *x, *v;
    double *a;       /* the force, until the loop makes it the acceleration */
    double *kept[4]; /* of the method's own arrays */
    double h, loss, weight, forth;
};

/* A loop over all particles, split into ranges for the host's threads. The three components
 * of a range are done in a row, with its masses in the cache. */
struct move {
    void (*row)(const struct row *row);
    const struct explicit_method *self;
    double *x, *v, h, weight, forth;
};

/* The part of a loop for the particles [begin, end): three rows. */
static void move_part(void *arg, size_t begin, size_t end) {
    const struct move *move = arg;
    const struct explicit_method *self = move->self;
    const struct cs_view *view = self->fixed.host->view;
    const size_t n = view->n;
    for (size_t c = 0; c < 3; c++) {
        const size_t at = c * n + begin;
        struct row row = {
            .count = end - begin,
            .inv_mass = view->inv_mass + begin,
            .x = move->x + at,
            .v = move->v + at,
            .a = self->a + at,
            .h = move->h,
            .loss = self->velocity_loss,
            .weight = move->weight,
            .forth = move->forth,
        };
        /* the method's history arrays (3,n) follow each other in memory */
        for (size_t k = 0; k < self->n_history; k++)
            row.kept[k] = self->history + 3 * n * k + at;
        move->row(&row);
    }
}

/* Runs a loop on the host's threads. */
static void share(struct move *move) {
    const struct cs_host *host = move->self->fixed.host;
    parallel_for(host, host->view->n, move_part, move);
}

/* Stores the force at (t, x, v) in a, and runs a loop, in one pass where the host can. The loop
 * divides the force by the mass, which saves a pass over memory. */
static void evaluate_and_share(struct move *move, double t, const double *x, const double *v) {
    const struct cs_loop loop = {move_part, move};
    force_then(move->self->fixed.host, t, x, v, move->self->a, &loop);
}

/* Runs a loop over rows that updates x and v. */
static void move_all(const struct explicit_method *self, double h, double *x, double *v,
                     void (*row)(const struct row *row)) {
    struct move move = {.row = row, .self = self, .x = x, .v = v, .h = h};
    share(&move);
}

/* The same with the force at (t, x, v). */
static void evaluate_and_move(const struct explicit_method *self, double t, double h, double *x,
                              double *v, void (*row)(const struct row *row)) {
    struct move move = {.row = row, .self = self, .x = x, .v = v, .h = h};
    evaluate_and_share(&move, t, x, v);
}

CS_CLONES static void explicit_euler_row(const struct row *row) {
    const double h = row->h, *restrict w = row->inv_mass, *restrict f = row->a;
    double *restrict x = row->x, *restrict v = row->v;
    for (size_t i = 0; i < row->count; i++) {
        x[i] += h * v[i];
        v[i] += h * (f[i] * w[i]);
    }
}

enum cs_step step_explicit_euler(struct fixed_step *loop, double t, double h, double *x,
                                 double *v) {
    evaluate_and_move(method_of(loop), t, h, x, v, explicit_euler_row);
    return CS_STEP_OK;
}

CS_CLONES static void symplectic_euler_row(const struct row *row) {
    const double h = row->h, *restrict w = row->inv_mass, *restrict f = row->a;
    double *restrict x = row->x, *restrict v = row->v;
    for (size_t i = 0; i < row->count; i++) {
        v[i] += h * (f[i] * w[i]);
        x[i] += h * v[i];
    }
}

enum cs_step step_symplectic_euler(struct fixed_step *loop, double t, double h, double *x,
                                   double *v) {
    evaluate_and_move(method_of(loop), t, h, x, v, symplectic_euler_row);
    return CS_STEP_OK;
}

CS_CLONES static void averaged_euler_row(const struct row *row) {
    const double h = row->h, *restrict w = row->inv_mass, *restrict f = row->a;
    double *restrict x = row->x, *restrict v = row->v;
    for (size_t i = 0; i < row->count; i++) {
        const double v_old = v[i];
        v[i] += h * (f[i] * w[i]);
        x[i] += h * ((v_old + v[i]) / 2);
    }
}

enum cs_step step_averaged_euler(struct fixed_step *loop, double t, double h, double *x,
                                 double *v) {
    evaluate_and_move(method_of(loop), t, h, x, v, averaged_euler_row);
    return CS_STEP_OK;
}

CS_CLONES static void accelerate_row(const struct row *row) {
    const double *restrict w = row->inv_mass;
    double *restrict a = row->a;
    for (size_t i = 0; i < row->count; i++)
        a[i] *= w[i];
}

/* The position of velocity-verlet. v becomes the prediction v + h a, which damping and drag
 * see at the new time. */
CS_CLONES static void drift_row(const struct row *row) {
    const double h = row->h, *restrict a = row->a;
    double *restrict x = row->x, *restrict v = row->v, *restrict old_a = row->kept[0];
    for (size_t i = 0; i < row->count; i++) {
        x[i] += h * (v[i] + h / 2 * a[i]);
        v[i] += h * a[i];
        old_a[i] = a[i];
    }
}

/* Corrects the prediction v + h a to v + h/2 (a + a'). */
CS_CLONES static void kick_row(const struct row *row) {
    const double h = row->h, *restrict w = row->inv_mass, *restrict old_a = row->kept[0];
    double *restrict v = row->v, *restrict a = row->a;
    for (size_t i = 0; i < row->count; i++) {
        a[i] *= w[i];
        v[i] += h / 2 * (a[i] - old_a[i]);
    }
}

enum cs_step step_velocity_verlet(struct fixed_step *loop, double t, double h, double *x,
                                  double *v) {
    struct explicit_method *self = method_of(loop);
    if (loop->history_void)
        evaluate_and_move(self, t, h, x, v, accelerate_row);
    move_all(self, h, x, v, drift_row);
    evaluate_and_move(self, t + h, h, x, v, kick_row);
    return CS_STEP_OK;
}

/* Starts u of position-verlet as v - h/2 a. */
CS_CLONES static void last_half_step_row(const struct row *row) {
    const double h = row->h, *restrict v = row->v, *restrict a = row->a;
    double *restrict u = row->kept[0];
    for (size_t i = 0; i < row->count; i++)
        u[i] = v[i] - h / 2 * a[i];
}

CS_CLONES static void position_verlet_row(const struct row *row) {
    const double h = row->h, loss = row->loss, *restrict a = row->a;
    const double kick = row->forth;
    double *restrict x = row->x, *restrict v = row->v, *restrict u = row->kept[0];
    double *restrict before = row->kept[1];
    for (size_t i = 0; i < row->count; i++) {
        before[i] = u[i];
        u[i] = (1 - loss) * u[i] + kick * a[i];
        x[i] += h * u[i];
        v[i] = u[i] + h / 2 * a[i];
    }
}

/* Takes back what a refused step made of u. */
CS_CLONES static void take_back_row(const struct row *row) {
    double *restrict u = row->kept[0];
    const double *restrict before = row->kept[1];
    for (size_t i = 0; i < row->count; i++)
        u[i] = before[i];
}

/* In u = (x - x_old)/h the recurrence is u' = (1 - l) u + h a, x' = x + h u': the same in
 * exact arithmetic, without the cancellation of nearly equal positions. Steps of other lengths
 * are those of leapfrog, u' = (1 - l) u + (h + h_old)/2 a: v holds the old acceleration, and u
 * from it would miss h/2 times the change of a, which contact makes large. If u is unknown
 * (after a restart, or a commit that changed the state) it starts as v - h/2 a, a Taylor step.
 */
enum cs_step step_position_verlet(struct fixed_step *loop, double t, double h, double *x,
                                  double *v) {
    struct explicit_method *self = method_of(loop);
    if (loop->refused) {
        move_all(self, h, x, v, take_back_row);
        self->h = self->h_before;
    }
    const bool start = self->h <= 0;
    if (start)
        evaluate_and_move(self, t, h, x, v, accelerate_row);
    const bool unknown = start || (loop->refused ? self->u_was_unknown : loop->history_void);
    if (unknown)
        move_all(self, h, x, v, last_half_step_row);
    if (!start)
        evaluate_and_move(self, t, h, x, self->history, accelerate_row);
    const bool same = unknown || fabs(h - self->h) <= 1e-9 * h;
    struct move move = {.row = position_verlet_row,
                        .self = self,
                        .x = x,
                        .v = v,
                        .h = h,
                        .forth = same ? h : 0.5 * (h + self->h)};
    share(&move);
    self->h_before = self->h;
    self->u_was_unknown = unknown;
    self->h = h;
    return CS_STEP_OK;
}

/* rk4: kept holds the stage's x and v, and the weighted sums of both slopes. */
CS_CLONES static void rk4_begin_row(const struct row *row) {
    const double *restrict x = row->x, *restrict v = row->v;
    double *restrict stage_x = row->kept[0], *restrict stage_v = row->kept[1];
    double *restrict sum_x = row->kept[2], *restrict sum_v = row->kept[3];
    for (size_t i = 0; i < row->count; i++) {
        stage_x[i] = x[i];
        stage_v[i] = v[i];
        sum_x[i] = sum_v[i] = 0;
    }
}

CS_CLONES static void rk4_stage_row(const struct row *row) {
    const double weight = row->weight, forth = row->forth;
    const double *restrict x = row->x, *restrict v = row->v;
    const double *restrict w = row->inv_mass, *restrict f = row->a;
    double *restrict stage_x = row->kept[0], *restrict stage_v = row->kept[1];
    double *restrict sum_x = row->kept[2], *restrict sum_v = row->kept[3];
    for (size_t i = 0; i < row->count; i++) {
        const double a = f[i] * w[i];
        sum_x[i] += weight * stage_v[i];
        sum_v[i] += weight * a;
        stage_x[i] = x[i] + forth * stage_v[i];
        stage_v[i] = v[i] + forth * a;
    }
}

CS_CLONES static void rk4_end_row(const struct row *row) {
    const double h = row->h;
    const double *restrict sum_x = row->kept[2], *restrict sum_v = row->kept[3];
    double *restrict x = row->x, *restrict v = row->v;
    for (size_t i = 0; i < row->count; i++) {
        x[i] += h / 6 * sum_x[i];
        v[i] += h / 6 * sum_v[i];
    }
}

enum cs_step step_rk4(struct fixed_step *loop, double t, double h, double *x, double *v) {
    static const double weight[] = {1, 2, 2, 1}, reach[] = {0.5, 0.5, 1, 0};
    struct explicit_method *self = method_of(loop);
    const double *stage_x = self->history, *stage_v = stage_x + 3 * (size_t)loop->host->view->n;
    move_all(self, h, x, v, rk4_begin_row);
    /* stage k + 1 lies at t + reach[k] h; after the last there is none */
    double stage_t = t;
    for (int k = 0; k < 4; k++) {
        struct move stage = {.row = rk4_stage_row,
                             .self = self,
                             .x = x,
                             .v = v,
                             .weight = weight[k],
                             .forth = reach[k] * h};
        evaluate_and_share(&stage, stage_t, stage_x, stage_v);
        stage_t = t + stage.forth;
    }
    move_all(self, h, x, v, rk4_end_row);
    return CS_STEP_OK;
}

enum cs_step restart_position_verlet(void *object, double t, const double *x, const double *v) {
    ((struct explicit_method *)object)->h = 0;
    return fixed_step_restart(object, t, x, v);
}
