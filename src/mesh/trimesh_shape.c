/* Generated meshes: box, sphere and torus. They use only + - * / and sqrt, so the vertices have
 * the same bits on every machine. */
#include "base/portable_sine.h"
#include "mesh/trimesh.h"

#include <math.h>
#include <string.h>

/* Sets vertex i of (3,n). */
static void set_position(struct cs_trimesh *mesh, uint32_t i, double x, double y, double z) {
    const size_t n = mesh->n;
    mesh->positions[i] = x;
    mesh->positions[n + i] = y;
    mesh->positions[2 * n + i] = z;
}

/* Writes a triangle and returns the place of the next. */
static uint32_t *add_triangle(uint32_t *out, uint32_t a, uint32_t b, uint32_t c) {
    *out++ = a, *out++ = b, *out++ = c;
    return out;
}

/* Writes a quad, counter-clockwise, as two triangles; `other` takes the other diagonal. Callers
 * alternate the diagonals, so that the mesh has no preferred direction. */
static uint32_t *add_quad(uint32_t *out, const uint32_t q[4], bool other) {
    const int k = other;
    out = add_triangle(out, q[k], q[1 + k], q[2 + k]);
    return add_triangle(out, q[k], q[2 + k], q[(3 + k) % 4]);
}

/* Index of lattice point p, 0..d along each axis, on the surface of a box. The (d + 1)^2 points
 * of the layer z = 0 come first, then d - 1 rings of 4 d points, then the layer z = d. */
static uint32_t box_index(const uint32_t p[3], uint32_t d) {
    const uint32_t full = (d + 1) * (d + 1), i = p[0], j = p[1], k = p[2];
    if (k == 0 || k == d)
        return (k ? full + (d - 1) * 4 * d : 0) + j * (d + 1) + i;
    const uint32_t ring = j == 0 && i < d   ? i
                          : i == d && j < d ? d + j
                          : j == d && i > 0 ? 2 * d + (d - i)
                                            : 3 * d + (d - j);
    return full + (k - 1) * 4 * d + ring;
}

/* A cube of side 1 with d x d quads on each face: 6 d^2 + 2 vertices, 12 d^2 triangles. Points
 * on edges and corners are written by each of their faces, with the same value. */
static enum cs_status make_box(struct cs_trimesh *mesh, uint32_t d, struct cs_arena *arena,
                               struct cs_error *error) {
    if (cs_trimesh_init(mesh, 6 * d * d + 2, 12 * d * d, false, arena, error))
        return error->status;
    uint32_t *out = mesh->triangles;
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t i = 0; i < d; i++)
            for (uint32_t j = 0; j < d; j++) {
                /* the corners go round the axis of the face, or back on its low side */
                static const uint32_t round[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
                const uint32_t axis = face / 2, high = face % 2;
                uint32_t quad[4];
                for (uint32_t c = 0; c < 4; c++) {
                    const uint32_t *step = round[high ? c : 3 - c];
                    uint32_t p[3];
                    p[axis] = high * d;
                    p[(axis + 1) % 3] = i + step[0];
                    p[(axis + 2) % 3] = j + step[1];
                    quad[c] = box_index(p, d);
                    set_position(mesh, quad[c], (double)p[0] / d - 0.5, (double)p[1] / d - 0.5,
                                 (double)p[2] / d - 0.5);
                }
                out = add_quad(out, quad, (i + j) % 2);
            }
    return CS_OK;
}

/* A face of the icosahedron: its corners, and the numbers of its sides 0-1, 1-2, 2-0. */
struct face {
    uint32_t corner[3], side[3];
};

/* Numbers the 30 sides of the icosahedron in the order in which the faces name them. */
static void number_sides(struct face faces[20]) {
    uint32_t ends[30][2], n = 0;
    for (int f = 0; f < 20; f++)
        for (int k = 0; k < 3; k++) {
            const uint32_t a = faces[f].corner[k], b = faces[f].corner[(k + 1) % 3];
            uint32_t s = 0;
            while (s < n && !((ends[s][0] == a && ends[s][1] == b) ||
                              (ends[s][0] == b && ends[s][1] == a)))
                s++;
            if (s == n) {
                ends[n][0] = a;
                ends[n++][1] = b;
            }
            faces[f].side[k] = s;
        }
}

/* Index of the point with whole weights w, of sum d, at the corners of face f. The 12 corners
 * come first, then d - 1 points per side, counted from its lower corner, then the inner points
 * of each face. Faces that share a side thus find the same index. */
static uint32_t sphere_index(const struct face *face, uint32_t f, const uint32_t w[3],
                             uint32_t d) {
    for (int k = 0; k < 3; k++)
        if (w[k] == d)
            return face->corner[k];
    for (int k = 0; k < 3; k++)
        if (w[(k + 2) % 3] == 0) {
            const bool rises = face->corner[k] < face->corner[(k + 1) % 3];
            return 12 + face->side[k] * (d - 1) + (rises ? w[(k + 1) % 3] : w[k]) - 1;
        }
    /* row w0 = 1 holds w1 = 1..d-2, and each later row one less */
    const uint32_t row = w[0] - 1, before = row * (d - 2) - row * (row - 1) / 2;
    return 12 + 30 * (d - 1) + f * ((d - 1) * (d - 2) / 2) + before + w[1] - 1;
}

/* A sphere of radius 1/2: each face of an icosahedron is divided into d^2 triangles, whose
 * points are projected onto the sphere. It has 12 + 30 (d - 1) + 20 (d - 1) (d - 2) / 2 = 10
 * d^2 + 2 vertices and 20 d^2 triangles. */
static enum cs_status make_sphere(struct cs_trimesh *mesh, uint32_t d, struct cs_arena *arena,
                                  struct cs_error *error) {
    const double g = (1 + sqrt(5)) / 2; /* the icosahedron's corners: (0, +-1, +-g), turned */
    const double corners[12][3] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                   {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                   {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    struct face faces[20] = {
        {{0, 11, 5}, {0}},  {{0, 5, 1}, {0}},  {{0, 1, 7}, {0}},  {{0, 7, 10}, {0}},
        {{0, 10, 11}, {0}}, {{1, 5, 9}, {0}},  {{5, 11, 4}, {0}}, {{11, 10, 2}, {0}},
        {{10, 7, 6}, {0}},  {{7, 1, 8}, {0}},  {{3, 9, 4}, {0}},  {{3, 4, 2}, {0}},
        {{3, 2, 6}, {0}},   {{3, 6, 8}, {0}},  {{3, 8, 9}, {0}},  {{4, 9, 5}, {0}},
        {{2, 4, 11}, {0}},  {{6, 2, 10}, {0}}, {{8, 6, 7}, {0}},  {{9, 8, 1}, {0}}};
    if (cs_trimesh_init(mesh, 10 * d * d + 2, 20 * d * d, false, arena, error))
        return error->status;
    number_sides(faces);
    uint32_t *out = mesh->triangles;
    for (uint32_t f = 0; f < 20; f++)
        for (uint32_t i = 0; i <= d; i++)
            for (uint32_t j = 0; i + j <= d; j++) {
                const uint32_t w[3] = {d - i - j, i, j};
                const uint32_t at = sphere_index(faces + f, f, w, d);
                double p[3] = {0}, squared = 0;
                for (int c = 0; c < 3; c++) {
                    for (int k = 0; k < 3; k++)
                        p[c] += w[k] * corners[faces[f].corner[k]][c];
                    squared += p[c] * p[c];
                }
                const double to_radius = 0.5 / sqrt(squared);
                set_position(mesh, at, p[0] * to_radius, p[1] * to_radius, p[2] * to_radius);
                if (w[0] == 0)
                    continue;
                const uint32_t right[3] = {w[0] - 1, i + 1, j}, up[3] = {w[0] - 1, i, j + 1};
                const uint32_t b = sphere_index(faces + f, f, right, d);
                const uint32_t c = sphere_index(faces + f, f, up, d);
                out = add_triangle(out, at, b, c);
                if (w[0] == 1)
                    continue;
                const uint32_t both[3] = {w[0] - 2, i + 1, j + 1};
                out = add_triangle(out, b, sphere_index(faces + f, f, both, d), c);
            }
    return CS_OK;
}

/* out: cosine and sine of k/m of a turn; the quadrant is found in whole numbers, so that points
 * a quarter turn apart have exactly turned coordinates */
static void cos_sin_turn(uint32_t k, uint32_t m, double out[2]) {
    const uint32_t quarter = 4 * k / m;
    const double r = (double)(4 * k % m) / m;
    const double c = cs_quarter_sine(1 - r), s = cs_quarter_sine(r);
    const double turned[4][2] = {{c, s}, {-s, c}, {-c, -s}, {s, -c}};
    memcpy(out, turned[quarter % 4], sizeof turned[0]);
}

/* A torus about the z axis: ring of radius 0.35, tube of radius 0.15 with d points. The ring
 * has 7 d / 3 points, the ratio of the radii, which makes the quads about square in the
 * middle. */
static enum cs_status make_torus(struct cs_trimesh *mesh, uint32_t d, struct cs_arena *arena,
                                 struct cs_error *error) {
    const uint32_t m = 7 * d / 3;
    if (cs_trimesh_init(mesh, m * d, 2 * m * d, false, arena, error))
        return error->status;
    uint32_t *out = mesh->triangles;
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = 0; j < d; j++) {
            double along[2], around[2];
            cos_sin_turn(i, m, along);
            cos_sin_turn(j, d, around);
            const double radius = 0.35 + 0.15 * around[0];
            set_position(mesh, i * d + j, radius * along[0], radius * along[1],
                         0.15 * around[1]);
            const uint32_t next = (i + 1) % m * d, above = (j + 1) % d;
            const uint32_t quad[4] = {i * d + j, next + j, next + above, i * d + above};
            out = add_quad(out, quad, (i + j) % 2);
        }
    return CS_OK;
}

enum cs_status cs_trimesh_make(struct cs_trimesh *mesh, enum cs_mesh_shape shape,
                               uint32_t detail, struct cs_arena *arena,
                               struct cs_error *error) {
    static enum cs_status (*const makers[CS_MESH_SHAPES])(
        struct cs_trimesh *, uint32_t, struct cs_arena *,
        struct cs_error *) = {make_box, make_sphere, make_torus, cs_trimesh_make_metaballs};
    return makers[shape](mesh, detail, arena, error);
}
