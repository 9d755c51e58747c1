/* shadow_map.h - shadow map: reversed depth of all casters as seen from the light. */
#ifndef CS_CPU_SHADOW_MAP_H
#define CS_CPU_SHADOW_MAP_H

#include "base/arena.h"
#include "draw/cpu/triangle.h"
#include "draw/view.h"

enum {
    CS_SHADOW_MAP_BORDER = 8, /* empty texels on each side, which samples may touch */
    CS_SHADOW_MAP_STRIDE = CS_SHADOW_SIDE + 2 * CS_SHADOW_MAP_BORDER, /* texels per row */
    CS_SHADOW_MAP_STRIPES = 8, /* parts of the map that threads draw independently */
};

/* Arrays are of the arena given to cs_shadow_map_init. Index 0 of `depth` is the border's first
 * texel. Values are reversed depth: greater is nearer to the light, 0 is empty. */
struct cs_shadow_map {
    struct cs_clip_transform transform; /* world to the light's clip space */
    float texel_size;         /* m: side of a texel at the distance of the casters' centre */
    bool enabled;             /* false: no shadow, all surfaces that face the light are lit */
    float *depth;             /* (CS_SHADOW_MAP_STRIDE, CS_SHADOW_MAP_STRIDE) */
    float *min_8x8, *max_8x8; /* of 8 x 8 texels whose first row and column are even; rows of
                                 STRIDE / 2 */
};

/* Allocates the arrays from the arena. Fails with CS_ERR_MEMORY. */
enum cs_status cs_shadow_map_init(struct cs_shadow_map *map, struct cs_arena *arena,
                                  struct cs_error *error);

/* Takes the light frustum of a light (fit_light_frustum). Returns true if it changed
 * and shadows are on: the lists of casters must then be projected again. */
bool cs_shadow_map_set_frustum(struct cs_shadow_map *map, const struct cs_view_light *light);

/* Draws stripe 0..CS_SHADOW_MAP_STRIPES-1 of the map from the triangles of two lists. Stripes
 * share no texel, so threads may draw them at the same time. */
void cs_shadow_map_draw(struct cs_shadow_map *map, uint32_t stripe,
                        const struct cs_triangles lists[2]);
/* Computes the bounds of blocks; call it after all stripes are drawn. */
void cs_shadow_map_bound(struct cs_shadow_map *map);

/* Query for n positions (3,n) in m. Each is moved along its unit normal (3,n) before the test,
 * against self-shadowing; visibility is the lit fraction 0..1, 0 if n_dot_l <= 0. */
struct cs_shadow_query {
    const float *positions[3], *normals[3];
    const float *n_dot_l; /* normal times direction of the light */
    float *visibility;    /* out */
    int n;
};
/* Fills lit->visibility. */
void cs_shadow_map_sample(const struct cs_shadow_map *map, const struct cs_shadow_query *query);

#endif
