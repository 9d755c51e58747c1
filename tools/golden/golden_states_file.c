/* Files of stored states: three arrays of NumPy in one stream of gzip (RFC 1952). */
#include "base/file.h"
#include "base/serialise.h"
#include "golden/golden_states.h"
#include "export/npy.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* zlib's: the largest window, with the head of gzip */
enum { GZIP_WINDOW = MAX_WBITS + 16, MEMORY_LEVEL = 8, FILE_MAX = 1 << 28 };

/* The three arrays, in the order of the file. */
struct part {
    const char *type;
    uint64_t shape[3];
    unsigned n_axes;
    void *items; /* little-endian in the file */
};
enum { PARTS = 3, ITEM_MAX = 8 };

void cs_golden_states_path(const char *folder, const char *name, char path[1024]) {
    snprintf(path, 1024, "%.500s/state/%.400s.npy.gz", folder, name);
}

static void describe(const struct cs_golden_states *states, struct part parts[PARTS]) {
    const struct part all[PARTS] = {
        {"<u4", {states->n_kept}, 1, states->frames},
        {"<f4", {states->n_kept, states->n, 3}, 3, states->x},
        {"<u8", {states->n_frames}, 1, states->hashes},
    };
    memcpy(parts, all, sizeof all);
}

static size_t item_bytes(const struct part *part) {
    return (size_t)(part->type[2] - '0');
}

static uint64_t count_items(const struct part *part) {
    uint64_t n = 1;
    for (unsigned k = 0; k < part->n_axes; k++)
        n *= part->shape[k];
    return n;
}

/* Copies items between memory and the little-endian bytes of a file. */
static void swap_items(const struct part *part, unsigned char *bytes, bool out) {
    const size_t size = item_bytes(part);
    const uint16_t probe = 1;
    unsigned char *items = part->items;
    const bool is_little = *(const unsigned char *)&probe == 1;
    for (uint64_t i = 0; i < count_items(part) * size; i++) {
        const uint64_t at = is_little ? i : i / size * size + size - 1 - i % size;
        if (out)
            bytes[i] = items[at];
        else
            items[at] = bytes[i];
    }
}

static unsigned char *pack_parts(const struct part parts[PARTS], size_t *length) {
    *length = 0;
    for (int k = 0; k < PARTS; k++)
        *length += CS_NPY_HEAD + count_items(parts + k) * item_bytes(parts + k);
    unsigned char *bytes = malloc(*length), *at = bytes;
    for (int k = 0; bytes && k < PARTS; k++) {
        cs_npy_head((char *)at, parts[k].type, parts[k].shape, parts[k].n_axes);
        swap_items(parts + k, at + CS_NPY_HEAD, true);
        at += CS_NPY_HEAD + count_items(parts + k) * item_bytes(parts + k);
    }
    return bytes;
}

/* Packs bytes into malloc'd ones; NULL if out of memory. */
static unsigned char *deflate_bytes(unsigned char *bytes, size_t length,
                                    size_t *packed_length) {
    z_stream stream = {.next_in = bytes, .avail_in = (uInt)length};
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, GZIP_WINDOW, MEMORY_LEVEL,
                     Z_DEFAULT_STRATEGY) != Z_OK)
        return NULL;
    const size_t max = deflateBound(&stream, (uLong)length);
    unsigned char *packed = malloc(max);
    stream.next_out = packed;
    stream.avail_out = (uInt)max;
    if (packed)
        deflate(&stream, Z_FINISH);
    *packed_length = stream.total_out;
    deflateEnd(&stream);
    return packed;
}

enum cs_status cs_golden_states_write(const struct cs_golden_states *states, const char *path,
                                      struct cs_error *error) {
    struct part parts[PARTS];
    size_t length, packed_length = 0;
    describe(states, parts);
    unsigned char *bytes = pack_parts(parts, &length), *packed = NULL;
    if (length > FILE_MAX)
        cs_fail(error, CS_ERR_USAGE, "%s: %zu bytes of states, expected at most %d", path,
                length, FILE_MAX);
    else if (!bytes || !(packed = deflate_bytes(bytes, length, &packed_length)))
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %s", path);
    else
        cs_file_write(path, packed, packed_length, error);
    free(packed);
    free(bytes);
    return error->status;
}

/* Unpacks a stream of gzip into malloc'd bytes of the length that its last four bytes tell;
 * NULL if that is no such stream. */
static unsigned char *inflate_bytes(unsigned char *packed, size_t packed_length,
                                    size_t *length) {
    const unsigned char *end = packed + packed_length;
    // head and end of a stream of gzip; the last four bytes are the length of what is packed
    if (packed_length < 18)
        return NULL;
    *length = end[-4] | (size_t)end[-3] << 8 | (size_t)end[-2] << 16 | (size_t)end[-1] << 24;
    unsigned char *bytes = *length <= FILE_MAX ? malloc(*length + 1) : NULL;
    z_stream stream = {.next_in = packed,
                       .avail_in = (uInt)packed_length,
                       .next_out = bytes,
                       .avail_out = (uInt)*length + 1};
    if (!bytes || inflateInit2(&stream, GZIP_WINDOW) != Z_OK) {
        free(bytes);
        return NULL;
    }
    const bool whole = inflate(&stream, Z_FINISH) == Z_STREAM_END && !stream.avail_in &&
                       stream.total_out == *length;
    inflateEnd(&stream);
    if (whole)
        return bytes;
    free(bytes);
    return NULL;
}

/* Reads the next array: its first axis has the length that its head tells, at most max, and
 * all else of the head is as we write it. False for anything else. */
static bool take_part(struct part *part, unsigned char **at, const unsigned char *end,
                      uint64_t max) {
    char head[CS_NPY_HEAD], text[CS_NPY_HEAD + 1] = "";
    if (end - *at < CS_NPY_HEAD)
        return false;
    memcpy(text, *at, CS_NPY_HEAD);
    // the magic number ends with a zero
    const char *shape = strstr(text + 10, "'shape': (");
    for (unsigned k = 0; shape && k < part->n_axes; k++) {
        shape += strcspn(shape, "0123456789");
        part->shape[k] = strtoull(shape, (char **)&shape, 10);
        if (part->shape[k] > max)
            return false;
    }
    cs_npy_head(head, part->type, part->shape, part->n_axes);
    const uint64_t left = (uint64_t)(end - *at) - CS_NPY_HEAD;
    if (memcmp(head, *at, CS_NPY_HEAD) != 0 || count_items(part) * item_bytes(part) > left)
        return false;
    part->items = malloc(count_items(part) * item_bytes(part) + ITEM_MAX);
    if (!part->items)
        return false;
    swap_items(part, *at + CS_NPY_HEAD, false);
    *at += CS_NPY_HEAD + count_items(part) * item_bytes(part);
    return true;
}

/* True if the frames ascend from 1 to at most those that were reached. */
static bool is_ascending(const struct cs_golden_states *states) {
    uint32_t before = 0;
    for (uint32_t k = 0; k < states->n_kept; before = states->frames[k++])
        if (states->frames[k] <= before || states->frames[k] > states->n_frames)
            return false;
    return true;
}

static bool take_states(struct cs_golden_states *states, unsigned char *bytes, size_t length,
                        uint32_t frames) {
    struct part parts[PARTS];
    unsigned char *at = bytes, *end = bytes + length;
    describe(states, parts);
    const bool whole = take_part(parts, &at, end, CS_GOLDEN_STATES_MAX) &&
                       take_part(parts + 1, &at, end, UINT32_MAX / 16) &&
                       take_part(parts + 2, &at, end, frames) && at == end;
    *states = (struct cs_golden_states){.n = (uint32_t)parts[1].shape[1],
                                        .n_kept = (uint32_t)parts[0].shape[0],
                                        .n_frames = (uint32_t)parts[2].shape[0],
                                        .frames = parts[0].items,
                                        .x = parts[1].items,
                                        .hashes = parts[2].items};
    return whole && parts[1].shape[0] == states->n_kept && parts[1].shape[2] == 3 &&
           is_ascending(states);
}

enum cs_status cs_golden_states_read(struct cs_golden_states *states, const char *path,
                                     uint32_t frames, struct cs_error *error) {
    char *packed;
    size_t packed_length, length = 0;
    *states = (struct cs_golden_states){0};
    if (cs_file_read(path, FILE_MAX, &packed, &packed_length, error))
        return error->status;
    unsigned char *bytes = inflate_bytes((unsigned char *)packed, packed_length, &length);
    free(packed);
    if (!bytes || !take_states(states, bytes, length, frames)) {
        cs_golden_states_finish(states);
        cs_fail(error, CS_ERR_FILE,
                "%s: found something else, expected the stored states of a run of %u frames",
                path, frames);
    }
    free(bytes);
    return error->status;
}
