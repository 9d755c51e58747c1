/* trace_reader.h - reads a stream of arrays, as base/trace_stream.h describes it. */
#ifndef CS_TRACE_READER_H
#define CS_TRACE_READER_H

#include "base/status.h"
#include "base/trace_stream.h"

#include <stdbool.h>

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
