/* Counts crossings, and finds the first collision of a move, over all pairs that may meet.
 *
 * A surface crosses another exactly if an edge of one pierces a triangle of the other, but for
 * degenerate contact. During a move two surfaces first meet in a point-triangle or an edge-edge
 * pair; these two kinds therefore suffice.
 *
 * Chunks of pairs run in parallel, each with its own result. Counts are integers and the
 * fraction is a minimum: both are independent of the order of pairs. The fraction found so far
 * in a chunk bounds the following pairs, which ends most of them early; a minimum does not
 * change by that. Every pair is tested by its own swept boxes first, so that a search that
 * finds more of them changes nothing. */
#include "model/contact/ccd/crossings.h"

#include "base/pool.h"
#include "model/contact/ccd/accd.h"
#include "model/contact/ccd/edge_triangle.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/system/seams.h"
#include "scene/body_pairs.h"
#include "scene/scene.h"

#include <string.h>

/* Result of one chunk; results are combined in the order of chunks. */
struct found {
    struct cs_crossing_count count;
    struct cs_first_collision collision;
};

struct cs_crossings {
    /* that of contact between bodies, if there is one */
    struct cs_primitive_search *search;
    bool *apart;         /* (bodies, bodies) pairs whose moves are limited; NULL: all of them */
    struct found *found; /* (n_chunks) */
    struct cs_point_motion *motion; /* (n_points) of the last move */
    bool failed;
};

/* Marks the pairs of bodies with contact: the limit applies to them alone, others may pass
 * through each other. */
static void list_apart(const struct cs_scene *scene, bool *apart) {
    const uint32_t n = cs_scene_surfaces(scene);
    double friction;
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = 0; b < n; b++)
            apart[(size_t)a * n + b] = cs_scene_bodies_collide(scene, a, b, &friction);
}

/* Takes the search and the moves of contact between bodies, or makes them. */
static enum cs_status find_search(struct cs_system *system, struct cs_crossings *crossings,
                                  struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    if (system->pairs) {
        crossings->search = &system->pairs->candidates.search;
        crossings->motion = system->pairs->point_motion;
        return CS_OK;
    }
    CS_ARENA_ARRAY(arena, crossings->motion, system->surfaces->n_points, error);
    crossings->search = cs_arena_alloc(arena, sizeof *crossings->search, error);
    return error->status
               ? error->status
               : cs_primitive_search_init(crossings->search, system->surfaces, arena, error);
}

enum cs_status cs_crossings_build(struct cs_system *system, struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    if (cs_surface_points_build(system, error))
        return error->status;
    struct cs_crossings *crossings = cs_arena_alloc(arena, sizeof *crossings, error);
    if (!crossings || find_search(system, crossings, error))
        return error->status;
    const size_t n = cs_scene_surfaces(system->scene);
    CS_ARENA_ARRAY(arena, crossings->found, crossings->search->n_chunks, error);
    if (cs_scene_crossings_by_pairs(system->scene) &&
        CS_ARENA_ARRAY(arena, crossings->apart, n * n, error))
        list_apart(system->scene, crossings->apart);
    if (!error->status)
        system->crossings = crossings;
    return error->status;
}

bool cs_crossings_failed(const struct cs_system *system) {
    return system->crossings && system->crossings->failed;
}

/* One question over all pairs. The result of each chunk goes to crossings->found. */
struct question {
    const struct cs_system *system;
    const struct cs_crossings *crossings;
    const double *x; /* (3,n_points) where edges are counted */
    /* whose contact pairs alone count; NULL: all pairs */
    const struct cs_scene *scene;
    /* marks of triangles; NULL: not wanted */
    uint8_t *marks;
};

static void clear_found(struct cs_crossings *crossings) {
    for (uint32_t k = 0; k < crossings->search->n_chunks; k++)
        crossings->found[k] = (struct found){.collision.fraction = 1};
}

/* Returns whether both bodies are colliders, which may pass through each other. */
static bool are_obstacles(const struct question *question, uint32_t a, uint32_t b) {
    const uint32_t n = question->system->scene->bodies.n;
    return a >= n && b >= n;
}

/* --- counting --- */

/* Marks a triangle. Several threads may mark the same one, with the same value. */
static void mark_triangle(uint8_t *marks, uint32_t t) {
    if (t != CS_NO_TRIANGLE)
        __atomic_store_n(marks + t, (uint8_t)1, __ATOMIC_RELAXED);
}

static void read_points(const struct question *question, const uint32_t *items, uint32_t n,
                        double p[][3]) {
    for (uint32_t k = 0; k < n; k++)
        for (size_t c = 0; c < 3; c++)
            p[k][c] = question->x[c * question->system->surfaces->n_points + items[k]];
}

/* Returns whether an end of an edge is a corner, or sewn to one, or one of both is tangled. */
static bool meet_in_a_vertex(const struct cs_system *system, const uint32_t ends[2],
                             const uint32_t corners[3]) {
    const uint32_t a = ends[0], b = ends[1], all[] = {a, b, corners[0], corners[1], corners[2]};
    if (cs_seams_tangled(system, all, 5))
        return true;
    for (int k = 0; k < 3; k++)
        if (corners[k] == a || corners[k] == b)
            return true;
    for (int k = 0; k < 6 && system->seams; k++)
        if (cs_seams_merged(system, ends[k / 3]) == cs_seams_merged(system, corners[k % 3]))
            return true;
    return false;
}

/* Counts edge e against triangle t, unless they have a particle in common, or two that are sewn
 * together. */
static void count_pair(const struct question *question, uint32_t e, uint32_t t,
                       struct cs_crossing_count *count) {
    const struct cs_surfaces *surfaces = question->system->surfaces;
    const uint32_t *ends = surfaces->edges + 2 * (size_t)e,
                   *corners = surfaces->triangles + 3 * (size_t)t;
    double edge[2][3], triangle[3][3];
    if (meet_in_a_vertex(question->system, ends, corners))
        return;
    read_points(question, ends, 2, edge);
    read_points(question, corners, 3, triangle);
    if (!cs_edge_crosses_triangle((const double(*)[3])edge, (const double(*)[3])triangle))
        return;
    if (!count->n++ || e < count->edge || (e == count->edge && t < count->triangle)) {
        count->edge = e;
        count->triangle = t;
    }
    if (!question->marks)
        return;
    mark_triangle(question->marks, t);
    mark_triangle(question->marks, surfaces->edge_triangles[2 * (size_t)e]);
    mark_triangle(question->marks, surfaces->edge_triangles[2 * (size_t)e + 1]);
}

static void count_pairs(void *arg, uint32_t chunk, const uint32_t (*pairs)[2], size_t n) {
    const struct question *question = arg;
    for (size_t k = 0; k < n; k++)
        count_pair(question, pairs[k][0], pairs[k][1],
                   &question->crossings->found[chunk].count);
}

static bool may_pierce(const void *arg, uint32_t a, uint32_t b) {
    const struct question *question = arg;
    double friction;
    return !are_obstacles(question, a, b) &&
           (!question->scene || cs_scene_bodies_collide(question->scene, a, b, &friction));
}

/* Counts at one state; scene and marks may be NULL. The first pair is the least by (edge,
 * triangle) of all chunks. */
static struct cs_crossing_count count(const struct cs_system *system, double t, const double *x,
                                      const struct cs_scene *scene, uint8_t *marks) {
    struct cs_crossings *crossings = system->crossings;
    struct cs_crossing_count all = {0};
    struct question question = {
        .system = system, .crossings = crossings, .scene = scene, .marks = marks};
    question.x = cs_surface_points_positions(system, CS_POINTS_BEGIN, t, x);
    const struct cs_move_query query = {.x0 = question.x,
                                        .pierce = true,
                                        .may_meet = may_pierce,
                                        .take = count_pairs,
                                        .arg = &question};
    clear_found(crossings);
    crossings->failed |= !cs_primitive_search_move(crossings->search, &query);
    for (uint32_t k = 0; k < crossings->search->n_chunks; k++) {
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
    const struct cs_surfaces *surfaces = system->surfaces;
    cs_text_add(out, "%llu edge%s through %s", (unsigned long long)count->n,
                count->n == 1 ? " goes" : "s go", count->n == 1 ? "a triangle" : "triangles");
    cs_text_add(out, count->n == 1 ? ", from " : ", the first from ");
    cs_surfaces_print_point(system, surfaces->edges[2 * (size_t)count->edge], out);
    cs_text_add(out, ", through the triangle at ");
    cs_surfaces_print_point(system, surfaces->triangles[3 * (size_t)count->triangle], out);
}

/* --- the first of a move --- */

/* Puts that edge first whose first triangle has the lower number, within a body: the rounding
 * of the distance depends on the order, which must not depend on the search. */
static void order_edges(const struct cs_surfaces *surfaces, uint32_t edges[2]) {
    const uint32_t e = edges[0], f = edges[1];
    if (surfaces->edge_triangles[2 * (size_t)e] <= surfaces->edge_triangles[2 * (size_t)f] ||
        cs_surfaces_body(surfaces->first_edge, surfaces->n_bodies, e) !=
            cs_surfaces_body(surfaces->first_edge, surfaces->n_bodies, f))
        return;
    edges[0] = f;
    edges[1] = e;
}

/* Returns whether a point is a body of its own, which has no surface to pass through. */
static bool is_alone(const struct cs_surfaces *surfaces, uint32_t point) {
    const uint32_t body = cs_surfaces_body(surfaces->first_point, surfaces->n_bodies, point);
    return surfaces->first_edge[body] == surfaces->first_edge[body + 1];
}

/* Takes a pair over if it meets before the first one so far. */
static void try_pair(const struct question *question, enum cs_pair_kind kind,
                     const uint32_t pair[2], struct cs_first_collision *first) {
    const struct cs_surfaces *surfaces = question->system->surfaces;
    uint32_t items[2] = {pair[0], pair[1]}, at[4];
    double p[4][3], moves[4][3];
    if (kind == CS_PAIR_EDGE_EDGE)
        order_edges(surfaces, items);
    else if (is_alone(surfaces, pair[0]))
        return;
    cs_candidate_vertices(surfaces, kind, items, at);
    // such a pair never meets
    if (cs_seams_join_pair(question->system, at, kind == CS_PAIR_EDGE_EDGE))
        return;
    for (size_t k = 0; k < 4; k++) {
        const double *move = question->crossings->motion[at[k]].values;
        memcpy(p[k], move + CS_POINT_MOVE_FROM, sizeof p[k]);
        memcpy(moves[k], move + CS_POINT_MOVE_BY, sizeof moves[k]);
    }
    const double fraction = cs_accd_safe_fraction(kind, (const double(*)[3])p,
                                                  (const double(*)[3])moves, first->fraction);
    if (!(fraction < first->fraction))
        return;
    first->fraction = fraction;
    first->kind = kind;
    memcpy(first->points, at, sizeof first->points);
}

/* Tries those of n pairs whose swept boxes meet. */
static void try_pairs(const struct question *question, enum cs_pair_kind kind,
                      const uint32_t (*pairs)[2], size_t n, struct cs_first_collision *first) {
    uint32_t some[CS_SEARCH_PAIRS][2];
    const struct cs_moving_pairs items = {question->system->surfaces, kind == CS_PAIR_EDGE_EDGE,
                                          pairs[0], n};
    const size_t near = cs_point_motion_filter(question->crossings->motion, &items,
                                               CS_ACCD_DISTANCE_MIN, some[0]);
    for (size_t k = 0; k < near; k++)
        try_pair(question, kind, some[k], first);
}

static void try_found(void *arg, uint32_t chunk, const uint32_t (*pairs)[2], size_t n) {
    const struct question *question = arg;
    const struct cs_crossings *crossings = question->crossings;
    try_pairs(question,
              chunk < crossings->search->n_point_chunks ? CS_PAIR_POINT_TRIANGLE
                                                        : CS_PAIR_EDGE_EDGE,
              pairs, n, &crossings->found[chunk].collision);
}

static bool may_meet(const void *arg, uint32_t a, uint32_t b) {
    const struct question *question = arg;
    const bool *apart = question->crossings->apart;
    return !are_obstacles(question, a, b) &&
           (!apart || apart[(size_t)a * question->system->surfaces->n_bodies + b]);
}

/* --- in the list of candidates --- */

/* Returns whether contact is defined between all pairs, colliders with each other excepted.
 * Colliders that are no meshes have no points, and meet nothing here. */
static bool all_bodies_collide(const struct cs_body_pair_table *table,
                               const struct cs_surfaces *surfaces, uint32_t n_bodies) {
    bool all = true;
    for (uint32_t a = 0; a < n_bodies; a++)
        for (uint32_t b = 0; b < table->n_bodies; b++)
            all = all && (surfaces->first_point[b] == surfaces->first_point[b + 1] ||
                          cs_body_pair_params_of(table, a, b)->range > 0);
    return all;
}

/* A list that covers the way has all pairs that come within their range on it, and pairs that
 * meet are among them (CS_CANDIDATES_ACCD_LIMIT). */
bool cs_crossings_list_suffices(const struct cs_system *system, const double *x0,
                                const double *x1) {
    struct cs_pairs *pairs = system->pairs;
    return pairs &&
           (system->crossings->apart || all_bodies_collide(&pairs->body_pairs, system->surfaces,
                                                           system->scene->bodies.n)) &&
           cs_candidates_max_motion(&pairs->candidates, x0, x1) <= CS_CANDIDATES_ACCD_LIMIT &&
           cs_candidates_cover_step(&pairs->candidates, x0, x1);
}

/* Tries one chunk of the list, which has the number of a chunk of the search. */
static void try_chunk(void *arg, uint32_t number) {
    const struct question *question = arg;
    const struct cs_candidate_chunk *chunk =
        question->system->pairs->candidates.chunks + number;
    for (size_t p = 0; p < chunk->n; p += CS_SEARCH_PAIRS)
        try_pairs(question, chunk->kind, (const uint32_t(*)[2])(chunk->pairs + 2 * p),
                  chunk->n - p < CS_SEARCH_PAIRS ? chunk->n - p : CS_SEARCH_PAIRS,
                  &question->crossings->found[number].collision);
}

struct cs_first_collision cs_crossings_first_collision(const struct cs_system *system,
                                                       double t0, const double *x0, double t1,
                                                       const double *x1) {
    struct cs_crossings *crossings = system->crossings;
    const double *from = cs_surface_points_positions(system, CS_POINTS_BEGIN, t0, x0);
    const double *to = cs_surface_points_positions(system, CS_POINTS_END, t1, x1);
    struct question question = {.system = system, .crossings = crossings, .x = from};
    struct cs_first_collision first = {.fraction = 1};
    const struct cs_move_query query = {.x0 = from,
                                        .x1 = to,
                                        .reach = {CS_ACCD_DISTANCE_MIN, CS_ACCD_DISTANCE_MIN},
                                        .may_meet = may_meet,
                                        .take = try_found,
                                        .arg = &question};
    cs_point_motion_set(system, from, to, crossings->motion);
    clear_found(crossings);
    // chunks of the list have the numbers of those of the search
    if (cs_crossings_list_suffices(system, from, to))
        cs_pool_run(crossings->search->n_chunks, try_chunk, &question);
    else
        crossings->failed |= !cs_primitive_search_move(crossings->search, &query);
    for (uint32_t k = 0; k < crossings->search->n_chunks; k++)
        if (crossings->found[k].collision.fraction < first.fraction)
            first = crossings->found[k].collision;
    return first;
}
