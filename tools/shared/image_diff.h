/* image_diff.h - difference of two images: the second level of the golden image gate. */
#ifndef CS_DRAW_IMAGE_DIFF_H
#define CS_DRAW_IMAGE_DIFF_H

#include "base/image.h"

#include <stdbool.h>

/* Measures of a difference. */
struct cs_image_difference {
    double rmse;     /* over all channels, in levels of 0..255 */
    double share;    /* fraction of pixels with a channel off by more than 2 */
    int largest;     /* greatest difference of a channel, in levels */
    uint64_t pixels; /* number of pixels that differ at all */
};

/* Compares the RGB of two images of equal size. */
struct cs_image_difference cs_image_compare(const struct cs_image *a, const struct cs_image *b);

/* Returns true within the calibrated gate: rmse <= 0.45 and share <= 0.0005 (image_diff.c). */
bool cs_image_difference_passes(const struct cs_image_difference *difference);

/* Writes 16 times the difference around mid grey into out (same size, memory of the caller). */
void cs_image_amplify(const struct cs_image *a, const struct cs_image *b, struct cs_image *out);

#endif
