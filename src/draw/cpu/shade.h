/* shade.h - the colour of fragments: what a pixel shows of one triangle. */
#ifndef CS_DRAW_SHADE_H
#define CS_DRAW_SHADE_H

#include "draw/cpu/shadow_map.h"
#include "draw/mipmap.h"
#include "draw/srgb.h"
#include "draw/surface_style.h"

enum { CS_FRAGMENTS = 256 };

/* The style of a surface in the numbers that shading needs. */
struct cs_shading_material {
    enum cs_surface_mode mode;
    int attributes;             /* that shading wants: see clip_project.h */
    bool has_ambient_occlusion; /* the value is that of a fold */
    float base[2][3];           /* front, back */
    float ambient, diffuse, specular;
    int shininess_int;      /* whole part of the exponent of highlights */
    int shininess_fraction; /* the rest of it in 1/256 */
    float fade_radius;      /* m about the origin where it has melted; 0: none */
    float depth_bias;       /* m by which the depth is moved away */
    struct cs_mipmap *mips;
};

void cs_shading_material_make(struct cs_shading_material *coat,
                              const struct cs_surface_style *style);

/* What shading looks at: all the same for a picture. */
struct cs_shading_context {
    struct cs_rays rays;
    int width, height;
    const struct cs_view_block *view;
    const struct cs_shadow_map *shadow_map;
    const struct cs_srgb *srgb;
};

/* Fragments of one side of one surface, shaded together. */
struct cs_fragments {
    const struct cs_shading_material *material;
    uint32_t key;
    int n, side;
    float x[CS_FRAGMENTS], y[CS_FRAGMENTS]; /* pixels from the top left */
    float inverse[CS_FRAGMENTS];            /* 1/w */
    float view_depth[CS_FRAGMENTS]; /* m along the view, of parallel rays: they have no w */
    float attributes[CS_ATTRIBUTES][CS_FRAGMENTS]; /* over w */
    float texels[CS_FRAGMENTS];                    /* a pixel, squared, of textured ones */
    uint32_t colour_index[CS_FRAGMENTS];           /* where their colour goes */
};

/* Colours: bytes of sRGB from red on; the highest is how much they let through. Forgets the
 * fragments. */
void cs_shade(const struct cs_shading_context *shading, struct cs_fragments *fragments,
              uint32_t *colours);

/* The ray through the middle of a pixel: 1 m along it is 1 m along the view. Of parallel rays
 * where it starts, from the eye on. */
CS_INLINE void cs_ray_direction(const struct cs_shading_context *shading, float x, float y,
                                float d[3]) {
    const struct cs_rays *r = &shading->rays;
    const float right = ((x + 0.5f) * (2 / (float)shading->width) - 1) * r->slope_x;
    const float up = (1 - (y + 0.5f) * (2 / (float)shading->height)) * r->slope_y;
    for (int i = 0; i < 3; i++)
        d[i] = right * r->right[i] + up * r->up[i] - (r->parallel ? 0 : r->back[i]);
}

/* The place t m along the ray through the middle of a pixel. */
CS_INLINE void cs_ray_point(const struct cs_shading_context *shading, float x, float y, float t,
                            float place[3]) {
    const struct cs_rays *r = &shading->rays;
    float d[3];
    cs_ray_direction(shading, x, y, d);
    for (int i = 0; i < 3; i++)
        place[i] = r->parallel ? r->eye[i] + d[i] - t * r->back[i] : r->eye[i] + t * d[i];
}

#endif
