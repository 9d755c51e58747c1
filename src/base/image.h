/* image.h - 8-bit RGB pixels with optional coverage, rows from the top. */
#ifndef CS_IMAGE_H
#define CS_IMAGE_H

#include <stddef.h>
#include <stdint.h>

/* An image; width 0: none. rgb holds 3 * width * height bytes. Whoever makes it owns both
 * arrays (malloc). */
struct cs_image {
    uint32_t width, height;
    uint8_t *rgb;
    uint8_t *alpha; /* (height, width) coverage, not premultiplied; NULL: opaque */
};

static inline size_t cs_image_bytes(const struct cs_image *image) {
    return 3 * (size_t)image->width * image->height;
}

#endif
