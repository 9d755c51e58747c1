/* trace_stream.h - a stream of the arrays that a run computed, stage by stage.
 *
 * A record is a line "FRAME STEP T N PHASE:NAME" and N doubles as little-endian bytes. The
 * first line of a stream is "clothsim trail 1". */
#ifndef CS_TRACE_STREAM_H
#define CS_TRACE_STREAM_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* An array at one stage of a step. */
struct cs_trace_record {
    uint32_t frame; /* the frame in progress, or just completed */
    uint64_t step;  /* steps completed before, since the run began */
    double t;       /* s */
    const char *phase, *name;
    const double *values; /* (n) */
    size_t n;
};

/* Writes the first line. Errors of writing show in ferror. */
void cs_trace_stream_begin(FILE *file);
void cs_trace_stream_write(FILE *file, const struct cs_trace_record *record);

/* A stream being read. Zeroed except for the file: at its beginning. */
struct cs_trace_stream {
    FILE *file;
    struct cs_trace_record record; /* the last that was read */
    bool header_done;
    char buffer[80]; /* owned: phase and name */
    double *values;  /* owned */
    size_t capacity; /* of values */
};
/* Reads the next record into `point`. Returns false at the end, or where the stream breaks off,
 * and on CS_ERR_FILE (not such a stream) and CS_ERR_MEMORY. */
bool cs_trace_stream_next(struct cs_trace_stream *trace, struct cs_error *error);
void cs_trace_stream_finish(struct cs_trace_stream *trace);

#endif
