/* srgb.c - tables of the sRGB curve by Newton's method, and colours with transparency. */
#include "draw/srgb.h"

#include "draw/look.h"

/* y^2.4 = y^2 (y^2)^(1/5) for y in 0..1. Newton's iteration for r^5 = y^2 is
 *   r' = (4 r + y^2 / r^4) / 5.
 * From r = 1, above the root, it falls by at most a fifth per step until it is near. */
static double power_2_4(double y) {
    const double square = y * y;
    double root = 1;
    if (y <= 0)
        return 0;
    // then digits double; the smallest y in use is 0.09, so 80 steps are ample
    for (int k = 0; k < 80; k++)
        root = (4 * root + square / (root * root * root * root)) / 5;
    return square * root;
}

static double decode(double c) {
    return c <= 0.04045 ? c / 12.92 : power_2_4((c + 0.055) / 1.055);
}

void cs_srgb_make(struct cs_srgb *srgb) {
    srgb->threshold[0] = -1;
    srgb->threshold[256] = srgb->threshold[257] = 2;
    for (int byte = 0; byte < 256; byte++) {
        srgb->linear[byte] = (float)decode(byte / 255.0);
        if (byte > 0)
            srgb->threshold[byte] = (float)decode((byte - 0.5) / 255);
    }
    int byte = 0;
    for (int i = 0; i <= 4097; i++) {
        while (byte < 255 && srgb->threshold[byte + 1] <= (float)i / 4096)
            byte++;
        srgb->segment_start[i] = (uint8_t)byte;
    }
}

uint32_t cs_srgb_blend_rows(uint32_t under, uint32_t over, uint32_t share) {
    // weights in units of 1 / (255 * 255): a = share / 255, b = 1 - transparency / 255
    const uint32_t above = 255 * share, below = (255 - (under >> 24)) * (255 - share);
    const uint32_t whole = above + below;
    uint32_t out = (255 - (whole + 127) / 255) << 24;
    for (int k = 0; k < 24 && whole; k += 8)
        out |= (((under >> k & 255) * below + (over >> k & 255) * above + whole / 2) / whole)
               << k;
    return out;
}

uint32_t cs_srgb_mean_clear(const struct cs_srgb *srgb, const uint32_t samples[CS_SAMPLES]) {
    float light[3] = {0, 0, 0};
    uint32_t whole = 0;
    for (int s = 0; s < CS_SAMPLES; s++) {
        const uint32_t cover = 255 - (samples[s] >> 24);
        whole += cover;
        for (int k = 0; k < 3; k++)
            light[k] += (float)cover * srgb->linear[samples[s] >> 8 * k & 255];
    }
    if (!whole)
        return 0xff000000;
    for (int k = 0; k < 3; k++) {
        const float mean = light[k] / (float)whole;
        light[k] = mean < 1 ? mean : 1;
    }
    return cs_srgb_pack(srgb, light[0], light[1], light[2]) |
           (255 - (whole + CS_SAMPLES / 2) / CS_SAMPLES) << 24;
}

uint32_t cs_srgb_blend_on_white(const struct cs_srgb *srgb, uint32_t colour) {
    const float clear = (float)(colour >> 24);
    float light[3];
    for (int k = 0; k < 3; k++)
        light[k] = (clear + (255 - clear) * srgb->linear[colour >> 8 * k & 255]) / 255;
    return cs_srgb_pack(srgb, light[0], light[1], light[2]);
}

/* Mean of the linear light in a box (left, top, right, bottom) of a picture, by area. */
static void shrink_pixel(const struct cs_srgb *srgb, const struct cs_image *image,
                         const double box[4], uint8_t out[3]) {
    double light[3] = {0}, area = 0;
    for (uint32_t y = (uint32_t)box[1]; y < image->height && y < box[3]; y++)
        for (uint32_t x = (uint32_t)box[0]; x < image->width && x < box[2]; x++) {
            const double share = (fmin(x + 1, box[2]) - fmax(x, box[0])) *
                                 (fmin(y + 1, box[3]) - fmax(y, box[1]));
            const size_t i = (size_t)y * image->width + x;
            const double cover = image->alpha ? image->alpha[i] / 255.0 : 1;
            for (int k = 0; k < 3; k++)
                light[k] +=
                    share * (1 - cover + cover * (double)srgb->linear[image->rgb[3 * i + k]]);
            area += share;
        }
    for (int k = 0; k < 3; k++)
        out[k] = (uint8_t)cs_srgb_encode(srgb, (float)fmin(light[k] / area, 1));
}

void cs_srgb_shrink(const struct cs_srgb *srgb, const struct cs_image *image,
                    const uint32_t size[2], size_t first, const struct cs_image *paper) {
    const double sx = (double)image->width / size[0], sy = (double)image->height / size[1];
    for (uint32_t y = 0; y < size[1]; y++)
        for (uint32_t x = 0; x < size[0]; x++) {
            const double box[4] = {x * sx, y * sy, (x + 1) * sx, (y + 1) * sy};
            shrink_pixel(srgb, image, box,
                         paper->rgb + 3 * (first + (size_t)y * paper->width + x));
        }
}

/* Colour maps of looks, the ink of lines, and a conversion from sRGB to linear RGB. */

// a cubic within 0.002 of the sRGB curve: + and * only, since libm's last bits differ by
// machine
void cs_colour_linear(uint32_t hex, float linear[3]) {
    for (int i = 0; i < 3; i++) {
        const double c = (double)(hex >> (16 - 8 * i) & 255) / 255;
        linear[i] = (float)(c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878));
    }
}

void cs_colour_stops(int32_t look, bool green_red, float stops[6][4]) {
    static const uint32_t from_green[6] = {0x1a9641, 0x77c35c, 0xc4e687,
                                           0xfecf7a, 0xf07c4a, 0xd7191c};
    const struct cs_look_kind *kind = cs_look_of(look);
    const uint32_t *table = green_red && kind->title ? from_green : kind->stops;
    for (int i = 0; i < 6; i++) {
        cs_colour_linear(table ? table[i] : 0, stops[i]);
        stops[i][3] = 1;
    }
}

// luminance of linear RGB in the primaries of sRGB (Y of IEC 61966-2-1), against a middle grey
void cs_colour_ink(const double background[3], float ink[3]) {
    const double luminance =
        0.2126 * background[0] + 0.7152 * background[1] + 0.0722 * background[2];
    cs_colour_linear(luminance > 0.18 ? 0x1d2733 : 0xe9eef4, ink);
}
