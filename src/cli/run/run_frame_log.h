/* run_frame_log.h - what a run keeps of its frames for the report. */
#ifndef CS_RUN_FRAME_LOG_H
#define CS_RUN_FRAME_LOG_H

#include "base/hash.h"
#include "sim/run_record.h"

#include <stdbool.h>
#include <stddef.h>

struct cs_job_frame {
    char hash[CS_HASH_DIGITS];
    bool drawn;
    double range[2];    /* of the colours, where drawn by a value */
    uint64_t crossings; /* where they are counted */
};

/* Zeroed: none. */
struct cs_frame_log {
    struct cs_job_frame *frames; /* owned */
    size_t capacity;
};

/* The frame of that number, from 1; CS_ERR_MEMORY. */
enum cs_status cs_frame_log_add(struct cs_frame_log *kept, size_t number,
                                const struct cs_job_frame *frame, struct cs_error *error);

/* The first n frames, into a checkpoint or from it. */
void cs_frame_log_serialise(struct cs_frame_log *kept, uint64_t n,
                            struct cs_serialiser *record);

void cs_frame_log_finish(struct cs_frame_log *kept);

#endif
