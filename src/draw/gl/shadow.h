/* shadow.h - the depth seen from the light, of cloth and spheres. */
#ifndef CS_DRAW_SHADOW_H
#define CS_DRAW_SHADOW_H

#include "draw/gl/view.h"

struct cs_shadow {
    unsigned program, frame, texture;
    int model;
};

enum cs_status cs_shadow_init(struct cs_shadow *shadow, struct cs_error *error);

/* Aims the light at `solid`: writes its matrix and `shade` into the view block. false where the
 * lamp hangs so near that there is no shadow. */
bool cs_shadow_aim(const struct cs_ball *solid, struct cs_view_block *block);

/* Between begin and the next target, what is drawn with `model` in use casts shadow. */
void cs_shadow_begin(const struct cs_shadow *shadow);
/* Gives the depth to the surface program. */
void cs_shadow_bind(const struct cs_shadow *shadow);

#endif
