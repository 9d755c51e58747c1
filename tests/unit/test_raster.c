/* The rasteriser against closed forms: areas, edges shared by two triangles, depth, clipping.
 */
#include "unit.h"

#include "draw/cpu/raster.h"
#include "draw/matrix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 64, PIXELS = SIZE * SIZE };

struct field {
    int32_t whole[PIXELS];
    cs_f8 depth[PIXELS];
    cs_i8 shown[PIXELS];
};

static struct field field;
static struct cs_samples samples = {.whole = field.whole,
                                    .depth = field.depth,
                                    .triangle_ids = field.shown,
                                    .width = SIZE,
                                    .rows = SIZE};

/* looks down -z: x and y of -1..1 at z = 0 are the picture */
static struct cs_clip_transform parallel(void) {
    double matrix[16];
    float as_float[16];
    struct cs_clip_transform clip;
    cs_matrix_parallel(1, 1, -1, 1, matrix);
    cs_matrix_to_float(matrix, as_float);
    cs_clip_transform_make(&clip, as_float, 0, SIZE, SIZE);
    cs_sample_pattern_jitter(cs_sample_pattern_of(8), &clip);
    return clip;
}

static struct cs_clip_transform perspective(double near) {
    double matrix[16];
    float as_float[16];
    struct cs_clip_transform clip;
    cs_matrix_perspective(1, 1, near, 100, matrix);
    cs_matrix_to_float(matrix, as_float);
    cs_clip_transform_make(&clip, as_float, (float)near, SIZE, SIZE);
    cs_sample_pattern_jitter(cs_sample_pattern_of(8), &clip);
    return clip;
}

/* of a place at w, before a far plane at 100 */
static double nearness(double near, double w) {
    const double z = (100 + near) / (100 - near) - 200 * near / ((100 - near) * w);
    return (double)CS_DEPTH_STEPS * (1 - (z / 2 + 0.5));
}

static void add(struct cs_triangles *triangles, const struct cs_clip_transform *clip,
                float p[3][3], bool front_only) {
    const struct cs_triangle_kind kind = {.attributes = 3, .front_only = front_only};
    struct cs_clip_vertex corners[3];
    const struct cs_clip_vertex *three[3] = {corners, corners + 1, corners + 2};
    for (int i = 0; i < 3; i++) {
        cs_clip_transform_corner(clip, p[i], corners + i);
        for (int k = 0; k < CS_ATTRIBUTES; k++)
            corners[i].attributes[k] = k < 3 ? p[i][k] : 0;
    }
    cs_triangles_add(triangles, clip, three, &kind);
}

static uint32_t covered(const struct cs_triangles *triangles, size_t from, size_t to) {
    uint32_t n = 0;
    memset(field.whole, CS_NOTHING, sizeof field.whole);
    samples.triangles = triangles->items;
    for (size_t i = from; i < to; i++)
        cs_raster_fill(&samples, (int32_t)i, cs_sample_pattern_of(8));
    for (int i = 0; i < PIXELS; i++)
        cs_samples_split(&samples, (size_t)i, i % SIZE, i / SIZE, cs_sample_pattern_of(8));
    for (size_t i = 0; i < PIXELS; i++)
        for (int s = 0; s < CS_SAMPLES; s++)
            n += field.shown[i][s] != CS_NOTHING;
    return n;
}

static uint32_t state = 1;
static float between(float least, float most) {
    state = state * 1664525u + 1013904223u;
    return least + (most - least) * (float)(state >> 8) / (float)(1 << 24);
}

/* The share of samples inside is the area, but for samples near the outline: at most one along
 * each quarter pixel of it is counted wrong. */
TEST(a_triangle_covers_its_area) {
    const struct cs_clip_transform clip = parallel();
    struct cs_triangles triangles = {0};
    for (int trial = 0; trial < 300; trial++) {
        float p[3][3];
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 2; k++)
                p[i][k] = between(-0.99f, 0.99f);
            p[i][2] = 0;
        }
        triangles.n = 0;
        add(&triangles, &clip, p, false);
        if (triangles.n == 0)
            continue;
        const double a = (double)(p[1][0] - p[0][0]), b = (double)(p[1][1] - p[0][1]);
        const double c = (double)(p[2][0] - p[0][0]), d = (double)(p[2][1] - p[0][1]);
        const double area = fabs(a * d - b * c) / 2 * SIZE * SIZE / 4;
        const double outline = (hypot(a, b) + hypot(c, d) + hypot(a - c, b - d)) * SIZE / 2;
        const double found = covered(&triangles, 0, 1) / (double)CS_SAMPLES;
        ck_assert_double_le(fabs(found - area), 0.5 * outline + 1);
        // errors of the three sides cancel: far below their bound
        ck_assert(area < 100 || fabs(found - area) < 0.05 * outline + 1);
    }
    cs_triangles_finish(&triangles);
}

/* Eight samples have a row and a column of sixteenths each, counted modulo a pixel: an edge
 * along either axis has eight steps. Four have four, and the passes of eight are those four
 * moved. */
TEST(samples_share_no_row_and_no_column) {
    const struct cs_sample_pattern *eight = cs_sample_pattern_of(8);
    const struct cs_sample_pattern *four = cs_sample_pattern_of(4);
    uint32_t columns = 0, rows = 0;
    for (int s = 0; s < CS_SAMPLES; s++) {
        columns |= 1u << ((eight->x[s] + 256) / 16 & 15);
        rows |= 1u << (eight->y[s] / 16 & 15);
        ck_assert_int_eq(eight->x[s] + (int)(256 * eight->right[s]), four->x[s]);
        ck_assert_int_eq(eight->y[s] - (int)(256 * eight->up[s]), four->y[s]);
    }
    ck_assert_uint_eq(columns, 0xaaaa);
    ck_assert_uint_eq(rows, 0xaaaa);
}

/* A fan about a point covers every sample of the picture exactly once, however it lies. */
TEST(neighbours_share_no_sample_and_leave_none) {
    const struct cs_clip_transform clip = parallel();
    struct cs_triangles triangles = {0};
    for (int trial = 0; trial < 60; trial++) {
        enum { SPOKES = 9 };
        const float far = trial % 2 ? 1.5f : 40; // the latter's edges need 64 bits
        // on corners of pixels and samples too, where edges meet them
        const float grid = trial % 3 ? 1.0f / 256 : 1.0f / 32;
        const float x = floorf(between(-0.9f, 0.9f) / grid) * grid;
        const float y = floorf(between(-0.9f, 0.9f) / grid) * grid;
        uint32_t sum = 0;
        triangles.n = 0;
        for (int i = 0; i < SPOKES; i++) {
            float p[3][3] = {{x, y, 0}};
            for (int e = 0; e < 2; e++) {
                const double angle = (i + e) % SPOKES * 6.283185307179586 / SPOKES;
                p[1 + e][0] = far * (float)cos(angle) * 2;
                p[1 + e][1] = far * (float)sin(angle) * 2;
                p[1 + e][2] = 0;
            }
            add(&triangles, &clip, p, false);
        }
        ck_assert_uint_ge(triangles.n, SPOKES);
        for (size_t i = 0; i < triangles.n; i++)
            sum += covered(&triangles, i, i + 1);
        ck_assert_uint_eq(sum, CS_SAMPLES * PIXELS);
        ck_assert_uint_eq(covered(&triangles, 0, triangles.n), CS_SAMPLES * PIXELS);
    }
    cs_triangles_finish(&triangles);
}

/* of two triangles that cross, each sample shows the one whose plane is nearer there */
TEST(the_nearer_one_shows) {
    const struct cs_clip_transform clip = perspective(0.1);
    struct cs_triangles triangles = {0};
    // planes z = -3 + x and z = -3 - x: the left half shows the second
    float p[2][3][3] = {{{-2, -9, -5}, {2, -9, -1}, {0, 9, -3}},
                        {{-2, -9, -1}, {2, -9, -5}, {0, 9, -3}}};
    for (int order = 0; order < 2; order++) {
        uint32_t seen = 0;
        triangles.n = 0;
        add(&triangles, &clip, p[order], false);
        add(&triangles, &clip, p[1 - order], false);
        ck_assert_uint_eq(triangles.n, 2);
        ck_assert_uint_gt(covered(&triangles, 0, 2), 0);
        for (int i = 0; i < PIXELS; i++)
            for (int s = 0; s < CS_SAMPLES; s++) {
                const int32_t id = field.shown[i][s];
                const double x = i % SIZE + cs_sample_pattern_of(8)->x[s] / 256.0 - SIZE / 2;
                const bool right = x > 0;
                if (id == CS_NOTHING || fabs(x) < 0.01)
                    continue;
                ck_assert_int_eq(id, right == (order == 0) ? 0 : 1);
                seen++;
            }
        ck_assert_uint_gt(seen, PIXELS);
    }
    cs_triangles_finish(&triangles);
}

/* of two at the same depth the later one */
TEST(of_equals_the_later_one_shows) {
    const struct cs_clip_transform clip = parallel();
    struct cs_triangles triangles = {0};
    float p[3][3] = {{-0.7f, -0.6f, 0.1f}, {0.8f, -0.5f, 0.3f}, {0.1f, 0.9f, 0.2f}};
    add(&triangles, &clip, p, false);
    add(&triangles, &clip, p, false);
    covered(&triangles, 0, 2);
    for (size_t i = 0; i < PIXELS; i++)
        for (int s = 0; s < CS_SAMPLES; s++)
            ck_assert_int_ne(field.shown[i][s], 0);
    cs_triangles_finish(&triangles);
}

/* A triangle that reaches behind the eye is a part of a plane: what is shown is where the ray
 * meets it before the eye, and its depth and place are those of the ray. */
TEST(what_lies_behind_the_eye_is_cut_off) {
    const float near = 0.25f;
    const struct cs_clip_transform clip = perspective((double)near);
    struct cs_triangles triangles = {0};
    // the plane y = -1, from far ahead to far behind
    float p[3][3] = {{-50, -1, -60}, {50, -1, -60}, {0, -1, 80}};
    add(&triangles, &clip, p, false);
    ck_assert_uint_ge(triangles.n, 1);
    covered(&triangles, 0, triangles.n);
    for (int i = 0; i < PIXELS; i++) {
        const cs_i8 *shown = field.shown + i;
        for (int s = 0; s < CS_SAMPLES; s++) {
            const double up = 1 - (i / SIZE + cs_sample_pattern_of(8)->y[s] / 256.0) * 2 / SIZE;
            const double right =
                (i % SIZE + cs_sample_pattern_of(8)->x[s] / 256.0) * 2 / SIZE - 1;
            const double along = up < 0 ? -1 / up : 1e9; // the ray's w at the plane
            const bool inside = along < 59 && fabs(right * along) < 50 * (1 - along / 60);
            if (along < 58 && inside && along > 1.05 * (double)near) {
                ck_assert_int_ne((*shown)[s], CS_NOTHING);
                const double exact = nearness((double)near, along);
                ck_assert_double_le(fabs((double)field.depth[i][s] - exact), 4 + 1e-4 * exact);
            }
            if (up > 0.02)
                ck_assert_int_eq((*shown)[s], CS_NOTHING);
        }
        const int32_t id = (*shown)[0];
        if (id == CS_NOTHING || i / SIZE < SIZE / 2 + 4)
            continue;
        // attributes are places: those of the ray through the middle
        const struct cs_triangle *t = triangles.items + id;
        const double up = 1 - (i / SIZE + 0.5) * 2 / SIZE;
        const float across = (float)(i % SIZE - t->left), down = (float)(i / SIZE - t->top);
        const struct cs_plane_equation *y = t->attributes + 1, *w = &t->inverse;
        const double inverse = (double)(w->value + w->d_dx * across + w->d_dy * down);
        const double side = t->is_back_facing ? -1 : 1;
        ck_assert_double_le(
            fabs(side * (double)(y->value + y->d_dx * across + y->d_dy * down) / inverse + 1),
            1e-3);
        ck_assert_double_le(fabs(inverse + up), 1e-4);
    }
    cs_triangles_finish(&triangles);
}

/* Corners so far beside the picture that pixels of theirs are no whole numbers any more. */
TEST(what_reaches_far_out_is_cut) {
    const struct cs_clip_transform clip = perspective(0.01);
    struct cs_triangles triangles = {0};
    float p[3][3] = {{-1e5f, -1e5f, -0.02f}, {1e5f, -1e5f, -0.02f}, {0, 1e5f, -0.02f}};
    add(&triangles, &clip, p, false);
    ck_assert_uint_eq(covered(&triangles, 0, triangles.n), CS_SAMPLES * PIXELS);
    for (size_t i = 0; i < PIXELS; i++)
        ck_assert_double_le(fabs((double)field.depth[i][0] - nearness(0.01, 0.02)), 4);
    cs_triangles_finish(&triangles);
}

/* the front is counter-clockwise; asked for it alone, the other side is left out */
TEST(sides_are_told_apart) {
    const struct cs_clip_transform clip = parallel();
    struct cs_triangles triangles = {0};
    float front[3][3] = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0, 0.5f, 0}};
    float back[3][3] = {{-0.5f, -0.5f, 0}, {0, 0.5f, 0}, {0.5f, -0.5f, 0}};
    add(&triangles, &clip, front, true);
    ck_assert_uint_eq(triangles.n, 1);
    ck_assert(!triangles.items[0].is_back_facing);
    add(&triangles, &clip, back, true);
    ck_assert_uint_eq(triangles.n, 1);
    add(&triangles, &clip, back, false);
    ck_assert_uint_eq(triangles.n, 2);
    ck_assert(triangles.items[1].is_back_facing);
    // nothing of it can be seen: on one line, and on one place
    float line[3][3] = {{-0.5f, -0.5f, 0}, {0, 0, 0}, {0.5f, 0.5f, 0}};
    float place[3][3] = {{0.1f, 0.1f, 0}, {0.1f, 0.1f, 0}, {0.1f, 0.1f, 0}};
    add(&triangles, &clip, line, false);
    add(&triangles, &clip, place, false);
    ck_assert_uint_eq(triangles.n, 2);
    cs_triangles_finish(&triangles);
}
