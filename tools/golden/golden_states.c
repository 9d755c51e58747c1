/* Keeps states of a run, and measures how far those of another one are off. */
#include "golden/golden_states.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum cs_status cs_golden_states_init(struct cs_golden_states *states, uint32_t n,
                                     uint32_t frames, uint32_t kept,
                                     const struct cs_golden_states *like,
                                     struct cs_error *error) {
    const uint32_t n_kept = like ? like->n_kept : kept < frames ? kept : frames;
    *states = (struct cs_golden_states){.n = n,
                                        .frames = calloc(n_kept + 1u, sizeof(uint32_t)),
                                        .x = calloc(3 * (size_t)n * n_kept + 1, sizeof(float)),
                                        .hashes = calloc(frames + 1u, sizeof(uint64_t))};
    if (!states->frames || !states->x || !states->hashes) {
        cs_golden_states_finish(states);
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for states of %u frames", frames);
    }
    for (uint32_t k = 0; k < n_kept; k++)
        states->frames[k] =
            like ? like->frames[k] : (uint32_t)(((uint64_t)k + 1) * frames / n_kept);
    return CS_OK;
}

void cs_golden_states_finish(struct cs_golden_states *states) {
    free(states->frames);
    free(states->x);
    free(states->hashes);
    *states = (struct cs_golden_states){0};
}

void cs_golden_states_add(struct cs_golden_states *states, const struct cs_run *run) {
    char digits[CS_HASH_DIGITS];
    cs_run_hash(run, digits);
    digits[16] = 0;
    states->hashes[states->n_frames++] = strtoull(digits, NULL, 16);
    // the list of frames ends with a zero
    if (states->frames[states->n_kept] != run->frame)
        return;
    float *x = states->x + 3 * (size_t)states->n * states->n_kept++;
    for (size_t i = 0; i < states->n; i++)
        for (size_t c = 0; c < 3; c++)
            x[3 * i + c] = (float)run->x[c * states->n + i];
}

/* m between two points; 0 for equal bits, infinite where a number is not finite. */
static double state_distance(const float a[3], const float b[3]) {
    double sum = 0;
    if (!memcmp(a, b, 3 * sizeof *a))
        return 0;
    for (int c = 0; c < 3; c++)
        sum += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
    return isfinite(sum) ? sqrt(sum) : (double)INFINITY;
}

static struct cs_golden_offset compare_frame(const struct cs_golden_states *found,
                                             const struct cs_golden_states *expected,
                                             uint32_t k, double tolerance) {
    const size_t at = 3 * (size_t)found->n * k;
    struct cs_golden_offset offset = {.frame = found->frames[k]};
    for (uint32_t i = 0; i < found->n; i++) {
        const double d =
            state_distance(found->x + at + 3 * (size_t)i, expected->x + at + 3 * (size_t)i);
        offset.count += d > tolerance;
        if (d > offset.distance) {
            offset.distance = d;
            offset.particle = i;
        }
    }
    return offset;
}

struct cs_golden_where cs_golden_states_compare(const struct cs_golden_states *found,
                                                const struct cs_golden_states *expected,
                                                double tolerance) {
    struct cs_golden_where where = {.n = found->n == expected->n ? found->n : 0};
    for (uint32_t f = 0; f < found->n_frames && f < expected->n_frames && !where.first_hash;
         f++)
        if (found->hashes[f] != expected->hashes[f])
            where.first_hash = f + 1;
    for (uint32_t k = 0; where.n && k < found->n_kept && k < expected->n_kept; k++) {
        const struct cs_golden_offset offset = compare_frame(found, expected, k, tolerance);
        if (offset.count && !where.first.frame)
            where.first = offset;
        if (offset.count)
            where.last = offset;
    }
    return where;
}

static void print_offset(const struct cs_golden_offset *offset, struct cs_text *out) {
    cs_text_add(out, "particle %u, %.2g m", offset->particle, offset->distance);
}

void cs_golden_where_print(const struct cs_golden_where *where, bool by_bits,
                           struct cs_text *out) {
    const uint32_t first = by_bits ? where->first_hash : where->first.frame;
    if (!first) {
        cs_text_add(out, "no frame that both have");
        return;
    }
    cs_text_add(out, "frame %u first, ", first);
    if (!where->n)
        cs_text_add(out, "of another number of particles");
    else if (!where->first.frame)
        cs_text_add(out, "by less than a float32 tells");
    else {
        // the first frame of another hash need not be one that is kept
        print_offset(&where->first, out);
        if (where->first.frame != first)
            cs_text_add(out, " at frame %u", where->first.frame);
    }
    if (where->last.frame != where->first.frame) {
        cs_text_add(out, "; ");
        print_offset(&where->last, out);
        cs_text_add(out, " at frame %u, where %u of %u are off", where->last.frame,
                    where->last.count, where->n);
    }
}
