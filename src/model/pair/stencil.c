/* Gradient of the distance of a pair by the adjoint of its two equations, and the derivative of
 * that gradient forwards, value and change side by side. */
#include "model/pair/stencil.h"

/* What the gradient is made of; the slopes of d by l1, l2 before the clamp, and the adjoint. */
struct slopes {
    double by_weight[2]; /* of d by L1, L2 */
    double mean;         /* of a triangle */
    double h[3];         /* of a triangle: by l0, l1, l2, each on its own */
    double k[2], z[2], y[3];
};

static void set_slopes(const struct cs_stencil *s, struct slopes *slopes) {
    const double *g = slopes->by_weight;
    slopes->by_weight[0] = -cs_vec3_dot(s->n, s->u);
    slopes->by_weight[1] = -cs_vec3_dot(s->n, s->v);
    slopes->mean = s->weight[0] * g[0] + s->weight[1] * g[1];
    if (s->kind == CS_STENCIL_EDGES) {
        slopes->k[0] = g[0] * s->soft[0][1];
        slopes->k[1] = g[1] * s->soft[1][1];
    } else {
        const double sum = s->soft[0][0] + s->soft[1][0] + s->soft[2][0];
        slopes->h[0] = -slopes->mean * s->soft[0][1] / sum;
        slopes->h[1] = (g[0] - slopes->mean) * s->soft[1][1] / sum;
        slopes->h[2] = (g[1] - slopes->mean) * s->soft[2][1] / sum;
        slopes->k[0] = slopes->h[1] - slopes->h[0];
        slopes->k[1] = slopes->h[2] - slopes->h[0];
    }
    cs_stencil_solve(s, slopes->k, slopes->z);
    for (int c = 0; c < 3; c++)
        slopes->y[c] = slopes->z[0] * s->u[c] + slopes->z[1] * s->v[c];
}

void cs_stencil_gradient(const struct cs_stencil *s, double g[4][3]) {
    struct slopes at;
    set_slopes(s, &at);
    const double pull[2] = {s->q * (1 - 2 * s->l[0]), s->q * (1 - 2 * s->l[1])};
    for (int c = 0; c < 3; c++) {
        const double r = s->w[c] - s->l[0] * s->u[c] - s->l[1] * s->v[c];
        const double u = at.z[0] * (r + pull[0] * s->u[c]) - s->l[0] * at.y[c];
        const double v = at.z[1] * (r + pull[1] * s->v[c]) - s->l[1] * at.y[c];
        double out[4];
        cs_stencil_spread(s->kind, u - s->weight[0] * s->n[c], v - s->weight[1] * s->n[c],
                          at.y[c] + s->n[c], out);
        for (int k = 0; k < 4; k++)
            g[k][c] = out[k];
    }
}

/* The changes along a direction, in the order in which they follow from each other. */
struct changes {
    double u[3], v[3], w[3];
    double a, b, c;
    double l[2], weight[2], n[3];
    double by_weight[2], k[2], z[2], y[3];
};

/* change of the solution of the two equations, when their right side changes by `right` */
static void change_solution(const struct cs_stencil *s, const struct changes *d,
                            const double solution[2], const double right[2], double out[2]) {
    const double grown = 1 + s->q;
    const double rest[2] = {right[0] - grown * d->a * solution[0] - d->b * solution[1],
                            right[1] - d->b * solution[0] - grown * d->c * solution[1]};
    cs_stencil_solve(s, rest, out);
}

static void change_places(const struct cs_stencil *s, struct changes *d) {
    d->a = 2 * cs_vec3_dot(s->u, d->u);
    d->b = cs_vec3_dot(s->u, d->v) + cs_vec3_dot(d->u, s->v);
    d->c = 2 * cs_vec3_dot(s->v, d->v);
    const double right[2] = {
        cs_vec3_dot(d->u, s->w) + cs_vec3_dot(s->u, d->w) + 0.5 * s->q * d->a,
        cs_vec3_dot(d->v, s->w) + cs_vec3_dot(s->v, d->w) + 0.5 * s->q * d->c};
    change_solution(s, d, s->l, right, d->l);
}

/* of a triangle: change of S(l0) + S(l1) + S(l2), and of the weights */
static double change_triangle(const struct cs_stencil *s, struct changes *d) {
    const double sum = s->soft[0][0] + s->soft[1][0] + s->soft[2][0];
    const double first = s->soft[1][1] * d->l[0], second = s->soft[2][1] * d->l[1];
    const double dsum = first + second - s->soft[0][1] * (d->l[0] + d->l[1]);
    d->weight[0] = (first - s->weight[0] * dsum) / sum;
    d->weight[1] = (second - s->weight[1] * dsum) / sum;
    return dsum;
}

static void change_direction(const struct cs_stencil *s, struct changes *d) {
    double dr[3];
    for (int c = 0; c < 3; c++)
        dr[c] = d->w[c] - s->weight[0] * d->u[c] - s->weight[1] * d->v[c] -
                d->weight[0] * s->u[c] - d->weight[1] * s->v[c];
    const double dd = cs_vec3_dot(s->n, dr);
    for (int c = 0; c < 3; c++)
        d->n[c] = (dr[c] - s->n[c] * dd) / s->d;
    d->by_weight[0] = -cs_vec3_dot(d->n, s->u) - cs_vec3_dot(s->n, d->u);
    d->by_weight[1] = -cs_vec3_dot(d->n, s->v) - cs_vec3_dot(s->n, d->v);
}

static void change_slopes(const struct cs_stencil *s, const struct slopes *at, double dsum,
                          struct changes *d) {
    if (s->kind == CS_STENCIL_EDGES) {
        for (int i = 0; i < 2; i++)
            d->k[i] =
                d->by_weight[i] * s->soft[i][1] + at->by_weight[i] * s->soft[i][2] * d->l[i];
        return;
    }
    const double sum = s->soft[0][0] + s->soft[1][0] + s->soft[2][0];
    const double dmean = d->weight[0] * at->by_weight[0] + s->weight[0] * d->by_weight[0] +
                         d->weight[1] * at->by_weight[1] + s->weight[1] * d->by_weight[1];
    const double g[3] = {0, at->by_weight[0], at->by_weight[1]};
    const double dg[3] = {0, d->by_weight[0], d->by_weight[1]};
    const double dl[3] = {-d->l[0] - d->l[1], d->l[0], d->l[1]};
    double dh[3];
    for (int i = 0; i < 3; i++)
        dh[i] = ((dg[i] - dmean) * s->soft[i][1] + (g[i] - at->mean) * s->soft[i][2] * dl[i] -
                 at->h[i] * dsum) /
                sum;
    d->k[0] = dh[1] - dh[0];
    d->k[1] = dh[2] - dh[0];
}

/* change of the gradient by the differences, component c, to the four points */
static void change_gradient(const struct cs_stencil *s, const struct slopes *at,
                            const struct changes *d, int c, double out[4]) {
    const double *u = s->u, *v = s->v, *l = s->l, *z = at->z;
    const double pull[2] = {s->q * (1 - 2 * l[0]), s->q * (1 - 2 * l[1])};
    const double r = s->w[c] - l[0] * u[c] - l[1] * v[c];
    const double dr =
        d->w[c] - l[0] * d->u[c] - l[1] * d->v[c] - d->l[0] * u[c] - d->l[1] * v[c];
    const double du = d->z[0] * (r + pull[0] * u[c]) +
                      z[0] * (dr + pull[0] * d->u[c] - 2 * s->q * d->l[0] * u[c]) -
                      d->l[0] * at->y[c] - l[0] * d->y[c];
    const double dv = d->z[1] * (r + pull[1] * v[c]) +
                      z[1] * (dr + pull[1] * d->v[c] - 2 * s->q * d->l[1] * v[c]) -
                      d->l[1] * at->y[c] - l[1] * d->y[c];
    cs_stencil_spread(s->kind, du - d->weight[0] * s->n[c] - s->weight[0] * d->n[c],
                      dv - d->weight[1] * s->n[c] - s->weight[1] * d->n[c], d->y[c] + d->n[c],
                      out);
}

void cs_stencil_tangent(const struct cs_stencil *s, double dp[4][3], double dg[4][3],
                        double dweights[4]) {
    struct slopes at;
    struct changes d;
    double dsum = 0, out[4];
    set_slopes(s, &at);
    cs_stencil_differences(s->kind, dp, d.u, d.v, d.w);
    change_places(s, &d);
    if (s->kind == CS_STENCIL_EDGES)
        for (int i = 0; i < 2; i++)
            d.weight[i] = s->soft[i][1] * d.l[i];
    else
        dsum = change_triangle(s, &d);
    change_direction(s, &d);
    change_slopes(s, &at, dsum, &d);
    change_solution(s, &d, at.z, d.k, d.z);
    for (int c = 0; c < 3; c++)
        d.y[c] = d.z[0] * s->u[c] + at.z[0] * d.u[c] + d.z[1] * s->v[c] + at.z[1] * d.v[c];
    for (int c = 0; c < 3; c++) {
        change_gradient(s, &at, &d, c, out);
        for (int k = 0; k < 4; k++)
            dg[k][c] = out[k];
    }
    cs_stencil_spread(s->kind, -d.weight[0], -d.weight[1], 0, dweights);
}
