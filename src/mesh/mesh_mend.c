/* Mends a mesh. Corners are joined to vertices by a union-find structure: at most vertices all
 * corners of the file's vertex are one; at the ends of an edge of three triangles or more, only
 * the corners of triangles that stay neighbours there. Welding joins more. */
#include "mesh/mesh_mend.h"

#include "base/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Distance of vertices in one place, over the diagonal of the box of all: the digits of a file
 * written in single precision. */
#define WELD_DISTANCE 1e-6

/* Rounds of cutting: a cut can bring to light another edge of three triangles. */
enum { ROUNDS_MAX = 8 };

struct work {
    struct cs_raw_mesh *raw;
    struct cs_mesh_mends *mends;
    struct cs_raw_side *sides; /* (3 n_triangles), sorted */
    uint32_t
        *places; /* (n_vertices) the first vertex in the same place; itself if not welded */
    uint32_t *parents; /* (n_vertices + 3 n_triangles) of the union-find structure */
    bool *torn;        /* (n_triangles) stays neighbour of none */
    bool *splits;      /* (n_vertices) its corners are joined one by one */
};

/* Makes two sets one; returns 0 if they are one already. */
static uint32_t join(uint32_t *parents, uint32_t a, uint32_t b) {
    a = cs_root_of(parents, a);
    b = cs_root_of(parents, b);
    parents[a > b ? a : b] = a < b ? a : b;
    return a != b;
}

/* --- sides --- */

/* The node of the corner at which a side has its lower (end 0) or higher end. */
static uint32_t node_of(const struct work *work, const struct cs_raw_side *side, int end) {
    const uint32_t k = (side->k + (side->falls != (end == 1))) % 3;
    const uint32_t vertex = side->vertex[end];
    return work->splits[vertex] ? work->raw->n_vertices + 3 * side->triangle + k : vertex;
}

/* Joins the corners along each pair of sides of opposite direction, in their order, that no
 * earlier call has paired. Returns the number of sets that became one with another. */
static uint32_t pair_sides(struct work *work, struct cs_raw_side *sides, uint32_t n) {
    uint32_t next[2] = {0, 0}, joined = 0;
    for (;;) {
        for (int way = 0; way < 2; way++)
            while (next[way] < n &&
                   (sides[next[way]].paired || sides[next[way]].falls != (way == 1)))
                next[way]++;
        if (next[0] == n || next[1] == n)
            return joined;
        struct cs_raw_side *a = sides + next[0], *b = sides + next[1];
        a->paired = b->paired = true;
        for (int end = 0; end < 2; end++)
            joined += join(work->parents, node_of(work, a, end), node_of(work, b, end));
    }
}

static int by_angle(const void *left, const void *right) {
    const struct cs_raw_side *a = left, *b = right;
    return a->angle != b->angle ? (a->angle > b->angle) - (a->angle < b->angle)
                                : a->falls - b->falls; // nothing is between faces in one place
}

/* Orders the sides at an edge where solids or holes touch, counter-clockwise about it: one that
 * falls and the next one bound the same solid, wherever they stand in the file. */
static void order_around(const struct work *work, struct cs_raw_side *sides, uint32_t n) {
    const double(*x)[3] = (const double(*)[3])work->raw->positions;
    double axes[3][3];
    uint32_t falling = 0;
    for (uint32_t i = 0; i < n; i++)
        falling += sides[i].falls;
    if (n < 4 || 2 * falling != n)
        return;
    for (uint32_t i = 0; i < n; i++) {
        const struct cs_raw_corner *corners = work->raw->triangles[sides[i].triangle].corners;
        const double *p = x[sides->vertex[0]], *q = x[sides->vertex[1]],
                     *r = x[corners[(sides[i].k + 2) % 3].vertex];
        double arm[3];
        for (int c = 0; c < 3; c++) {
            axes[2][c] = q[c] - p[c];
            arm[c] = r[c] - p[c];
        }
        if (i == 0) {
            cs_vec3_cross(axes[2], arm, axes[1]);
            cs_vec3_cross(axes[1], axes[2], axes[0]);
        }
        const double a = cs_vec3_dot(arm, axes[0]), b = cs_vec3_dot(arm, axes[1]);
        // ascends with the angle, whatever the lengths of the axes
        const double slope = b / (fabs(a) + fabs(b));
        sides[i].angle = a >= 0 ? slope : 2 - slope;
    }
    qsort(sides, n, sizeof *sides, by_angle);
    // the first that falls after one that does not begins
    uint32_t first = 0;
    while (!sides[first].falls || sides[(first + n - 1) % n].falls)
        first++;
    for (uint32_t i = 0; i < first; i++)
        sides[i].angle += 4;
    qsort(sides, n, sizeof *sides, by_angle);
}

static uint32_t run_of(const struct work *work, uint32_t first, bool by_vertex) {
    return cs_raw_side_run(work->sides + first, 3 * work->raw->n_triangles - first, by_vertex);
}

/* Marks the ends of edges of more than two triangles, and returns their number; counts them as
 * faults if `tells`. */
static uint32_t mark_splits(struct work *work, bool tells) {
    uint32_t found = 0;
    for (uint32_t s = 0, n; s < 3 * work->raw->n_triangles; s += n) {
        struct cs_raw_side *side = work->sides + s;
        n = run_of(work, s, true);
        if (n <= 2)
            continue;
        found++;
        if (tells)
            cs_mesh_fault_count(&work->mends->cut, &work->mends->cut_line,
                                work->raw->triangles[side[2].triangle].line);
        work->splits[side->vertex[0]] = work->splits[side->vertex[1]] = true;
        /* a cut that has left the edge whole goes round it: the third triangle and more are
         * torn */
        for (uint32_t i = 2; i < n && !tells; i++)
            work->torn[side[i].triangle] = true;
    }
    return found;
}

/* Joins corners: along the edges of the file, then along open edges in one place. */
static void join_corners(struct work *work) {
    for (uint32_t s = 0; s < 3 * work->raw->n_triangles; s++)
        work->sides[s].paired = work->torn[work->sides[s].triangle];
    for (uint32_t s = 0, n; s < 3 * work->raw->n_triangles; s += n) {
        n = run_of(work, s, true);
        order_around(work, work->sides + s, n);
        pair_sides(work, work->sides + s, n);
        /* neighbours of opposite orientation stay so, and are refused; more are cut off */
        for (uint32_t i = 0; i < n && n > 1; i++)
            work->sides[s + i].paired = true;
    }
    for (uint32_t s = 0, n; s < 3 * work->raw->n_triangles; s += n) {
        n = run_of(work, s, false);
        if (work->sides[s].place[0] != work->sides[s].place[1])
            work->mends->welded += pair_sides(work, work->sides + s, n);
    }
}

/* --- vertices --- */

/* Numbers the sets of corners: in the order of the file's vertices, then what was cut off. Sets
 * corners, sources and positions. */
static enum cs_status number_vertices(struct work *work, struct cs_error *error) {
    struct cs_raw_mesh *raw = work->raw;
    const size_t nodes = raw->n_vertices + 3 * (size_t)raw->n_triangles;
    uint32_t *numbers = calloc(nodes + 1, sizeof *numbers); /* from 1; 0: not used */
    uint32_t *sources = calloc(nodes + 1, sizeof *sources);
    double(*positions)[3] = calloc(nodes + 1, sizeof *positions);
    uint32_t n = 0;
    if (!numbers || !sources || !positions) {
        free(numbers);
        free(sources);
        free(positions);
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a mesh");
    }
    for (size_t s = 0; s < 3 * (size_t)raw->n_triangles; s++) {
        const struct cs_raw_side *side = work->sides + s;
        numbers[cs_root_of(work->parents, node_of(work, side, side->falls))] = 1;
    }
    for (size_t node = 0; node < nodes; node++) {
        if (!numbers[node])
            continue;
        const uint32_t corner = (uint32_t)(node - raw->n_vertices);
        const uint32_t vertex = node < raw->n_vertices
                                    ? (uint32_t)node
                                    : raw->triangles[corner / 3].corners[corner % 3].vertex;
        sources[n] = raw->sources ? raw->sources[vertex] : vertex;
        memcpy(positions[n], raw->positions[vertex], sizeof *positions);
        numbers[node] = ++n;
    }
    for (size_t s = 0; s < 3 * (size_t)raw->n_triangles; s++) {
        const struct cs_raw_side *side = work->sides + s;
        raw->triangles[side->triangle].corners[side->k].vertex =
            numbers[cs_root_of(work->parents, node_of(work, side, side->falls))] - 1;
    }
    free(numbers);
    free(raw->sources);
    free(raw->positions);
    raw->sources = sources;
    raw->positions = positions;
    raw->n_vertices = n;
    return CS_OK;
}

/* Marks the ends of edges of one triangle. */
static void mark_open(const struct work *work, bool *open) {
    for (uint32_t s = 0, n; s < 3 * work->raw->n_triangles; s += n) {
        n = run_of(work, s, true);
        for (int end = 0; end < 2 && n == 1; end++)
            open[work->sides[s].vertex[end]] = true;
    }
}

/* Finds the ends of open edges that lie in one place, and lists the sides by place. */
static enum cs_status find_places(struct work *work, struct cs_error *error) {
    const struct cs_raw_mesh *raw = work->raw;
    bool *open = calloc((size_t)raw->n_vertices + 1, sizeof *open);
    if (!open)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a mesh");
    mark_open(work, open);
    if (cs_near_vertices_find((const double(*)[3])raw->positions, raw->n_vertices, open,
                              WELD_DISTANCE, work->places, error))
        cs_raw_sides_list(work->raw, work->places, work->sides);
    free(open);
    return error->status;
}

/* Counts the pieces that edges and vertices hold together. */
static uint32_t count_pieces(const struct cs_raw_mesh *raw, uint32_t *parents) {
    uint32_t pieces = raw->n_vertices;
    for (uint32_t i = 0; i < raw->n_vertices; i++)
        parents[i] = i;
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        for (int k = 1; k < 3; k++)
            pieces -= join(parents, raw->triangles[t].corners[0].vertex,
                           raw->triangles[t].corners[k].vertex);
    return pieces;
}

/* --- all --- */

static enum cs_status begin_mending(struct work *work, struct cs_arena *arena,
                                    struct cs_error *error) {
    const size_t n = work->raw->n_vertices, sides = 3 * (size_t)work->raw->n_triangles;
    CS_ARENA_ARRAY(arena, work->sides, sides, error);
    CS_ARENA_ARRAY(arena, work->places, n, error);
    CS_ARENA_ARRAY(arena, work->parents, n + sides, error);
    CS_ARENA_ARRAY(arena, work->splits, n, error);
    CS_ARENA_ARRAY(arena, work->torn, sides / 3, error);
    for (size_t i = 0; !error->status && i < n + sides; i++)
        work->parents[i] = (uint32_t)i;
    for (size_t i = 0; !error->status && i < n; i++)
        work->places[i] = (uint32_t)i;
    if (!error->status)
        cs_raw_sides_list(work->raw, work->places, work->sides);
    return error->status;
}

/* One round: cuts, and welds if asked to. *again: edges of more than two triangles are left. */
static enum cs_status mend_once(struct cs_raw_mesh *raw, bool weld, bool first,
                                struct cs_mesh_mends *mends, bool *again,
                                struct cs_error *error) {
    struct cs_arena arena = {0};
    struct work work = {.raw = raw, .mends = mends};
    if (!begin_mending(&work, &arena, error)) {
        /* a mesh without faults is numbered once, for its loose vertices */
        *again = mark_splits(&work, first) > 0;
        if (*again || first)
            if (!weld || !find_places(&work, error)) {
                join_corners(&work);
                number_vertices(&work, error);
                *again = *again || mends->welded;
            }
        if (!error->status)
            mends->pieces = count_pieces(raw, work.parents);
    }
    cs_arena_finish(&arena);
    return error->status;
}

/* Vertices of no face. */
static uint32_t count_loose(const struct cs_raw_mesh *raw, struct cs_error *error) {
    uint32_t loose = 0;
    bool *used = calloc((size_t)raw->n_vertices + 1, sizeof *used);
    if (!used)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a mesh");
    for (uint32_t t = 0; used && t < raw->n_triangles; t++)
        for (int k = 0; k < 3; k++)
            used[raw->triangles[t].corners[k].vertex] = true;
    for (uint32_t i = 0; used && i < raw->n_vertices; i++)
        loose += !used[i];
    free(used);
    return loose;
}

/* Rounds of cutting, until no edge has more than two triangles; the first one welds. */
static enum cs_status mend_edges(struct cs_raw_mesh *raw, bool weld,
                                 struct cs_mesh_mends *mends, struct cs_error *error) {
    bool again = true;
    for (int round = 0; again && round < ROUNDS_MAX; round++)
        if (mend_once(raw, weld && round == 0, round == 0, mends, &again, error))
            return error->status;
    return CS_OK;
}

enum cs_status cs_mesh_mend(struct cs_raw_mesh *raw, bool weld, struct cs_mesh_mends *mends,
                            struct cs_error *error) {
    mends->loose = count_loose(raw, error);
    if (error->status || cs_flat_faces_remove(raw, mends, error) ||
        cs_repeated_faces_remove(raw, mends, error) || cs_faces_turn_alike(raw, mends, error) ||
        mend_edges(raw, weld, mends, error))
        return error->status;
    /* a welded vertex may have moved onto the side of a narrow face */
    const uint32_t flat = mends->flat;
    return cs_flat_faces_remove(raw, mends, error) || mends->flat == flat
               ? error->status
               : mend_edges(raw, false, mends, error);
}
