/* colour_bar.h - the colour bar beside a picture: quantity, unit, and labels at round values.
 */
#ifndef CS_DRAW_COLOUR_BAR_H
#define CS_DRAW_COLOUR_BAR_H

#include "draw/glyph.h"
#include "draw/render.h"

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
