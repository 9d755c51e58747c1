/* image.h - 8-bit RGB pixels, rows from the top, and how much they cover. */
#ifndef CS_IMAGE_H
#define CS_IMAGE_H

#include <stddef.h>
#include <stdint.h>

/* width 0: no image. rgb holds 3 * width * height bytes, owned by whoever made it (malloc). */
struct cs_image {
    uint32_t width, height;
    uint8_t *rgb;
    uint8_t *alpha; /* (height, width), owned likewise: rgb is not times it; NULL: all cover */
};

static inline size_t cs_image_bytes(const struct cs_image *image) {
    return 3 * (size_t)image->width * image->height;
}

#endif
