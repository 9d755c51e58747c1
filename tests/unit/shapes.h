/* shapes.h - one collider of each shape, and points about it that look random. */
#ifndef CS_TESTS_SHAPES_H
#define CS_TESTS_SHAPES_H

#include "model/contact/posed_collider.h"
#include "scene/collider_keys.h"
#include "unit.h"

/* rotation by the unit quaternion (1, 2, 3, 4)/sqrt(30): no axis stays parallel to another */
#define OBLIQUE                                                                                \
    { 0.18257418583505536, 0.36514837167011072, 0.54772255750516607, 0.73029674334022143 }

static struct cs_collider colliders[] = {
    {.sphere = {true, {0.3, -0.2, 0.1}, 0.35}},
    {.plane = {true, {0.1, 0.2, 0.3}, {0.48, 0.6, 0.64}, 1}},
    {.floor = {true, 0.25, 1}},
    {.box = {true, {0.2, 0.1, -0.3}, {0.8, 0.5, 0.6}, OBLIQUE, 0.06}},
    {.capsule = {true, {-0.2, 0.1, 0.3}, {0.4, 0.5, -0.1}, 0.12}},
    // a box whose edges are as round as can be: a capsule's relative
    {.box = {true, {0, 0, 0}, {0.4, 0.4, 1}, OBLIQUE, 0.2}},
};
enum { SPHERE, PLANE, FLOOR, BOX, CAPSULE, ROUND, N_COLLIDERS };

/* Asserts that a collider of every shape with a distance stands above. */
static inline void check_shapes(void) {
#define X(name, keys, text)                                                                    \
    {                                                                                          \
        bool found = false;                                                                    \
        for (int k = 0; k < N_COLLIDERS; k++)                                                  \
            found |= colliders[k].name.present;                                                \
        ck_assert_msg(found, "add a collider to shapes.h: " #name);                            \
    }
    CS_SOLID_LIST(X)
#undef X
}

static struct cs_scene scene = {.colliders = {colliders, N_COLLIDERS}};
static struct cs_system at_rest = {.scene = &scene};

/* numbers in -1..1 that look random, the same everywhere */
static inline double draw(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(int64_t)*seed / 9223372036854775808.0;
}

static inline void draw_point(uint64_t *seed, const struct cs_posed_collider *about,
                              double p[3]) {
    for (int c = 0; c < 3; c++)
        p[c] = about->centre[c] + 0.8 * draw(seed);
}

#endif
