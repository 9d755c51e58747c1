/* Counts crossings, and finds the collision-free fraction of a move, over all pairs of parts
 * that may meet.
 *
 * A surface crosses another exactly if an edge of one pierces a triangle of the other, but for
 * degenerate contact. Each pair of an edge and a triangle belongs to one pair of representative
 * triangles, so none is counted twice (representative_triangles.h). During a move two surfaces
 * first meet in a point-triangle or an edge-edge pair; these two kinds therefore suffice.
 *
 * The jobs of the tree run in parallel, each with its own result. Counts are integers and the
 * fraction is a minimum: both are independent of the order of jobs. The fraction found so far
 * in a job bounds the following pairs, which ends most of them early; a minimum does not change
 * by that. */
#include "model/contact/ccd/crossings.h"

#include "base/pool.h"
#include "model/contact/ccd/accd.h"
#include "model/contact/ccd/edge_triangle.h"
#include "model/contact/surface_points.h"
#include "scene/body_pairs.h"

#include <math.h>
#include <string.h>

/* Result of one job; results are combined in the order of jobs. */
struct found {
    struct cs_crossing_count count;
    /* collision-free fraction */
    double share;
};

struct cs_crossings {
    struct cs_representative_triangles parts;
    bool *apart;         /* (bodies, bodies) pairs whose moves are limited; NULL: all of them */
    struct found *found; /* (CS_BVH_PAIRS_MAX) */
};

/* Marks the pairs of bodies with contact: the limit applies to them alone, others may pass
 * through each other. */
static void list_nonadjacent(const struct cs_scene *scene, bool *apart) {
    const uint32_t n = cs_scene_surfaces(scene);
    double friction;
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = 0; b < n; b++)
            apart[(size_t)a * n + b] = cs_scene_bodies_collide(scene, a, b, &friction);
}

enum cs_status cs_crossings_build(struct cs_system *system, struct cs_error *error) {
    struct cs_crossings *crossings = cs_arena_alloc(&system->arena, sizeof *crossings, error);
    if (error->status)
        return error->status;
    crossings->found =
        cs_arena_alloc_array(&system->arena, CS_BVH_PAIRS_MAX, sizeof *crossings->found, error);
    const size_t n = cs_scene_surfaces(system->scene);
    if (cs_scene_crossings_by_pairs(system->scene) &&
        (crossings->apart = cs_arena_alloc_array(&system->arena, n * n, sizeof(bool), error)))
        list_nonadjacent(system->scene, crossings->apart);
    if (!error->status && !cs_representative_triangles_build(system, &crossings->parts, error))
        system->crossings = crossings;
    return error->status;
}

/* One query over all pairs. The result of each job goes to `found`. */
struct question {
    const struct cs_representative_triangles *parts;
    /* bodies; colliders have higher numbers */
    uint32_t n_bodies;
    const double *x0, *x1;
    /* pairs of bodies that count; NULL: all */
    const bool *apart;
    /* scene whose contact pairs alone count; NULL: all pairs */
    const struct cs_scene *apart_by;
    /* marks of triangles; NULL: not wanted */
    uint8_t *marks;
    struct found *found;
    cs_bvh_visitor *visit;
};
struct asking {
    const struct question *question;
    struct found *found;
};

/* Runs one job of the tree with an empty result. */
static void run_job(void *arg, uint32_t job) {
    const struct question *question = arg;
    struct asking asking = {question, question->found + job};
    asking.found->count = (struct cs_crossing_count){0};
    asking.found->share = 1;
    cs_bvh_visit(&question->parts->bvh, job, question->visit, &asking);
}

static void read_points(const struct cs_representative_triangles *parts, const double *x,
                        const uint32_t *items, uint32_t n, double p[][3]) {
    for (uint32_t k = 0; k < n; k++)
        for (size_t c = 0; c < 3; c++)
            p[k][c] = x[c * parts->n_points + items[k]];
}

/* --- counting --- */

/* Marks a triangle. Several threads may mark the same one, with the same value. */
static void mark_triangle(uint8_t *marks, uint32_t t) {
    // several threads may mark the same triangle
    if (t != CS_NO_TRIANGLE)
        __atomic_store_n(marks + t, (uint8_t)1, __ATOMIC_RELAXED);
}

/* Counts edge e against triangle t, unless they have a particle in common. */
static void count_pair(const struct asking *asking, uint32_t e, uint32_t t) {
    const struct question *question = asking->question;
    const struct cs_representative_triangles *parts = question->parts;
    const uint32_t *ends = cs_edge_vertices(parts, e),
                   *corners = cs_triangle_vertices(parts, t);
    struct cs_crossing_count *count = &asking->found->count;
    double edge[2][3], triangle[3][3];
    for (int k = 0; k < 6; k++)
        if (ends[k / 3] == corners[k % 3])
            return;
    read_points(parts, question->x0, ends, 2, edge);
    read_points(parts, question->x0, corners, 3, triangle);
    if (!cs_edge_crosses_triangle((const double(*)[3])edge, (const double(*)[3])triangle))
        return;
    if (!count->n++ || e < count->edge || (e == count->edge && t < count->triangle)) {
        count->edge = e;
        count->triangle = t;
    }
    if (!question->marks)
        return;
    mark_triangle(question->marks, t);
    mark_triangle(question->marks, parts->surfaces->edge_triangles[2 * (size_t)e]);
    mark_triangle(question->marks, parts->surfaces->edge_triangles[2 * (size_t)e + 1]);
}

/* Tests the edges owned by a part against the triangle of another. */
static void count_edges(const struct asking *asking, uint32_t part, uint32_t other) {
    const struct cs_representative_triangles *parts = asking->question->parts;
    const uint32_t t = parts->triangles[other];
    if (t == CS_NO_TRIANGLE)
        return;
    for (uint32_t k = parts->first_edge[part]; k < parts->first_edge[part + 1]; k++)
        count_pair(asking, parts->edges[k], t);
}

/* Returns whether both parts are of colliders, which may pass through each other. */
static bool are_obstacles(const struct question *question, uint32_t i, uint32_t j) {
    const uint32_t *bodies = question->parts->bodies;
    return bodies[i] >= question->n_bodies && bodies[j] >= question->n_bodies;
}

/* Returns whether no contact is defined between the bodies of two parts. */
static bool are_free(const struct question *question, uint32_t i, uint32_t j) {
    const uint32_t *bodies = question->parts->bodies;
    double friction;
    return question->apart_by &&
           !cs_scene_bodies_collide(question->apart_by, bodies[i], bodies[j], &friction);
}

static void count_parts(void *arg, uint32_t i, uint32_t j) {
    const struct question *question = ((const struct asking *)arg)->question;
    if (are_obstacles(question, i, j) || are_free(question, i, j))
        return;
    count_edges(arg, i, j);
    count_edges(arg, j, i);
}

/* Counts at one state; apart_by and marks may be NULL. The first pair is the least by (edge,
 * triangle) of all jobs. */
static struct cs_crossing_count count(const struct cs_system *system, double t, const double *x,
                                      const struct cs_scene *apart_by, uint8_t *marks) {
    struct cs_crossings *crossings = system->crossings;
    struct cs_crossing_count all = {0};
    const double *places = cs_surface_points_positions(system, CS_POINTS_BEGIN, t, x);
    struct question question = {.parts = &crossings->parts,
                                .n_bodies = system->scene->bodies.n,
                                .x0 = places,
                                .apart_by = apart_by,
                                .marks = marks,
                                .found = crossings->found,
                                .visit = count_parts};
    cs_representative_triangles_update(&crossings->parts, places, NULL, 0);
    cs_pool_run(crossings->parts.bvh.n_jobs, run_job, &question);
    for (uint32_t k = 0; k < crossings->parts.bvh.n_jobs; k++) {
        const struct cs_crossing_count *one = &crossings->found[k].count;
        const bool first = one->n && (!all.n || one->edge < all.edge ||
                                      (one->edge == all.edge && one->triangle < all.triangle));
        if (first) {
            all.edge = one->edge;
            all.triangle = one->triangle;
        }
        all.n += one->n;
    }
    return all;
}

struct cs_crossing_count cs_crossings_mark(const struct cs_system *system, double t,
                                           const double *x, uint8_t *marks) {
    memset(marks, 0, system->surfaces->n_triangles);
    return count(system, t, x, NULL, marks);
}

struct cs_crossing_count cs_crossings_count(const struct cs_system *system, double t,
                                            const double *x) {
    return count(system, t, x, NULL, NULL);
}

struct cs_crossing_count cs_crossings_start(const struct cs_system *system) {
    return count(system, 0, system->state, system->scene, NULL);
}

void cs_crossings_print(const struct cs_system *system, const struct cs_crossing_count *count,
                        struct cs_text *out) {
    const struct cs_representative_triangles *parts = &system->crossings->parts;
    cs_text_add(out, "%llu edge%s through %s", (unsigned long long)count->n,
                count->n == 1 ? " goes" : "s go", count->n == 1 ? "a triangle" : "triangles");
    cs_text_add(out, count->n == 1 ? ", from " : ", the first from ");
    cs_surfaces_print_point(system, cs_edge_vertices(parts, count->edge)[0], out);
    cs_text_add(out, ", through the triangle at ");
    cs_surfaces_print_point(system, cs_triangle_vertices(parts, count->triangle)[0], out);
}

/* --- the first of a move --- */

/* Reduces the fraction of the job if a pair meets. A swept-box test of its own points precedes
 * the search; the boxes of the parts are larger. */
static void try_pair(const struct asking *asking, enum cs_primitive_pair_kind kind,
                     const uint32_t particles[4]) {
    const struct question *question = asking->question;
    const size_t n = question->parts->n_points,
                 side = kind == CS_PRIMITIVE_POINT_TRIANGLE ? 1 : 2;
    double p[4][3], moves[4][3];
    struct cs_swept_aabb swept_boxes[2] = {cs_swept_aabb_empty(), cs_swept_aabb_empty()};
    for (size_t k = 0; k < 4; k++)
        for (size_t l = 0; l < side; l++)
            if (k >= side && particles[k] == particles[l])
                return;
    for (size_t k = 0; k < 4; k++)
        cs_swept_aabb_add_point(swept_boxes + (k >= side), n, particles[k], question->x0,
                                question->x1);
    if (!cs_swept_aabbs_overlap(swept_boxes, swept_boxes + 1, CS_ACCD_DISTANCE_MIN))
        return;
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++) {
            p[k][c] = question->x0[c * n + particles[k]];
            moves[k][c] = question->x1[c * n + particles[k]] - p[k][c];
        }
    asking->found->share = cs_accd_safe_fraction(
        kind, (const double(*)[3])p, (const double(*)[3])moves, asking->found->share);
}

/* Tests the points owned by a part against the triangle of another. */
static void try_points(const struct asking *asking, uint32_t part, uint32_t other) {
    const struct cs_representative_triangles *parts = asking->question->parts;
    const uint32_t t = parts->triangles[other];
    if (t == CS_NO_TRIANGLE)
        return;
    const uint32_t *corners = cs_triangle_vertices(parts, t);
    for (uint32_t k = parts->first_point[part]; k < parts->first_point[part + 1]; k++)
        try_pair(asking, CS_PRIMITIVE_POINT_TRIANGLE,
                 (const uint32_t[4]){parts->points[k], corners[0], corners[1], corners[2]});
}

/* Tests the edges owned by two parts against each other. */
static void try_edges(const struct asking *asking, uint32_t part, uint32_t other) {
    const struct cs_representative_triangles *parts = asking->question->parts;
    for (uint32_t k = parts->first_edge[part]; k < parts->first_edge[part + 1]; k++)
        for (uint32_t l = parts->first_edge[other]; l < parts->first_edge[other + 1]; l++) {
            const uint32_t *e = cs_edge_vertices(parts, parts->edges[k]);
            const uint32_t *f = cs_edge_vertices(parts, parts->edges[l]);
            try_pair(asking, CS_PRIMITIVE_EDGE_EDGE,
                     (const uint32_t[4]){e[0], e[1], f[0], f[1]});
        }
}

/* Tests all primitives of two parts: points and triangles both ways, and edges. */
static void try_parts(void *arg, uint32_t i, uint32_t j) {
    const struct question *question = ((const struct asking *)arg)->question;
    const uint32_t *bodies = question->parts->bodies;
    if (are_obstacles(question, i, j))
        return;
    if (question->apart &&
        !question->apart[(size_t)bodies[i] * question->parts->surfaces->n_bodies + bodies[j]])
        return;
    try_points(arg, i, j);
    try_points(arg, j, i);
    try_edges(arg, i, j);
}

double cs_crossings_safe_fraction(const struct cs_system *system, double t0, const double *x0,
                                  double t1, const double *x1) {
    struct cs_crossings *crossings = system->crossings;
    struct question question = {
        .parts = &crossings->parts,
        .n_bodies = system->scene->bodies.n,
        .x0 = cs_surface_points_positions(system, CS_POINTS_BEGIN, t0, x0),
        .x1 = cs_surface_points_positions(system, CS_POINTS_END, t1, x1),
        .apart = crossings->apart,
        .found = crossings->found,
        .visit = try_parts};
    double share = 1;
    if (cs_accd_candidates_suffice(system, crossings->apart, question.x0, question.x1))
        return cs_accd_candidates_safe_fraction(system, question.x0, question.x1);
    cs_representative_triangles_update(&crossings->parts, question.x0, question.x1,
                                       CS_ACCD_DISTANCE_MIN);
    cs_pool_run(crossings->parts.bvh.n_jobs, run_job, &question);
    for (uint32_t k = 0; k < crossings->parts.bvh.n_jobs; k++)
        share = fmin(share, crossings->found[k].share);
    return share;
}
