/* overlay.h - all lines of a picture: springs, edges, marks, and the colour bar. */
#ifndef CS_DRAW_OVERLAY_H
#define CS_DRAW_OVERLAY_H

#include "draw/colour_bar.h"
#include "draw/render.h"
#include "draw/wireframe.h"

/* The lines of a scene's pictures. */
struct cs_overlay {
    struct cs_wireframe wireframe;
    struct cs_colour_bar colour_bar;
    struct cs_lines *lines; /* borrowed: a renderer's, with its calls set */
};

/* pixels_per_m: at the camera's target. Allocates the lines from the arena. CS_ERR_MEMORY. */
enum cs_status cs_overlay_init(struct cs_overlay *overlay, const struct cs_system *system,
                               double pixels_per_m, struct cs_lines *lines,
                               struct cs_arena *arena, struct cs_error *error);

/* Takes a new scale after the camera has moved. */
void cs_overlay_aim(struct cs_overlay *overlay, double pixels_per_m);

/* Draws all lines of a frame, from back to front. */
void cs_overlay_draw(const struct cs_overlay *overlay, const struct cs_frame *frame);

/* Returns true if a body's surface is not drawn, to show what lies behind it. */
bool cs_overlay_hides(const struct cs_scene *scene, uint32_t body);

#endif
