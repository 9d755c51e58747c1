/* Makes a unit sphere by subdividing an icosahedron, without sines. */
#include "draw/ball.h"

#include "draw/matrix.h"

enum { CUTS = 4, N_TRIANGLES = 20 << (2 * CUTS) };

// a is 1 and b the golden ratio before they are made unit vectors
static const signed char corners[12][3] = {{-1, 2, 0}, {1, 2, 0}, {-1, -2, 0}, {1, -2, 0},
                                           {0, -1, 2}, {0, 1, 2}, {0, -1, -2}, {0, 1, -2},
                                           {2, 0, -1}, {2, 0, 1}, {-2, 0, -1}, {-2, 0, 1}};
static const unsigned char faces[20][3] = {
    {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};

static void set_vertex(struct cs_vertex *vertex, const double p[3]) {
    for (int i = 0; i < 3; i++)
        vertex->place[i] = vertex->normal[i] = (float)p[i];
    vertex->value = 0;
}

// cuts the triangle p until `cuts` is 0; corners are not shared, the same ones come out equal
static struct cs_vertex *cut(double p[3][3], int cuts, struct cs_vertex *out) {
    if (cuts == 0) {
        for (int i = 0; i < 3; i++)
            set_vertex(out++, p[i]);
        return out;
    }
    double middle[3][3];
    for (int i = 0; i < 3; i++) {
        for (int axis = 0; axis < 3; axis++)
            middle[i][axis] = p[i][axis] + p[(i + 1) % 3][axis];
        /* the middle of an edge lies inside the sphere: pushed out onto it */
        cs_normalise(middle[i]);
    }
    for (int i = 0; i < 3; i++) {
        /* corners in the order of the parent's, so that every triangle faces outwards */
        double part[3][3];
        memcpy(part[0], p[i], sizeof part[0]);
        memcpy(part[1], middle[i], sizeof part[1]);
        memcpy(part[2], middle[(i + 2) % 3], sizeof part[2]);
        out = cut(part, cuts - 1, out);
    }
    return cut(middle, cuts - 1, out);
}

enum cs_status cs_ball_make(struct cs_vertex **vertices, uint32_t *n, struct cs_arena *arena,
                            struct cs_error *error) {
    const double golden = (1 + sqrt(5)) / 2;
    struct cs_vertex *out = cs_arena_take_n(arena, 3 * N_TRIANGLES, sizeof *out, error);
    *vertices = out;
    *n = 3 * N_TRIANGLES;
    for (int face = 0; out && face < 20; face++) {
        double p[3][3];
        for (int i = 0; i < 3; i++) {
            for (int axis = 0; axis < 3; axis++) {
                const int c = corners[faces[face][i]][axis];
                p[i][axis] = c == 2 ? golden : c == -2 ? -golden : c;
            }
            cs_normalise(p[i]);
        }
        out = cut(p, CUTS, out);
    }
    return error->status;
}
