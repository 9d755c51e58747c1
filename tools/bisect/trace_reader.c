/* Reads streams of arrays, record by record. */
#include "bisect/trace_reader.h"

#include "base/text.h"

#include <endian.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { VALUES_MAX = 1 << 28 };

/* Reports that the file is no such stream. */
static bool refuse_stream(struct cs_error *error) {
    cs_fail(error, CS_ERR_FILE,
            "expected the output of clothsim run --trace, found something else");
    return false;
}

/* Reads "FRAME STEP T N PHASE:NAME"; a phase may contain blanks, a name no colon. */
static bool read_line(struct cs_trace_stream *trace, struct cs_error *error) {
    struct cs_trace_record *record = &trace->record;
    char line[240], t[40], *colon;
    if (!fgets(line, sizeof line, trace->file))
        return false;
    line[strcspn(line, "\n")] = 0;
    if (sscanf(line, "%" SCNu32 " %" SCNu64 " %39s %zu %79[^\n]", &record->frame, &record->step,
               t, &record->n, trace->buffer) != 5 ||
        !cs_parse_real(t, &record->t) || record->n > VALUES_MAX ||
        !(colon = strrchr(trace->buffer, ':')))
        return refuse_stream(error);
    *colon = 0;
    record->phase = trace->buffer;
    record->name = colon + 1;
    return true;
}

/* Reads the values of the record into the stream's buffer. */
static bool read_values(struct cs_trace_stream *trace, struct cs_error *error) {
    const size_t n = trace->record.n;
    if (n > trace->capacity) {
        free(trace->values);
        trace->values = malloc(n * sizeof *trace->values);
        trace->capacity = trace->values ? n : 0;
    }
    if (n > trace->capacity) {
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %zu values", n);
        return false;
    }
    if (fread(trace->values, sizeof *trace->values, n, trace->file) != n)
        return false;
    for (size_t k = 0; k < n; k++) {
        uint64_t word;
        memcpy(&word, trace->values + k, sizeof word);
        word = le64toh(word);
        memcpy(trace->values + k, &word, sizeof word);
    }
    trace->record.values = trace->values;
    return true;
}

bool cs_trace_stream_next(struct cs_trace_stream *trace, struct cs_error *error) {
    char line[40];
    if (!trace->header_done) {
        trace->header_done = true;
        if (!fgets(line, sizeof line, trace->file))
            return false;
        if (strcmp(line, "clothsim trail 1\n") != 0)
            return refuse_stream(error);
    }
    return read_line(trace, error) && read_values(trace, error);
}

void cs_trace_stream_finish(struct cs_trace_stream *trace) {
    free(trace->values);
    *trace = (struct cs_trace_stream){0};
}
