/* image_diff.h - how far two images are apart: the second level of the golden gate. */
#ifndef CS_DRAW_IMAGE_DIFF_H
#define CS_DRAW_IMAGE_DIFF_H

#include "base/image.h"

#include <stdbool.h>

struct cs_image_difference {
    double rmse;     /* over all channels, in levels of 0..255 */
    double share;    /* of pixels with a channel off by more than 2, in 0..1 */
    int largest;     /* difference of one channel */
    uint64_t pixels; /* that differ at all */
};

/* Sizes must be equal. */
struct cs_image_difference cs_image_compare(const struct cs_image *a, const struct cs_image *b);

/* The calibrated gate: rmse <= 0.45 and share <= 0.0005. */
bool cs_image_difference_passes(const struct cs_image_difference *difference);

/* Writes 16 times the difference around mid grey into out (same size, memory of the caller). */
void cs_image_amplify(const struct cs_image *a, const struct cs_image *b, struct cs_image *out);

#endif
