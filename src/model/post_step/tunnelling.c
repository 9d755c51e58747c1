/* tunnelling.c - where a particle enters a collider that it passes; see tunnelling.h.
 *
 * In the frame of the collider the particle moves straight from its position at the start of
 * the step to that at the end. Distances from a convex shape are convex along a line: the
 * least one is found by trisection, and the entry by bisection before it. */
#include "model/post_step/tunnelling.h"

#include "scene/collider_keys.h"

#include <math.h>
#include <string.h>

/* Depth that counts as a passage, as a fraction of the inner radius. Shorter chords cut an
 * edge, as particles that slide over it do. */
#define GRAZING 0.1
/* cosine between the normals at entry and end, above which the push at the end is right */
#define SAME_SIDE 0.5

/* parts of a chord that are left: (2/3)^60 = 3e-11, and 1/2^40 */
enum { TRISECTIONS = 60, BISECTIONS = 40 };

/* Straight way of a particle relative to a collider. */
struct chord {
    const struct cs_posed_collider *collider;
    double from[3], way[3]; /* m, world, as if the collider stood in its last pose */
};

/* Signed distance in m at the fraction s of the way. */
static double distance_at(const struct chord *chord, double s, double n[3]) {
    double p[3];
    for (int c = 0; c < 3; c++)
        p[c] = chord->from[c] + s * chord->way[c];
    return cs_posed_collider_signed_distance(chord->collider, p, n);
}

/* Fraction of the way at which the distance is least. */
static double find_deepest(const struct chord *chord) {
    double low = 0, high = 1, n[3];
    for (int k = 0; k < TRISECTIONS; k++) {
        const double third = (high - low) / 3;
        if (distance_at(chord, low + third, n) < distance_at(chord, high - third, n))
            high -= third;
        else
            low += third;
    }
    return 0.5 * (low + high);
}

/* Last fraction before `deepest` at which the particle is in front. */
static double find_entry(const struct chord *chord, double deepest) {
    double low = 0, high = deepest, n[3];
    for (int k = 0; k < BISECTIONS; k++) {
        const double middle = 0.5 * (low + high);
        *(distance_at(chord, middle, n) < 0 ? &high : &low) = middle;
    }
    return low;
}

bool cs_tunnelling_is_possible(const struct cs_scene *scene) {
    for (uint32_t k = 0; k < scene->colliders.n; k++)
        if (!cs_shape_is_endless(cs_collider_shape(cs_scene_colliders(scene) + k)))
            return true;
    return false;
}

double cs_tunnelling_inner_radius(const struct cs_posed_collider *collider) {
    const double *half = collider->half_sizes;
    const double radius = collider->radius + collider->collider->thickness;
    switch (collider->shape->bounds) {
    case CS_BOUNDS_SPHERE:
        return radius;
    case CS_BOUNDS_BOX:
        return radius + fmin(half[0], fmin(half[1], half[2]));
    case CS_BOUNDS_HALF_SPACE:
    case CS_BOUNDS_MESH:
        break;
    }
    return HUGE_VAL;
}

/* Sets the chord; returns its length in m. */
static double set_chord(struct chord *chord, const struct cs_posed_collider *before,
                        const struct cs_posed_collider *after, const double from[3],
                        const double to[3]) {
    double own[3];
    chord->collider = after;
    memcpy(chord->from, from, sizeof chord->from);
    if (before != after) {
        cs_collider_to_local(before, from, own);
        cs_collider_to_world(after, own, chord->from);
    }
    for (int c = 0; c < 3; c++)
        chord->way[c] = to[c] - chord->from[c];
    return sqrt(cs_vec3_dot(chord->way, chord->way));
}

bool cs_tunnelling_find(const struct cs_posed_collider *before,
                        const struct cs_posed_collider *after, const double from[3],
                        const double to[3], double *gap, double n[3]) {
    struct chord chord;
    double entered[3], ended[3];
    const double inner = cs_tunnelling_inner_radius(after);
    const double length = set_chord(&chord, before, after, from, to);
    // false for NaN too
    if (!(length > inner) || !(distance_at(&chord, 0, entered) < length))
        return false;
    const double deepest = find_deepest(&chord);
    if (!(distance_at(&chord, deepest, ended) < -GRAZING * inner))
        return false;
    // a particle that starts behind the surface entered where it is nearest
    const double s = find_entry(&chord, deepest);
    const double start = distance_at(&chord, s, entered);
    const double behind = start + (1 - s) * cs_vec3_dot(chord.way, entered);
    const double end = distance_at(&chord, 1, ended);
    if (!(behind < 0) || (end < 0 && cs_vec3_dot(entered, ended) > SAME_SIDE))
        return false;
    *gap = behind;
    memcpy(n, entered, sizeof entered);
    return true;
}

bool cs_tunnelling_is_deep(const struct cs_posed_collider *before,
                           const struct cs_posed_collider *after, const double from[3],
                           const double to[3]) {
    struct chord chord;
    double n[3], gap;
    const double small = CS_TUNNELLING_DEPTH * cs_tunnelling_inner_radius(after);
    if (!(set_chord(&chord, before, after, from, to) > small))
        return false;
    return distance_at(&chord, 1, n) < -small ||
           cs_tunnelling_find(before, after, from, to, &gap, n);
}
