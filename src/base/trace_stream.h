/* trace_stream.h - what a program computed, stage by stage, as a stream of arrays.
 *
 * A record is a line "FRAME STEP T N PHASE:NAME" and N doubles as little-endian bytes. The
 * first line of a stream is "clothsim trail 1".
 */
#ifndef CS_TRACE_STREAM_H
#define CS_TRACE_STREAM_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* An array as it stood somewhere. */
struct cs_trace_record {
    uint32_t frame; /* being made, or that was made */
    uint64_t step;  /* that were done before, since the run began */
    double t;       /* s */
    const char *phase, *name;
    const double *values; /* (n) */
    size_t n;
};

/* Writes the first line. What cannot be written is seen by ferror. */
void cs_trace_stream_begin(FILE *file);
void cs_trace_stream_write(FILE *file, const struct cs_trace_record *point);

/* A stream that is read. Zeroed but for the file: at its beginning. */
struct cs_trace_stream {
    FILE *file;
    struct cs_trace_record point; /* the last that was read */
    bool header_done;
    char buffer[80]; /* owned: phase and name */
    double *values;  /* owned */
    size_t capacity; /* of values */
};
/* Reads the next point; false at the end, or where the stream breaks off. CS_ERR_FILE where it
 * is none, CS_ERR_MEMORY. */
bool cs_trace_stream_next(struct cs_trace_stream *trace, struct cs_error *error);
void cs_trace_stream_finish(struct cs_trace_stream *trace);

#endif
