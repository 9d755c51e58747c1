/* glyph.h - figures and small letters: strokes, the only lettering of pictures. */
#ifndef CS_DRAW_GLYPH_H
#define CS_DRAW_GLYPH_H

#include "base/arena.h"
#include "draw/render.h"

#include <stdint.h>

/* Anti-aliased lines and dots of any width, collected and drawn in one call. */

/* Style of all lines of a call. */
struct cs_line_style {
    float colour[3];     /* linear RGB */
    double alpha;        /* opacity, 0..1 */
    double half_width;   /* pixels */
    double depth_offset; /* m by which the lines show through surfaces in front of them */
    bool flat;           /* ends are pixels from the top left, not m */
    bool on_top;         /* in front of everything, as flat ones are */
};

/* Lines being collected; the first member of a renderer's own struct. */
struct cs_lines {
    uint32_t n, capacity;
    float (*ends)[6]; /* (capacity) from, to; owned by the arena */
    /* set by the renderer: draws the n lines, later ones over earlier ones */
    void (*draw)(struct cs_lines *lines, const struct cs_line_style *style);
    /* set by the renderer: draws a rectangle of left, top, width, height in pixels in the
     * colour map, lowest value at the bottom */
    void (*ramp)(struct cs_lines *lines, const double box[4]);
};

/* Allocates room for `capacity` lines from the arena. CS_ERR_MEMORY. */
enum cs_status cs_lines_init(struct cs_lines *lines, uint32_t capacity, struct cs_arena *arena,
                             struct cs_error *error);

/* Adds a line in m (flat: in pixels); equal ends make a dot. At most `capacity` between two
 * draws. */
void cs_lines_add(struct cs_lines *lines, const double from[3], const double to[3]);

/* Draws the added lines and removes them. */
void cs_lines_draw(struct cs_lines *lines, const struct cs_line_style *style);

/* Adds the lines of a text of figures, small letters, N and .-+%:=_, right-aligned: x, y are
 * the pixels of the right end of the base line, height that of a figure. Other letters leave a
 * gap.
 */
void cs_glyph_add(struct cs_lines *lines, const char *text, double x, double y, double height);

/* Width in pixels of a text, with the gap before its first letter. */
double cs_glyph_width(const char *text, double height);

/* The colour bar beside a picture: quantity, unit, and labels at round values.
 */

struct cs_render;

/* Colour and place of the bar. */
struct cs_colour_bar {
    float ink[3];         /* linear RGB of lines and labels */
    float paper[3];       /* of the panel below them */
    double width, height; /* pixels of the picture */
};

enum {
    CS_COLOUR_BAR_LINES = 1024, /* lines that it adds between two draws, at most */
    CS_COLOUR_BAR_TICKS = 16
};

/* Pixels of a picture's width that the bar and its panel take; 0 for a look without one. */
double cs_colour_bar_width(const struct cs_render *render);

/* Sets the bar for pictures of the scene. */
void cs_colour_bar_init(struct cs_colour_bar *bar, const struct cs_render *render);

/* Draws the bar of a frame whose look has a title: colours, ticks, labels, on a panel. */
void cs_colour_bar_draw(const struct cs_colour_bar *bar, struct cs_lines *lines,
                        const struct cs_frame *frame);

/* Finds round values in a range, ends included: multiples of 1, 2 or 5 times a power of ten,
 * ascending. steps, 3 to 15: at most so many of them span the range. Returns their number; a
 * range without width gives its one value. */
uint32_t cs_colour_bar_ticks(const double range[2], int steps,
                             double ticks[CS_COLOUR_BAR_TICKS]);

#endif
