/* Curvatures along the normal of one stencil. The derivatives are those of the formulas of
 * normal_curvature.h by the product rule; none divides by what depends on the state. */
#include "model/elastic/normal_stencil.h"

#include "base/vec3.h"

#include <string.h>

/* Forces on a stencil: along the weights for each curvature, and on the ends of d[0], d[1]. */
struct reaction {
    double moment[3][3], end[2][3];
};

void cs_normal_stencil_sums(const struct cs_bending_stencil *of, size_t n, const double *p,
                            struct cs_normal_sums *sums) {
    *sums = (struct cs_normal_sums){0};
    for (size_t c = 0; p && c < 3; c++) {
        const double *q = p + c * n;
        for (uint32_t j = 1; j < of->n; j++)
            for (size_t a = 0; a < 3; a++)
                sums->k[a][c] += of->weights[a][j] * (q[of->at[j]] - q[of->at[0]]);
        for (size_t k = 0; k < 2; k++)
            sums->d[k][c] = q[of->at[of->ends[2 * k + 1]]] - q[of->at[of->ends[2 * k]]];
    }
}

/* out += the change of n with the changes `by` of both differences. */
static void add_normal_change(double product, const struct cs_normal_sums *at,
                              const struct cs_normal_sums *by, double out[3]) {
    double one[3], other[3];
    cs_vec3_cross(by->d[0], at->d[1], one);
    cs_vec3_cross(at->d[0], by->d[1], other);
    for (int c = 0; c < 3; c++)
        out[c] += (one[c] + other[c]) / product;
}

void cs_normal_stencil_state(const struct cs_bending_stencil *of, size_t n, const double *x,
                             const double *v, struct cs_normal_state *at) {
    *at = (struct cs_normal_state){.product = of->product};
    cs_normal_stencil_sums(of, n, x, &at->x);
    cs_normal_stencil_sums(of, n, v, &at->v);
    cs_vec3_cross(at->x.d[0], at->x.d[1], at->normal);
    for (int c = 0; c < 3; c++)
        at->normal[c] /= at->product;
    // rates over time
    add_normal_change(at->product, &at->x, &at->v, at->normal_rate);
    for (int a = 0; a < 3; a++) {
        at->kappa[a] = cs_vec3_dot(at->x.k[a], at->normal);
        at->kappa_rate[a] =
            cs_vec3_dot(at->v.k[a], at->normal) + cs_vec3_dot(at->x.k[a], at->normal_rate);
    }
}

/* A D s. */
static void multiply(const struct cs_moduli *D, const double s[3], double M[3]) {
    M[0] = D->warp * s[0] + D->coupling * s[1];
    M[1] = D->coupling * s[0] + D->weft * s[1];
    M[2] = D->shear * s[2];
}

void cs_normal_stencil_moments(const struct cs_bending_stencil *of,
                               const struct cs_normal_state *at, struct cs_normal_factors by,
                               double M[3]) {
    double s[3];
    for (int a = 0; a < 3; a++)
        s[a] = by.kappa * (at->kappa[a] - of->rest[a]) + by.rate * at->kappa_rate[a];
    multiply(&of->moduli, s, M);
}

/* out += m of the header, from the moments and vectors k. */
static void add_lever(double product, const double M[3], const double (*k)[3], double out[3]) {
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
            out[c] += M[a] * k[a][c] / product;
}

/* out += the forces on the ends of the differences d, by m. */
static void add_ends(const double (*d)[3], const double m[3], struct reaction *out) {
    double one[3], other[3];
    cs_vec3_cross(d[1], m, one);
    cs_vec3_cross(m, d[0], other);
    for (int c = 0; c < 3; c++) {
        out->end[0][c] += one[c];
        out->end[1][c] += other[c];
    }
}

static void find_reaction(const struct cs_normal_state *at, const double M[3],
                          struct reaction *out) {
    double m[3] = {0};
    *out = (struct reaction){0};
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 3; c++)
            out->moment[a][c] = M[a] * at->normal[c];
    add_lever(at->product, M, at->x.k, m);
    add_ends(at->x.d, m, out);
}

/* Change of n and of its rate, of the curvatures, and of their rates. */
struct change {
    double normal[3], normal_rate[3], kappa[3], kappa_rate[3];
};

static void find_change(const struct cs_normal_state *at, const struct cs_normal_sums *dx,
                        const struct cs_normal_sums *dv, struct change *by) {
    *by = (struct change){0};
    add_normal_change(at->product, &at->x, dx, by->normal);
    add_normal_change(at->product, &at->x, dv, by->normal_rate);
    add_normal_change(at->product, &at->v, dx, by->normal_rate);
    for (int a = 0; a < 3; a++) {
        by->kappa[a] = cs_vec3_dot(dx->k[a], at->normal) + cs_vec3_dot(at->x.k[a], by->normal);
        by->kappa_rate[a] =
            cs_vec3_dot(dv->k[a], at->normal) + cs_vec3_dot(at->v.k[a], by->normal) +
            cs_vec3_dot(dx->k[a], at->normal_rate) + cs_vec3_dot(at->x.k[a], by->normal_rate);
    }
}

/* Change of the reaction to moments M that change by dM. */
static void change_reaction(const struct cs_normal_state *at, const struct cs_normal_sums *dx,
                            const struct change *by, const double M[3], const double dM[3],
                            struct reaction *out) {
    double m[3] = {0}, dm[3] = {0};
    *out = (struct reaction){0};
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 3; c++)
            out->moment[a][c] = dM[a] * at->normal[c] + M[a] * by->normal[c];
    // product rule: m goes by M and k, the ends by m and the differences
    add_lever(at->product, M, at->x.k, m);
    add_lever(at->product, dM, at->x.k, dm);
    add_lever(at->product, M, dx->k, dm);
    add_ends(dx->d, m, out);
    add_ends(at->x.d, dm, out);
}

/* Forces on the points, times -1. */
static void spread(const struct cs_bending_stencil *of, const struct reaction *by,
                   double out[CS_NORMAL_FORCES]) {
    memset(out, 0, CS_NORMAL_FORCES * sizeof *out);
    for (size_t c = 0; c < 3; c++) {
        for (size_t j = 0; j < of->n; j++)
            for (size_t a = 0; a < 3; a++)
                out[3 * j + c] += of->weights[a][j] * by->moment[a][c];
        for (size_t k = 0; k < 2; k++) {
            out[3 * of->ends[2 * k + 1] + c] += by->end[k][c];
            out[3 * of->ends[2 * k] + c] -= by->end[k][c];
        }
    }
}

void cs_normal_stencil_force(const struct cs_bending_stencil *of,
                             const struct cs_normal_state *at, struct cs_normal_factors by,
                             double out[CS_NORMAL_FORCES]) {
    struct reaction reaction;
    double M[3];
    cs_normal_stencil_moments(of, at, by, M);
    find_reaction(at, M, &reaction);
    spread(of, &reaction, out);
}

void cs_normal_stencil_derivative(const struct cs_bending_stencil *of,
                                  const struct cs_normal_state *at, struct cs_normal_factors by,
                                  const struct cs_normal_sums *dx,
                                  const struct cs_normal_sums *dv,
                                  double out[CS_NORMAL_FORCES]) {
    struct reaction reaction;
    struct change change;
    double M[3], dM[3], s[3];
    find_change(at, dx, dv, &change);
    cs_normal_stencil_moments(of, at, by, M);
    for (int a = 0; a < 3; a++)
        s[a] = by.change * change.kappa[a] + by.change_rate * change.kappa_rate[a];
    multiply(&of->moduli, s, dM);
    change_reaction(at, dx, &change, M, dM, &reaction);
    spread(of, &reaction, out);
}
