/* surface_style.h - appearance of a surface, independent of the renderer. */
#ifndef CS_DRAW_SURFACE_STYLE_H
#define CS_DRAW_SURFACE_STYLE_H

#include "draw/mesh.h"
#include "model/contact/posed_collider.h"
#include "scene/scene.h"

/* Source of a surface's colour. */
enum cs_surface_mode {
    CS_SURFACE_PLAIN,
    CS_SURFACE_TEXTURED,
    CS_SURFACE_VALUE,
    CS_SURFACE_FAINT
};

/* Style of a body or a collider (formulas: cpu/shade.c). */
struct cs_surface_style {
    enum cs_surface_mode mode;
    unsigned texture;                             /* OpenGL name */
    double front_colour[3], back_colour[3];       /* linear RGB */
    double ambient, diffuse, specular, shininess; /* Blinn-Phong */
    double depth_bias;                            /* m by which the depth is moved away */
    bool has_ambient_occlusion;                   /* values darken ambient light (mesh.h) */
    double fade_radius; /* m from the y axis where it has faded out; 0: never */
};

/* Fills the style of a body for a look, but for its texture. */
void cs_style_cloth(struct cs_surface_style *style, const struct cs_material *material,
                    bool textured, int32_t look);

/* Fills the style of a collider below cloth with cells of `cell` m: the depth of a curved one
 * is biased by the depth of a chord. */
void cs_style_solid(struct cs_surface_style *style, const struct cs_posed_collider *collider,
                    double cell);

#endif
