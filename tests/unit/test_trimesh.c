/* Generated shapes are closed, of the right kind, look outwards, and have the sizes that are
 * promised; what is made of their edges agrees with a search by brute force. */
#include "mesh/trimesh.h"
#include "unit.h"

#include <math.h>

static void make(struct cs_trimesh *mesh, enum cs_mesh_shape shape, uint32_t detail,
                 struct cs_arena *arena) {
    struct cs_error error = {0};
    *arena = (struct cs_arena){0};
    cs_trimesh_make(mesh, shape, detail, arena, &error);
    cs_trimesh_finish(mesh, "shape", NULL, arena, &error);
    UNIT_ASSERT_OK(&error);
}

/* by the divergence theorem: above 0 where normals look outwards */
static double volume_of(const struct cs_trimesh *mesh) {
    double volume = 0;
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        double normal[3];
        cs_trimesh_normal(mesh, t, mesh->positions, mesh->n, 0, normal);
        for (size_t c = 0; c < 3; c++)
            volume +=
                normal[c] * mesh->positions[c * mesh->n + mesh->triangles[3 * (size_t)t]] / 6;
    }
    return volume;
}

static double area_of(const struct cs_trimesh *mesh) {
    double area = 0;
    for (uint32_t i = 0; i < mesh->n; i++)
        area += mesh->area[i];
    return area;
}

TEST(shapes_are_closed_and_look_outwards) {
    static const double pi = 3.14159265358979323846;
    const struct {
        uint32_t least, euler;
        double volume, area; /* of the smooth shape; 0: unknown */
    } shapes[CS_MESH_SHAPES] = {
        [CS_MESH_BOX] = {3, 2, 1, 6},
        [CS_MESH_SPHERE] = {3, 2, pi / 6, pi},
        [CS_MESH_TORUS] = {3, 0, 2 * pi * pi * 0.35 * 0.15 * 0.15, 4 * pi * pi * 0.35 * 0.15},
        [CS_MESH_LIMBS] = {8, 2, 0, 0}};
    for (uint32_t s = 0; s < CS_MESH_SHAPES; s++)
        for (uint32_t detail = shapes[s].least; detail <= 40; detail++) {
            struct cs_trimesh mesh;
            struct cs_arena arena;
            make(&mesh, (enum cs_mesh_shape)s, detail, &arena);
            ck_assert_uint_eq(mesh.n_open, 0);
            ck_assert_uint_eq(mesh.n + mesh.n_triangles - mesh.n_edges, shapes[s].euler);
            const double volume = volume_of(&mesh);
            ck_assert_double_gt(volume, 0.03);
            /* chords lie inside: short by at most the square of the angle of an edge */
            if (shapes[s].volume > 0 && s != CS_MESH_BOX) {
                const double off = 14.0 / (detail * detail);
                ck_assert_double_le(volume, shapes[s].volume);
                ck_assert_double_ge(volume, shapes[s].volume * (1 - off));
                ck_assert_double_ge(area_of(&mesh), shapes[s].area * (1 - off));
            }
            if (s == CS_MESH_BOX) {
                ck_assert_double_eq_tol(volume, 1, 1e-12);
                ck_assert_double_eq_tol(area_of(&mesh), 6, 1e-11);
            }
            cs_arena_finish(&arena);
        }
}

/* the sizes that the scenes of the soft-body thesis want */
TEST(vertices_are_as_many_as_promised) {
    static const struct {
        enum cs_mesh_shape shape;
        uint32_t detail, n;
    } promised[] = {{CS_MESH_BOX, 16, 1538},   {CS_MESH_SPHERE, 25, 6252},
                    {CS_MESH_SPHERE, 3, 92},   {CS_MESH_TORUS, 26, 1560},
                    {CS_MESH_LIMBS, 31, 1586}, {CS_MESH_LIMBS, 61, 6186}};
    for (size_t k = 0; k < sizeof promised / sizeof *promised; k++) {
        struct cs_trimesh mesh;
        struct cs_arena arena;
        make(&mesh, promised[k].shape, promised[k].detail, &arena);
        ck_assert_uint_eq(mesh.n, promised[k].n);
        cs_arena_finish(&arena);
    }
}

TEST(spheres_and_tori_lie_on_their_surface) {
    struct cs_trimesh mesh;
    struct cs_arena arena;
    make(&mesh, CS_MESH_SPHERE, 9, &arena);
    for (uint32_t i = 0; i < mesh.n; i++) {
        const double x = mesh.positions[i], y = mesh.positions[mesh.n + i];
        const double z = mesh.positions[2 * mesh.n + i];
        ck_assert_double_eq_tol(sqrt(x * x + y * y + z * z), 0.5, 1e-15);
    }
    cs_arena_finish(&arena);
    make(&mesh, CS_MESH_TORUS, 11, &arena);
    for (uint32_t i = 0; i < mesh.n; i++) {
        const double x = mesh.positions[i], y = mesh.positions[mesh.n + i];
        const double z = mesh.positions[2 * mesh.n + i];
        ck_assert_double_eq_tol(hypot(hypot(x, y) - 0.35, z), 0.15, 1e-15);
    }
    cs_arena_finish(&arena);
}

/* limbs are the same on both sides: the mirror image of each vertex is one */
TEST(limbs_are_symmetric) {
    struct cs_trimesh mesh;
    struct cs_arena arena;
    make(&mesh, CS_MESH_LIMBS, 20, &arena);
    for (uint32_t i = 0; i < mesh.n; i++) {
        double nearest = 1;
        for (uint32_t j = 0; j < mesh.n; j++)
            nearest =
                fmin(nearest,
                     fabs(mesh.positions[i] + mesh.positions[j]) +
                         fabs(mesh.positions[mesh.n + i] - mesh.positions[mesh.n + j]) +
                         fabs(mesh.positions[2 * mesh.n + i] - mesh.positions[2 * mesh.n + j]));
        ck_assert_double_le(nearest, 1e-12);
    }
    cs_arena_finish(&arena);
}

static bool has_corner(const struct cs_trimesh *mesh, uint32_t t, uint32_t i) {
    const uint32_t *corner = mesh->triangles + 3 * (size_t)t;
    return corner[0] == i || corner[1] == i || corner[2] == i;
}

/* Edges, hinges and neighbourhoods against a search over all pairs. */
TEST(edges_agree_with_brute_force) {
    for (uint32_t s = 0; s < CS_MESH_SHAPES; s++) {
        struct cs_trimesh mesh;
        struct cs_arena arena;
        uint32_t e = 0, h = 0;
        make(&mesh, (enum cs_mesh_shape)s, s == CS_MESH_LIMBS ? 10 : 4, &arena);
        for (uint32_t a = 0; a < mesh.n; a++)
            for (uint32_t b = a + 1; b < mesh.n; b++) {
                bool edge = false, hinge = false;
                for (uint32_t t = 0; t < mesh.n_triangles; t++) {
                    edge = edge || (has_corner(&mesh, t, a) && has_corner(&mesh, t, b));
                    for (uint32_t u = 0; u < mesh.n_triangles && has_corner(&mesh, t, a); u++) {
                        int shared = 0;
                        for (int k = 0; k < 3; k++)
                            shared += has_corner(&mesh, t, mesh.triangles[3 * (size_t)u + k]);
                        hinge = hinge || (shared == 2 && !has_corner(&mesh, t, b) &&
                                          has_corner(&mesh, u, b) && !has_corner(&mesh, u, a));
                    }
                }
                if (edge) {
                    ck_assert_uint_eq(mesh.edges[2 * e], a);
                    ck_assert_uint_eq(mesh.edges[2 * e++ + 1], b);
                } else if (hinge) {
                    ck_assert_uint_eq(mesh.hinges[2 * h], a);
                    ck_assert_uint_eq(mesh.hinges[2 * h++ + 1], b);
                }
            }
        ck_assert_uint_eq(e, mesh.n_edges);
        ck_assert_uint_eq(h, mesh.n_hinges);
        for (uint32_t i = 0; i < mesh.n; i++)
            for (uint32_t k = cs_trimesh_around_begin(&mesh, i);
                 k < mesh.vertex_triangles_end[i]; k++)
                ck_assert(has_corner(&mesh, mesh.vertex_triangles[k], i));
        ck_assert_uint_eq(mesh.vertex_triangles_end[mesh.n - 1], 3 * mesh.n_triangles);
        cs_arena_finish(&arena);
    }
}
