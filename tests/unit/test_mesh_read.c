/* OBJ files are read whole; bad ones are refused with the line. */
#include "scene/file/mesh_read.h"
#include "unit.h"

static const double plain[3] = {1, 1, 1};

static enum cs_status read_obj(const char *text, const double scale[3], struct cs_trimesh *mesh,
                               struct cs_arena *arena, struct cs_error *error) {
    *mesh = (struct cs_trimesh){0};
    return cs_mesh_read_text("m.obj", text, strlen(text), scale, mesh, arena, error);
}

#define TETRAHEDRON                                                                            \
    "# four corners\r\no thing\ns off\nmtllib x y\n\n"                                         \
    "v 0 0 0\nv\t1 0 0 # behind\nv 0 1 0\r\nv 0 0 1e0\n"

TEST(tetrahedron_is_whole) {
    static const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    const double scale[3] = {2, 3, 4};
    struct cs_trimesh mesh;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    /* from the front, from the back, with normals that are passed over, without a last newline
     */
    read_obj(TETRAHEDRON "vn 0 0 1\nf 1 3 2\nf -4 -3 -1\nf 2//1 3//1 4//9\nf 1 4 3", scale,
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
             plain, &mesh, &arena, &error);
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
        {"v 1 2 3 4\n", "m.obj:1: a vertex has more than 3 numbers"},
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
        {TETRAHEDRON "vt 0 0\nf 1/ 2/1 3/1\n", "expected the number of a texture coordinate"},
        {TETRAHEDRON "vt 0 0\nf 1/1 2/1 3\n", "m.obj:11: a corner has no texture coordinate"},
        {TETRAHEDRON "vt 0 0\nf 1 2 3\nf 1 2 4/1\n", "m.obj:12: a corner has a texture"},
        {TETRAHEDRON "f 1 2 2\n", "m.obj:10: the triangle of vertices 1, 2 and 2 has no area"},
        {"v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n",
         "m.obj:4: the triangle of vertices 1, 2 and 3"},
        {TETRAHEDRON "f 1 2 3\n", "m.obj: vertex 4 is in no face"},
        {TETRAHEDRON "v 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n",
         "m.obj:13: the edge of vertices 1 and 2 has 3 triangles, expected 1 or 2"},
        {TETRAHEDRON "f 1 2 3\nf 1 2 4\n",
         "m.obj:11: the two triangles at the edge of vertices 1 and 2 have opposite"},
        {"curv 1 2\n", "m.obj:1: found \"curv\", expected v, vt, vn, f, o, g, s, usemtl or mt"},
        {"v 1 2 3\nf 1 2 \\\n3\n", "m.obj:2: found \"\\\", expected the number of a vertex"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        struct cs_trimesh mesh;
        struct cs_arena arena = {0};
        struct cs_error error = {0};
        read_obj(bad[k].text, plain, &mesh, &arena, &error);
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
            cs_mesh_read_text("m.obj", copy, length, plain, &mesh, &arena, &error) != CS_OK;
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
    cs_mesh_read_text("m.obj", "v 1\0 2 3\n", 9, plain, &mesh, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "m.obj: found a zero byte, expected text");
    cs_mesh_read("none.obj", "none.obj", plain, &mesh, &arena, &missing);
    UNIT_ASSERT_FAILED(&missing, CS_ERR_FILE, "none.obj");
    cs_arena_finish(&arena);
}
