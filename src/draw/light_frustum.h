/* light_frustum.h - where the light's picture of the scene is taken from. */
#ifndef CS_DRAW_LIGHT_FRUSTUM_H
#define CS_DRAW_LIGHT_FRUSTUM_H

#include "draw/view.h"

enum { CS_SHADOW_SIDE = 512 }; /* pixels: coarse enough to blur the edges */

/* Aims the light at `solid`: writes its matrix and `shade` into the view block. false where the
 * lamp hangs so near that there is no shadow. */
bool cs_light_frustum_fit(const struct cs_bounding_sphere *solid, struct cs_view_block *block);

#endif
