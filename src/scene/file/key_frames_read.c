/* Reads key frames of a mesh from a PC2 file, an NPZ file or a sequence of OBJ files. */
#include "scene/file/key_frames_read.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/serialise.h"
#include "mesh/vertex_paths.h"
#include "scene/collider_keys.h"
#include "scene/file/mesh_read.h"
#include "scene/mesh_keys.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    FILE_BYTES_MAX = 1 << 30,
    NUMBERS_MAX = 1 << 27, /* coordinates in all key frames: 2 GB with the velocities */
    NPY_TEXT_MAX = 512
};

/* A file being read, and the paths that it fills. */
struct input {
    const char *name;
    const unsigned char *bytes;
    size_t length;
    const struct cs_collider *collider;
    struct cs_vertex_paths *paths;
    struct cs_arena *arena;
    struct cs_error *error;
};

__attribute__((format(printf, 2, 3))) static enum cs_status fail(const struct input *in,
                                                                 const char *format, ...) {
    char message[256];
    CS_FORMAT(message, format);
    return cs_fail(in->error, CS_ERR_FILE, "%s: %s", in->name, message);
}

/* Little-endian integers of the file. */
static uint32_t get_16(const unsigned char *at) {
    return at[0] | (uint32_t)at[1] << 8;
}
static uint32_t get_32(const unsigned char *at) {
    return get_16(at) | get_16(at + 2) << 16;
}
static uint64_t get_64(const unsigned char *at) {
    return get_32(at) | (uint64_t)get_32(at + 4) << 32;
}

/* A number of 4 or 8 bytes. */
static double get_real(const unsigned char *at, unsigned bytes) {
    const uint32_t bits = get_32(at);
    float single;
    memcpy(&single, &bits, sizeof single);
    return bytes == 8 ? cs_double_from_le64(htole64(get_64(at))) : (double)single;
}

/* Checks the number of key frames and takes their positions. */
static enum cs_status begin_keys(const struct input *in, uint64_t n_keys) {
    struct cs_vertex_paths *paths = in->paths;
    if (n_keys < 2)
        return fail(in, "found %llu key frame%s, expected two or more",
                    (unsigned long long)n_keys, n_keys == 1 ? "" : "s");
    if (n_keys > NUMBERS_MAX / 3 / paths->n)
        return fail(in, "found %llu key frames of %u vertices, expected at most %u",
                    (unsigned long long)n_keys, paths->n, NUMBERS_MAX / 3 / paths->n);
    paths->n_keys = (uint32_t)n_keys;
    paths->positions = cs_arena_alloc_array(
        in->arena, paths->n_keys, 3 * (size_t)paths->n * sizeof *paths->positions, in->error);
    return in->error->status;
}

/* Vertices of the mesh before it was mended. */
static uint32_t vertices_of(const struct input *in) {
    const struct cs_trimesh *mesh = in->collider->geometry;
    return mesh->n_file ? mesh->n_file : mesh->n;
}

static enum cs_status check_vertices(const struct input *in, uint64_t n) {
    return n == vertices_of(in) ? CS_OK
                                : fail(in, "found %llu vertices, expected the %u of the mesh",
                                       (unsigned long long)n, vertices_of(in));
}

/* Sets all positions from numbers (n_keys, n, 3) of `bytes` bytes each. */
static enum cs_status set_positions(const struct input *in, const unsigned char *numbers,
                                    unsigned bytes) {
    const struct cs_trimesh *mesh = in->collider->geometry;
    const size_t n = in->paths->n, n_file = vertices_of(in);
    for (size_t k = 0; k < in->paths->n_keys; k++)
        for (size_t i = 0; i < n; i++) {
            const size_t from = mesh->file_vertex ? mesh->file_vertex[i] : i;
            double p[3];
            for (size_t c = 0; c < 3; c++) {
                p[c] = get_real(numbers + (3 * (k * n_file + from) + c) * bytes, bytes);
                if (!(p[c] >= -1e9 && p[c] <= 1e9))
                    return fail(in,
                                "key frame %zu, vertex %zu: found %g, expected a number "
                                "(-1e9..1e9)",
                                k, from, p[c]);
            }
            cs_mesh_to_scene(in->collider->mesh, p, p);
            for (size_t c = 0; c < 3; c++)
                in->paths->positions[(3 * k + c) * n + i] = p[c];
        }
    return CS_OK;
}

static enum cs_status read_pc2(const struct input *in) {
    enum { HEADER = 32 };
    if (in->length < HEADER || memcmp(in->bytes, "POINTCACHE2", 12) != 0)
        return fail(in, "found no header of 32 bytes that begins with POINTCACHE2");
    if (get_32(in->bytes + 12) != 1)
        return fail(in, "found version %u, expected 1", get_32(in->bytes + 12));
    const uint32_t n_keys = get_32(in->bytes + 28);
    // the size must be exact, or a file cut off would pass
    if (check_vertices(in, get_32(in->bytes + 16)))
        return in->error->status;
    const uint64_t expected = HEADER + 12 * (uint64_t)vertices_of(in) * n_keys;
    if (in->length != expected)
        return fail(in, "found %zu bytes, expected %llu for %u samples of %u points",
                    in->length, (unsigned long long)expected, n_keys, vertices_of(in));
    return begin_keys(in, n_keys) ? in->error->status
                                  : set_positions(in, in->bytes + HEADER, 4);
}

/* --- NPZ --- */

/* A member of a ZIP archive as its local header has it (PKWARE's APPNOTE 6.3). */
struct member {
    const char *name; /* not terminated */
    uint32_t name_bytes, flags, method, crc;
    const unsigned char *data;
    uint64_t bytes; /* as stored */
};

/* Sets the size of a member from its Zip64 field: id 1, length, size, stored size. */
static bool read_long_size(const unsigned char *extra, size_t length, uint64_t *bytes) {
    while (length >= 4 && get_16(extra) != 1 && length - 4 >= get_16(extra + 2)) {
        length -= 4 + get_16(extra + 2);
        extra += 4 + get_16(extra + 2);
    }
    if (length < 20 || get_16(extra) != 1 || get_16(extra + 2) < 16)
        return false;
    *bytes = get_64(extra + 12);
    return true;
}

/* Reads the member at *at and moves *at behind it; false: no whole member is there. */
static bool next_member(const struct input *in, size_t *at, struct member *out) {
    enum { HEADER = 30 };
    const unsigned char *header = in->bytes + *at;
    size_t rest = in->length - *at;
    if (rest < HEADER || get_32(header) != 0x04034b50)
        return false;
    const size_t name_bytes = get_16(header + 26), extra_bytes = get_16(header + 28);
    *out = (struct member){.name = (const char *)header + HEADER,
                           .name_bytes = (uint32_t)name_bytes,
                           .flags = get_16(header + 6),
                           .method = get_16(header + 8),
                           .crc = get_32(header + 14),
                           .data = header + HEADER + name_bytes + extra_bytes,
                           .bytes = get_32(header + 18)};
    // no offset leaves the file
    rest -= HEADER;
    if (rest < name_bytes + extra_bytes ||
        (out->bytes == UINT32_MAX &&
         !read_long_size(header + HEADER + name_bytes, extra_bytes, &out->bytes)))
        return false;
    rest -= name_bytes + extra_bytes;
    if (out->bytes > rest)
        return false;
    *at = in->length - rest + (size_t)out->bytes;
    return true;
}

/* Finds the member NAME.npy and checks that it is stored. */
static enum cs_status find_member(const struct input *in, const char *array,
                                  struct member *out) {
    char name[CS_TEXT_MAX + 4];
    size_t at = 0;
    const int length = snprintf(name, sizeof name, "%s.npy", array);
    while (next_member(in, &at, out)) {
        if (out->flags & 8)
            return fail(in, "the archive was written to a pipe, expected one with its sizes");
        if (out->name_bytes != (uint32_t)length || memcmp(out->name, name, out->name_bytes))
            continue;
        if (out->method != 0)
            return fail(in, "%.60s is compressed, expected an archive of numpy.savez", name);
        return CS_OK;
    }
    return fail(in, "found no array \"%.60s\" in a whole ZIP archive", array);
}

/* Copies the text of an NPY header; returns the offset of the numbers, 0 if there is none. */
static size_t npy_text(const struct member *npy, char text[NPY_TEXT_MAX]) {
    if (npy->bytes < 12 || memcmp(npy->data, "\x93NUMPY", 6) != 0)
        return 0;
    const bool is_short = npy->data[6] == 1;
    const size_t begin = is_short ? 10 : 12;
    const size_t length = is_short ? get_16(npy->data + 8) : get_32(npy->data + 8);
    if (length >= NPY_TEXT_MAX || length > npy->bytes - begin)
        return 0;
    memcpy(text, npy->data + begin, length);
    text[length] = 0;
    return begin + length;
}

static enum cs_status read_npz(const struct input *in) {
    const char *array = in->collider->mesh->key_frames.array;
    char text[NPY_TEXT_MAX];
    unsigned long long shape[3];
    unsigned bytes = 0;
    struct member npy = {0};
    array = *array ? array : "positions";
    if (find_member(in, array, &npy))
        return in->error->status;
    // the header is a Python dictionary, as numpy writes it
    const size_t begin = npy_text(&npy, text);
    const char *axes = begin ? strstr(text, "'shape': (") : NULL;
    if (!axes ||
        sscanf(axes, "'shape': (%9llu, %9llu, %9llu)", shape, shape + 1, shape + 2) < 3 ||
        shape[2] != 3)
        return fail(in, "%.60s has another shape than (key frames, vertices, 3)", array);
    if (!strstr(text, "'fortran_order': False"))
        return fail(in, "%.60s is in Fortran order, expected C order", array);
    if (strstr(text, "'descr': '<f8'"))
        bytes = 8;
    else if (strstr(text, "'descr': '<f4'"))
        bytes = 4;
    else
        return fail(in, "%.60s has another type than float32 or float64, little-endian", array);
    if (check_vertices(in, shape[1]) || begin_keys(in, shape[0]))
        return in->error->status;
    if (npy.bytes - begin != 3 * bytes * shape[0] * shape[1])
        return fail(in, "%.60s has another size than its header says", array);
    if (npy.crc != cs_hash_crc32(0, npy.data, (size_t)npy.bytes))
        return fail(in, "%.60s is damaged: its checksum differs", array);
    return set_positions(in, npy.data + begin, bytes);
}

/* --- files --- */

static bool ends_with(const char *text, const char *ending) {
    const size_t length = strlen(text), wanted = strlen(ending);
    return length > wanted && !strcmp(text + length - wanted, ending);
}

bool cs_key_frames_file(const struct cs_key_frames *keys, uint32_t k, char out[CS_TEXT_MAX]) {
    const size_t begin = strcspn(keys->file, "#"), width = strspn(keys->file + begin, "#");
    const bool sequence = ends_with(keys->file, ".obj");
    if (!keys->present || k >= (sequence ? (uint64_t)keys->count : 1))
        return false;
    return width == 0 ? snprintf(out, CS_TEXT_MAX, "%s", keys->file) < CS_TEXT_MAX
                      : snprintf(out, CS_TEXT_MAX, "%.*s%0*lld%s", (int)begin, keys->file,
                                 (int)width, (long long)(keys->first + k),
                                 keys->file + begin + width) < CS_TEXT_MAX;
}

/* Reads a file whole; sets the hash of its bytes. */
static enum cs_status read_whole(struct input *in, const char *path) {
    char *bytes;
    size_t length;
    if (!cs_file_read(path, FILE_BYTES_MAX, &bytes, &length, in->error) &&
        !cs_key_frames_read_bytes(bytes, length, in->collider, in->paths, in->arena, in->error))
        cs_hash_bytes(bytes, length, in->paths->file_hash);
    free(bytes);
    return in->error->status;
}

/* Reads the sequence of OBJ files. */
static enum cs_status read_sequence(struct input *in, const char *folder) {
    const struct cs_key_frames *keys = &in->collider->mesh->key_frames;
    struct cs_text hashes = {0};
    char file[CS_TEXT_MAX], hash[CS_HASH_DIGITS];
    in->name = keys->file;
    if (!strchr(keys->file, '#'))
        return cs_fail(in->error, CS_ERR_SCENE,
                       "%s: found no #, expected one for each digit of a file's number",
                       keys->file);
    if (keys->count < 2)
        return cs_fail(in->error, CS_ERR_SCENE,
                       "%s: key_frames.count is %lld, expected two or more", keys->file,
                       (long long)keys->count);
    if (begin_keys(in, (uint64_t)keys->count))
        return in->error->status;
    for (uint32_t k = 0; !in->error->status && cs_key_frames_file(keys, k, file); k++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, file);
        if (!cs_mesh_read_positions(path, file, in->collider,
                                    in->paths->positions + 3 * (size_t)k * in->paths->n, hash,
                                    in->error))
            cs_text_add(&hashes, "%s\n", hash);
    }
    if (hashes.failed)
        cs_fail(in->error, CS_ERR_MEMORY, "out of memory for the key frames");
    cs_hash_bytes(cs_text_get(&hashes), hashes.length, in->paths->file_hash);
    cs_text_finish(&hashes);
    return in->error->status;
}

/* Sets what the scene's keys say. */
static void set_keys(struct cs_vertex_paths *paths, const struct cs_collider *collider) {
    const struct cs_key_frames *keys = &collider->mesh->key_frames;
    *paths = (struct cs_vertex_paths){.n = collider->geometry->n,
                                      .end = (enum cs_paths_end)keys->end,
                                      .start = keys->start,
                                      .interval = 1 / keys->rate};
}

enum cs_status cs_key_frames_read_bytes(const char *bytes, size_t length,
                                        const struct cs_collider *collider,
                                        struct cs_vertex_paths *paths, struct cs_arena *arena,
                                        struct cs_error *error) {
    const struct input in = {collider->mesh->key_frames.file,
                             (const unsigned char *)bytes,
                             length,
                             collider,
                             paths,
                             arena,
                             error};
    set_keys(paths, collider);
    if (ends_with(in.name, ".pc2") ? read_pc2(&in) : read_npz(&in))
        return error->status;
    return cs_vertex_paths_finish(paths, arena, error);
}

enum cs_status cs_key_frames_read(const char *folder, const struct cs_collider *collider,
                                  struct cs_vertex_paths *paths, struct cs_arena *arena,
                                  struct cs_error *error) {
    const char *file = collider->mesh->key_frames.file;
    struct input in = {
        .name = file, .collider = collider, .paths = paths, .arena = arena, .error = error};
    char path[4096];
    if (!cs_scene_is_below(file))
        return cs_fail(error, CS_ERR_SCENE,
                       "found \"%.60s\", expected a file in the scene's folder or below", file);
    set_keys(paths, collider);
    if (ends_with(file, ".obj"))
        return read_sequence(&in, folder) ? error->status
                                          : cs_vertex_paths_finish(paths, arena, error);
    if (!ends_with(file, ".pc2") && !ends_with(file, ".npz"))
        return cs_fail(error, CS_ERR_SCENE,
                       "found \"%.60s\", expected a name that ends in .pc2, .npz or .obj",
                       file);
    snprintf(path, sizeof path, "%s/%s", folder, file);
    return read_whole(&in, path);
}
