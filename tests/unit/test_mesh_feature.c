/* What a point feels of a mesh, triangle by triangle: once over what is flat, never drawn to
 * it, with exact derivatives, and as far as the true distance says. */
#include "model/contact/barrier_law.h"
#include "model/contact/narrow_phase/feature_weights.h"
#include "model/contact/narrow_phase/mesh_feature.h"
#include "pair_positions.h"
#include "unit.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* --- a feature --- */

static const struct cs_feature_kind forms[] = {{1, 1, 0.2}, {0, 1, 0.2}, {0, 0, 0.2}};

static double distance_at(struct cs_feature_kind kind, double p[4][3], double g[4][3]) {
    struct cs_mesh_feature feature;
    cs_mesh_feature_set(&feature, kind, p);
    cs_mesh_feature_to_points(feature.g, g);
    return feature.d;
}

/* value, weights and gradient by differences of fourth order along dp */
struct slopes {
    double d, weight[4], g[4][3], scale;
};

static void differ(struct cs_feature_kind kind, double p[4][3], double dp[4][3],
                   struct slopes *by) {
    static const double at[4] = {-2, -1, 1, 2},
                        share[4] = {1.0 / 12, -8.0 / 12, 8.0 / 12, -1.0 / 12};
    const double step = 1e-5;
    *by = (struct slopes){0};
    for (int j = 0; j < 4; j++) {
        double moved[4][3], g[4][3], weight[4];
        struct cs_mesh_feature feature;
        for (int k = 0; k < 12; k++)
            moved[k / 3][k % 3] = p[k / 3][k % 3] + at[j] * step * dp[k / 3][k % 3];
        cs_mesh_feature_set(&feature, kind, moved);
        cs_mesh_feature_to_points(feature.g, g);
        cs_mesh_feature_weights(&feature, weight);
        by->d += share[j] / step * feature.d;
        for (int k = 0; k < 4; k++) {
            by->weight[k] += share[j] / step * weight[k];
            for (int c = 0; c < 3; c++)
                by->g[k][c] += share[j] / step * g[k][c];
        }
    }
}

TEST(derivatives_are_those_of_differences) {
    uint64_t state = 1;
    double worst[3] = {0};
    for (int k = 0; k < 30000; k++) {
        const struct cs_feature_kind kind = forms[k % 3];
        double p[4][3], dp[4][3], g[4][3], dg[4][3], dw[4], along = 0;
        struct cs_mesh_feature feature;
        struct slopes by;
        place_facet(&state, k, p);
        for (int i = 0; i < 12; i++)
            dp[i / 3][i % 3] = draw(&state);
        cs_mesh_feature_set(&feature, kind, p);
        cs_mesh_feature_to_points(feature.g, g);
        cs_mesh_feature_tangent(&feature, dp, dg, dw);
        differ(kind, p, dp, &by);
        for (int i = 0; i < 4; i++) {
            along += cs_vec3_dot(g[i], dp[i]);
            worst[1] = fmax(worst[1], fabs(by.weight[i] - dw[i]) / 40);
            for (int c = 0; c < 3; c++)
                worst[2] = fmax(worst[2], fabs(by.g[i][c] - dg[i][c]) / 40);
        }
        worst[0] = fmax(worst[0], fabs(along - by.d));
    }
    ck_assert_msg(worst[0] < 1e-9 && worst[1] < 1e-9 && worst[2] < 1e-9, "%g %g %g", worst[0],
                  worst[1], worst[2]);
}

/* a force along the gradient moves and turns nothing as a whole */
TEST(gradient_keeps_momentum) {
    uint64_t state = 3;
    double worst = 0;
    for (int k = 0; k < 10000; k++) {
        double p[4][3], g[4][3];
        place_facet(&state, k, p);
        distance_at(forms[k % 3], p, g);
        worst = fmax(worst, place_whole(p, g));
    }
    ck_assert_msg(worst < 1e-12, "%g", worst);
}

/* --- a mesh --- */
enum { CELLS = 4, POINTS = (CELLS + 1) * (CELLS + 1) + 1, TRIANGLES = 2 * CELLS * CELLS };

/* a point over a field of triangles, of which the point is number 0 */
struct field {
    struct cs_arena arena;
    struct cs_surfaces surfaces;
    struct cs_feature_weights weights;
    uint32_t triangles[3 * TRIANGLES], edges[6 * TRIANGLES], owners[6 * TRIANGLES];
    double x[3 * POINTS];
};

static void add_edge(struct field *field, uint32_t a, uint32_t b, uint32_t triangle) {
    struct cs_surfaces *s = &field->surfaces;
    uint32_t e = 0;
    while (e < s->n_edges && (s->edges[2 * e] != a || s->edges[2 * e + 1] != b))
        e++;
    if (e < s->n_edges) {
        s->edge_triangles[2 * e + 1] = triangle;
        return;
    }
    s->edges[2 * e] = a;
    s->edges[2 * e + 1] = b;
    s->edge_triangles[2 * e] = triangle;
    s->edge_triangles[2 * e + 1] = CS_NO_TRIANGLE;
    s->n_edges++;
}

static int by_ends(const void *a, const void *b) {
    const uint32_t *first = a, *second = b;
    for (int k = 0; k < 2; k++)
        if (first[k] != second[k])
            return first[k] < second[k] ? -1 : 1;
    return 0;
}

/* edges by their first ends, owners along with them */
static void sort_edges(struct cs_surfaces *s) {
    static uint32_t rows[3 * TRIANGLES][4];
    for (uint32_t e = 0; e < s->n_edges; e++) {
        memcpy(rows[e], s->edges + 2 * e, 2 * sizeof(uint32_t));
        memcpy(rows[e] + 2, s->edge_triangles + 2 * e, 2 * sizeof(uint32_t));
    }
    qsort(rows, s->n_edges, sizeof rows[0], by_ends);
    for (uint32_t e = 0; e < s->n_edges; e++) {
        memcpy(s->edges + 2 * e, rows[e], 2 * sizeof(uint32_t));
        memcpy(s->edge_triangles + 2 * e, rows[e] + 2, 2 * sizeof(uint32_t));
    }
}

static void open(struct field *field, double jitter, uint64_t *state) {
    struct cs_error error = {0};
    memset(field, 0, sizeof *field);
    struct cs_surfaces *s = &field->surfaces;
    *s = (struct cs_surfaces){.n_points = POINTS,
                              .n_triangles = TRIANGLES,
                              .triangles = field->triangles,
                              .edges = field->edges,
                              .edge_triangles = field->owners};
    for (uint32_t i = 0; i < POINTS - 1; i++) {
        field->x[1 + i] = i % (CELLS + 1) - CELLS / 2.0 + jitter * draw(state);
        field->x[POINTS + 1 + i] = (i / (CELLS + 1)) - CELLS / 2.0 + jitter * draw(state);
    }
    for (uint32_t t = 0; t < TRIANGLES; t++) {
        const uint32_t cell = t / 2, a = 1 + cell / CELLS * (CELLS + 1) + cell % CELLS;
        const uint32_t corners[2][3] = {{a, a + 1, a + CELLS + 1},
                                        {a + 1, a + CELLS + 2, a + CELLS + 1}};
        memcpy(s->triangles + 3 * t, corners[t % 2], sizeof corners[0]);
        for (int k = 0; k < 3; k++) {
            const uint32_t i = corners[t % 2][k], j = corners[t % 2][(k + 1) % 3];
            add_edge(field, i < j ? i : j, i < j ? j : i, t);
        }
    }
    sort_edges(s);
    ck_assert_int_eq(cs_feature_weights_init(&field->weights, s, &field->arena, &error), CS_OK);
}

static void place_of(const struct field *field, const uint32_t at[4], double p[4][3]) {
    for (int k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            p[k][c] = field->x[c * POINTS + at[k]];
}

/* what one feature has of energy and force */
static double add(const struct field *field, const uint32_t at[4], struct cs_feature_kind kind,
                  double within, double count, double force[3]) {
    double p[4][3], g[4][3];
    place_of(field, at, p);
    const double d = distance_at(kind, p, g);
    for (int i = 0; i < 3; i++)
        force[i] += count * cs_barrier_at(d, within, 1).force * g[0][i];
    return count * cs_barrier_energy(d, within, 1);
}

/* energy of the point, k = 1, and the force on it */
static double energy_at(struct field *field, double range, double force[3]) {
    const struct cs_surfaces *s = &field->surfaces;
    static struct cs_weighted_feature features[CS_FEATURES_PER_TRIANGLE * TRIANGLES];
    double energy = 0;
    uint32_t n = 0;
    memset(force, 0, 3 * sizeof *force);
    for (uint32_t t = 0; t < TRIANGLES; t++) {
        const uint32_t *c = s->triangles + 3 * t;
        const struct cs_feature_query pair = {
            .points = {0, c[0], c[1], c[2]}, .triangle = t, .range = range};
        n = cs_feature_weights_join(
            features, n,
            cs_feature_weights_find(&field->weights, &pair, 1, field->x, features + n));
    }
    for (uint32_t k = 0; k < n; k++)
        energy += add(field, features[k].points, features[k].kind,
                      CS_FEATURE_RANGE_RATIO * range, features[k].weight, force);
    return energy;
}

static void put(struct field *field, double x, double y, double z) {
    field->x[0] = x;
    field->x[POINTS] = y;
    field->x[(size_t)2 * POINTS] = z;
}

/* over the inside of any flat mesh it is the law of the height, with no force along it */
TEST(flat_meshes_are_felt_once) {
    const double range = 0.4, y[] = {0.2, 0.5, 0.7, 0.9};
    uint64_t state = 5;
    double worst = 0;
    struct field field;
    for (int mesh = 0; mesh < 3; mesh++) {
        open(&field, 0.12 * mesh, &state);
        for (int k = 0; k < 4000; k++) {
            double force[3];
            put(&field, 1.2 * draw(&state), 1.2 * draw(&state), y[k % 4] * range);
            const double energy = energy_at(&field, range, force);
            const double within = CS_FEATURE_RANGE_RATIO * range;
            const double right = cs_barrier_energy(y[k % 4] * range, within, 1);
            const double push = cs_barrier_at(y[k % 4] * range, within, 1).force;
            worst = fmax(worst, fabs(energy / right - 1));
            worst = fmax(worst, fabs(force[2] / push - 1));
            worst = fmax(worst, hypot(force[0], force[1]) / push);
        }
        cs_arena_finish(&field.arena);
    }
    ck_assert_msg(worst < 1e-9, "%g", worst);
}

/* --- bent meshes --- */

enum shape { RIDGE, VALLEY, TIP, PIT, SADDLE, CRUMPLED, SHAPES };

static double height_of(enum shape shape, double bend, double x, double y, uint64_t *state) {
    const double t = tan(bend / 2);
    const double of[SHAPES] = {-t * fabs(x),
                               t * fabs(x),
                               -t * hypot(x, y),
                               t * hypot(x, y),
                               t * (fabs(x) - fabs(y)),
                               0.5 * t * draw(state)};
    return of[shape];
}

static void bend(struct field *field, enum shape shape, double by, uint64_t *state) {
    double *x = field->x;
    for (size_t i = 1; i < POINTS; i++)
        x[2 * POINTS + i] = height_of(shape, by, x[i], x[POINTS + i], state);
}

/* m, from the point to a triangle; to = the nearest of its points */
static double nearest_on(const struct field *field, const uint32_t *corners, double to[3]) {
    double p[4][3], best = HUGE_VAL, share[2];
    struct cs_pair_distance plane;
    place_of(field, (uint32_t[4]){0, corners[0], corners[1], corners[2]}, p);
    cs_pair_distance_frame(&plane, CS_PAIR_POINT_TRIANGLE, 0, p);
    const double *l = plane.unclamped;
    for (int k = 0; k < 4; k++) { // the plane, and the three rims
        const double *a = p[k ? k : 1], *b = p[k ? 1 + k % 3 : 1];
        double along = 0, length = 0, at[3], squared = 0;
        for (int c = 0; c < 3; c++) {
            along += (p[0][c] - a[c]) * (b[c] - a[c]);
            length += (b[c] - a[c]) * (b[c] - a[c]);
        }
        share[0] = k ? fmin(fmax(along / length, 0), 1) : l[0];
        share[1] = k ? 0 : l[1];
        for (int c = 0; c < 3; c++) {
            at[c] = k ? a[c] + share[0] * (b[c] - a[c])
                      : a[c] + share[0] * plane.u[c] + share[1] * plane.v[c];
            squared += (p[0][c] - at[c]) * (p[0][c] - at[c]);
        }
        if ((k || (l[0] >= 0 && l[1] >= 0 && l[0] + l[1] <= 1)) && squared < best) {
            best = squared;
            memcpy(to, at, sizeof at);
        }
    }
    return sqrt(best);
}

static double nearest(const struct field *field, double to[3]) {
    double best = HUGE_VAL, at[3];
    for (uint32_t t = 0; t < TRIANGLES; t++) {
        const double d = nearest_on(field, field->triangles + 3 * t, at);
        if (d < best) {
            best = d;
            memcpy(to, at, sizeof at);
        }
    }
    return best;
}

/* a triangle by definition: plane or nearest rim, rims and corners, each measured alone */
static double plain_triangle(struct field *field, uint32_t t, double range, double force[3]) {
    const double within = CS_FEATURE_RANGE_RATIO * range, e = CS_FEATURE_BLEND_RADIUS * range;
    const uint32_t *c = field->triangles + 3 * t;
    const struct cs_feature_kind rim = {1, 1, e}, corner = {0, 1, e}, flat = {0, 0, e};
    double p[4][3], energy = 0, least = HUGE_VAL;
    uint32_t nearest = 3;
    struct cs_pair_distance plane;
    place_of(field, (uint32_t[4]){0, c[0], c[1], c[2]}, p);
    cs_pair_distance_frame(&plane, CS_PAIR_POINT_TRIANGLE, 0, p);
    const double l[3] = {1 - plane.unclamped[0] - plane.unclamped[1], plane.unclamped[0],
                         plane.unclamped[1]};
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t at[4] = {0, c[k], c[(k + 1) % 3], c[(k + 2) % 3]};
        const bool inner = field->weights.opposite_vertex[3 * t + (k + 2) % 3] != CS_NO_POINT;
        struct cs_mesh_feature feature;
        place_of(field, at, p);
        cs_mesh_feature_set(&feature, rim, p);
        energy += add(field, at, rim, within, inner ? -0.5 : 0, force);
        energy += add(field, at, corner, within, field->weights.vertex_share[c[k]], force);
        const double squared = cs_vec3_dot(feature.from_edge, feature.from_edge);
        if (l[(k + 2) % 3] < 0 && squared < least) {
            least = squared;
            nearest = k;
        }
    }
    const uint32_t at[4] = {0, c[nearest % 3], c[(nearest + 1) % 3], c[(nearest + 2) % 3]};
    return energy + add(field, at, nearest < 3 ? rim : flat, within, 1, force);
}

/* a feature in range is truly in range: of what the search leaves out nothing is felt */
static void check_reach(struct field *field, double range) {
    for (uint32_t t = 0; t < TRIANGLES; t++) {
        const uint32_t *c = field->triangles + 3 * t;
        const struct cs_feature_query pair = {
            .points = {0, c[0], c[1], c[2]}, .triangle = t, .range = range};
        struct cs_weighted_feature features[CS_FEATURES_PER_TRIANGLE];
        double to[3];
        if (cs_feature_weights_find(&field->weights, &pair, 1, field->x, features))
            UNIT_ASSERT_OFTEN(nearest_on(field, c, to) < range);
    }
}

/* features that are felt once are what all triangles together feel */
TEST(facets_are_joined_to_the_same_sum) {
    uint64_t state = 11;
    double worst = 0;
    uint32_t tried = 0;
    struct field field;
    for (int k = 0; k < 3 * SHAPES; k++) {
        open(&field, 0.1 * (k % 2), &state);
        bend(&field, k / 3, 0.2 + 0.8 * (k % 3), &state);
        for (int probe = 0; probe < 200; probe++) {
            double force[3], plain[3] = {0}, to[3], energy = 0, off = 0;
            const double aside = probe % 4 ? 1 : 0.03; // some right over corners
            put(&field, aside * draw(&state), aside * draw(&state), draw(&state));
            // the foot is at its place to 1e-12, which a short distance does not show
            if (!(nearest(&field, to) > 0.04))
                continue;
            for (uint32_t t = 0; t < TRIANGLES; t++)
                energy += plain_triangle(&field, t, 0.4, plain);
            const double joined = energy_at(&field, 0.4, force);
            for (int c = 0; c < 3; c++)
                off = fmax(off, fabs(force[c] - plain[c]));
            tried++;
            worst = fmax(worst, fmax(off / (1 + sqrt(cs_vec3_dot(plain, plain))),
                                     fabs(joined - energy) / (1 + energy)));
        }
        cs_arena_finish(&field.arena);
    }
    ck_assert_msg(tried > 1000 && worst < 1e-9, "%u: %g", tried, worst);
}

/* whatever the mesh is like, a point is pushed away from the nearest of it, by an energy that
 * is not small */
TEST(bent_meshes_never_draw) {
    const double range = 0.4;
    uint64_t state = 7;
    uint32_t tried = 0;
    struct field field;
    for (int k = 0; k < 3 * SHAPES; k++) {
        open(&field, 0.1, &state);
        bend(&field, k / 3, 0.2 + 0.8 * (k % 3), &state);
        for (int probe = 0; probe < 400; probe++) {
            double to[3] = {0}, force[3], out = 0;
            put(&field, draw(&state), draw(&state), draw(&state));
            const double d = nearest(&field, to), energy = energy_at(&field, range, force);
            if (!(d > 0.1 * range && d < 0.9 * range))
                continue;
            for (size_t c = 0; c < 3; c++)
                out += force[c] * (field.x[c * POINTS] - to[c]) / d;
            ck_assert_msg(out > 0 && energy > 0.3 * cs_barrier_energy(d, range, 1),
                          "shape %d: push %g of %g, energy %g of %g", k / 3, out,
                          cs_barrier_at(d, range, 1).force, energy,
                          cs_barrier_energy(d, range, 1));
            check_reach(&field, range);
            tried++;
        }
        cs_arena_finish(&field.arena);
    }
    ck_assert_uint_gt(tried, 1000);
}
