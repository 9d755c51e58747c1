/* colour.h - the colours of values, springs and marks. */
#ifndef CS_DRAW_COLOUR_H
#define CS_DRAW_COLOUR_H

#include <stdint.h>

/* Six evenly spaced stops in linear RGB for the look's values, lowest first. Force grows from
 * dark violet over green to bright yellow; strain, which has a sign, is blue where springs are
 * short, pale at 0 and red where they are long; marks are red at the end. Stops beside each
 * other are told apart by readers who see no green, and in grey by their lightness. */
void cs_colour_stops(int32_t look, float stops[6][4]);

/* From 0xRRGGBB in sRGB to linear RGB. */
void cs_colour_linear(uint32_t hex, float linear[3]);

/* Dark or light ink in linear RGB, whichever reads better on a background. */
void cs_colour_ink(const double background[3], float ink[3]);

#endif
