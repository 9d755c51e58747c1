/* OBJ files are read whole; bad ones are refused with the line. */
#include "mesh_text.h"
#include "scene/mesh_keys.h"

#include <math.h>

TEST(tetrahedron_is_whole) {
    static const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    const struct cs_mesh_source scaled = {.scale = {2, 3, 4}};
    struct cs_trimesh mesh;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    /* from the front, from the back, with normals that are passed over, without a last newline
     */
    read_obj(TETRAHEDRON "vn 0 0 1\nf 1 3 2\nf -4 -3 -1\nf 2//1 3//1 4//9\nf 1 4 3", &scaled,
             &mesh, &arena, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(mesh.n, 4);
    ck_assert_uint_eq(mesh.n_triangles, 4);
    ck_assert_uint_eq(mesh.n_edges, 6);
    ck_assert_uint_eq(mesh.n_open, 0);
    ck_assert_uint_eq(mesh.n_hinges, 0); /* every pair has an edge */
    ck_assert_ptr_null(mesh.uv);
    ck_assert_mem_eq(mesh.triangles, triangles, sizeof triangles);
    ck_assert_double_eq(mesh.positions[1], 2);
    ck_assert_double_eq(mesh.positions[4 + 2], 3);
    ck_assert_double_eq(mesh.positions[8 + 3], 4);
    ck_assert_double_eq_tol(mesh.area[0], (3 + 4 + 6) / 3.0, 1e-15);
    cs_arena_finish(&arena);
}

TEST(polygons_become_fans_with_texture) {
    static const uint32_t triangles[9] = {0, 1, 2, 0, 2, 3, 0, 3, 4};
    struct cs_trimesh mesh;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    read_obj("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 2 0\nv -1 1 0\n"
             "vt 0 0\nvt 0.5 0.25 0\nvt 1\nf 1/1 2/2 3/3/7 4/-1 5/-3\n",
             &plain, &mesh, &arena, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(mesh.n_triangles, 3);
    ck_assert_mem_eq(mesh.triangles, triangles, sizeof triangles);
    ck_assert_uint_eq(mesh.n_edges, 7);
    ck_assert_uint_eq(mesh.n_open, 5);
    ck_assert_uint_eq(mesh.n_hinges, 2);
    ck_assert_ptr_nonnull(mesh.uv);
    /* rows from the top */
    ck_assert_double_eq((double)mesh.uv[0], 0);
    ck_assert_double_eq((double)mesh.uv[1], 1);
    ck_assert_double_eq((double)mesh.uv[2], 0.5);
    ck_assert_double_eq((double)mesh.uv[3], 0.75);
    ck_assert_double_eq((double)mesh.uv[4], 1);
    ck_assert_double_eq((double)mesh.uv[12 + 4],
                        0); /* the last corner: -3 is the first of three */
    cs_arena_finish(&arena);
}

TEST(bad_meshes_are_refused) {
    static const struct {
        const char *text, *message;
    } bad[] = {
        {"", "m.obj: found no faces"},
        {TETRAHEDRON, "m.obj: found no faces"},
        {"v 1 2\n", "m.obj:1: a vertex has 2 numbers, expected 3"},
        {"v 1 2\nv 1 x 2\nf 1 2\nf 1 2 9\nv 1\n",
         "m.obj:1: a vertex has 2 numbers, expected 3; m.obj:2: found \"x\", expected a number "
         "(-1e9..1e9); m.obj:3: a face has 2 corners, expected 3 or more; m.obj:5: a vertex "
         "has 1 "
         "numbers, expected 3; and 1 more"},
        {"\nv 1 2 x\n", "m.obj:2: found \"x\", expected a number"},
        {"v 1 2 1e10\n", "m.obj:1: found \"1e10\", expected a number (-1e9..1e9)"},
        {"v 1 2 nan\n", "m.obj:1: found \"nan\""},
        {"v 1 2 0x1\n", "m.obj:1: found \"0x1\""},
        {"v 1 2 10000000000000000000000000000000000000000000000000000000000000e-61\n",
         "expected a number"},
        {"vt\n", "m.obj:1: a texture coordinate has 0 numbers, expected 1"},
        {TETRAHEDRON "f 1 2\n", "m.obj:10: a face has 2 corners, expected 3 or more"},
        {TETRAHEDRON "f 1 2 5\n", "m.obj:10: vertex 5 does not exist (1..4)"},
        {TETRAHEDRON "f 1 2 -5\n", "m.obj:10: vertex -5 does not exist (1..4)"},
        {TETRAHEDRON "f 1 2 99999999999999999999\n", "does not exist (1..4)"},
        {TETRAHEDRON "f 1 2 0\n", "m.obj:10: found \"0\", expected the number of a vertex"},
        {TETRAHEDRON "f 1 2 3x\n", "found \"3x\", expected the number of a vertex"},
        {TETRAHEDRON "f 1/1 2/1 3/1\n", "m.obj:10: texture coordinate 1 does not exist (1..0)"},
        {TETRAHEDRON "f 1/x 2/1 3/1\n", "expected the number of a texture coordinate"},
        {TETRAHEDRON "f 1 2 2\n", "m.obj: found no faces: 1 face without area (line 10) "
                                  "removed, 2 vertices in no face removed"},
        {"v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n",
         "m.obj: found no faces: 1 face without area (line 4) removed"},
        {TETRAHEDRON "v 3 1 2\nf 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n",
         "the two triangles at the edge of vertices 1 and 2 have opposite"},
        {"curv 1 2\nsurf 1\ncurv 1\n",
         "m.obj: found no faces: 3 lines of other programs passed over (curv, surf)"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        struct cs_trimesh mesh;
        struct cs_arena arena = {0};
        struct cs_error error = {0};
        read_obj(bad[k].text, &plain, &mesh, &arena, &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, bad[k].message);
        cs_arena_finish(&arena);
    }
}

/* Cut anywhere, the text is read or refused, and never read beyond its end. */
TEST(truncated_text_is_refused_or_read) {
    static const char whole[] = TETRAHEDRON "vt 0 0\nf 1/1 3/1 2/1\nf 1/1 2/1 4/1\n";
    uint32_t refused = 0;
    for (size_t length = 0; length < sizeof whole; length++) {
        char *copy = malloc(length ? length : 1);
        struct cs_trimesh mesh = {0};
        struct cs_arena arena = {0};
        struct cs_error error = {0};
        memcpy(copy, whole, length);
        refused +=
            cs_mesh_read_text("m.obj", copy, length, &plain, &mesh, &arena, &error) != CS_OK;
        ck_assert(error.status == CS_OK || error.status == CS_ERR_FILE);
        free(copy);
        cs_arena_finish(&arena);
    }
    ck_assert_uint_ge(refused, sizeof whole - 10);
}

TEST(zero_bytes_and_missing_files_are_refused) {
    struct cs_trimesh mesh = {0};
    struct cs_arena arena = {0};
    struct cs_error error = {0}, missing = {0};
    cs_mesh_read_text("m.obj", "v 1\0 2 3\n", 9, &plain, &mesh, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "m.obj: found a zero byte, expected text");
    cs_mesh_read("none.obj", "none.obj", &plain, &mesh, &arena, &missing);
    UNIT_ASSERT_FAILED(&missing, CS_ERR_FILE, "none.obj");
    cs_arena_finish(&arena);
}

/* Each spelling of the square is the same mesh. */
TEST(spellings_of_exporters_are_read) {
    static const char *const spellings[] = {
        SQUARE FACES,
        "v 0 0 0 1 0 0\nv 2 0 0 0 1 0\nv 2 1 0 .5 .5 .5\nv 0 1 0 1 1 1\n" FACES,
        "v 0 0 0 1\nv 2 0 0 1\nv 2 1 0 1\nv 0 1 0 1\n" FACES,
        "\xef\xbb\xbf" SQUARE FACES,
        SQUARE FACES "l 1 2 3\np 1\nmg off\nvp 1\ns 1\nvn 0 0 1\nmtllib a b.mtl\n",
        SQUARE "f 1 2 \\\n3 4\n",
        SQUARE "f 1 2 \\\r\n3 4",
        "v 0 0 0\rv 2 0 0\rv 2 1 0\rv 0 1 0\rf 1 2 3\rf 1 3 4\r",
        SQUARE "vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1 3 4\n",
        SQUARE "f 1/ 2/ 3/\nf 1// 3/ 4/\n",
        FACES SQUARE,
    };
    struct cs_trimesh first, mesh;
    struct cs_arena of_first, arena;
    read_sound(spellings[0], &plain, &first, &of_first);
    for (size_t k = 0; k < sizeof spellings / sizeof *spellings; k++) {
        read_sound(spellings[k], &plain, &mesh, &arena);
        ck_assert_uint_eq(mesh.n, 4);
        ck_assert_uint_eq(mesh.n_triangles, 2);
        ck_assert_mem_eq(mesh.positions, first.positions, 12 * sizeof *mesh.positions);
        ck_assert_mem_eq(mesh.triangles, first.triangles, 6 * sizeof *mesh.triangles);
        ck_assert_str_eq(mesh.mends, "");
        ck_assert_uint_eq(mesh.pieces, 1);
        cs_arena_finish(&arena);
    }
    read_sound(SQUARE "ny 0 0 0\nvl 1\nny 1\n\x80\x01 2\n" FACES, &plain, &mesh, &arena);
    ck_assert_str_eq(mesh.mends, "4 lines of other programs passed over (ny, vl)");
    cs_arena_finish(&arena);
    cs_arena_finish(&of_first);
}

/* The areas are those of the shoelace formula, from whichever corner the polygon begins. */
TEST(concave_polygons_are_cut_into_their_area) {
    static const struct {
        double area;
        int n;
        double x[8][2];
    } polygons[] = {
        {3, 6, {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}},
        {0.5, 4, {{0, 0}, {1, 2}, {0, 0.5}, {-1, 2}}},
        {5, 5, {{0, 0}, {2, 0}, {3, 1}, {1, 2}, {-1, 1}}},
        {2, 5, {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {0, 1}}},
        {5, 8, {{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}},
    };
    for (size_t k = 0; k < sizeof polygons / sizeof *polygons; k++)
        for (int turn = 0; turn < polygons[k].n; turn++) {
            const int n = polygons[k].n;
            struct cs_text text = {0};
            struct cs_trimesh mesh;
            struct cs_arena arena;
            /* in a plane askew, of which the area is sqrt(3) times that of its shadow */
            for (int i = 0; i < n; i++)
                cs_text_add(&text, "v %g %g %g\n", polygons[k].x[i][0], polygons[k].x[i][1],
                            polygons[k].x[i][0] - polygons[k].x[i][1]);
            cs_text_add(&text, "f");
            for (int i = 0; i < n; i++)
                cs_text_add(&text, " %d", (i + turn) % n + 1);
            read_sound(cs_text_get(&text), &plain, &mesh, &arena);
            ck_assert_double_eq_tol(area_of(&mesh), sqrt(3) * polygons[k].area, 1e-12);
            ck_assert_uint_eq(mesh.n_triangles, n - 2);
            ck_assert_str_eq(mesh.mends, "");
            cs_text_finish(&text);
            cs_arena_finish(&arena);
        }
}

/* A square with a square hole, which a bridge joins to the outside; and a quad at a pole, two
 * of whose corners lie in one place. */
TEST(corners_in_one_place_cross_nothing) {
    struct cs_trimesh mesh;
    struct cs_arena arena;
    read_sound("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0.5 0.5 0\nv 0.5 1.5 0\nv 1.5 1.5 0\n"
               "v 1.5 0.5 0\nf 1 2 3 4 1 5 6 7 8 5\n",
               &plain, &mesh, &arena);
    ck_assert_double_eq_tol(area_of(&mesh), 3, 1e-12);
    ck_assert_uint_eq(mesh.n_open, 8);
    ck_assert_str_eq(mesh.mends, "");
    cs_arena_finish(&arena);
    read_sound("v 0 0 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4\n", &plain, &mesh, &arena);
    ck_assert_double_eq_tol(area_of(&mesh), 1, 1e-12);
    ck_assert_str_eq(mesh.mends, "1 face without area (line 5) removed");
    cs_arena_finish(&arena);
}

TEST(polygons_that_cross_themselves_are_told) {
    struct cs_trimesh mesh;
    struct cs_arena arena;
    read_sound("v 0 0 0\nv 3 0 0\nv 1 -1 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 4 5\n", &plain,
               &mesh, &arena);
    ck_assert_ptr_nonnull(strstr(
        mesh.mends, "1 polygon that crosses itself or has over 1024 corners (line 6) cut as"));
    cs_arena_finish(&arena);
}
