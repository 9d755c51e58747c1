/* aim.h - where the light's picture of the scene is taken from. */
#ifndef CS_DRAW_AIM_H
#define CS_DRAW_AIM_H

#include "draw/view.h"

enum { CS_SHADOW_SIDE = 512 }; /* pixels: coarse enough to blur the edges */

/* Aims the light at `solid`: writes its matrix and `shade` into the view block. false where the
 * lamp hangs so near that there is no shadow. */
bool cs_shadow_aim(const struct cs_ball *solid, struct cs_view_block *block);

#endif
