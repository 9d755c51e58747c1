/* colour.h - the colours of values, springs and marks. */
#ifndef CS_DRAW_COLOUR_H
#define CS_DRAW_COLOUR_H

#include <stdint.h>

/* Six evenly spaced stops in linear RGB for the look's values, lowest first: green over yellow
 * and orange to red for force (cloth thesis, fig. 6.2), violet over green to yellow for strain,
 * and red at the end for marks. */
void cs_colour_stops(int32_t look, float stops[6][4]);

/* From 0xRRGGBB in sRGB to linear RGB. */
void cs_colour_linear(uint32_t hex, float linear[3]);

/* Dark or light ink in linear RGB, whichever reads better on a background. */
void cs_colour_ink(const double background[3], float ink[3]);

#endif
