/* Every force of the list is finite where shapes collapse, and its damping takes energy there.
 */
#include "contract_fixture.h"
#include "scene/scene.h"

#include <math.h>

/* The scene's bodies on the way into degenerate shapes: every stencil folds onto a line or a
 * point, the normals of all triangles vanish, pairs in contact come to one place. */
static void collapse(const struct fixture *cloth, const double *from, int axes, double share,
                     double *x) {
    for (uint32_t b = 0; b < cloth->session.scene->bodies.n; b++) {
        const struct cs_body_range *body = cloth->system->bodies + b;
        for (size_t c = 0; c < 3; c++)
            for (size_t i = c * N + body->first, k = 0; k < body->count; i++, k++) {
                const double to = from[c * N + body->first];
                x[i] = (int)c < axes ? to + (1 - share) * (from[i] - to) : from[i];
            }
    }
}

static bool all_finite(const double *a) {
    for (size_t i = 0; i < VALUES; i++)
        if (!isfinite(a[i]))
            return false;
    return true;
}

static double dot(const double *a, const double *b) {
    double sum = 0;
    for (size_t i = 0; i < VALUES; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Force, derivative, energy, matrix and bounds of one force at one state are finite, and its
 * damping takes energy. */
static void check_state(const struct fixture *cloth, const struct cs_term *term) {
    const struct cs_eval at = STATE_OF(cloth, term->part_bits);
    struct cs_eval change = at;
    double f[VALUES], df[VALUES], share[VALUES], p[VALUES], work[2 * N], omega, delta;
    for (size_t i = 0; i < VALUES; i++)
        p[i] = cloth->system->inv_mass[i % N] > 0 ? sin(1.7 * (double)i) : 0;
    force(cloth, at, f);
    change.dx = change.dv = p;
    cs_terms_jvp(cloth->system, &change, df);
    share_of(cloth, (struct cs_matrix){.cd = -0.02, .ck = -4e-4, .psd = true}, p, share);
    cs_spectral_bounds_at(cloth->system, &at, work, &omega, &delta);
    ck_assert_msg(all_finite(f) && all_finite(df), "%s: no force", term->name);
    ck_assert_msg(all_finite(share) && isfinite(omega) && isfinite(delta),
                  "%s: no matrix or bound", term->name);
    ck_assert_msg(!term->energy || isfinite(term->energy(cloth->system, &at)), "%s: no energy",
                  term->name);
    const struct cs_eval damping =
        STATE_OF(cloth, term->part_bits & (CS_PART_DAMPING | CS_PART_ELASTIC_DAMPING |
                                           CS_PART_DISSIPATIVE | CS_PART_DRAG));
    if (!damping.parts)
        return;
    force(cloth, damping, f);
    ck_assert_msg(dot(f, cloth->v) <= 1e-12, "%s: damping gives %g W", term->name,
                  dot(f, cloth->v));
}

TEST(every_force_is_finite_where_shapes_collapse) {
    for (uint32_t k = 0; k < cs_n_terms; k++)
        for (int axes = 1; axes <= 3; axes++) {
            struct fixture cloth;
            double from[VALUES];
            open(&cloth);
            leave_alone(&cloth, cs_terms[k]);
            memcpy(from, cloth.x, sizeof from);
            for (int step = 0; step <= 24; step++) {
                // to 1 in halves, and then there
                collapse(&cloth, from, axes, step < 24 ? 1 - ldexp(1, -2 * step) : 1, cloth.x);
                check_state(&cloth, cs_terms[k]);
            }
            fixture_close(&cloth);
        }
}
