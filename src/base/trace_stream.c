/* Writes streams of arrays, in blocks of 512 doubles on the stack. */
#include "base/trace_stream.h"

#include "base/text.h"

#include <endian.h>
#include <inttypes.h>
#include <string.h>

enum { BLOCK = 512 };

void cs_trace_stream_begin(FILE *file) {
    fprintf(file, "clothsim trail 1\n");
}

void cs_trace_stream_write(FILE *file, const struct cs_trace_record *record) {
    struct cs_text t = {0};
    uint64_t words[BLOCK];
    cs_text_add_real(&t, record->t);
    fprintf(file, "%" PRIu32 " %" PRIu64 " %s %zu %s:%s\n", record->frame, record->step,
            cs_text_get(&t), record->n, record->phase, record->name);
    cs_text_finish(&t);
    for (size_t done = 0; done < record->n;) {
        const size_t count = record->n - done < BLOCK ? record->n - done : BLOCK;
        memcpy(words, record->values + done, count * sizeof *words);
        for (size_t k = 0; k < count; k++)
            words[k] = htole64(words[k]);
        fwrite(words, sizeof *words, count, file);
        done += count;
    }
}
