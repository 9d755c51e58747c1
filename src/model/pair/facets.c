/* Rims, corners and planes counted so that a flat mesh is felt once. */
#include "model/pair/facets.h"

#include "scene/pairs.h"

#include <string.h>

/* --- how triangles hang together --- */

static uint32_t corner_opposite(const uint32_t *corners, const uint32_t *edge) {
    uint32_t k = 0;
    while (k < 2 && (corners[k] == edge[0] || corners[k] == edge[1]))
        k++;
    return k;
}

/* Of a corner whose fan of triangles is cut by its inner rims: 1 - triangles + rims of it are
 * left to be counted, so that all count 1. */
static void share_corners(struct cs_facets *facets, const uint32_t *inner) {
    const struct cs_surfaces *s = facets->surfaces;
    for (size_t c = 0; c < 3 * (size_t)s->n_triangles; c++)
        facets->share[s->triangles[c]] += 1;
    for (uint32_t i = 0; i < s->n_points; i++)
        if (facets->share[i] > 0)
            facets->share[i] = (1 - facets->share[i] + inner[i]) / facets->share[i];
}

static void cross_edges(struct cs_facets *facets, uint32_t *inner) {
    const struct cs_surfaces *s = facets->surfaces;
    for (size_t c = 0; c < 3 * (size_t)s->n_triangles; c++)
        facets->across[c] = CS_NO_POINT;
    for (size_t e = 0; e < s->n_edges; e++) {
        const uint32_t *edge = s->edges + 2 * e, *owner = s->owners + 2 * e;
        facets->started[edge[0] + 1]++;
        if (owner[1] == CS_NO_TRIANGLE)
            continue;
        const uint32_t *first = s->triangles + 3 * (size_t)owner[0];
        const uint32_t *second = s->triangles + 3 * (size_t)owner[1];
        const uint32_t k = corner_opposite(first, edge), l = corner_opposite(second, edge);
        facets->across[3 * (size_t)owner[0] + k] = second[l];
        facets->across[3 * (size_t)owner[1] + l] = first[k];
        inner[edge[0]]++;
        inner[edge[1]]++;
    }
}

enum cs_status cs_facets_init(struct cs_facets *facets, const struct cs_surfaces *surfaces,
                              struct cs_arena *arena, struct cs_error *error) {
    const size_t corners = 3 * (size_t)surfaces->n_triangles, n = surfaces->n_points;
    *facets = (struct cs_facets){.surfaces = surfaces};
    facets->across = cs_arena_take_n(arena, corners, sizeof *facets->across, error);
    facets->share = cs_arena_take_n(arena, n, sizeof *facets->share, error);
    facets->started = cs_arena_take_n(arena, n + 1, sizeof *facets->started, error);
    uint32_t *inner = cs_arena_take_n(arena, n, sizeof *inner, error);
    if (error->status)
        return error->status;
    cross_edges(facets, inner);
    for (size_t i = 0; i < n; i++)
        facets->started[i + 1] += facets->started[i];
    share_corners(facets, inner);
    return CS_OK;
}

size_t cs_facets_bytes(const struct cs_scene *scene) {
    size_t bytes = sizeof(uint32_t);
    for (uint32_t b = 0; b < cs_scene_surfaces(scene); b++) {
        const struct cs_surface_size size = cs_surface_size_of(scene, b);
        bytes += 3 * size.triangles * sizeof(uint32_t) +
                 size.points * (sizeof(double) + 2 * sizeof(uint32_t));
    }
    return bytes;
}

/* --- what a point feels --- */

static bool are_joined(const struct cs_facets *facets, uint32_t a, uint32_t b) {
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    bool joined = false;
    for (uint32_t e = facets->started[low]; e < facets->started[low + 1]; e++)
        joined = joined || facets->surfaces->edges[2 * (size_t)e + 1] == high;
    return joined;
}

/* One pair at work. */
struct finding {
    const struct cs_facets *facets;
    const uint32_t *corners; /* of the triangle */
    uint32_t point, triangle, n;
    double p[4][3], l[3], range, e;
    double height, area; /* over the plane, squared; (2 areas)^2 */
    const double *x;
    struct cs_facet_use *uses;
};

/* puts the facet that rim or corner `first` of the triangle stands for; NULL: out of range */
static struct cs_facet *put(struct finding *at, uint32_t first, struct cs_facet_form form,
                            struct cs_facet *facet) {
    struct cs_facet_use *use = at->uses + at->n;
    use->form = form;
    use->alone = 0;
    use->at[0] = at->point;
    memcpy(use->p[0], at->p[0], sizeof use->p[0]);
    for (uint32_t k = 0; k < 3; k++) {
        use->at[1 + k] = at->corners[(first + k) % 3];
        memcpy(use->p[1 + k], at->p[1 + (first + k) % 3], sizeof use->p[0]);
    }
    cs_facet_measure(facet, form, use->p);
    use->d = facet->d;
    if (!(use->d < at->range))
        return NULL;
    at->n++;
    return facet;
}

/* squared distances below it may be in range: a bent one is below the true one */
static double limit_of(const struct finding *at) {
    return at->range * at->range + 0.5 * at->e * at->e;
}

/* a rim whose line alone is too far away */
static bool is_far(const struct finding *at, uint32_t k) {
    const double *a = at->p[1 + k], *b = at->p[1 + (k + 1) % 3], l = at->l[(k + 2) % 3];
    double length = 0;
    for (int c = 0; c < 3; c++)
        length += (b[c] - a[c]) * (b[c] - a[c]);
    return at->height + l * l * at->area / length >= limit_of(at);
}

static void put_plane(struct finding *at) {
    struct cs_facet facet;
    if (put(at, 0, (struct cs_facet_form){0, 0, at->e}, &facet))
        at->uses[at->n - 1].count = at->uses[at->n - 1].alone = 1;
}

/* whether the foot is beyond rim k for the triangle across it too, as over a ridge */
static bool is_ridge(const struct finding *at, uint32_t k, uint32_t across) {
    const double *a = at->p[1 + k], *b = at->p[1 + (k + 1) % 3];
    double u[3], v[3], w[3];
    for (size_t c = 0; c < 3; c++) {
        u[c] = b[c] - a[c];
        v[c] = at->x[c * at->facets->surfaces->n_points + across] - a[c];
        w[c] = at->p[0][c] - a[c];
    }
    return cs_vec3_dot(w, v) * cs_vec3_dot(u, u) < cs_vec3_dot(w, u) * cs_vec3_dot(u, v);
}

/* How often the nearest rim counts alone: what is taken away from it by the triangle across is
 * not put there in the first place. */
static double count_alone(const struct finding *at, uint32_t k, uint32_t across, double t) {
    const double share = at->facets->share[at->corners[t < 0 ? k : (k + 1) % 3]];
    if (across == CS_NO_POINT)
        return 1;
    if (!is_ridge(at, k, across))
        return 0;
    return (t < 0 || t > 1) && share > 0 ? share : 0.5;
}

/* The rims: half of an inner one is taken away, and the nearest of those that the foot is
 * beyond is the triangle itself. */
static void put_rims(struct finding *at) {
    uint32_t nearest = CS_FACETS;
    double least = 0, alone = 0;
    for (uint32_t k = 0; k < 3; k++) { // from corner k to k + 1
        const uint32_t across = at->facets->across[3 * (size_t)at->triangle + (k + 2) % 3];
        const bool inner = across != CS_NO_POINT && across != at->point;
        const bool beyond = at->l[(k + 2) % 3] < 0;
        struct cs_facet facet;
        if (!(inner || beyond) || is_far(at, k) ||
            !put(at, k, (struct cs_facet_form){1, 1, at->e}, &facet))
            continue;
        const double squared = cs_vec3_dot(facet.leg, facet.leg);
        at->uses[at->n - 1].count = inner ? -0.5 : 0;
        if (beyond && (nearest == CS_FACETS || squared < least)) {
            nearest = at->n - 1;
            least = squared;
            alone = count_alone(at, k, inner ? across : CS_NO_POINT, facet.t);
        }
    }
    if (nearest < CS_FACETS) {
        at->uses[nearest].count += 1;
        at->uses[nearest].alone = alone;
    }
}

static void put_corners(struct finding *at, bool own) {
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t corner = at->corners[k];
        const double share = at->facets->share[corner];
        double squared = 0;
        for (int c = 0; c < 3; c++)
            squared += (at->p[0][c] - at->p[1 + k][c]) * (at->p[0][c] - at->p[1 + k][c]);
        struct cs_facet facet;
        if (share == 0 || !(squared < limit_of(at)) ||
            (own && are_joined(at->facets, at->point, corner)))
            continue;
        if (put(at, k, (struct cs_facet_form){0, 1, at->e}, &facet))
            at->uses[at->n - 1].count = share;
    }
}

/* what counts nothing goes */
static uint32_t keep(struct cs_facet_use *uses, uint32_t n) {
    uint32_t kept = 0;
    for (uint32_t k = 0; k < n; k++)
        if (uses[k].count != 0)
            uses[kept++] = uses[k];
    return kept;
}

static double height_over(const struct cs_stencil *plane) {
    double squared = 0;
    for (int c = 0; c < 3; c++) {
        const double r = plane->w[c] - plane->l[0] * plane->u[c] - plane->l[1] * plane->v[c];
        squared += r * r;
    }
    return squared;
}

uint32_t cs_facets_find(const struct cs_facets *facets, const struct cs_facets_pair *pair,
                        const double *x, struct cs_facet_use uses[CS_FACETS]) {
    struct finding at = {.facets = facets,
                         .corners = pair->at + 1,
                         .point = pair->at[0],
                         .triangle = pair->triangle,
                         .range = CS_FACET_WITHIN * pair->range,
                         .e = CS_FACET_BEND * pair->range,
                         .x = x,
                         .uses = uses};
    struct cs_stencil plane;
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            at.p[k][c] = x[c * facets->surfaces->n_points + pair->at[k]];
    cs_stencil_frame(&plane, CS_STENCIL_TRIANGLE, at.p);
    at.height = height_over(&plane);
    at.area = 1 / plane.inverse;
    at.l[0] = 1 - plane.l[0] - plane.l[1];
    at.l[1] = plane.l[0];
    at.l[2] = plane.l[1];
    if (at.l[0] >= 0 && at.l[1] >= 0 && at.l[2] >= 0)
        put_plane(&at);
    put_rims(&at);
    put_corners(&at, pair->own);
    return keep(uses, at.n);
}
