/* explicit_steps.c - one step of each explicit method.
 *
 * With a = f(t, x, v) / m and step h, ' marking the new state:
 *   explicit-euler    x' = x + h v,              v' = v + h a    (cloth thesis, eq. 5.15)
 *   symplectic-euler  v' = v + h a,              x' = x + h v'   (flag thesis; HLW 2006, I.1.2)
 *   averaged-euler    v' = v + h a,              x' = x + h (v + v')/2   (cloth article)
 *   velocity-verlet   x' = x + h v + h^2/2 a,    v' = v + h/2 (a + a'),
 *                     a' = a(x', v + h a): one evaluation a step, a' is kept for the next
 *   position-verlet   x' = (2 - l) x - (1 - l) x_old + h^2 a(x, (x - x_old)/h)
 *                     (flag thesis, with its loss l), v' = (x' - x)/h + h/2 a
 *   rk4               y' = y + h/6 (k1 + 2 k2 + 2 k3 + k4), y = (x, v), k1 = F(t, y),
 *                     k2 = F(t + h/2, y + h/2 k1), k3 = F(t + h/2, y + h/2 k2),
 *                     k4 = F(t + h, y + h k3)   (Kutta 1901)
 */
#include "explicit_steps.h"

static struct explicit_method *method_of(struct fixed_step *loop) {
    return (struct explicit_method *)loop;
}

static size_t length_of(const struct explicit_method *self) {
    return 3 * (size_t)self->loop.host->view->n;
}

static void evaluate(struct explicit_method *self, double t, const double *x, const double *v) {
    const struct cs_host *host = self->loop.host;
    const size_t n = host->view->n;
    host->force(host->ctx, t, x, v, CS_PART_ALL, self->a);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            self->a[c * n + i] *= host->view->inv_mass[i];
}

enum cs_step step_explicit_euler(struct fixed_step *loop, double t, double h, double *x,
                                 double *v) {
    struct explicit_method *self = method_of(loop);
    evaluate(self, t, x, v);
    const size_t length = length_of(self);
    const double *a = self->a;
    for (size_t i = 0; i < length; i++) {
        x[i] += h * v[i];
        v[i] += h * a[i];
    }
    return CS_STEP_OK;
}

enum cs_step step_symplectic_euler(struct fixed_step *loop, double t, double h, double *x,
                                   double *v) {
    struct explicit_method *self = method_of(loop);
    evaluate(self, t, x, v);
    const size_t length = length_of(self);
    const double *a = self->a;
    for (size_t i = 0; i < length; i++) {
        v[i] += h * a[i];
        x[i] += h * v[i];
    }
    return CS_STEP_OK;
}

enum cs_step step_averaged_euler(struct fixed_step *loop, double t, double h, double *x,
                                 double *v) {
    struct explicit_method *self = method_of(loop);
    evaluate(self, t, x, v);
    const size_t length = length_of(self);
    const double *a = self->a;
    for (size_t i = 0; i < length; i++) {
        const double v_old = v[i];
        v[i] += h * a[i];
        x[i] += h * ((v_old + v[i]) / 2);
    }
    return CS_STEP_OK;
}

enum cs_step step_velocity_verlet(struct fixed_step *loop, double t, double h, double *x,
                                  double *v) {
    struct explicit_method *self = method_of(loop);
    const size_t length = length_of(self);
    double *a = self->a, *old_a = self->kept;
    if (loop->fresh)
        evaluate(self, t, x, v);
    // v goes through v + h a, which is what damping and drag see at the new time
    for (size_t i = 0; i < length; i++) {
        x[i] += h * (v[i] + h / 2 * a[i]);
        v[i] += h * a[i];
        old_a[i] = a[i];
    }
    evaluate(self, t + h, x, v);
    for (size_t i = 0; i < length; i++)
        v[i] += h / 2 * (a[i] - old_a[i]);
    return CS_STEP_OK;
}

/* In u = (x - x_old)/h the recurrence is u' = (1 - l) u + h a, x' = x + h u': the same in exact
 * arithmetic, without the difference of near positions. Where u is not known (at the start, or
 * where commit moved v or h is another) it is v - h/2 a: a Taylor step. */
enum cs_step step_position_verlet(struct fixed_step *loop, double t, double h, double *x,
                                  double *v) {
    struct explicit_method *self = method_of(loop);
    const size_t length = length_of(self);
    double *a = self->a, *u = self->kept;
    const bool start = self->h <= 0;
    if (start)
        evaluate(self, t, x, v);
    if (loop->fresh || fabs(h - self->h) > 1e-9 * h)
        for (size_t i = 0; i < length; i++)
            u[i] = v[i] - h / 2 * a[i];
    if (!start)
        evaluate(self, t, x, u);
    for (size_t i = 0; i < length; i++) {
        u[i] = (1 - self->loss) * u[i] + h * a[i];
        x[i] += h * u[i];
        v[i] = u[i] + h / 2 * a[i];
    }
    self->h = h;
    return CS_STEP_OK;
}

enum cs_step step_rk4(struct fixed_step *loop, double t, double h, double *x, double *v) {
    static const double weight[] = {1, 2, 2, 1}, reach[] = {0.5, 0.5, 1, 0};
    struct explicit_method *self = method_of(loop);
    const size_t length = length_of(self);
    const double *a = self->a;
    double *stage_x = self->kept, *stage_v = stage_x + length;
    double *sum_x = stage_v + length, *sum_v = sum_x + length;
    for (size_t i = 0; i < length; i++) {
        stage_x[i] = x[i];
        stage_v[i] = v[i];
        sum_x[i] = sum_v[i] = 0;
    }
    double stage_t = t;
    for (int k = 0; k < 4; k++) {
        evaluate(self, stage_t, stage_x, stage_v);
        const double forth = reach[k] * h;
        for (size_t i = 0; i < length; i++) {
            sum_x[i] += weight[k] * stage_v[i];
            sum_v[i] += weight[k] * a[i];
            stage_x[i] = x[i] + forth * stage_v[i];
            stage_v[i] = v[i] + forth * a[i];
        }
        stage_t = t + forth;
    }
    for (size_t i = 0; i < length; i++) {
        x[i] += h / 6 * sum_x[i];
        v[i] += h / 6 * sum_v[i];
    }
    return CS_STEP_OK;
}

enum cs_step restart_position_verlet(void *object, double t, const double *x, const double *v) {
    ((struct explicit_method *)object)->h = 0;
    return fixed_step_restart(object, t, x, v);
}
