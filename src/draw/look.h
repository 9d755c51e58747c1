/* look.h - table of looks: colours and lines of each; the style of a surface in a look.
 *
 * A new look needs: its line in CS_LOOK_LIST (scene/picture_keys.h), its row in look.c, and
 * code for anything that no look draws or measures yet. */
#ifndef CS_DRAW_LOOK_H
#define CS_DRAW_LOOK_H

#include "model/contact/posed_collider.h"

struct cs_material;

/* Source of the colours of bodies. */
enum cs_look_colours {
    CS_COLOURS_MATERIAL,  /* lit, with textures and folds */
    CS_COLOURS_FAINT,     /* pale, behind lines */
    CS_COLOURS_FORCE,     /* N */
    CS_COLOURS_STRAIN,    /* 1 */
    CS_COLOURS_STRESS,    /* N/m */
    CS_COLOURS_CROSSINGS, /* marks of triangles: 0 or 1 */
    CS_COLOURS_NORMALS,   /* x, y and z of the normal as red, green and blue */
    CS_COLOURS_UV         /* texture coordinates as red and green */
};

/* One look. */
struct cs_look_kind {
    enum cs_look_colours colours;
    const uint32_t *stops;      /* (6) colours of the map, 0xrrggbb in sRGB; NULL: no values */
    const char *title, *unit;   /* of the colour bar; NULL: no bar, and no range of values */
    double factor;              /* from values to the bar's labels */
    bool has_sign;              /* the range is symmetric about 0 */
    bool edges, springs, goals; /* lines over the surfaces */
};

/* Returns the row of a look (enum of CS_LOOK_LIST); constant. */
const struct cs_look_kind *cs_look_of(int32_t look);

/* Source of a surface's colour. */
enum cs_surface_mode {
    CS_SURFACE_PLAIN,
    CS_SURFACE_TEXTURED,
    CS_SURFACE_VALUE,
    CS_SURFACE_FAINT,
    CS_SURFACE_NORMALS,
    CS_SURFACE_UV
};

/* Pattern and haze of the ground (formulas: cpu/shade.c). Zeroed: the surface is no ground. */
struct cs_ground_style {
    float centre[2], radius; /* m: x and z of the middle; distance where the haze hides all */
    float normal[3];
    float tile;   /* m: side of a square, or between lines; 0: plain */
    bool lines;   /* thin lines instead of light and dark squares */
    float ink[3]; /* linear RGB of lines, and of shadows on a ground of nothing else */
    float shadow; /* opacity of these shadows; 0: a lit surface */
};

/* Style of a body or a collider (formulas: cpu/shade.c). */
struct cs_surface_style {
    enum cs_surface_mode mode;
    unsigned texture;                             /* OpenGL name */
    double front_colour[3], back_colour[3];       /* linear RGB */
    double ambient, diffuse, specular, shininess; /* Blinn-Phong */
    double depth_bias;                            /* m by which the depth is moved away */
    bool has_ambient_occlusion;                   /* values darken ambient light (mesh.h) */
    struct cs_ground_style ground;
};

/* Returns whether a body's vertices need texture coordinates: for its texture, or the look uv.
 */
bool cs_look_needs_uv(int32_t look, bool textured);

/* Returns how often they repeat over a body (2): once in the look uv. */
const double *cs_look_repeat(int32_t look, const struct cs_material *material);

/* Fills the style of a body for a look, but for its texture. */
void cs_style_cloth(struct cs_surface_style *style, const struct cs_material *material,
                    bool textured, int32_t look);

/* Fills the style of a collider below cloth with cells of `cell` m: the depth of a curved one
 * is biased by the depth of a chord. */
void cs_style_solid(struct cs_surface_style *style, const struct cs_posed_collider *collider,
                    double cell);

#endif
