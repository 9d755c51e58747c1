/* Writes and reads streams of arrays. */
#include "base/trail.h"

#include "base/text.h"

#include <endian.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 512, VALUES_MAX = 1 << 28 };

void cs_trail_begin(FILE *file) {
    fprintf(file, "clothsim trail 1\n");
}

void cs_trail_write(FILE *file, const struct cs_trail_point *point) {
    struct cs_text t = {0};
    uint64_t words[BLOCK];
    cs_text_add_real(&t, point->t);
    fprintf(file, "%" PRIu32 " %" PRIu64 " %s %zu %s:%s\n", point->frame, point->step,
            cs_text_get(&t), point->n, point->phase, point->name);
    cs_text_finish(&t);
    for (size_t done = 0; done < point->n;) {
        const size_t count = point->n - done < BLOCK ? point->n - done : BLOCK;
        memcpy(words, point->values + done, count * sizeof *words);
        for (size_t k = 0; k < count; k++)
            words[k] = htole64(words[k]);
        fwrite(words, sizeof *words, count, file);
        done += count;
    }
}

static bool refuse(struct cs_error *error) {
    cs_fail(error, CS_ERR_FILE, "expected a trail of clothsim, found something else");
    return false;
}

/* "FRAME STEP T N PHASE:NAME", where a phase may have blanks */
static bool read_line(struct cs_trail *trail, struct cs_error *error) {
    struct cs_trail_point *point = &trail->point;
    char line[240], t[40], *colon;
    if (!fgets(line, sizeof line, trail->file))
        return false;
    line[strcspn(line, "\n")] = 0;
    if (sscanf(line, "%" SCNu32 " %" SCNu64 " %39s %zu %79[^\n]", &point->frame, &point->step,
               t, &point->n, trail->words) != 5 ||
        !cs_parse_real(t, &point->t) || point->n > VALUES_MAX ||
        !(colon = strrchr(trail->words, ':')))
        return refuse(error);
    *colon = 0;
    point->phase = trail->words;
    point->name = colon + 1;
    return true;
}

static bool read_values(struct cs_trail *trail, struct cs_error *error) {
    const size_t n = trail->point.n;
    if (n > trail->capacity) {
        free(trail->values);
        trail->values = malloc(n * sizeof *trail->values);
        trail->capacity = trail->values ? n : 0;
    }
    if (n > trail->capacity) {
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %zu values", n);
        return false;
    }
    if (fread(trail->values, sizeof *trail->values, n, trail->file) != n)
        return false;
    for (size_t k = 0; k < n; k++) {
        uint64_t word;
        memcpy(&word, trail->values + k, sizeof word);
        word = le64toh(word);
        memcpy(trail->values + k, &word, sizeof word);
    }
    trail->point.values = trail->values;
    return true;
}

bool cs_trail_next(struct cs_trail *trail, struct cs_error *error) {
    char line[40];
    if (!trail->begun) {
        trail->begun = true;
        if (!fgets(line, sizeof line, trail->file))
            return false;
        if (strcmp(line, "clothsim trail 1\n") != 0)
            return refuse(error);
    }
    return read_line(trail, error) && read_values(trail, error);
}

void cs_trail_finish(struct cs_trail *trail) {
    free(trail->values);
    *trail = (struct cs_trail){0};
}
