/* Holds the colours of the ink, and converts sRGB to linear RGB. */
#include "draw/colour.h"

#include "draw/look.h"

// a cubic within 0.002 of the sRGB curve: no libm, whose last bit depends on the machine
void cs_colour_linear(uint32_t hex, float linear[3]) {
    for (int i = 0; i < 3; i++) {
        const double c = (double)(hex >> (16 - 8 * i) & 255) / 255;
        linear[i] = (float)(c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878));
    }
}

void cs_colour_stops(int32_t look, float stops[6][4]) {
    const uint32_t *table = cs_look_of(look)->stops;
    for (int i = 0; i < 6; i++) {
        cs_colour_linear(table ? table[i] : 0, stops[i]);
        stops[i][3] = 1;
    }
}

void cs_colour_ink(const double background[3], float ink[3]) {
    const double luminance =
        0.2126 * background[0] + 0.7152 * background[1] + 0.0722 * background[2];
    cs_colour_linear(luminance > 0.18 ? 0x1d2733 : 0xe9eef4, ink);
}
