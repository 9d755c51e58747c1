/* shadow_map.h - the nearness of what casts shadow, seen from the light. */
#ifndef CS_CPU_SHADOW_MAP_H
#define CS_CPU_SHADOW_MAP_H

#include "base/arena.h"
#include "draw/cpu/triangle.h"
#include "draw/light_frustum.h"

enum {
    CS_SHADOW_MAP_BORDER = 8, /* texels of nothing around, which look-ups may touch */
    CS_SHADOW_MAP_STRIDE = CS_SHADOW_SIDE + 2 * CS_SHADOW_MAP_BORDER,
    CS_SHADOW_MAP_STRIPES = 8,
};

struct cs_shadow_map {
    struct cs_clip_transform transform;
    float texel_size;         /* m: size of a texel where things are */
    bool enabled;             /* else all is lit */
    float *depth;             /* (CS_SHADOW_MAP_STRIDE, CS_SHADOW_MAP_STRIDE) */
    float *min_max_2x2[2];    /* least and largest of 2 x 2 texels, a row of half the stride */
    float *min_6x6, *max_6x6; /* of the 6 x 6 texels from each even one on */
};

enum cs_status cs_shadow_map_init(struct cs_shadow_map *map, struct cs_arena *arena,
                                  struct cs_error *error);

/* Takes the aim from a view block (cs_light_frustum_fit). true if it has changed. */
bool cs_shadow_map_set_frustum(struct cs_shadow_map *map, const struct cs_view_block *block);

/* Draws stripe 0..CS_SHADOW_MAP_STRIPES-1 of the map: the triangles of two lists. */
void cs_shadow_map_draw(struct cs_shadow_map *map, uint32_t stripe,
                        const struct cs_triangles *fixed, const struct cs_triangles *moving);
/* Bounds of blocks, once all stripes are drawn. */
void cs_shadow_map_bound(struct cs_shadow_map *map);

/* The share of light that comes to n places (3,n), each moved by `off` texels along its normal
 * (3,n); 0 where facing <= 0. Rows of the arrays are `stride` apart. */
struct cs_shadow_query {
    const float *positions[3], *normals[3];
    const float *n_dot_l; /* normal times direction of the light */
    float *visibility;    /* out */
    int n;
};
void cs_shadow_map_sample(const struct cs_shadow_map *map, const struct cs_shadow_query *lit);

#endif
