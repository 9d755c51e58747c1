/* colour_bar.h - the colour bar beside a picture: quantity, unit, and figures at round values.
 */
#ifndef CS_DRAW_COLOUR_BAR_H
#define CS_DRAW_COLOUR_BAR_H

#include "draw/line.h"
#include "draw/render.h"

struct cs_colour_bar {
    float ink[3];
    double width, height; /* of the picture */
};

enum {
    CS_COLOUR_BAR_LINES = 1024, /* lines that it draws at once at most */
    CS_COLOUR_BAR_TICKS = 16
};

void cs_colour_bar_init(struct cs_colour_bar *bar, const struct cs_render *render);

/* For a frame with a title. */
void cs_colour_bar_draw(const struct cs_colour_bar *bar, struct cs_lines *lines,
                        const struct cs_frame *frame);

/* Multiples of 1, 2 or 5 times a power of ten within a range, ends included, lowest first;
 * steps: how many of them span the range at most, 3 to 15. Returns how many there are; where
 * the range has no width, its value alone. */
uint32_t cs_colour_bar_ticks(const double range[2], int steps,
                             double ticks[CS_COLOUR_BAR_TICKS]);

#endif
