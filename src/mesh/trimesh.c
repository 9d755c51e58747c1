/* Checks a triangle mesh and derives its topology: edges, hinges, triangles at each vertex, and
 * areas of vertices.
 *
 * The three sides of each triangle are sorted by their vertices. Sides of one edge are then
 * neighbours in the list: one for an edge of the boundary, two inside, of opposite direction if
 * the triangles are oriented alike. All derived lists come out sorted, so the result does not
 * depend on the order of qsort. */
#include "mesh/trimesh.h"

#include "base/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum cs_status cs_trimesh_init(struct cs_trimesh *mesh, uint32_t n, uint32_t n_triangles,
                               bool uv, struct cs_arena *arena, struct cs_error *error) {
    *mesh = (struct cs_trimesh){.n = n, .n_triangles = n_triangles};
    mesh->positions = cs_arena_alloc_array(arena, 3 * (size_t)n, sizeof(double), error);
    CS_ARENA_ARRAY(arena, mesh->triangles, 3 * (size_t)n_triangles, error);
    if (uv)
        mesh->uv = cs_arena_alloc_array(arena, 6 * (size_t)n_triangles, sizeof(float), error);
    return error->status;
}

/* A directed side of a triangle, stored by its ordered ends. */
struct side {
    uint32_t low, high, triangle, across; /* ends; its triangle; the third corner */
    bool falls;                           /* directed from high to low */
};

/* Arguments and temporary arrays of one cs_trimesh_finish. */
struct work {
    struct cs_trimesh *mesh;
    const char *name;
    const uint32_t *lines;
    struct side *sides; /* (3 n_triangles), owned */
    uint32_t *hinges;   /* (n_hinges, 2) with repetitions, owned; NULL in the counting walk */
    uint32_t n_sides, n_hinges;
    struct cs_arena *arena;
    struct cs_error *error;
};

/* Writes the place of triangle t in the file: "x.obj:12", or "x.obj: triangle 3" without
 * lines. */
#define PLACE_MAX 320
static void position_of(const struct work *work, uint32_t t, char place[PLACE_MAX]) {
    if (work->lines)
        snprintf(place, PLACE_MAX, "%.256s:%u", work->name, work->lines[t]);
    else
        snprintf(place, PLACE_MAX, "%.256s: triangle %u", work->name, t);
}

bool cs_triangle_has_area(const double a[3], const double b[3], const double c[3]) {
    const double *p[4] = {a, b, c, a};
    double side[3][3], normal[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++)
            side[k][i] = p[k + 1][i] - p[k][i];
        longest = fmax(longest, cs_vec3_dot(side[k], side[k]));
    }
    cs_vec3_cross(side[0], side[2], normal);
    return sqrt(cs_vec3_dot(normal, normal)) > 1e-9 * longest;
}

/* Checks that the corners exist and the area is above 0. */
static enum cs_status check_triangle(const struct work *work, uint32_t t) {
    const struct cs_trimesh *mesh = work->mesh;
    const uint32_t *corner = mesh->triangles + 3 * (size_t)t;
    char place[PLACE_MAX];
    double p[3][3];
    position_of(work, t, place);
    for (int k = 0; k < 3; k++) {
        if (corner[k] >= mesh->n)
            return cs_fail(work->error, CS_ERR_FILE, "%s: vertex %u does not exist (1..%u)",
                           place, corner[k] + 1, mesh->n);
        for (size_t c = 0; c < 3; c++)
            p[k][c] = mesh->positions[c * mesh->n + corner[k]];
    }
    if (!cs_triangle_has_area(p[0], p[1], p[2]))
        return cs_fail(work->error, CS_ERR_FILE,
                       "%s: the triangle of vertices %u, %u and %u has no area", place,
                       corner[0] + 1, corner[1] + 1, corner[2] + 1);
    return CS_OK;
}

/* Returns true if one of the names in a list separated by blanks is this one. */
static bool has_name(const char *names, const char *name) {
    const size_t length = strlen(name);
    for (const char *at = names; *at; at += strspn(at, " ")) {
        const size_t next = strcspn(at, " ");
        if (next == length && !memcmp(at, name, length))
            return true;
        at += next;
    }
    return false;
}

bool cs_mesh_has_label(const struct cs_mesh_label *labels,
                       const uint32_t numbers[CS_LABEL_KINDS], const char *name) {
    for (int kind = 0; kind < CS_LABEL_KINDS; kind++) {
        if (!numbers[kind])
            continue;
        const char *names = labels[numbers[kind] - 1].names;
        /* the name of an object or of a material may have blanks */
        if (kind == CS_LABEL_GROUP ? has_name(names, name) : !strcmp(names, name))
            return true;
    }
    return false;
}

/* Orders sides by edge, then by triangle: a total order, as qsort is not stable. */
static int by_edge(const void *left, const void *right) {
    const struct side *a = left, *b = right;
    if (a->low != b->low)
        return a->low < b->low ? -1 : 1;
    if (a->high != b->high)
        return a->high < b->high ? -1 : 1;
    return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

/* Lists the sides of all triangles and sorts them. */
static void fill_sides(struct work *work) {
    for (uint32_t t = 0; t < work->mesh->n_triangles; t++)
        for (int k = 0; k < 3; k++) {
            const uint32_t *corner = work->mesh->triangles + 3 * (size_t)t;
            const uint32_t from = corner[k], to = corner[(k + 1) % 3];
            work->sides[work->n_sides++] = (struct side){.low = from < to ? from : to,
                                                         .high = from < to ? to : from,
                                                         .triangle = t,
                                                         .across = corner[(k + 2) % 3],
                                                         .falls = from > to};
        }
    qsort(work->sides, work->n_sides, sizeof *work->sides, by_edge);
}

/* Checks one edge of `count` sides: two at most, in opposite directions. */
static enum cs_status check_edge(const struct work *work, const struct side *side,
                                 uint32_t count) {
    char place[PLACE_MAX];
    position_of(work, side[count - 1].triangle, place);
    if (count > 2)
        return cs_fail(work->error, CS_ERR_FILE,
                       "%s: the edge of vertices %u and %u has %u triangles, expected 1 or 2",
                       place, side->low + 1, side->high + 1, count);
    if (count == 2 && side[0].falls == side[1].falls)
        return cs_fail(work->error, CS_ERR_FILE,
                       "%s: the two triangles at the edge of vertices %u and %u have opposite "
                       "orientations",
                       place, side->low + 1, side->high + 1);
    return CS_OK;
}

/* Counts edges, open edges and hinges; writes edges and hinges if their arrays exist. */
static enum cs_status walk_edges(struct work *work) {
    struct cs_trimesh *mesh = work->mesh;
    mesh->n_edges = mesh->n_open = work->n_hinges = 0;
    for (uint32_t s = 0, count; s < work->n_sides; s += count) {
        const struct side *side = work->sides + s;
        /* sides are sorted: those of one edge are neighbours */
        for (count = 1; s + count < work->n_sides && side[count].low == side->low &&
                        side[count].high == side->high;)
            count++;
        if (check_edge(work, side, count))
            return work->error->status;
        if (mesh->edges) {
            mesh->edges[2 * (size_t)mesh->n_edges] = side->low;
            mesh->edges[2 * (size_t)mesh->n_edges + 1] = side->high;
        }
        if (work->hinges && count == 2) {
            const uint32_t a = side[0].across, b = side[1].across;
            work->hinges[2 * (size_t)work->n_hinges] = a < b ? a : b;
            work->hinges[2 * (size_t)work->n_hinges + 1] = a < b ? b : a;
        }
        mesh->n_edges++;
        mesh->n_open += count == 1;
        work->n_hinges += count == 2;
    }
    return CS_OK;
}

/* Orders pairs of vertices. */
static int by_pair(const void *left, const void *right) {
    const uint32_t *a = left, *b = right;
    if (a[0] != b[0])
        return a[0] < b[0] ? -1 : 1;
    return a[1] < b[1] ? -1 : a[1] > b[1];
}

/* Stores each hinge once. Leaves out pairs that an edge joins already: in a tetrahedron all of
 * them are. */
static enum cs_status store_hinges(struct work *work) {
    struct cs_trimesh *mesh = work->mesh;
    const size_t pair = 2 * sizeof *work->hinges;
    qsort(work->hinges, work->n_hinges, pair, by_pair);
    mesh->hinges = cs_arena_alloc_array(work->arena, work->n_hinges, pair, work->error);
    for (uint32_t h = 0; mesh->hinges && h < work->n_hinges; h++) {
        const uint32_t *hinge = work->hinges + 2 * (size_t)h;
        if ((h && !by_pair(hinge - 2, hinge)) || hinge[0] == hinge[1] ||
            bsearch(hinge, mesh->edges, mesh->n_edges, pair, by_pair))
            continue;
        memcpy(mesh->hinges + 2 * (size_t)mesh->n_hinges++, hinge, pair);
    }
    return work->error->status;
}

/* Lists the triangles at each vertex by counting sort, and sums areas. Refuses a vertex without
 * triangles, because its particle would have no mass and no spring. */
static enum cs_status fill_vertices(struct work *work) {
    struct cs_trimesh *mesh = work->mesh;
    uint32_t *end = mesh->vertex_triangles_end;
    for (size_t k = 0; k < 3 * (size_t)mesh->n_triangles; k++)
        end[mesh->triangles[k]]++;
    for (uint32_t i = 0, before = 0; i < mesh->n; i++) {
        if (end[i] == 0)
            return cs_fail(work->error, CS_ERR_FILE, "%s: vertex %u is in no face", work->name,
                           i + 1);
        /* starts for now; they become ends while `around` is filled */
        const uint32_t count = end[i];
        end[i] = before;
        before += count;
    }
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        double normal[3];
        cs_trimesh_normal(mesh, t, mesh->positions, mesh->n, 0, normal);
        const double area =
            0.5 * sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        for (int k = 0; k < 3; k++) {
            const uint32_t i = mesh->triangles[3 * (size_t)t + k];
            mesh->vertex_triangles[end[i]++] = t;
            mesh->area[i] += area / 3;
        }
    }
    return CS_OK;
}

/* Mean length of the edges, in the order of the list. */
static void measure_edges(struct cs_trimesh *mesh) {
    for (uint32_t e = 0; e < mesh->n_edges; e++) {
        const uint32_t *ends = mesh->edges + 2 * (size_t)e;
        mesh->edge += sqrt(cs_trimesh_squared_distance(mesh, ends[0], ends[1])) / mesh->n_edges;
    }
}

/* Allocates the temporary sides, and the arrays of vertices in the arena. */
static enum cs_status allocate_mesh(struct work *work) {
    struct cs_trimesh *mesh = work->mesh;
    const size_t corners = 3 * (size_t)mesh->n_triangles;
    work->sides = calloc(corners + 1, sizeof *work->sides);
    work->hinges = NULL;
    if (!work->sides)
        return cs_fail(work->error, CS_ERR_MEMORY, "out of memory for a mesh of %u triangles",
                       mesh->n_triangles);
    CS_ARENA_ARRAY(work->arena, mesh->vertex_triangles, corners, work->error);
    CS_ARENA_ARRAY(work->arena, mesh->vertex_triangles_end, mesh->n, work->error);
    mesh->area = cs_arena_alloc_array(work->arena, mesh->n, sizeof *mesh->area, work->error);
    return work->error->status;
}

/* All of cs_trimesh_finish but the release of temporary memory. */
static enum cs_status build(struct work *work) {
    struct cs_trimesh *mesh = work->mesh;
    if (mesh->n == 0 || mesh->n_triangles == 0)
        return cs_fail(work->error, CS_ERR_FILE, "%s: found no faces", work->name);
    for (uint32_t t = 0; t < mesh->n_triangles; t++)
        if (check_triangle(work, t))
            return work->error->status;
    if (allocate_mesh(work))
        return work->error->status;
    fill_sides(work);
    if (walk_edges(work) || fill_vertices(work))
        return work->error->status;
    /* the first walk has counted edges and hinges, the second writes them */
    mesh->edges =
        cs_arena_alloc_array(work->arena, mesh->n_edges, 2 * sizeof *mesh->edges, work->error);
    work->hinges = calloc((size_t)work->n_hinges + 1, 2 * sizeof *work->hinges);
    if (!work->hinges)
        cs_fail(work->error, CS_ERR_MEMORY, "out of memory for %u edges", mesh->n_edges);
    if (work->error->status || walk_edges(work) || store_hinges(work))
        return work->error->status;
    measure_edges(mesh);
    return CS_OK;
}

enum cs_status cs_trimesh_finish(struct cs_trimesh *mesh, const char *name,
                                 const uint32_t *lines, struct cs_arena *arena,
                                 struct cs_error *error) {
    struct work work = {
        .mesh = mesh, .name = name, .lines = lines, .arena = arena, .error = error};
    build(&work);
    free(work.sides);
    free(work.hinges);
    return error->status;
}
