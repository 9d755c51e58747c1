/* fragments.h - fragments, one per pixel and visible triangle, and the ground among them. */
#ifndef CS_CPU_FRAGMENTS_H
#define CS_CPU_FRAGMENTS_H

#include "draw/cpu/shadow_map.h"
#include "draw/look.h"
#include "draw/mipmap.h"
#include "draw/srgb.h"

enum { CS_FRAGMENTS = 256, CS_FRAGMENTS_PADDED = CS_FRAGMENTS + 4 };

/* A surface style (surface_style.h) in the form and precision that shading needs. */
struct cs_shading_material {
    enum cs_surface_mode mode;
    int attributes;                   /* that shading wants: see triangle.h */
    bool has_ambient_occlusion;       /* attribute 3 is the depth of a fold (mesh.h) */
    float base[2][3];                 /* linear colour of front, back */
    float ambient, diffuse, specular; /* reflection coefficients */
    int shininess_int;                /* exponent of highlights: whole part */
    int shininess_fraction;           /* and the rest in 1/256 */
    struct cs_ground_style ground;    /* pattern and haze; radius 0: none */
    float depth_bias;                 /* m by which the depth is moved away */
    struct cs_mipmap *mips;           /* borrowed; NULL without a texture */
};

/* Inputs of shading that are the same for a whole picture; all pointers are borrowed. */
struct cs_shading_context {
    struct cs_rays rays;
    int width, height;
    const struct cs_view_block *view;
    const struct cs_shadow_map *shadow_maps; /* one for each light of the view */
    const struct cs_srgb *srgb;
};

/* Fragments of one side of one surface, collected to be shaded together (structure of
 * arrays). */
struct cs_fragments {
    const struct cs_shading_material *material;
    uint32_t key; /* of the surface and side, to find the slot */
    int n, side;  /* fragments; 0: front, 1: back */
    float x[CS_FRAGMENTS_PADDED], y[CS_FRAGMENTS_PADDED]; /* pixels from the top left */
    float inverse[CS_FRAGMENTS_PADDED];                   /* 1/w */
    float view_depth[CS_FRAGMENTS]; /* m along the view, of parallel rays: they have no w */
    float attributes[CS_ATTRIBUTES][CS_FRAGMENTS_PADDED]; /* divided by w */
    struct cs_texel_footprint footprints[CS_FRAGMENTS];   /* of textured surfaces */
    uint32_t colour_index[CS_FRAGMENTS];                  /* index in `colours` of the result */
};

/* Intermediate results of cs_shade, 22 KiB. Some arrays serve twice: facing holds |n|^2 before
 * n.l, share holds the visibility or |n.v|, cover the roots of the highlight or the
 * ground's pattern before the opacity. */
struct cs_shading_work {
    float place[3][CS_FRAGMENTS], view[3][CS_FRAGMENTS], normal[3][CS_FRAGMENTS],
        light[3][CS_FRAGMENTS];
    float facing[CS_FRAGMENTS], share[CS_FRAGMENTS], shine[CS_FRAGMENTS], base[3][CS_FRAGMENTS],
        colour[3][CS_FRAGMENTS], cover[CS_FRAGMENTS];
};

/* The shadow at the first n fragments. */
CS_INLINE struct cs_shadow_query cs_shading_query(const struct cs_shading_work *w,
                                                  float *visibility, int n) {
    return (struct cs_shadow_query){.positions = {w->place[0], w->place[1], w->place[2]},
                                    .normals = {w->normal[0], w->normal[1], w->normal[2]},
                                    .n_dot_l = w->facing,
                                    .visibility = visibility,
                                    .n = n};
}

/* Changes the base colours of the ground by its pattern, which is left in `cover`. */
void cs_shade_pattern(const struct cs_shading_context *shading,
                      const struct cs_fragments *fragments, struct cs_shading_work *work);

/* Shades a ground of shadows and lines alone: ink, and its opacity in `cover`. */
void cs_shade_shadows(const struct cs_shading_context *shading,
                      const struct cs_fragments *fragments, struct cs_shading_work *work);

/* Fades the colours of the ground into the background, and dithers them; sets `cover`. */
void cs_shade_haze(const struct cs_shading_context *shading,
                   const struct cs_fragments *fragments, struct cs_shading_work *work);

/* Colour of the background in row y, linear from the upper to the lower edge; cs_shade_haze has
 * the same. */
CS_INLINE void cs_sky_colour(const struct cs_shading_context *shading, float y, float c[3]) {
    const struct cs_view_block *view = shading->view;
    for (int i = 0; i < 3; i++) {
        const float slope =
            (view->bottom_colour[i] - view->top_colour[i]) / (float)shading->height;
        c[i] = cs_clamp(view->top_colour[i] + slope * (y + 0.5f), 0, 1);
    }
}

/* The linear colour of a value, limited to 0..1, between the six stops of the colour map. */
CS_INLINE void cs_ramp_colour(const struct cs_shading_context *shading, float value,
                              float c[3]) {
    const float at = cs_clamp(value, 0, 1) * 5;
    const int low = cs_min((int)at, 4);
    const float *a = shading->view->colour_stops[low],
                *b = shading->view->colour_stops[low + 1];
    for (int k = 0; k < 3; k++)
        c[k] = a[k] + (b[k] - a[k]) * (at - (float)low);
}

/* Direction of the ray through the middle of pixel (x, y): 1 m along it is 1 m along the view.
 * For parallel rays this is the offset of the origin from the eye. */
CS_INLINE void cs_ray_direction(const struct cs_shading_context *shading, float x, float y,
                                float d[3]) {
    const struct cs_rays *r = &shading->rays;
    const float right = ((x + 0.5f) * (2 / (float)shading->width) - 1 + r->shift) * r->slope_x;
    const float up = (1 - (y + 0.5f) * (2 / (float)shading->height)) * r->slope_y;
    for (int i = 0; i < 3; i++)
        d[i] = right * r->right[i] + up * r->up[i] - (r->parallel ? 0 : r->back[i]);
}

#endif
