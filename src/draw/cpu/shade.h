/* shade.h - the colour of fragments: what a pixel shows of one triangle. */
#ifndef CS_DRAW_SHADE_H
#define CS_DRAW_SHADE_H

#include "draw/cpu/lightmap.h"
#include "draw/mips.h"
#include "draw/style.h"
#include "draw/tone.h"

enum { CS_FRAGMENTS = 256 };

/* The style of a surface in the numbers that shading needs. */
struct cs_coat {
    enum cs_surface_mode mode;
    int attributes;   /* that shading wants: see lens.h */
    bool folds;       /* the value is that of a fold */
    float base[2][3]; /* front, back */
    float ambient, diffuse, specular;
    int shine;      /* whole part of the exponent of highlights */
    int shine_part; /* the rest of it in 1/256 */
    float fade;     /* m about the origin where it has melted; 0: none */
    float sink;     /* m by which the depth is moved away */
    struct cs_mips *mips;
};

void cs_coat_make(struct cs_coat *coat, const struct cs_surface_style *style);

/* What shading looks at: all the same for a picture. */
struct cs_easel {
    struct cs_rays rays;
    int width, height;
    const struct cs_view_block *view;
    const struct cs_lightmap *lightmap;
    const struct cs_tone *tone;
};

/* Fragments of one side of one surface, shaded together. */
struct cs_fragments {
    const struct cs_coat *coat;
    uint32_t key;
    int n, side;
    float x[CS_FRAGMENTS], y[CS_FRAGMENTS]; /* pixels from the top left */
    float inverse[CS_FRAGMENTS];            /* 1/w */
    float along[CS_FRAGMENTS]; /* m along the view, of parallel rays: they have no w */
    float attributes[CS_ATTRIBUTES][CS_FRAGMENTS]; /* over w */
    float texels[CS_FRAGMENTS];                    /* a pixel, squared, of textured ones */
    uint32_t out[CS_FRAGMENTS];                    /* where their colour goes */
};

/* Colours: bytes of sRGB from red on; the highest is how much they let through. Forgets the
 * fragments. */
void cs_shade(const struct cs_easel *easel, struct cs_fragments *fragments, uint32_t *colours);

/* The ray through the middle of a pixel: 1 m along it is 1 m along the view. Of parallel rays
 * where it starts, from the eye on. */
CS_INLINE void cs_rays_through(const struct cs_easel *easel, float x, float y, float d[3]) {
    const struct cs_rays *r = &easel->rays;
    const float right = ((x + 0.5f) * (2 / (float)easel->width) - 1) * r->slope_x;
    const float up = (1 - (y + 0.5f) * (2 / (float)easel->height)) * r->slope_y;
    for (int i = 0; i < 3; i++)
        d[i] = right * r->right[i] + up * r->up[i] - (r->parallel ? 0 : r->back[i]);
}

/* The place t m along the ray through the middle of a pixel. */
CS_INLINE void cs_rays_place(const struct cs_easel *easel, float x, float y, float t,
                             float place[3]) {
    const struct cs_rays *r = &easel->rays;
    float d[3];
    cs_rays_through(easel, x, y, d);
    for (int i = 0; i < 3; i++)
        place[i] = r->parallel ? r->eye[i] + d[i] - t * r->back[i] : r->eye[i] + t * d[i];
}

#endif
