/* film_pen.h - flat lines, figures and the colour bar on an image in memory. */
#ifndef CS_FILM_PEN_H
#define CS_FILM_PEN_H

#include "base/image.h"
#include "draw/line.h"
#include "draw/tone.h"

struct cs_pen {
    struct cs_lines lines; /* first: see cs_lines */
    struct cs_image *image;
    const struct cs_tone *tone; /* both borrowed */
    double left, top;           /* pixels of the image where the pen's own begin */
    int32_t look;               /* whose colours a ramp has */
};

/* For so many lines at once. CS_ERR_MEMORY. */
enum cs_status cs_pen_init(struct cs_pen *pen, uint32_t capacity, struct cs_image *image,
                           const struct cs_tone *tone, struct cs_arena *arena,
                           struct cs_error *error);

#endif
