/* shade.h - shading: the colour of fragments. */
#ifndef CS_DRAW_SHADE_H
#define CS_DRAW_SHADE_H

#include "draw/cpu/fragments.h"

/* Fills all but mips from a style. */
void cs_shading_material_make(struct cs_shading_material *material,
                              const struct cs_surface_style *style);

/* Shades the fragments into colours[colour_index[i]], then sets n to 0. Colours are packed:
 * red, green, blue as sRGB bytes from the lowest on, and 255 - opacity in the highest. */
void cs_shade(const struct cs_shading_context *shading, struct cs_fragments *fragments,
              uint32_t *colours);

#endif
