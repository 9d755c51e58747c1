/* Key frames are read whole from each format; bad files are refused with their name. */
#include "mesh/vertex_paths.h"
#include "scene/file/key_frames_read.h"

#include "base/serialise.h"
#include "scene/collider_keys.h"
#include "scene/mesh_keys.h"
#include "unit.h"

#include <zlib.h>

enum { N = 3, KEYS = 2, NUMBERS = KEYS * N * 3, BYTES_MAX = 4096 };

/* coordinate c of vertex i in key frame k */
static double number(int k, int i, int c) {
    return 0.25 * (k + 1) - i + 8 * c;
}

/* A file in memory. */
struct bytes {
    unsigned char at[BYTES_MAX];
    size_t n;
};

static void put(struct bytes *out, const void *bytes, size_t n) {
    memcpy(out->at + out->n, bytes, n);
    out->n += n;
}

static void put_32(struct bytes *out, uint32_t value) {
    value = htole32(value);
    put(out, &value, sizeof value);
}

static void put_16(struct bytes *out, uint32_t value) {
    put(out, (unsigned char[2]){value & 255, value >> 8 & 255}, 2);
}

/* All numbers as floats or doubles. */
static void put_numbers(struct bytes *out, bool single) {
    for (int k = 0; k < NUMBERS; k++) {
        const double value = number(k / (3 * N), k / 3 % N, k % 3);
        const uint64_t word = cs_double_to_le64(value);
        if (single)
            put(out, &(uint32_t){cs_float_to_le32((float)value)}, 4);
        else
            put(out, &word, sizeof word);
    }
}

static struct bytes make_pc2(void) {
    struct bytes out = {0};
    put(&out, "POINTCACHE2", 12);
    put_32(&out, 1);
    put_32(&out, N);
    put_32(&out, cs_float_to_le32(3));
    put_32(&out, cs_float_to_le32(1));
    put_32(&out, KEYS);
    put_numbers(&out, true);
    return out;
}

/* Adds a stored member with its local header; Zip64 sizes if asked for. */
static void put_member(struct bytes *out, const char *name, const struct bytes *data,
                       bool is_long) {
    put_32(out, 0x04034b50);
    put_16(out, 45);
    for (int k = 0; k < 4; k++)
        put_16(out, 0);
    put_32(out, (uint32_t)crc32(0, data->at, (uInt)data->n));
    for (int k = 0; k < 2; k++)
        put_32(out, is_long ? UINT32_MAX : (uint32_t)data->n);
    put_16(out, (uint32_t)strlen(name));
    put_16(out, is_long ? 20 : 0);
    put(out, name, strlen(name));
    for (int k = 0; is_long && k < 5; k++)
        put_32(out, k == 0 ? 1 | 16 << 16 : k % 2 ? (uint32_t)data->n : 0);
    put(out, data->at, data->n);
}

/* An archive of two arrays; `header`: of the one with the positions. */
static struct bytes make_npz(const char *header, bool single, bool is_long) {
    struct bytes out = {0}, array = {0}, other = {0};
    put(&other, "nothing", 7);
    put(&array, "\x93NUMPY\1", 8);
    put_16(&array, (uint32_t)strlen(header));
    put(&array, header, strlen(header));
    put_numbers(&array, single);
    put_member(&out, "times.npy", &other, is_long);
    put_member(&out, "positions.npy", &array, is_long);
    return out;
}

static const struct cs_trimesh triangle = {.n = N};

/* Reads a file of memory for a mesh of N vertices. */
static void read_file(const char *name, const struct bytes *file, const char *array,
                      struct cs_vertex_paths *paths, struct cs_arena *arena,
                      struct cs_error *error) {
    struct cs_mesh_source source = {.scale = {1, 2, 4},
                                    .key_frames = {.present = true, .rate = 4, .start = 0.5}};
    const struct cs_collider collider = {.mesh = &source, .geometry = &triangle};
    snprintf(source.key_frames.file, sizeof source.key_frames.file, "%s", name);
    snprintf(source.key_frames.array, sizeof source.key_frames.array, "%s", array);
    *error = (struct cs_error){0};
    cs_key_frames_read_bytes((const char *)file->at, file->n, &collider, paths, arena, error);
}

static void check_numbers(const char *name, const struct bytes *file) {
    struct cs_vertex_paths paths;
    struct cs_arena arena = {0};
    struct cs_error error;
    read_file(name, file, "", &paths, &arena, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(paths.n_keys, KEYS);
    ck_assert_double_eq(paths.interval, 0.25);
    ck_assert_double_eq(paths.start, 0.5);
    for (int k = 0; k < KEYS; k++)
        for (int i = 0; i < N; i++)
            for (int c = 0; c < 3; c++)
                ck_assert_double_eq(paths.positions[(3 * k + c) * N + i],
                                    number(k, i, c) * (1 << c));
    cs_arena_finish(&arena);
}

#define HEADER "{'descr': '%s', 'fortran_order': False, 'shape': (2, 3, 3), }\n"

TEST(each_format_is_read) {
    const struct bytes pc2 = make_pc2();
    check_numbers("a.pc2", &pc2);
    for (int k = 0; k < 4; k++) {
        char header[100];
        snprintf(header, sizeof header, HEADER, k & 1 ? "<f4" : "<f8");
        const struct bytes npz = make_npz(header, k & 1, k & 2);
        check_numbers("a.npz", &npz);
    }
}

/* Fails with `part` in the message. */
static void check_refused(const char *name, const struct bytes *file, const char *array,
                          const char *part) {
    struct cs_vertex_paths paths;
    struct cs_arena arena = {0};
    struct cs_error error;
    read_file(name, file, array, &paths, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, part);
    ck_assert_msg(!strncmp(error.message, name, strlen(name)), "%s", error.message);
    cs_arena_finish(&arena);
}

/* One byte of a PC2 file changed. */
static void check_pc2(size_t at, unsigned char value, const char *part) {
    struct bytes file = make_pc2();
    file.at[at] = value;
    check_refused("a.pc2", &file, "", part);
}

TEST(bad_pc2_is_refused) {
    struct bytes file = make_pc2();
    check_pc2(0, 'Q', "found no header");
    check_pc2(11, ' ', "found no header");
    check_pc2(12, 2, "found version 2, expected 1");
    check_pc2(16, 4, "found 4 vertices, expected the 3 of the mesh");
    check_pc2(28, 3, "found 104 bytes, expected 140 for 3 samples of 3 points");
    // a number that is none: the exponent is all ones
    file.at[32 + 36 + 2] = 0xc0;
    file.at[32 + 36 + 3] = 0x7f;
    check_refused("a.pc2", &file, "", "key frame 1, vertex 0: found nan");
    file = make_pc2();
    file.at[28] = 1;
    file.n -= 36;
    check_refused("a.pc2", &file, "", "found 1 key frame, expected two or more");
    file.n = 20;
    check_refused("a.pc2", &file, "", "found no header");
}

static void check_header(const char *header, const char *part) {
    const struct bytes file = make_npz(header, false, false);
    check_refused("a.npz", &file, "", part);
}

TEST(bad_npz_is_refused) {
    check_header("{'descr': '>f8', 'fortran_order': False, 'shape': (2, 3, 3), }",
                 "another type");
    check_header("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3, 3), }",
                 "Fortran order");
    check_header("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 9), }",
                 "another shape");
    check_header("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2, 3), }",
                 "found 2 vertices, expected the 3 of the mesh");
    check_header("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3, 3), }",
                 "found 1 key frame");
    check_header("{'descr': '<f8', 'fortran_order': False, 'shape': (9, 3, 3), }",
                 "another size");
    struct bytes file =
        make_npz("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, 3), }", false, true);
    check_refused("a.npz", &file, "poses", "found no array \"poses\"");
    file.at[file.n - 1] ^= 1;
    check_refused("a.npz", &file, "", "is damaged: its checksum differs");
    file.n--;
    check_refused("a.npz", &file, "", "found no array \"positions\"");
    file.n++;
    // the first member only has its size read
    file.at[8] = 8;
    check_refused("a.npz", &file, "times", "times.npy is compressed");
    file.at[6] = 8;
    check_refused("a.npz", &file, "times", "was written to a pipe");
}

static void write_text(const char *file, const char *text) {
    FILE *out = fopen(file, "w");
    ck_assert_ptr_nonnull(out);
    fputs(text, out);
    ck_assert_int_eq(fclose(out), 0);
}

/* Reads keys of `file` in this folder for the triangle 0 1 2; returns its hash. */
static void read_here(const char *file, int64_t count, struct cs_vertex_paths *paths,
                      struct cs_arena *arena, struct cs_error *error) {
    static uint32_t corners[3] = {0, 1, 2};
    const struct cs_trimesh mesh = {.n = N, .n_triangles = 1, .triangles = corners};
    struct cs_mesh_source source = {.scale = {1, 1, 1},
                                    .key_frames = {true, "", "", 8, count, 24, 0, 0}};
    const struct cs_collider collider = {.mesh = &source, .geometry = &mesh};
    snprintf(source.key_frames.file, sizeof source.key_frames.file, "%s", file);
    *error = (struct cs_error){0};
    cs_key_frames_read(".", &collider, paths, arena, error);
}

TEST(sequences_are_read) {
    struct cs_vertex_paths paths;
    struct cs_arena arena = {0};
    struct cs_error error;
    char before[CS_HASH_DIGITS];
    write_text("a08.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_text("a09.obj", "v 0 0 1\nv 1 0 2\nv 0 1 3\nf 1 2 3\n");
    write_text("a10.obj", "v 0 0 1\nv 1 0 2\nv 0 1 3\nf 2 3 1\n");
    write_text("a11.obj", "v 0 0 1\nv 1 0 2\nv 0 1 3\nv 1 1 1\nf 1 2 3\nf 3 2 4\n");
    read_here("a##.obj", 2, &paths, &arena, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(paths.n_keys, 2);
    ck_assert_double_eq(paths.positions[1], 1);
    ck_assert_double_eq(paths.positions[9 + 6 + 2], 3);
    memcpy(before, paths.file_hash, sizeof before);
    read_here("a##.obj", 3, &paths, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "a10.obj: found other faces");
    write_text("a10.obj", "v 0 0 1\nv 1 0 2\nv 0 1 3\nf 1 2 3\n");
    read_here("a##.obj", 4, &paths, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "a11.obj: found 4 vertices, expected the 3");
    read_here("a##.obj", 1, &paths, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_SCENE, "count is 1, expected two or more");
    read_here("a.obj", 2, &paths, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_SCENE, "found no #");
    read_here("a##.ply", 2, &paths, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_SCENE, "ends in .pc2, .npz or .obj");
    read_here("../a##.obj", 2, &paths, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_SCENE, "expected a file in the scene's folder");
    read_here("b##.obj", 2, &paths, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "cannot read \"./b08.obj\"");
    read_here("b.pc2", 0, &paths, &arena, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "cannot read \"./b.pc2\"");
    // the hash is that of what the files hold
    write_text("a09.obj", "v 0 0 1\nv 1 0 2\nv 0 1 4\nf 1 2 3\n");
    read_here("a##.obj", 2, &paths, &arena, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_str_ne(paths.file_hash, before);
    cs_arena_finish(&arena);
}
