/* hermite.c - the polynomial through positions, velocities and accelerations.
 *
 * With w_j(s) = prod_(k != j) ((s - s_k) / (s_j - s_k))^3 and u = s - s_j, the polynomials that
 * belong to x_j, v_j and a_j are w_j times
 *   1 - g u + c u^2,  u - g u^2,  u^2/2:
 * 1/w_j up to u^2, with g = w_j'(s_j) = sum_k 3/d and c = (g^2 + sum_k 3/d^2) / 2, d = s_j -
 * s_k. Times s are in lengths h of the first interval; positions are taken from the first end,
 * where the sum of their weights, 1, would cost digits. */
#include "hermite.h"
#include "parallel.h"

#include <math.h>

/* Weights of an end's position, velocity and acceleration: [0] in a position, [1] in a
 * velocity. */
struct weights {
    double x[2], v[2], a[2];
};

struct job {
    const struct hermite_end *ends;
    const struct weights *weights;
    int n_ends;
    size_t half; /* 3n */
    double *z;
};

static struct weights weights_of(int n_ends, const struct hermite_end *ends, double t, int j) {
    const double h = fabs(ends[1].t - ends[0].t);
    double value = 1, slope = 0, g = 0, q = 0;
    for (int k = 0; k < n_ends; k++) {
        if (k == j)
            continue;
        const double d = (ends[j].t - ends[k].t) / h, r = (t - ends[k].t) / h / d;
        slope = slope * r * r * r + value * 3 * r * r / d;
        value *= r * r * r;
        g += 3 / d;
        q += 3 / (d * d);
    }
    const double u = (t - ends[j].t) / h, c = (g * g + q) / 2;
    const double x = 1 - g * u + c * u * u, v = u - g * u * u, a = u * u / 2;
    return (struct weights){
        .x = {value * x, (slope * x + value * (2 * c * u - g)) / h},
        .v = {value * v * h, slope * v + value * (1 - 2 * g * u)},
        .a = {value * a * h * h, (slope * a + value * u) * h},
    };
}

/* Adds `count` numbers of end j from `at` on. */
CS_CLONES static void add_end(const struct job *job, int j, size_t at, size_t count) {
    const struct weights w = job->weights[j];
    const size_t half = job->half;
    const double *restrict x0 = job->ends->y + at, *restrict x = job->ends[j].y + at;
    const double *restrict v = job->ends[j].y + half + at, *restrict a = job->ends[j].a + at;
    double *restrict zx = job->z + at, *restrict zv = job->z + half + at;
    for (size_t i = 0; i < count; i++) {
        const double moved = x[i] - x0[i];
        zx[i] += w.x[0] * moved + w.v[0] * v[i] + w.a[0] * a[i];
        zv[i] += w.x[1] * moved + w.v[1] * v[i] + w.a[1] * a[i];
    }
}

static void state_part(void *arg, size_t begin, size_t end) {
    const struct job *job = arg;
    for (size_t i = begin; i < end; i++) {
        job->z[i] = job->ends->y[i];
        job->z[job->half + i] = 0;
    }
    for (int j = 0; j < job->n_ends; j++)
        add_end(job, j, begin, end - begin);
}

void hermite_state(const struct cs_host *host, int n_ends, const struct hermite_end *ends,
                   double t, double *z) {
    struct weights weights[HERMITE_ENDS];
    const size_t n = host->view->n;
    struct job job = {ends, weights, n_ends, 3 * n, z};
    for (int j = 0; j < n_ends; j++)
        weights[j] = weights_of(n_ends, ends, t, j);
    parallel_for(host, job.half, state_part, &job);
    // weights sum to 1 but for rounding, which moves what must not move
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3 && host->view->inv_mass[i] == 0; c++) {
            const double v = ends->y[(3 + c) * n + i];
            z[c * n + i] = ends->y[c * n + i] + (t - ends->t) * v;
            z[(3 + c) * n + i] = v;
        }
}
