/* Any bytes as a file of stored states, and, packed by gzip, as what is in one: states or a
 * refusal, and what is written reads as the same states. */
#include "folder.h"
#include "golden/golden_states.h"

#include <stdint.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

/* frames of the run that the states are of; the head of gzip before the largest window */
enum { FRAMES = 1000, GZIP_WINDOW = MAX_WBITS + 16, MEMORY_LEVEL = 8 };

static bool is_same(const struct cs_golden_states *a, const struct cs_golden_states *b) {
    const size_t bytes = 3 * sizeof *a->x * a->n * a->n_kept;
    return a->n == b->n && a->n_kept == b->n_kept && a->n_frames == b->n_frames &&
           !memcmp(a->frames, b->frames, a->n_kept * sizeof *a->frames) &&
           !memcmp(a->x, b->x, bytes) &&
           !memcmp(a->hashes, b->hashes, a->n_frames * sizeof *a->hashes);
}

static void read_states(const void *bytes, size_t length) {
    struct cs_golden_states states, again;
    struct cs_error error = {0};
    const enum cs_status status =
        cs_golden_states_read(&states, fuzz_write("a.npy.gz", bytes, length), FRAMES, &error);
    CS_ASSERT(status == error.status);
    if (status) {
        CS_ASSERT(status == CS_ERR_FILE && strstr(error.message, "a.npy.gz") && !states.x);
        return;
    }
    uint32_t before = 0;
    for (uint32_t k = 0; k < states.n_kept; before = states.frames[k++])
        CS_ASSERT(states.frames[k] > before && states.frames[k] <= states.n_frames);
    CS_ASSERT(states.n_frames <= FRAMES);
    CS_ASSERT(!cs_golden_states_write(&states, fuzz_path("b.npy.gz"), &error));
    CS_ASSERT(!cs_golden_states_read(&again, fuzz_path("b.npy.gz"), FRAMES, &error));
    CS_ASSERT(is_same(&states, &again));
    cs_golden_states_finish(&again);
    cs_golden_states_finish(&states);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    z_stream stream = {.avail_in = (uInt)length};
    CS_ASSERT(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, GZIP_WINDOW, MEMORY_LEVEL,
                           Z_DEFAULT_STRATEGY) == Z_OK);
    const size_t most = deflateBound(&stream, (uLong)length);
    uint8_t *packed = malloc(most), *copy = malloc(length + 1);
    CS_ASSERT(packed && copy);
    memcpy(copy, bytes, length);
    stream.next_in = copy;
    stream.next_out = packed;
    stream.avail_out = (uInt)most;
    CS_ASSERT(deflate(&stream, Z_FINISH) == Z_STREAM_END);
    read_states(packed, stream.total_out);
    read_states(bytes, length);
    deflateEnd(&stream);
    free(packed);
    free(copy);
    return 0;
}
