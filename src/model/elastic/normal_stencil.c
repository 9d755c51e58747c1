/* Curvatures along the normal of one stencil. The derivatives are those of the formulas of
 * normal_stencil.h by the product rule. */
#include "model/elastic/normal_stencil.h"

#include "base/vec3.h"
#include "scene/elastic_keys.h"

#include <math.h>
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

/* Change of the product of the differences with the changes `by` of both. */
static void product_rate(const struct cs_normal_sums *at, const struct cs_normal_sums *by,
                         double out[3]) {
    double one[3], other[3];
    cs_vec3_cross(by->d[0], at->d[1], one);
    cs_vec3_cross(at->d[0], by->d[1], other);
    for (int c = 0; c < 3; c++)
        out[c] = one[c] + other[c];
}

/* Change of n with a change of the product. */
static void normal_rate(const struct cs_normal_state *state, const double rate[3],
                        double out[3]) {
    const double along = state->length_slope * cs_vec3_dot(state->normal, rate);
    for (int c = 0; c < 3; c++)
        out[c] = (rate[c] - along * state->normal[c]) / state->length;
}

void cs_normal_stencil_state(const struct cs_bending_stencil *of, size_t n, const double *x,
                             const double *v, struct cs_normal_state *state) {
    cs_normal_stencil_sums(of, n, x, &state->x);
    cs_normal_stencil_sums(of, n, v, &state->v);
    cs_vec3_cross(state->x.d[0], state->x.d[1], state->normal);
    // of a curved body L is L0 at rest too
    const double squared = cs_vec3_dot(state->normal, state->normal),
                 least = of->product * of->product;
    state->length_slope = of->is_curved ? 1 / (1 + CS_NORMAL_FLOOR) : 0;
    state->length = of->is_curved
                        ? sqrt(state->length_slope * (squared + CS_NORMAL_FLOOR * least))
                        : of->product;
    for (int c = 0; c < 3; c++)
        state->normal[c] /= state->length;
    // rates over time
    product_rate(&state->x, &state->v, state->rate);
    normal_rate(state, state->rate, state->turn);
    for (int a = 0; a < 3; a++) {
        state->kappa[a] = cs_vec3_dot(state->x.k[a], state->normal);
        state->kappa_rate[a] =
            cs_vec3_dot(state->v.k[a], state->normal) + cs_vec3_dot(state->x.k[a], state->turn);
    }
}

void cs_normal_stencil_moments(const struct cs_bending_stencil *of,
                               const struct cs_normal_state *state, struct cs_normal_factors by,
                               double M[3]) {
    double s[3];
    for (int a = 0; a < 3; a++)
        s[a] = by.kappa * (state->kappa[a] - of->rest[a]) + by.rate * state->kappa_rate[a];
    cs_moduli_multiply(&of->moduli, s, M);
}

/* m of the header. */
static void find_lever(const struct cs_normal_state *state, const double M[3], double m[3]) {
    for (int c = 0; c < 3; c++) {
        m[c] = 0;
        for (int a = 0; a < 3; a++)
            m[c] +=
                M[a] *
                (state->x.k[a][c] - state->length_slope * state->kappa[a] * state->normal[c]) /
                state->length;
    }
}

static void find_reaction(const struct cs_normal_state *state, const double M[3],
                          struct reaction *out) {
    double m[3];
    find_lever(state, M, m);
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 3; c++)
            out->moment[a][c] = M[a] * state->normal[c];
    cs_vec3_cross(state->x.d[1], m, out->end[0]);
    cs_vec3_cross(m, state->x.d[0], out->end[1]);
}

/* Change of the curvatures, and of their rates. */
struct change {
    double product[3], normal[3], length, kappa[3], kappa_rate[3];
};

/* Change of the rate of the normal with changes of positions and velocities. */
static void find_turn_change(const struct cs_normal_state *state,
                             const struct cs_normal_sums *dx, const struct cs_normal_sums *dv,
                             const struct change *by, double out[3]) {
    double by_velocity[3], by_position[3], product[3];
    product_rate(&state->x, dv, by_velocity);
    product_rate(&state->v, dx, by_position);
    for (int c = 0; c < 3; c++)
        product[c] = by_velocity[c] + by_position[c];
    const double along = state->length_slope * cs_vec3_dot(state->normal, state->rate);
    const double turned = state->length_slope * (cs_vec3_dot(by->normal, state->rate) +
                                                 cs_vec3_dot(state->normal, product));
    for (int c = 0; c < 3; c++)
        out[c] = (product[c] - by->normal[c] * along - state->normal[c] * turned -
                  state->turn[c] * by->length) /
                 state->length;
}

static void find_change(const struct cs_normal_state *state, const struct cs_normal_sums *dx,
                        const struct cs_normal_sums *dv, struct change *by) {
    double turn[3];
    product_rate(&state->x, dx, by->product);
    by->length = state->length_slope * cs_vec3_dot(state->normal, by->product);
    normal_rate(state, by->product, by->normal);
    find_turn_change(state, dx, dv, by, turn);
    for (int a = 0; a < 3; a++) {
        by->kappa[a] =
            cs_vec3_dot(dx->k[a], state->normal) + cs_vec3_dot(state->x.k[a], by->normal);
        by->kappa_rate[a] =
            cs_vec3_dot(dv->k[a], state->normal) + cs_vec3_dot(state->v.k[a], by->normal) +
            cs_vec3_dot(dx->k[a], state->turn) + cs_vec3_dot(state->x.k[a], turn);
    }
}

/* Change of the reaction to moments M that change by dM. */
static void change_reaction(const struct cs_normal_state *state,
                            const struct cs_normal_sums *dx, const struct change *by,
                            const double M[3], const double dM[3], struct reaction *out) {
    double m[3], dm[3], one[3], other[3];
    find_lever(state, M, m);
    find_lever(state, dM, dm);
    for (int c = 0; c < 3; c++) {
        for (int a = 0; a < 3; a++) {
            dm[c] += M[a] *
                     (dx->k[a][c] - state->length_slope * (by->kappa[a] * state->normal[c] +
                                                           state->kappa[a] * by->normal[c])) /
                     state->length;
            out->moment[a][c] = dM[a] * state->normal[c] + M[a] * by->normal[c];
        }
        // the length divides m
        dm[c] -= m[c] * by->length / state->length;
    }
    cs_vec3_cross(dx->d[1], m, one);
    cs_vec3_cross(state->x.d[1], dm, other);
    for (int c = 0; c < 3; c++)
        out->end[0][c] = one[c] + other[c];
    cs_vec3_cross(dm, state->x.d[0], one);
    cs_vec3_cross(m, dx->d[0], other);
    for (int c = 0; c < 3; c++)
        out->end[1][c] = one[c] + other[c];
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
                             const struct cs_normal_state *state, struct cs_normal_factors by,
                             double out[CS_NORMAL_FORCES]) {
    struct reaction reaction;
    double M[3];
    cs_normal_stencil_moments(of, state, by, M);
    find_reaction(state, M, &reaction);
    spread(of, &reaction, out);
}

void cs_normal_stencil_derivative(const struct cs_bending_stencil *of,
                                  const struct cs_normal_state *state,
                                  struct cs_normal_factors by, const struct cs_normal_sums *dx,
                                  const struct cs_normal_sums *dv,
                                  double out[CS_NORMAL_FORCES]) {
    struct reaction reaction;
    struct change change;
    double M[3], dM[3], s[3];
    find_change(state, dx, dv, &change);
    cs_normal_stencil_moments(of, state, by, M);
    for (int a = 0; a < 3; a++)
        s[a] = by.change * change.kappa[a] + by.change_rate * change.kappa_rate[a];
    cs_moduli_multiply(&of->moduli, s, dM);
    change_reaction(state, dx, &change, M, dM, &reaction);
    spread(of, &reaction, out);
}
