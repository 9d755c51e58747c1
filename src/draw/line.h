/* line.h - lines and dots with smooth edges, any width, collected and drawn in one call. */
#ifndef CS_DRAW_LINE_H
#define CS_DRAW_LINE_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>

struct cs_line_style {
    float colour[3]; /* linear RGB */
    double alpha;
    double half_width;   /* pixels */
    double depth_offset; /* m by which the lines show through surfaces in front of them */
    bool flat;           /* ends are pixels from the top left, not m */
    bool on_top;         /* in front of everything, as flat ones are */
};

/* The first member of what a renderer keeps of its lines. */
struct cs_lines {
    uint32_t n, capacity;
    float (*ends)[6]; /* (capacity) from, to; owned by the arena */
    /* the renderer's: draws the n lines, later ones over earlier ones */
    void (*draw)(struct cs_lines *lines, const struct cs_line_style *style);
    /* the renderer's: a rectangle of left, top, width, height in pixels, in the colours of the
     * map, lowest at the bottom */
    void (*ramp)(struct cs_lines *lines, const double box[4]);
};

enum cs_status cs_lines_init(struct cs_lines *lines, uint32_t capacity, struct cs_arena *arena,
                             struct cs_error *error);

/* Adds a line; equal ends make a dot. No more than the capacity between two draws. */
void cs_lines_add(struct cs_lines *lines, const double from[3], const double to[3]);

/* Draws what was added, and forgets it. */
void cs_lines_draw(struct cs_lines *lines, const struct cs_line_style *style);

#endif
