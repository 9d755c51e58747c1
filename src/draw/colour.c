/* Holds the colours of values and of the ink, and converts sRGB to linear RGB. */
#include "draw/colour.h"

#include "scene/scene.h"

static const uint32_t force_stops[6] = {0x3b1f6b, 0x31578f, 0x1f8a8c,
                                        0x3db86f, 0xa4d742, 0xfbe84a};
static const uint32_t strain_stops[6] = {0x1d3f8f, 0x4f8fc9, 0xc3dcea,
                                         0xf3d3bd, 0xde7a55, 0x8f1626};

// marked triangles are red, all others pale
static const uint32_t mark_stops[6] = {0xd9dde2, 0xd9dde2, 0xd9dde2,
                                       0xd9dde2, 0xd9dde2, 0xd0121b};

// a cubic within 0.002 of the sRGB curve: no libm, whose last bit depends on the machine
void cs_colour_linear(uint32_t hex, float linear[3]) {
    for (int i = 0; i < 3; i++) {
        const double c = (double)(hex >> (16 - 8 * i) & 255) / 255;
        linear[i] = (float)(c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878));
    }
}

void cs_colour_stops(int32_t look, float stops[6][4]) {
    const uint32_t *table = look == CS_LOOK_STRAIN      ? strain_stops
                            : look == CS_LOOK_CROSSINGS ? mark_stops
                                                        : force_stops;
    for (int i = 0; i < 6; i++) {
        cs_colour_linear(table[i], stops[i]);
        stops[i][3] = 1;
    }
}

void cs_colour_ink(const double background[3], float ink[3]) {
    const double luminance =
        0.2126 * background[0] + 0.7152 * background[1] + 0.0722 * background[2];
    cs_colour_linear(luminance > 0.18 ? 0x1d2733 : 0xe9eef4, ink);
}
