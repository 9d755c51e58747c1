/* Compares two images for the second level of the golden image gate. */
#include "shared/image_diff.h"

#include "base/status.h"

#include <math.h>
#include <stdlib.h>

struct cs_image_difference cs_image_compare(const struct cs_image *a,
                                            const struct cs_image *b) {
    CS_ASSERT(a->width == b->width && a->height == b->height);
    const uint64_t pixels = (uint64_t)a->width * a->height;
    struct cs_image_difference difference = {0};
    /* sums of integers, which are exact for pictures of any size */
    uint64_t squares = 0, far = 0;
    for (uint64_t i = 0; i < pixels; i++) {
        int most = 0;
        for (uint64_t k = 3 * i; k < 3 * i + 3; k++) {
            const int off = abs(a->rgb[k] - b->rgb[k]);
            squares += (uint64_t)(off * off);
            most = off > most ? off : most;
        }
        difference.pixels += most > 0;
        /* up to 2 levels count as rounding; rmse sees them all the same */
        far += most > 2;
        difference.largest = most > difference.largest ? most : difference.largest;
    }
    if (pixels) {
        difference.rmse = sqrt((double)squares / (3 * (double)pixels));
        difference.share = (double)far / (double)pixels;
    }
    return difference;
}

/* Calibrated on the same Mesa with other CPU instructions, which must pass (rmse 0.23, share
 * 0.0001 at most), and on a light moved by 2.5 %, which must fail (0.70 and 0.0008). */
bool cs_image_difference_passes(const struct cs_image_difference *difference) {
    return difference->rmse <= 0.45 && difference->share <= 0.0005;
}

void cs_image_amplify(const struct cs_image *a, const struct cs_image *b,
                      struct cs_image *out) {
    CS_ASSERT(a->width == b->width && a->height == b->height);
    const uint64_t bytes = 3 * (uint64_t)a->width * a->height;
    out->width = a->width;
    out->height = a->height;
    for (uint64_t i = 0; i < bytes; i++) {
        const int grey = 128 + 16 * (b->rgb[i] - a->rgb[i]);
        out->rgb[i] = (uint8_t)(grey < 0 ? 0 : grey > 255 ? 255 : grey);
    }
}
