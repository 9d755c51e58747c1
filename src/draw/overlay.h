/* overlay.h - all lines of a picture: springs, edges, marks, and the colour bar. */
#ifndef CS_DRAW_OVERLAY_H
#define CS_DRAW_OVERLAY_H

#include "draw/colour_bar.h"
#include "draw/render.h"
#include "draw/wireframe.h"

struct cs_overlay {
    struct cs_wireframe wireframe;
    struct cs_colour_bar colour_bar;
    struct cs_lines *lines; /* borrowed: a renderer's, with its calls set */
};

/* pixels_per_m: where the camera looks. Takes the lines' memory from the arena. */
enum cs_status cs_overlay_init(struct cs_overlay *overlay, const struct cs_system *system,
                               double pixels_per_m, struct cs_lines *lines,
                               struct cs_arena *arena, struct cs_error *error);

/* Once the camera has moved. */
void cs_overlay_aim(struct cs_overlay *overlay, double pixels_per_m);

/* Draws them in the order in which they lie over each other. */
void cs_overlay_draw(const struct cs_overlay *overlay, const struct cs_frame *frame);

/* The surface of a body gives way to what lies behind it. */
bool cs_overlay_hides(const struct cs_scene *scene, uint32_t body);

#endif
