/* surface_style.h - how a surface looks, whatever draws it. */
#ifndef CS_DRAW_SURFACE_STYLE_H
#define CS_DRAW_SURFACE_STYLE_H

#include "draw/mesh.h"
#include "model/contact/posed_collider.h"
#include "scene/scene.h"

enum cs_surface_mode {
    CS_SURFACE_PLAIN,
    CS_SURFACE_TEXTURED,
    CS_SURFACE_VALUE,
    CS_SURFACE_FAINT
};

struct cs_surface_style {
    enum cs_surface_mode mode;
    unsigned texture;                       /* the renderer's name of it */
    double front_colour[3], back_colour[3]; /* linear RGB */
    double ambient, diffuse, specular, shininess;
    double depth_bias;          /* m by which the depth is moved away */
    bool has_ambient_occlusion; /* values darken ambient light (mesh.h) */
    double fade_radius;         /* m about the origin where it has melted; 0: none */
};

/* The style of a body, but for its texture. */
void cs_style_cloth(struct cs_surface_style *style, const struct cs_material *material,
                    bool textured, int32_t look);

/* The style of a collider under cloth as coarse as `cell` (m): what is curved is sunk. */
void cs_style_solid(struct cs_surface_style *style, const struct cs_posed_collider *collider,
                    double cell);

#endif
