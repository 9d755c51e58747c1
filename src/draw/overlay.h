/* overlay.h - all lines of a picture: springs, edges, marks, and the colour bar. */
#ifndef CS_DRAW_OVERLAY_H
#define CS_DRAW_OVERLAY_H

#include "draw/glyph.h"
#include "draw/render.h"
#include "model/system/particle_system.h"

/* The lines of a scene's pictures. */
struct cs_overlay {
    const struct cs_system *system; /* borrowed */
    double line_unit;               /* pixels of a line of width 1: 1/480 of the height */
    double cell;                    /* pixels between neighbours at the camera's target */
    double depth_offset;            /* m by which lines are moved towards the eye */
    uint8_t *rim; /* (n) held particles with a free neighbour, of the last picture */
    struct cs_colour_bar colour_bar;
    const uint8_t *marks;   /* of the canvas settings, which its owner sets; NULL: none */
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
