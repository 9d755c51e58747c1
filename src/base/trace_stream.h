/* trace_stream.h - a stream of the arrays that a run computed, stage by stage.
 *
 * A record is a line "FRAME STEP T N PHASE:NAME" and N doubles as little-endian bytes. The
 * first line of a stream is "clothsim trail 1". */
#ifndef CS_TRACE_STREAM_H
#define CS_TRACE_STREAM_H

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

#endif
