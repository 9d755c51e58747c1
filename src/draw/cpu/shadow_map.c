/* shadow_map.c - shadow map (Williams 1978) with 5 x 5 taps a texel apart, each blended from
 * four comparisons (percentage closer filtering, Reeves 1987).
 *
 * The taps of a row weigh 1, 2, 3, 2 and 1. A tap at t of weight w adds w max(0, 1 - |k - t|)
 * to the weight of texel k. Their sum is the tent max(0, 3 - |k - x|) about the middle tap x,
 * so the border of a shadow is a smooth curve without steps. The weights of all 25 are products
 * of a row's and a column's, with sum 81: V = (1/81) sum_kl a_k b_l [depth_kl <= nearness] The
 * taps reach from x - 2 to x + 2. They touch the texels floor(x) - 2 to floor(x) + 3, a window
 * of 6 x 6.
 *
 * Min/max bounds decide most queries: if the window's maximum is no nearer than the position, V
 * is 1; if its minimum is nearer, V is 0. A 6 x 6 window starts at an even or an odd texel;
 * blocks of 8 x 8 texels from each even one contain both, at a quarter of the memory.
 *
 * Self-shadowing: a plane whose normal makes the angle a with the light rises by d tan a over d
 * texels. A position moved by o along the normal is o / cos a above its plane, as measured
 * along the light. It clears texels up to d = o / sin a, and a window reaches d = 2 + 1 along
 * a row, 4.2 along a diagonal. The normal is interpolated: if it leans by b from that of the
 * triangle, d = o cos b / sin(a + b). project() moves by (1.9 + 5 sin a) texels, which clears
 * the diagonal for b up to 24 degrees at a = 0 and 31 degrees from a = 30 degrees on.
 */
#include "draw/cpu/shadow_map.h"

#include "draw/cpu/raster.h"

#include <math.h>
#include <string.h>

enum { HALF = CS_SHADOW_MAP_STRIDE / 2, BLOCK = 64 };

enum cs_status cs_shadow_map_init(struct cs_shadow_map *map, struct cs_arena *arena,
                                  struct cs_error *error) {
    const size_t all = (size_t)CS_SHADOW_MAP_STRIDE * CS_SHADOW_MAP_STRIDE,
                 half = (size_t)HALF * HALF;
    // four floats at once may be written past the last row
    float *memory = cs_arena_alloc_array(arena, all + 2 * half + 8, sizeof *memory, error);
    if (!memory)
        return error->status;
    map->depth = memory;
    map->min_8x8 = memory + all;
    map->max_8x8 = map->min_8x8 + half;
    return CS_OK;
}

bool cs_shadow_map_set_frustum(struct cs_shadow_map *map, const struct cs_view_light *light) {
    const struct cs_shadow_map old = *map;
    map->enabled = light->shadow_params[2] > 0;
    if (!map->enabled)
        return false;
    // the frustum of a lamp starts at a positive distance: half of it still keeps w above 0
    const bool is_lamp = light->place[3] > 0;
    cs_clip_transform_make(&map->transform, light->world_to_light, is_lamp ? 1e-6f : 0,
                           CS_SHADOW_SIDE, CS_SHADOW_SIDE);
    map->texel_size = light->shadow_params[1];
    return !old.enabled || memcmp(&old.transform, &map->transform, sizeof map->transform) != 0;
}

void cs_shadow_map_draw(struct cs_shadow_map *map, uint32_t stripe,
                        const struct cs_triangles lists[2]) {
    enum { ROWS = CS_SHADOW_SIDE / CS_SHADOW_MAP_STRIPES };
    const int top = (int)stripe * ROWS;
    float *first =
        map->depth + CS_SHADOW_MAP_BORDER * CS_SHADOW_MAP_STRIDE + CS_SHADOW_MAP_BORDER;
    memset(first - CS_SHADOW_MAP_BORDER + (size_t)top * CS_SHADOW_MAP_STRIDE, 0,
           sizeof(float) * ROWS * CS_SHADOW_MAP_STRIDE);
    for (int l = 0; l < 2; l++)
        for (size_t i = 0; i < lists[l].n; i++) {
            const struct cs_triangle *t = lists[l].items + i;
            if (t->bottom >= top && t->top < top + ROWS)
                cs_raster_raise(t, first, CS_SHADOW_MAP_STRIDE, top, ROWS);
        }
}

/* Minimum and maximum of each 2 x 2 block: the first level that the 8 x 8 bounds are made of.
 */
CS_CLONES static void bound_pairs(struct cs_shadow_map *map) {
    for (size_t y = 0; y < HALF; y++) {
        const float *row = map->depth + 2 * y * CS_SHADOW_MAP_STRIDE;
        for (size_t x = 0; x < HALF; x++) {
            float least = row[2 * x], largest = least;
            for (size_t k = 1; k < 4; k++) {
                const float z = row[2 * x + (k & 1) + (k >> 1) * CS_SHADOW_MAP_STRIDE];
                least = z < least ? z : least;
                largest = z > largest ? z : largest;
            }
            map->min_8x8[y * HALF + x] = least;
            map->max_8x8[y * HALF + x] = largest;
        }
    }
}

/* An 8 x 8 block is 4 x 4 blocks of 2 x 2, itself the first of them: it takes its place. The
 * last three of each row and column have none. */
CS_CLONES void cs_shadow_map_bound(struct cs_shadow_map *map) {
    bound_pairs(map);
    for (size_t y = 0; y + 3 < HALF; y++)
        for (size_t x = 0; x + 3 < HALF; x++) {
            const size_t at = y * HALF + x;
            float least = map->min_8x8[at], largest = map->max_8x8[at];
            for (size_t k = 1; k < 16; k++) {
                const size_t beside = at + k / 4 * HALF + k % 4;
                const float low = map->min_8x8[beside], high = map->max_8x8[beside];
                least = low < least ? low : least;
                largest = high > largest ? high : largest;
            }
            map->min_8x8[at] = least;
            map->max_8x8[at] = largest;
        }
}

// summed weights of texels k (four of them) of a row whose middle tap lies at `at`
CS_INLINE cs_f4 weights(cs_f4 k, float at) {
    const cs_i4 no_sign = {0x7fffffff, 0x7fffffff, 0x7fffffff, 0x7fffffff};
    const cs_f4 near = 3 - (cs_f4)((cs_i4)(k - at) & no_sign);
    return (cs_f4)((near > 0) & (cs_i4)near);
}

/* The weighted fraction of lit texels. x, y: texels from the middle of the map's first;
 * (column, line): first texel of the window. Four columns and two more are lanes; two lanes
 * weigh 0. */
CS_INLINE float window(const struct cs_shadow_map *map, float x, float y, float nearness,
                       int column, int line) {
    const int bx = column - CS_SHADOW_MAP_BORDER, by = line - CS_SHADOW_MAP_BORDER;
    const cs_f4 first = {0, 1, 2, 3}, then = {4, 5, 6, 7};
    const cs_f4 across = weights(first, x - (float)bx), down = weights(first, y - (float)by);
    const cs_f4 across_last = weights(then, x - (float)bx);
    const cs_f4 down_last = weights(then, y - (float)by);
    const float *row = map->depth + (size_t)line * CS_SHADOW_MAP_STRIDE + (size_t)column;
    cs_f4 sum = {0};
    for (int r = 0; r < 6; r++, row += CS_SHADOW_MAP_STRIDE) {
        const float weight = r < 4 ? down[r] : down_last[r - 4];
        const cs_f4 z = *(const cs_f4_unaligned *)row,
                    last = *(const cs_f4_unaligned *)(row + 4);
        sum += (cs_f4)((z <= nearness) & (cs_i4)across) * weight;
        sum += (cs_f4)((last <= nearness) & (cs_i4)across_last) * weight;
    }
    return ((sum[0] + sum[1]) + (sum[2] + sum[3])) / 81;
}

/* Moves the positions from..from + n off their surfaces and projects them: out[0], out[1] in
 * texels from the middle of the first, out[2] reversed depth. The slant is stored first because
 * a square root of a choice would not be vectorised. */
CS_INLINE void project(const struct cs_shadow_map *map, const struct cs_shadow_query *query,
                       int from, int n, float out[3][BLOCK]) {
    const struct cs_clip_transform clip = map->transform;
    const float texel = map->texel_size, side = CS_SHADOW_SIDE;
    float slant[BLOCK];
    for (int i = 0; i < n; i++) {
        const float f = query->n_dot_l[from + i], s = 1 - f * f;
        slant[i] = s > 0 ? s : 0;
    }
    for (int i = 0; i < n; i++) {
        // off the surface by as much as a slope rises under the texels that are read
        const float off = (1.9f + 5 * sqrtf(slant[i])) * texel;
        const float a = query->positions[0][from + i] + off * query->normals[0][from + i];
        const float b = query->positions[1][from + i] + off * query->normals[1][from + i];
        const float c = query->positions[2][from + i] + off * query->normals[2][from + i];
        const float w = clip.w[0] * a + clip.w[1] * b + clip.w[2] * c + clip.w[3];
        const float z = clip.z[0] * a + clip.z[1] * b + clip.z[2] * c + clip.z[3];
        const float x = clip.x[0] * a + clip.x[1] * b + clip.x[2] * c + clip.x[3];
        const float y = clip.y[0] * a + clip.y[1] * b + clip.y[2] * c + clip.y[3];
        const float inverse = 1 / w;
        out[0][i] = (x * inverse * 0.5f + 0.5f) * side - 0.5f;
        out[1][i] = (0.5f - y * inverse * 0.5f) * side - 0.5f;
        out[2][i] = cs_reversed_depth(z * inverse * 0.5f + 0.5f);
        slant[i] = w;
    }
    for (int i = 0; i < n; i++) {
        // beyond the map and behind the lamp there is no shadow: the first, empty block
        const float x = out[0][i], y = out[1][i], last = side - 0.5f;
        const bool inside =
            (slant[i] > 0) & (x >= -0.5f) & (y >= -0.5f) & (x <= last) & (y <= last);
        out[0][i] = inside ? x : 2 - CS_SHADOW_MAP_BORDER;
        out[1][i] = inside ? y : 2 - CS_SHADOW_MAP_BORDER;
    }
    for (int i = 0; i < n; i++) {
        // what lies farther away than all that casts shadow still catches it
        const float near = out[2][i] > 0 ? out[2][i] : 0;
        out[2][i] = query->n_dot_l[from + i] > 0 ? near : -1;
    }
}

// visibility of up to BLOCK positions
CS_CLONES static void sample_block_bounds(const struct cs_shadow_map *map,
                                          const struct cs_shadow_query *query, int from,
                                          int n) {
    float at[3][BLOCK];
    int32_t texel[2][BLOCK], block[BLOCK];
    project(map, query, from, n, at);
    // rounded down: 4 texels are added so that the number is positive
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < n; i++)
            texel[k][i] = (int32_t)(at[k][i] - 2 + 4) + CS_SHADOW_MAP_BORDER - 4;
    for (int i = 0; i < n; i++)
        block[i] = (texel[1][i] >> 1) * HALF + (texel[0][i] >> 1);
    for (int i = 0; i < n; i++) {
        const float near = at[2][i];
        query->visibility[from + i] =
            map->max_8x8[block[i]] <= near ? 1
            : map->min_8x8[block[i]] > near
                ? 0
                : window(map, at[0][i], at[1][i], near, texel[0][i], texel[1][i]);
    }
}

void cs_shadow_map_sample(const struct cs_shadow_map *map,
                          const struct cs_shadow_query *query) {
    for (int i = 0; !map->enabled && i < query->n; i++)
        query->visibility[i] = query->n_dot_l[i] > 0 ? 1 : 0;
    for (int i = 0; map->enabled && i < query->n; i += BLOCK)
        sample_block_bounds(map, query, i, query->n - i < BLOCK ? query->n - i : BLOCK);
}
