/* shadow.h - shadow map through OpenGL: depth seen from the light. */
#ifndef CS_DRAW_SHADOW_H
#define CS_DRAW_SHADOW_H

#include "draw/view.h"

/* OpenGL names: program without colour, frame buffer, depth texture. */
struct cs_shadow {
    unsigned program, frame, texture;
};

/* Makes the map. CS_ERR_MODULE if the driver cannot. */
enum cs_status cs_shadow_init(struct cs_shadow *shadow, struct cs_error *error);

/* Starts the map: everything drawn until the next frame buffer casts shadow. */
void cs_shadow_begin(const struct cs_shadow *shadow);
/* Binds the map to texture unit 1, as the surface program samples it. */
void cs_shadow_bind(const struct cs_shadow *shadow);

#endif
