/* Keeps the frames of a run for its report. */
#include "cli/run/run_frame_log.h"

#include <stdlib.h>

static bool has_room(struct cs_frame_log *kept, size_t frames) {
    if (frames <= kept->capacity)
        return true;
    const size_t capacity = 2 * frames + 64;
    void *larger = realloc(kept->frames, capacity * sizeof *kept->frames);
    if (!larger)
        return false;
    *kept = (struct cs_frame_log){larger, capacity};
    return true;
}

enum cs_status cs_frame_log_add(struct cs_frame_log *kept, size_t number,
                                const struct cs_job_frame *frame, struct cs_error *error) {
    if (!has_room(kept, number))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the hashes of %zu frames",
                       number);
    kept->frames[number - 1] = *frame;
    return CS_OK;
}

void cs_frame_log_serialise(struct cs_frame_log *kept, uint64_t n,
                            struct cs_serialiser *record) {
    if (record->is_reading &&
        (record->failed || n > record->length || !has_room(kept, (size_t)n)))
        record->failed = true;
    else
        cs_serialiser_bytes(record, kept->frames, (size_t)n * sizeof *kept->frames);
}

void cs_frame_log_finish(struct cs_frame_log *kept) {
    free(kept->frames);
    *kept = (struct cs_frame_log){0};
}
