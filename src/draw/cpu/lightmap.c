/* lightmap.c - shadow map (Williams 1978) with 3 x 3 taps 1.4 texels apart, each blended from
 * four comparisons (percentage closer filtering, Reeves 1987).
 *
 * The taps touch 5 x 5 texels, and their weights are products of one along a row and one along
 * a column. Bounds of blocks tell most places to be lit or dark without a look at the texels.
 */
#include "draw/cpu/lightmap.h"

#include "draw/cpu/lanes.h"
#include "draw/cpu/raster.h"

#include <math.h>
#include <string.h>

enum { HALF = CS_MAP_STRIDE / 2, BLOCK = 64 };

static const float reach = 1.4f; // texels between taps

enum cs_status cs_lightmap_init(struct cs_lightmap *map, struct cs_arena *arena,
                                struct cs_error *error) {
    const size_t all = (size_t)CS_MAP_STRIDE * CS_MAP_STRIDE, half = (size_t)HALF * HALF;
    // four floats at once may be written past the last row
    float *memory = cs_arena_take_n(arena, all + 4 * half + 8, sizeof *memory, error);
    if (!memory)
        return error->status;
    map->nearest = memory;
    map->coarse[0] = memory + all;
    map->coarse[1] = map->coarse[0] + half;
    map->least = map->coarse[1] + half;
    map->largest = map->least + half;
    return CS_OK;
}

bool cs_lightmap_aim(struct cs_lightmap *map, const struct cs_view_block *block) {
    const struct cs_lightmap old = *map;
    map->present = block->shade[2] > 0;
    if (!map->present)
        return false;
    // a lamp's picture begins at a distance: half of it still keeps w above 0
    const bool is_lamp = block->light[3] > 0;
    cs_lens_make(&map->lens, block->world_to_light, is_lamp ? 1e-6f : 0, CS_SHADOW_SIDE,
                 CS_SHADOW_SIDE);
    map->texel = block->shade[1];
    return !old.present || memcmp(&old.lens, &map->lens, sizeof map->lens) != 0;
}

void cs_lightmap_draw(struct cs_lightmap *map, uint32_t stripe,
                      const struct cs_triangles *fixed, const struct cs_triangles *moving) {
    enum { ROWS = CS_SHADOW_SIDE / CS_MAP_STRIPES };
    const struct cs_triangles *lists[2] = {fixed, moving};
    const int top = (int)stripe * ROWS;
    float *first = map->nearest + CS_MAP_EDGE * CS_MAP_STRIDE + CS_MAP_EDGE;
    memset(first - CS_MAP_EDGE + (size_t)top * CS_MAP_STRIDE, 0,
           sizeof(float) * ROWS * CS_MAP_STRIDE);
    for (int l = 0; l < 2; l++)
        for (size_t i = 0; i < lists[l]->n; i++) {
            const struct cs_triangle *t = lists[l]->items + i;
            if (t->bottom >= top && t->top < top + ROWS)
                cs_raster_raise(t, first, CS_MAP_STRIDE, top, ROWS);
        }
}

CS_CLONES static void bound_pairs(struct cs_lightmap *map) {
    for (size_t y = 0; y < HALF; y++) {
        const float *row = map->nearest + 2 * y * CS_MAP_STRIDE;
        for (size_t x = 0; x < HALF; x++) {
            float least = row[2 * x], largest = least;
            for (size_t k = 1; k < 4; k++) {
                const float z = row[2 * x + (k & 1) + (k >> 1) * CS_MAP_STRIDE];
                least = z < least ? z : least;
                largest = z > largest ? z : largest;
            }
            map->coarse[0][y * HALF + x] = least;
            map->coarse[1][y * HALF + x] = largest;
        }
    }
}

CS_CLONES void cs_lightmap_bound(struct cs_lightmap *map) {
    bound_pairs(map);
    for (size_t y = 0; y + 2 < HALF; y++)
        for (size_t x = 0; x + 2 < HALF; x++) {
            const size_t at = y * HALF + x;
            float least = map->coarse[0][at], largest = map->coarse[1][at];
            for (size_t k = 1; k < 9; k++) {
                const size_t beside = at + k / 3 * HALF + k % 3;
                const float low = map->coarse[0][beside], high = map->coarse[1][beside];
                least = low < least ? low : least;
                largest = high > largest ? high : largest;
            }
            map->least[at] = least;
            map->largest[at] = largest;
        }
}

// weight of texels k, k + 1.. of a row, if the middle tap lies at `at`
CS_INLINE cs_f4 weights(cs_f4 k, float at) {
    const cs_i4 no_sign = {0x7fffffff, 0x7fffffff, 0x7fffffff, 0x7fffffff};
    cs_f4 sum = {0};
    for (int tap = -1; tap <= 1; tap++) {
        const cs_f4 far = (cs_f4)((cs_i4)(k - (at + reach * (float)tap)) & no_sign);
        const cs_f4 near = 1 - far;
        sum += (cs_f4)((near > 0) & (cs_i4)near);
    }
    return sum;
}

// x, y: texels of the map from the middle of the first; from (bx, by) on 5 x 5 are touched
CS_INLINE float window(const struct cs_lightmap *map, float x, float y, float nearness, int bx,
                       int by) {
    const cs_f4 first = {0, 1, 2, 3}, then = {4, 5, 6, 7};
    const cs_f4 across = weights(first, x - (float)bx), down = weights(first, y - (float)by);
    const cs_f4 across_last = weights(then, x - (float)bx);
    const cs_f4 down_last = weights(then, y - (float)by);
    const float *row =
        map->nearest + (size_t)(by + CS_MAP_EDGE) * CS_MAP_STRIDE + (size_t)(bx + CS_MAP_EDGE);
    cs_f4 sum = {0};
    float last = 0;
    for (int r = 0; r < 5; r++, row += CS_MAP_STRIDE) {
        const float weight = r < 4 ? down[r] : down_last[0];
        const cs_f4 z = *(const cs_f4_loose *)row;
        sum += (cs_f4)((z <= nearness) & (cs_i4)across) * weight;
        last += row[4] <= nearness ? across_last[0] * weight : 0;
    }
    return (((sum[0] + sum[1]) + (sum[2] + sum[3])) + last) / 9;
}

CS_INLINE float look(const struct cs_lightmap *map, float x, float y, float nearness) {
    const float side = CS_SHADOW_SIDE;
    if (!(x >= -0.5f && y >= -0.5f && x <= side - 0.5f && y <= side - 0.5f))
        return 1;
    // rounded down: 4 texels are added so that the number is positive
    const int bx = (int)(x - reach + 4) - 4, by = (int)(y - reach + 4) - 4;
    const size_t block =
        (size_t)((by + CS_MAP_EDGE) >> 1) * HALF + (size_t)((bx + CS_MAP_EDGE) >> 1);
    if (map->largest[block] <= nearness)
        return 1;
    if (map->least[block] > nearness)
        return 0;
    return window(map, x, y, nearness, bx, by);
}

// to texels and nearness: out[0], out[1], out[2]
CS_INLINE void project(const struct cs_lightmap *map, const struct cs_lit *lit, int from, int n,
                       float out[3][BLOCK]) {
    const struct cs_lens lens = map->lens;
    const float texel = map->texel, side = CS_SHADOW_SIDE;
    float slant[BLOCK];
    for (int i = 0; i < n; i++) {
        const float f = lit->facing[from + i], s = 1 - f * f;
        slant[i] = s > 0 ? s : 0;
    }
    for (int i = 0; i < n; i++) {
        // off the surface by as much as a slope rises under the texels that are read
        const float off = (0.4f + 2.6f * sqrtf(slant[i])) * texel;
        const float a = lit->places[0][from + i] + off * lit->normals[0][from + i];
        const float b = lit->places[1][from + i] + off * lit->normals[1][from + i];
        const float c = lit->places[2][from + i] + off * lit->normals[2][from + i];
        const float w = lens.w[0] * a + lens.w[1] * b + lens.w[2] * c + lens.w[3];
        const float z = lens.z[0] * a + lens.z[1] * b + lens.z[2] * c + lens.z[3];
        const float x = lens.x[0] * a + lens.x[1] * b + lens.x[2] * c + lens.x[3];
        const float y = lens.y[0] * a + lens.y[1] * b + lens.y[2] * c + lens.y[3];
        const float inverse = 1 / w;
        // behind the lamp there is no shadow: beyond the map
        out[0][i] = w > 0 ? (x * inverse * 0.5f + 0.5f) * side - 0.5f : -2;
        out[1][i] = (0.5f - y * inverse * 0.5f) * side - 0.5f;
        // what lies farther away than all that casts shadow still catches it
        const float nearness = cs_nearness(z * inverse * 0.5f + 0.5f);
        out[2][i] = nearness > 0 ? nearness : 0;
    }
}

CS_CLONES static void look_block(const struct cs_lightmap *map, const struct cs_lit *lit,
                                 int from, int n) {
    float at[3][BLOCK];
    project(map, lit, from, n, at);
    for (int i = 0; i < n; i++) {
        const bool lit_side = lit->facing[from + i] > 0;
        lit->share[from + i] = lit_side ? look(map, at[0][i], at[1][i], at[2][i]) : 0;
    }
}

void cs_lightmap_look(const struct cs_lightmap *map, const struct cs_lit *lit) {
    for (int i = 0; !map->present && i < lit->n; i++)
        lit->share[i] = lit->facing[i] > 0 ? 1 : 0;
    for (int i = 0; map->present && i < lit->n; i += BLOCK)
        look_block(map, lit, i, lit->n - i < BLOCK ? lit->n - i : BLOCK);
}
