/* colour.h - colour maps of values, and the colours of lines and marks. */
#ifndef CS_DRAW_COLOUR_H
#define CS_DRAW_COLOUR_H

#include <stdint.h>

/* Sets six evenly spaced stops in linear RGB for the look's values, lowest first. Force runs
 * from dark violet over green to bright yellow. Strain, which has a sign, is blue where springs
 * are short, pale at 0 and red where they are long. Marks are red at the end. Neighbouring
 * stops differ for readers who see no green, and by lightness in grey. */
void cs_colour_stops(int32_t look, float stops[6][4]);

/* Converts 0xRRGGBB in sRGB to linear RGB, within 0.002 (colour.c). */
void cs_colour_linear(uint32_t hex, float linear[3]);

/* Sets a dark or a light ink in linear RGB, the one with more contrast to a background. */
void cs_colour_ink(const double background[3], float ink[3]);

#endif
