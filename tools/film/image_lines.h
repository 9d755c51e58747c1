/* image_lines.h - flat lines, figures and the colour bar on an image in memory. */
#ifndef CS_IMAGE_LINES_H
#define CS_IMAGE_LINES_H

#include "base/image.h"
#include "draw/glyph.h"
#include "draw/srgb.h"

struct cs_image_lines {
    struct cs_lines lines; /* first: see cs_lines */
    struct cs_image *image;
    const struct cs_srgb *srgb; /* both borrowed */
    double left, top;           /* pixels of the image where the pen's own begin */
    int32_t look;               /* whose colours a ramp has */
};

/* Prepares for so many lines at a time. CS_ERR_MEMORY. */
enum cs_status cs_image_lines_init(struct cs_image_lines *lines, uint32_t capacity,
                                   struct cs_image *image, const struct cs_srgb *srgb,
                                   struct cs_arena *arena, struct cs_error *error);

#endif
