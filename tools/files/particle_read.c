/* Reads arrays of float64 from stored members of a ZIP archive (PKWARE's APPNOTE 6.3). */
#include "files/particle_read.h"

#include "base/file.h"
#include "base/serialise.h"

#include <stdlib.h>
#include <string.h>

enum { HEADER = 30, FILE_BYTES_MAX = 1 << 30 };

/* The file, whole. */
struct archive {
    const char *path; /* borrowed */
    char *bytes;
    size_t length;
};

/* An array in the bytes of the archive. */
struct array {
    const char *numbers; /* little-endian */
    unsigned long long shape[3];
    uint64_t bytes;
};

static uint64_t number_at(const char *at, unsigned bytes) {
    uint64_t value = 0;
    for (unsigned k = bytes; k-- > 0;)
        value = value << 8 | (unsigned char)at[k];
    return value;
}

static double real_at(const char *at) {
    return cs_double_from_le64(htole64(number_at(at, 8)));
}

/* Moves *at past the member there; false: it is not whole, or not stored. */
static bool next_member(const struct archive *archive, size_t *at, const char **name,
                        size_t *name_bytes, struct array *data) {
    const char *header = archive->bytes + *at;
    const size_t rest = archive->length - *at;
    if (rest < HEADER || number_at(header, 4) != 0x04034b50 || number_at(header + 8, 2) != 0)
        return false;
    *name = header + HEADER;
    *name_bytes = number_at(header + 26, 2);
    const size_t extra = number_at(header + 28, 2), begin = HEADER + *name_bytes + extra;
    data->bytes = number_at(header + 18, 4);
    /* the Zip64 field comes first where it is there: id 1, length, size, stored size */
    if (data->bytes == UINT32_MAX && extra >= 20 && begin <= rest &&
        number_at(header + begin - extra, 2) == 1)
        data->bytes = number_at(header + begin - extra + 12, 8);
    if (begin > rest || data->bytes > rest - begin)
        return false;
    data->numbers = header + begin;
    *at += begin + data->bytes;
    return true;
}

/* Reads the header of an array in `axes` dimensions; false: it is no such array of float64. */
static bool read_header(struct array *array, unsigned axes) {
    char text[512] = "";
    if (array->bytes < 12 || memcmp(array->numbers, "\x93NUMPY\x01", 7) != 0)
        return false;
    const size_t length = number_at(array->numbers + 8, 2), begin = 10 + length;
    if (length >= sizeof text || begin > array->bytes)
        return false;
    memcpy(text, array->numbers + 10, length);
    const char *shape = strstr(text, "'shape': (");
    unsigned long long *at = array->shape;
    at[0] = at[1] = at[2] = 1;
    if (!shape || !strstr(text, "'<f8'") || !strstr(text, "'fortran_order': False") ||
        sscanf(shape, "'shape': (%9llu, %9llu, %9llu)", at, at + 1, at + 2) != (int)axes)
        return false;
    array->numbers += begin;
    array->bytes -= begin;
    return array->bytes == at[0] * at[1] * at[2] * sizeof(double);
}

static enum cs_status find_array(const struct archive *archive, const char *name, unsigned axes,
                                 struct array *array, struct cs_error *error) {
    const char *found;
    size_t at = 0, n;
    while (next_member(archive, &at, &found, &n, array))
        if (n == strlen(name) && !memcmp(found, name, n))
            return read_header(array, axes)
                       ? CS_OK
                       : cs_fail(error, CS_ERR_FILE,
                                 "%s: %s is no whole array of float64 in %u dimensions",
                                 archive->path, name, axes);
    return cs_fail(error, CS_ERR_FILE,
                   "%s: found no stored %s, expected an archive of clothsim run --export npz",
                   archive->path, name);
}

/* The table of t, x, y and z from both arrays. */
static enum cs_status fill(struct cs_number_table *table, const struct array *times,
                           const struct array *positions, uint32_t particle,
                           struct cs_arena *arena, struct cs_error *error) {
    static const char *const names[] = {"t", "x", "y", "z"};
    *table = (struct cs_number_table){.columns = 4, .rows = (uint32_t)times->shape[0]};
    for (int c = 0; c < 4; c++)
        table->names[c] = cs_arena_copy_text(arena, names[c], error);
    table->values = cs_arena_alloc_array(arena, 4 * (size_t)table->rows, sizeof(double), error);
    for (size_t r = 0; !error->status && r < table->rows; r++) {
        table->values[4 * r] = real_at(times->numbers + 8 * r);
        for (size_t c = 0; c < 3; c++)
            table->values[4 * r + 1 + c] = real_at(
                positions->numbers + 8 * (3 * (r * positions->shape[1] + particle) + c));
    }
    return error->status;
}

enum cs_status cs_particle_read(const char *path, uint32_t particle, struct cs_arena *arena,
                                struct cs_number_table *table, struct cs_error *error) {
    struct array times, positions;
    struct archive archive = {.path = path};
    if (cs_file_read(path, FILE_BYTES_MAX, &archive.bytes, &archive.length, error))
        return error->status;
    if (!find_array(&archive, "times.npy", 1, &times, error) &&
        !find_array(&archive, "positions.npy", 3, &positions, error)) {
        /* one position for each time */
        if (!positions.shape[1] || positions.shape[2] != 3 ||
            positions.shape[0] != times.shape[0])
            cs_fail(error, CS_ERR_FILE, "%s: positions.npy is not (samples, particles, 3)",
                    path);
        else if (particle >= positions.shape[1])
            cs_fail(error, CS_ERR_USAGE, "--particle: found %u, expected 0 to %llu", particle,
                    positions.shape[1] - 1);
        else
            fill(table, &times, &positions, particle, arena, error);
    }
    free(archive.bytes);
    return error->status;
}
