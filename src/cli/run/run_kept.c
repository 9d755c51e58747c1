/* Keeps the frames of a run for its report. */
#include "cli/run/run_kept.h"

#include <stdlib.h>

static bool has_room(struct cs_kept *kept, size_t frames) {
    if (frames <= kept->capacity)
        return true;
    const size_t capacity = 2 * frames + 64;
    void *larger = realloc(kept->frames, capacity * sizeof *kept->frames);
    if (!larger)
        return false;
    *kept = (struct cs_kept){larger, capacity};
    return true;
}

enum cs_status cs_kept_add(struct cs_kept *kept, size_t number,
                           const struct cs_job_frame *frame, struct cs_error *error) {
    if (!has_room(kept, number))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the hashes of %zu frames",
                       number);
    kept->frames[number - 1] = *frame;
    return CS_OK;
}

void cs_kept_record(struct cs_kept *kept, uint64_t n, struct cs_record *record) {
    if (record->loading && (record->failed || n > record->length || !has_room(kept, (size_t)n)))
        record->failed = true;
    else
        cs_record_bytes(record, kept->frames, (size_t)n * sizeof *kept->frames);
}

void cs_kept_finish(struct cs_kept *kept) {
    free(kept->frames);
    *kept = (struct cs_kept){0};
}
