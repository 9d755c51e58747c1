/* Collects lines until a renderer draws them. */
#include "draw/line.h"

enum cs_status cs_lines_init(struct cs_lines *lines, uint32_t capacity, struct cs_arena *arena,
                             struct cs_error *error) {
    lines->capacity = capacity;
    lines->ends = cs_arena_alloc_array(arena, capacity, sizeof *lines->ends, error);
    return error->status;
}

void cs_lines_add(struct cs_lines *lines, const double from[3], const double to[3]) {
    CS_ASSERT(lines->n < lines->capacity);
    float *ends = lines->ends[lines->n++];
    for (int i = 0; i < 3; i++) {
        ends[i] = (float)from[i];
        ends[3 + i] = (float)to[i];
    }
}

void cs_lines_draw(struct cs_lines *lines, const struct cs_line_style *style) {
    if (lines->n)
        lines->draw(lines, style);
    lines->n = 0;
}
