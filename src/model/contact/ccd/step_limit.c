/* Combines the step tests of contact with colliders, samples and pairs with the limit of
 * crossings. */
#include "model/contact/ccd/step_limit.h"

#include "model/contact/broad_phase/swept_aabb.h"
#include "model/contact/ccd/accd.h"
#include "model/contact/ccd/crossings.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/pair_step_check.h"
#include "model/contact/step_check.h"
#include "model/contact/surface_points.h"
#include "model/system/surfaces.h"
#include "scene/body_pairs.h"

#include <string.h>

bool cs_step_limit_applies(const struct cs_system *system) {
    return system->collider_params || system->pairs ||
           cs_scene_crossings(system->scene) == CS_CROSSINGS_LIMIT;
}

/* Cheap tests come first: particles, samples, pairs, crossings. The first that fails decides.
 */
double cs_step_limit_fraction(const struct cs_system *system, double t0, const double *x0,
                              double t1, const double *x1) {
    if (system->collider_params && t1 > t0 &&
        !cs_collider_contact_resolves_step(system, t0, x0, t1, x1))
        return 0.5;
    if (system->contact_samples && t1 > t0 &&
        !cs_contact_samples_resolve_step(system->contact_samples, t0, x0, t1, x1))
        return 0.5;
    if (system->pairs && t1 > t0 &&
        !cs_contact_pairs_resolve_step(system->pairs, t0, x0, t1, x1))
        return 0.5;
    return cs_scene_crossings(system->scene) == CS_CROSSINGS_LIMIT
               ? cs_crossings_safe_fraction(system, t0, x0, t1, x1)
               : 1;
}

bool cs_step_limit_failed(const struct cs_system *system) {
    const struct cs_pairs *pairs = system->pairs;
    const struct cs_contact_samples *samples = system->contact_samples;
    return (pairs && pairs->failed) ||
           (samples && (samples->current_set.failed || samples->matrix.failed));
}

/* Counts crossings only under the policy that stops a run at the first one. */
bool cs_step_limit_ends_run(const struct cs_system *system, double t, const double *x,
                            struct cs_text *why) {
    if (cs_scene_crossings(system->scene) != CS_CROSSINGS_STOP)
        return false;
    const struct cs_crossing_count found = cs_crossings_count(system, t, x);
    if (!found.n)
        return false;
    cs_text_add(why, "after the step to t = %.9g s ", t);
    cs_crossings_print(system, &found, why);
    return true;
}

/* Finds the primitives that blocked a step by testing all pairs, once, where a run ends. */

/* points times triangles that are tested in about ten seconds */
#define PAIRS_MAX 1e9

enum cs_status cs_blocked_step_init(struct cs_blocked_step *blocked,
                                    const struct cs_system *system, struct cs_arena *arena,
                                    struct cs_error *error) {
    *blocked = (struct cs_blocked_step){0};
    if (cs_scene_crossings(system->scene) == CS_CROSSINGS_LIMIT)
        blocked->x =
            cs_arena_alloc_array(arena, 6 * (size_t)system->view.n, sizeof(double), error);
    return error->status;
}

void cs_blocked_step_store(struct cs_blocked_step *blocked, const struct cs_system *system,
                           const double t[2], const double *const x[2], double share) {
    const size_t n3 = 3 * (size_t)system->view.n;
    blocked->is_set = blocked->x && share < 1;
    for (size_t end = 0; end < 2 && blocked->is_set; end++) {
        blocked->t[end] = t[end];
        memcpy(blocked->x + end * n3, x[end], n3 * sizeof *blocked->x);
    }
}

/* Search for the pair that meets first. */
struct search {
    const struct cs_surfaces *surfaces;
    const double *x[2];
    double share;
    enum cs_primitive_pair_kind kind;
    /* its points, valid if share is below 1 */
    uint32_t at[4];
};

/* Takes a pair over if it meets earlier than the best one so far. */
static void try_pair(struct search *search, enum cs_primitive_pair_kind kind,
                     const uint32_t at[4]) {
    const size_t n = search->surfaces->n_points,
                 side = kind == CS_PRIMITIVE_POINT_TRIANGLE ? 1 : 2;
    struct cs_swept_aabb swept_boxes[2] = {cs_swept_aabb_empty(), cs_swept_aabb_empty()};
    double p[4][3], moves[4][3];
    for (size_t k = 0; k < 4; k++)
        cs_swept_aabb_add_point(swept_boxes + (k >= side), n, at[k], search->x[0],
                                search->x[1]);
    if (!cs_swept_aabbs_overlap(swept_boxes, swept_boxes + 1, CS_ACCD_DISTANCE_MIN))
        return;
    for (size_t k = side; k < 4; k++)
        for (size_t l = 0; l < side; l++)
            if (at[k] == at[l])
                return;
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++) {
            p[k][c] = search->x[0][c * n + at[k]];
            moves[k][c] = search->x[1][c * n + at[k]] - p[k][c];
        }
    const double share = cs_accd_safe_fraction(kind, (const double(*)[3])p,
                                               (const double(*)[3])moves, search->share);
    if (!(share < search->share))
        return;
    search->share = share;
    search->kind = kind;
    memcpy(search->at, at, sizeof search->at);
}

/* Tests all pairs of a point and a triangle, and all pairs of edges. */
static void try_all(struct search *search) {
    const struct cs_surfaces *s = search->surfaces;
    for (uint32_t i = 0; i < s->n_points; i++)
        for (size_t t = 0; t < s->n_triangles; t++) {
            const uint32_t *c = s->triangles + 3 * t;
            try_pair(search, CS_PRIMITIVE_POINT_TRIANGLE,
                     (const uint32_t[4]){i, c[0], c[1], c[2]});
        }
    for (size_t e = 0; e < s->n_edges; e++)
        for (size_t f = e + 1; f < s->n_edges; f++) {
            const uint32_t *a = s->edges + 2 * e, *b = s->edges + 2 * f;
            try_pair(search, CS_PRIMITIVE_EDGE_EDGE,
                     (const uint32_t[4]){a[0], a[1], b[0], b[1]});
        }
}

/* Runs the same test as the tree, so that it finds the pair that limited the step. */
void cs_blocked_step_print(const struct cs_blocked_step *blocked,
                           const struct cs_system *system, struct cs_text *out) {
    const struct cs_surfaces *s = system->surfaces;
    if (!blocked->is_set || (double)s->n_points * s->n_triangles > PAIRS_MAX)
        return;
    const size_t n3 = 3 * (size_t)system->view.n;
    struct search search = {.surfaces = s, .share = 1};
    search.x[0] =
        cs_surface_points_positions(system, CS_POINTS_BEGIN, blocked->t[0], blocked->x);
    search.x[1] =
        cs_surface_points_positions(system, CS_POINTS_END, blocked->t[1], blocked->x + n3);
    try_all(&search);
    if (!(search.share < 1))
        return;
    const bool edges = search.kind == CS_PRIMITIVE_EDGE_EDGE;
    cs_text_add(out, edges ? "; there the edge at " : "; there ");
    cs_surfaces_print_point(system, search.at[0], out);
    cs_text_add(out, edges ? " would cross the edge at " : " would cross the triangle at ");
    cs_surfaces_print_point(system, search.at[edges ? 2 : 1], out);
}
