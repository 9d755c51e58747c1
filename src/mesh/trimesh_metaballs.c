/* The mesh `limbs`: a rounded body with limbs, as a level set of metaballs (Blinn 1982) that is
 * meshed by surface nets (Gibson 1998).
 *
 * Field: each blob b is an ellipsoid with centre m and radii a. With
 *   r_b^2 = sum_c ((p - m)_c / a_c)^2
 *   F(p) = sum_b w(r_b^2) - 1/4,   w(r^2) = (1 - r^2 / 2)^2 for r^2 < 2, else 0.
 * The surface is F = 0. A blob alone has w(1) = 1/4: its surface is its ellipsoid r = 1. Where
 * blobs overlap their sum exceeds 1/4 earlier, which blends them smoothly. Value and slope of w
 * are 0 at r^2 = 2, so a blob ends there. Blinn uses an exponential, which never ends; a
 * polynomial also has the same bits on every machine.
 *
 * Mesh: F is sampled at the points of a cubic lattice. Each cell with both signs gets one
 * vertex, the mean of the crossings of its edges (Gibson starts from the cell's middle and
 * relaxes). Each lattice edge with a crossing gets a quad of the vertices of the four cells
 * around it. The result is closed, because F < 0 on the border of the lattice. It is a manifold
 * once parts that touch in a lattice edge or corner only are joined (join_touching).
 */
#include "mesh/trimesh.h"

#include <stdlib.h>

/* Blobs: centre (3), then radii (3) of its ellipsoid, as fractions of the body's height of
 * about 1. A blob whose x is not 0 stands for two, mirrored at x = 0. */
static const double blobs[][6] = {
    {0, -0.13, 0, 0.19, 0.23, 0.16},          /* trunk */
    {0, 0.235, 0, 0.155, 0.145, 0.14},        /* head */
    {0, 0.20, 0.135, 0.06, 0.05, 0.055},      /* snout */
    {0.13, 0.375, -0.01, 0.07, 0.07, 0.045},  /* ears */
    {0.20, 0.01, 0.02, 0.10, 0.07, 0.065},    /* arms */
    {0.33, 0.03, 0.04, 0.075, 0.062, 0.06},   /* hands */
    {0.12, -0.32, 0.02, 0.075, 0.10, 0.075},  /* legs */
    {0.13, -0.425, 0.07, 0.075, 0.055, 0.10}, /* feet */
};
/* half extents of the lattice along x, y, z: at least those of the surface */
static const double reach[3] = {0.42, 0.5, 0.24};

/* Samples of F, and the numbering of the vertices. Point (i, j, k) has the index
 *   (k n[1] + j) n[0] + i;
 * its cell reaches to (i + 1, j + 1, k + 1). */
struct lattice {
    uint32_t n[3];    /* points along each axis; even, for symmetry about 0 */
    double step;      /* spacing of the points: 1 / detail */
    double *field;    /* (n) F, above 0 inside; owned */
    uint32_t *vertex; /* (n) vertex of the cell whose lowest corner is here; owned */
    uint32_t n_vertices, n_quads; /* counted by the last walk */
};

/* Index of a lattice point. */
static size_t at(const struct lattice *lattice, uint32_t i, uint32_t j, uint32_t k) {
    return ((size_t)k * lattice->n[1] + j) * lattice->n[0] + i;
}

/* F at a point: the sum of all blobs in the order of the table, less the level 1/4. */
static double field_at(const double p[3]) {
    double sum = -0.25;
    for (size_t b = 0; b < sizeof blobs / sizeof *blobs; b++)
        for (int side = 1; side >= (blobs[b][0] > 0 ? -1 : 1); side -= 2) {
            double squared = 0;
            for (int c = 0; c < 3; c++) {
                const double d = (p[c] - (c ? 1 : side) * blobs[b][c]) / blobs[b][3 + c];
                squared += d * d;
            }
            if (squared < 2)
                sum += (1 - squared / 2) * (1 - squared / 2);
        }
    return sum;
}

/* Coordinate of point i of an axis; the lattice is centred on 0. */
static double coordinate(const struct lattice *lattice, int axis, uint32_t i) {
    /* the same to both sides, so that the halves of the body are alike */
    return lattice->step * (i - 0.5 * (lattice->n[axis] - 1));
}

/* Samples F at all points. */
static void fill_field(struct lattice *lattice) {
    for (uint32_t k = 0; k < lattice->n[2]; k++)
        for (uint32_t j = 0; j < lattice->n[1]; j++)
            for (uint32_t i = 0; i < lattice->n[0]; i++) {
                const double p[3] = {coordinate(lattice, 0, i), coordinate(lattice, 1, j),
                                     coordinate(lattice, 2, k)};
                lattice->field[at(lattice, i, j, k)] = field_at(p);
            }
}

/* Removes the two patterns of signs for which surface nets give no manifold, by moving one
 * outside point of each inside:
 *   - a lattice face whose diagonals differ in sign, with four crossings: four quads would
 *     share the edge between the two cells at the face;
 *   - a cell in which two opposite corners alone differ from the six others: its one vertex
 *     would join two sheets.
 * One pass over all cells; returns true if it changed a point, since that may make a new
 * pattern. Points only ever change to inside, so repeated passes end. */
static bool join_touching(struct lattice *lattice) {
    static const double joined = 1e-3; /* just inside */
    const size_t row = lattice->n[0], layer = row * lattice->n[1];
    const size_t last = at(lattice, lattice->n[0] - 2, lattice->n[1] - 2, lattice->n[2] - 2);
    const size_t stride[3] = {1, row, layer};
    double *f = lattice->field;
    bool found = false;
    for (size_t p = 0; p <= last; p++) {
        for (int axis = 0; axis < 3; axis++) {
            const size_t u = stride[axis], v = stride[(axis + 1) % 3];
            const bool here = f[p] > 0, across = f[p + u + v] > 0;
            if (here != across || (f[p + u] > 0) == here || (f[p + v] > 0) == here)
                continue;
            f[here ? p + u : p] = joined;
            found = true;
        }
        for (uint32_t corner = 0; corner < 4; corner++) {
            /* a corner of the cell, and the one across; alone against the six others */
            const size_t a = (corner & 1) + (corner & 2 ? row : 0), b = 1 + row + layer - a;
            uint32_t inside = 0;
            for (uint32_t c = 0; c < 8; c++)
                inside += f[p + (c & 1) + (c & 2 ? row : 0) + (c & 4 ? layer : 0)] > 0;
            const bool apart =
                (f[p + a] > 0) == (f[p + b] > 0) && inside == (f[p + a] > 0 ? 2 : 6);
            if (!apart)
                continue;
            f[inside == 6 ? p + a : corner & 1 ? p + a - 1 : p + a + 1] = joined;
            found = true;
        }
    }
    return found;
}

/* Returns true if F changes sign on the edge from point p along an axis. */
static bool crosses(const struct lattice *lattice, const uint32_t p[3], int axis) {
    const size_t stride[3] = {1, lattice->n[0], (size_t)lattice->n[0] * lattice->n[1]};
    const size_t here = at(lattice, p[0], p[1], p[2]);
    return (lattice->field[here] > 0) != (lattice->field[here + stride[axis]] > 0);
}

/* The mean of the crossings of the 12 edges of the cell at p; returns false if there are none.
 * F is taken as linear along an edge: it is 0 at the fraction a / (a - b). */
static bool cell_vertex(const struct lattice *lattice, const uint32_t p[3], double place[3]) {
    int n = 0;
    place[0] = place[1] = place[2] = 0;
    for (int axis = 0; axis < 3; axis++)
        for (uint32_t e = 0; e < 4; e++) {
            uint32_t from[3] = {p[0], p[1], p[2]}, to[3];
            from[(axis + 1) % 3] += e % 2;
            from[(axis + 2) % 3] += e / 2;
            if (!crosses(lattice, from, axis))
                continue;
            for (int c = 0; c < 3; c++)
                to[c] = from[c] + (c == axis);
            /* the crossing: where linear interpolation along the edge is 0 */
            const double a = lattice->field[at(lattice, from[0], from[1], from[2])];
            const double b = lattice->field[at(lattice, to[0], to[1], to[2])];
            for (int c = 0; c < 3; c++)
                place[c] += coordinate(lattice, c, from[c]) +
                            (c == axis ? lattice->step * a / (a - b) : 0);
            n++;
        }
    for (int c = 0; c < 3 && n; c++)
        place[c] /= n;
    return n > 0;
}

/* Numbers the cells with a vertex. The second walk, with positions (3,n) given, writes them
 * too; n is the count of the first. */
static void walk_cells(struct lattice *lattice, double *places) {
    const size_t n = lattice->n_vertices;
    double place[3];
    lattice->n_vertices = 0;
    for (uint32_t k = 0; k + 1 < lattice->n[2]; k++)
        for (uint32_t j = 0; j + 1 < lattice->n[1]; j++)
            for (uint32_t i = 0; i + 1 < lattice->n[0]; i++) {
                if (!cell_vertex(lattice, (uint32_t[3]){i, j, k}, place))
                    continue;
                for (size_t c = 0; places && c < 3; c++)
                    places[c * n + lattice->n_vertices] = place[c];
                lattice->vertex[at(lattice, i, j, k)] = lattice->n_vertices++;
            }
}

/* Writes the two triangles of the quad around the edge from p along an axis, cut along the
 * shorter diagonal. The four cells are taken counter-clockwise about the axis if p is inside,
 * so that normals point from inside to outside; else the other way round. */
static void add_quad(const struct lattice *lattice, struct cs_trimesh *mesh, uint32_t *out,
                     const uint32_t p[3], int axis) {
    static const uint32_t back[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
    const bool outwards = lattice->field[at(lattice, p[0], p[1], p[2])] > 0;
    uint32_t quad[4];
    for (int c = 0; c < 4; c++) {
        const uint32_t *step = back[outwards ? c : 3 - c];
        uint32_t cell[3] = {p[0], p[1], p[2]};
        cell[(axis + 1) % 3] -= step[0];
        cell[(axis + 2) % 3] -= step[1];
        quad[c] = lattice->vertex[at(lattice, cell[0], cell[1], cell[2])];
    }
    const int k = cs_trimesh_squared_distance(mesh, quad[1], quad[3]) <
                  cs_trimesh_squared_distance(mesh, quad[0], quad[2]);
    const uint32_t corners[6] = {quad[k], quad[1 + k], quad[2 + k],
                                 quad[k], quad[2 + k], quad[(3 + k) % 4]};
    for (int c = 0; c < 6; c++)
        out[c] = corners[c];
}

/* Counts the quads; with a mesh given, also writes their triangles. Starts at 1, where each
 * point has all its cells; the border has no crossings. */
static void walk_edges(struct lattice *lattice, struct cs_trimesh *mesh) {
    lattice->n_quads = 0;
    for (uint32_t k = 1; k + 1 < lattice->n[2]; k++)
        for (uint32_t j = 1; j + 1 < lattice->n[1]; j++)
            for (uint32_t i = 1; i + 1 < lattice->n[0]; i++)
                for (int axis = 0; axis < 3; axis++) {
                    const uint32_t p[3] = {i, j, k};
                    if (!crosses(lattice, p, axis))
                        continue;
                    if (mesh)
                        add_quad(lattice, mesh, mesh->triangles + 6 * (size_t)lattice->n_quads,
                                 p, axis);
                    lattice->n_quads++;
                }
}

/* Runs in time and memory proportional to the lattice, detail^3. Fails with CS_ERR_MEMORY; then
 * only memory of the arena stays taken. */

enum cs_status cs_trimesh_make_metaballs(struct cs_trimesh *mesh, uint32_t detail,
                                         struct cs_arena *arena, struct cs_error *error) {
    struct lattice lattice = {.step = 1.0 / detail};
    for (int c = 0; c < 3; c++)
        /* half the extent rounded down, and 3 points beyond on each side */
        lattice.n[c] = 2 * (uint32_t)(reach[c] * detail) + 6;
    const size_t points = at(&lattice, 0, 0, lattice.n[2]);
    lattice.field = calloc(points, sizeof *lattice.field);
    lattice.vertex = calloc(points, sizeof *lattice.vertex);
    if (!lattice.field || !lattice.vertex) {
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a lattice of %zu points", points);
        goto done;
    }
    fill_field(&lattice);
    /* joining one place may make its neighbours touch */
    while (join_touching(&lattice))
        continue;
    /* the first pass counts, the second writes */
    walk_cells(&lattice, NULL);
    walk_edges(&lattice, NULL);
    if (cs_trimesh_init(mesh, lattice.n_vertices, 2 * lattice.n_quads, false, arena, error))
        goto done;
    walk_cells(&lattice, mesh->positions);
    walk_edges(&lattice, mesh);
done:
    free(lattice.field);
    free(lattice.vertex);
    return error->status;
}
