/* Meshes of files are mended to a surface: welded, turned, cut, without what has no area. */
#include "mesh_text.h"
#include "scene/mesh_keys.h"

#include <math.h>

/* A sheet of 2 x 1 squares whose middle column is written twice, once a rounding away. */
#define HALVES                                                                                 \
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1.0000001 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\n"         \
    "f 1 2 3 4\nf 5 6 7 8\n"
TEST(doubled_vertices_are_welded) {
    const struct cs_mesh_source apart = {.scale = {1, 1, 1}};
    struct cs_trimesh mesh;
    struct cs_arena arena;
    read_sound(HALVES, &plain, &mesh, &arena);
    ck_assert_uint_eq(mesh.n, 6);
    ck_assert_uint_eq(mesh.pieces, 1);
    ck_assert_uint_eq(mesh.n_edges, 9);
    ck_assert_uint_eq(mesh.n_file, 8);
    ck_assert_uint_eq(mesh.file_vertex[4], 5);
    ck_assert_str_eq(mesh.mends, "2 doubled vertices welded");
    cs_arena_finish(&arena);
    read_sound(HALVES, &apart, &mesh, &arena);
    ck_assert_uint_eq(mesh.n, 8);
    ck_assert_uint_eq(mesh.pieces, 2);
    ck_assert_str_eq(mesh.mends, "");
    cs_arena_finish(&arena);
}

/* A cube as renderers write it, with vertices of its own on each face, is closed. */
TEST(faces_with_vertices_of_their_own_are_one_surface) {
    static const int axes[6][2] = {{1, 2}, {2, 1}, {2, 0}, {0, 2}, {0, 1}, {1, 0}};
    static const int corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    struct cs_text text = {0};
    struct cs_trimesh mesh;
    struct cs_arena arena;
    for (int face = 0; face < 6; face++) {
        for (int k = 0; k < 4; k++) {
            int p[3] = {0, 0, 0};
            p[axes[face][0]] = corners[k][0];
            p[axes[face][1]] = corners[k][1];
            p[3 - axes[face][0] - axes[face][1]] = face % 2 == 0;
            cs_text_add(&text, "v %d %d %d\n", p[0], p[1], p[2]);
        }
        cs_text_add(&text, "f -4 -3 -2 -1\n");
    }
    read_sound(cs_text_get(&text), &plain, &mesh, &arena);
    ck_assert_uint_eq(mesh.n, 8);
    ck_assert_uint_eq(mesh.n_open, 0);
    ck_assert_double_eq_tol(area_of(&mesh), 6, 1e-12);
    ck_assert_str_eq(mesh.mends, "16 doubled vertices welded");
    cs_text_finish(&text);
    cs_arena_finish(&arena);
}

/* A closed tetrahedron with a vertex on an edge of one face, closed by a face without area, and
 * one with a face of two equal places: both stay closed. */
TEST(faces_without_area_leave_no_gap) {
    struct cs_trimesh mesh;
    struct cs_arena arena;
    read_sound(TETRAHEDRON "v 0.5 0 0\nf 1 3 2\nf 1 5 4\nf 5 2 4\nf 1 2 5\nf 2 3 4\nf 1 4 3\n",
               &plain, &mesh, &arena);
    ck_assert_uint_eq(mesh.n, 5);
    ck_assert_uint_eq(mesh.n_open, 0);
    ck_assert_double_eq_tol(area_of(&mesh), 1.5 + sqrt(3) / 2, 1e-12);
    ck_assert_str_eq(mesh.mends, "1 face without area (line 14) removed");
    cs_arena_finish(&arena);
    read_sound(TETRAHEDRON "v 0 0 0\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 5 4 3\nf 1 4 5\nf 1 5 3\n",
               &plain, &mesh, &arena);
    ck_assert_uint_eq(mesh.n, 4);
    ck_assert_uint_eq(mesh.n_open, 0);
    ck_assert_str_eq(mesh.mends, "2 faces without area (the first in line 15) removed");
    cs_arena_finish(&arena);
}

/* Every face but one of two tetrahedra, and the wrong one of them is turned. */
TEST(faces_against_their_neighbours_are_turned) {
    struct cs_trimesh mesh, right;
    struct cs_arena arena, of_right;
    read_sound(TETRAHEDRON "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", &plain, &right, &of_right);
    read_sound(TETRAHEDRON "f 1 3 2\nf 1 2 4\nf 4 3 2\nf 1 4 3\n", &plain, &mesh, &arena);
    ck_assert_uint_eq(mesh.n_open, 0);
    ck_assert_str_eq(mesh.mends, "1 face against its neighbours (line 12) turned");
    for (int k = 0; k < 3; k++)
        ck_assert_uint_eq(mesh.triangles[6 + k], right.triangles[6 + (k + 2) % 3]);
    cs_arena_finish(&arena);
    cs_arena_finish(&of_right);
}

TEST(repeated_faces_and_loose_vertices_are_removed) {
    struct cs_trimesh mesh;
    struct cs_arena arena;
    read_sound("v 9 9 9\n" SQUARE "f 2 3 4\nf 2 4 5\nf 4 2 3\nf 4 3 2\n", &plain, &mesh,
               &arena);
    ck_assert_uint_eq(mesh.n, 4);
    ck_assert_uint_eq(mesh.n_triangles, 2);
    ck_assert_uint_eq(mesh.file_vertex[0], 1);
    ck_assert_str_eq(mesh.mends, "2 faces given twice (the first in line 8) removed, 1 vertex "
                                 "in no face removed");
    cs_arena_finish(&arena);
}

/* Of a closed surface whose two sides are both there one stays; two tetrahedra keep the wall
 * between them, of a face each. */
TEST(walls_between_solids_stay_and_other_sides_of_sheets_do_not) {
    struct cs_trimesh mesh;
    struct cs_arena arena;
    read_sound(TETRAHEDRON
               "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n",
               &plain, &mesh, &arena);
    ck_assert_uint_eq(mesh.n_triangles, 4);
    ck_assert_uint_eq(mesh.n_open, 0);
    cs_arena_finish(&arena);
    read_sound(TETRAHEDRON "v 0 0 -1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
                           "f 1 2 3\nf 1 5 2\nf 2 5 3\nf 1 3 5\n",
               &plain, &mesh, &arena);
    ck_assert_uint_eq(mesh.n, 8);
    ck_assert_uint_eq(mesh.pieces, 2);
    ck_assert_uint_eq(mesh.n_open, 0);
    ck_assert_str_eq(mesh.mends,
                     "3 edges of three triangles or more (the first in line 15) cut");
    cs_arena_finish(&arena);
}

/* Three pages of a book; and two cubes that share an edge, which become two closed pieces. */
TEST(edges_of_three_triangles_are_cut) {
    struct cs_trimesh mesh;
    struct cs_arena arena;
    read_sound(TETRAHEDRON "v 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n", &plain, &mesh, &arena);
    ck_assert_uint_eq(mesh.n, 7);
    ck_assert_uint_eq(mesh.n_triangles, 3);
    ck_assert_uint_eq(mesh.pieces, 2);
    ck_assert_str_eq(mesh.mends, "1 edge of three triangles or more (line 13) cut");
    cs_arena_finish(&arena);
    read_sound("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nv 0 0 -1\n"
               "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nf 1 5 2\nf 1 2 6\nf 2 5 6\nf 1 6 5\n",
               &plain, &mesh, &arena);
    ck_assert_uint_eq(mesh.n, 8);
    ck_assert_uint_eq(mesh.pieces, 2);
    ck_assert_uint_eq(mesh.n_open, 0);
    cs_arena_finish(&arena);
}

/* Of a file in centimetres with z up, one material alone. */
TEST(a_set_is_read_in_its_unit_with_its_axis) {
    const struct cs_mesh_source source = {.scale = {1, 1, 2},
                                          .units = CS_MESH_CM,
                                          .up = CS_MESH_UP_Z,
                                          .weld = true,
                                          .set = "fine silk"};
    struct cs_mesh_source none = source;
    struct cs_trimesh mesh;
    struct cs_arena arena;
    struct cs_error error = {0};
    read_sound("v 100 0 0\nv 0 100 0\nv 0 0 100\nv 300 300 300\ng a waist\nusemtl fine silk\n"
               "f 1 2 3\ng b\nusemtl wool\nf 1 2 4\n",
               &source, &mesh, &arena);
    static const double expected[9] = {1, 0, 0, 0, 0, 2, 0, -1, 0};
    ck_assert_uint_eq(mesh.n, 3);
    for (int k = 0; k < 9; k++)
        ck_assert_double_eq_tol(mesh.positions[k], expected[k], 1e-15);
    ck_assert_str_eq(mesh.mends, "");
    ck_assert(cs_mesh_has_label(mesh.labels, mesh.triangle_labels[0], "waist"));
    ck_assert(cs_mesh_has_label(mesh.labels, mesh.triangle_labels[0], "a"));
    ck_assert(!cs_mesh_has_label(mesh.labels, mesh.triangle_labels[0], "silk"));
    ck_assert(!cs_mesh_has_label(mesh.labels, mesh.triangle_labels[0], ""));
    cs_arena_finish(&arena);
    memcpy(none.set, "linen", sizeof "linen");
    read_obj(SQUARE FACES, &none, &mesh, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "found no group, object or material \"linen\"");
    cs_arena_finish(&arena);
}

/* A weld that leaves an edge of three triangles and a face without area, and a cut round which
 * an edge stays whole: found among random files. */
TEST(faults_that_mending_leaves_are_mended) {
    static const char *const texts[] = {
        "v 0.5 1 1\n"
        "v 2 1.0000001 1.0000001\n"
        "v -1 1.0000001 0.5\n"
        "v 0 1.0000001 1\n"
        "v 0 1.0000001 1.0000001\n"
        "f 3 4 2\n"
        "f 4 5 4 4\n"
        "o x\n"
        "f 5 1 2 1\n"
        "f 2 5 3 2\n",
        "v -1 2 -1\n"
        "v 0 1 2\n"
        "v 0 -1 1.0000001\n"
        "v 1.0000001 -1 0\n"
        "v 0 1 -1\n"
        "v 1 1.0000001 0.5\n"
        "v 0 1.0000001 2\n"
        "v 0.5 -1 2\n"
        "f 4 7 8\n"
        "f 4 8 2\n"
        "f 1 7 8\n"
        "f 7 1 6\n",
    };
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        struct cs_trimesh mesh;
        struct cs_arena arena;
        read_sound(texts[k], &plain, &mesh, &arena);
        ck_assert_uint_ge(mesh.n_triangles, 2);
        cs_arena_finish(&arena);
    }
}
