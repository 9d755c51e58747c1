/* lightmap.h - the nearness of what casts shadow, seen from the light. */
#ifndef CS_DRAW_LIGHTMAP_H
#define CS_DRAW_LIGHTMAP_H

#include "base/arena.h"
#include "draw/aim.h"
#include "draw/cpu/triangle.h"

enum {
    CS_MAP_EDGE = 8, /* texels of nothing around, which look-ups may touch */
    CS_MAP_STRIDE = CS_SHADOW_SIDE + 2 * CS_MAP_EDGE,
    CS_MAP_STRIPES = 8,
};

struct cs_lightmap {
    struct cs_lens lens;
    float texel;            /* m: size of a texel where things are */
    bool present;           /* else all is lit */
    float *nearest;         /* (CS_MAP_STRIDE, CS_MAP_STRIDE) */
    float *coarse[2];       /* least and largest of 2 x 2 texels, a row of half the stride */
    float *least, *largest; /* of the 6 x 6 texels from each even one on */
};

enum cs_status cs_lightmap_init(struct cs_lightmap *map, struct cs_arena *arena,
                                struct cs_error *error);

/* Takes the aim from a view block (cs_shadow_aim). true if it has changed. */
bool cs_lightmap_aim(struct cs_lightmap *map, const struct cs_view_block *block);

/* Draws stripe 0..CS_MAP_STRIPES-1 of the map: the triangles of two lists. */
void cs_lightmap_draw(struct cs_lightmap *map, uint32_t stripe,
                      const struct cs_triangles *fixed, const struct cs_triangles *moving);
/* Bounds of blocks, once all stripes are drawn. */
void cs_lightmap_bound(struct cs_lightmap *map);

/* The share of light that comes to n places (3,n), each moved by `off` texels along its normal
 * (3,n); 0 where facing <= 0. Rows of the arrays are `stride` apart. */
struct cs_lit {
    const float *places[3], *normals[3];
    const float *facing; /* normal times direction of the light */
    float *share;        /* out */
    int n;
};
void cs_lightmap_look(const struct cs_lightmap *map, const struct cs_lit *lit);

#endif
