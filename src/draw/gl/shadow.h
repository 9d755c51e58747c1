/* shadow.h - the depth seen from the light, of cloth and spheres. */
#ifndef CS_DRAW_SHADOW_H
#define CS_DRAW_SHADOW_H

#include "draw/view.h"

struct cs_shadow {
    unsigned program, frame, texture;
};

enum cs_status cs_shadow_init(struct cs_shadow *shadow, struct cs_error *error);

/* Between begin and the next target, what is drawn casts shadow. */
void cs_shadow_begin(const struct cs_shadow *shadow);
/* Gives the depth to the surface program. */
void cs_shadow_bind(const struct cs_shadow *shadow);

#endif
