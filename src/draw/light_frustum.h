/* light_frustum.h - the frustum of the shadow map: a cone or box of light around all casters.
 */
#ifndef CS_DRAW_LIGHT_FRUSTUM_H
#define CS_DRAW_LIGHT_FRUSTUM_H

#include "draw/view.h"

enum { CS_SHADOW_SIDE = 512 }; /* texels: coarse enough to blur the edges */

/* Fits the light's frustum to the sphere `solid` of all casters. Writes world_to_light and
 * shadow_params (1 / side; texel size in m at the centre; 1 or 0: shadows on) into the view
 * block. Returns false, with shadows off, if the lamp is within 1.05 radii of the centre. */
bool cs_light_frustum_fit(const struct cs_bounding_sphere *solid, struct cs_view_block *block);

#endif
