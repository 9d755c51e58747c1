/* What a particle passes within one step is found, and nothing else. */
#include "model/post_step/tunnelling.h"
#include "scene/collider_keys.h"

#include "shapes.h"

#include <math.h>

/* Ways through a plate of 2 cm, whose half-space at the entry is known. */
TEST(tunnelling_is_judged_by_the_side_of_entry) {
    static struct cs_collider plate = {
        .box = {true, {0, 0, 0}, {1, 0.02, 1}, {0, 0, 0, 1}, 0.001}};
    static const struct {
        double from[3], to[3];
        bool passes;
        double gap, n[3];
    } ways[] = {
        {{0, 0.1, 0}, {0.1, -0.2, 0}, true, -0.21, {0, 1, 0}}, // through
        {{0, -0.1, 0}, {0.1, 0.2, 0}, true, -0.21, {0, -1, 0}},
        {{0, 0.1, 0}, {0, -0.004, 0}, true, -0.014, {0, 1, 0}}, // beyond the middle
        {{0, 0.1, 0}, {0, 0.004, 0}, false, 0, {0}},            // not yet
        {{0, 0.008, 0}, {0, -0.03, 0}, true, -0.04, {0, 1, 0}}, // starts behind the surface
        {{0, 0.008, 0}, {0, 0.2, 0}, false, 0, {0}},            // and leaves
        {{0, 0.1, 0}, {1, -0.0, 0}, false, 0, {0}},             // beside its end
        {{0.7, 0, 0}, {0.4, 0, 0.1}, true, -0.1, {1, 0, 0}},    // by its edge
        {{0.499, 0.012, 0}, {0.512, 0.007, 0}, false, 0, {0}},  // grazes the edge
        {{0, (double)NAN, 0}, {0, -0.2, 0}, false, 0, {0}},
    };
    struct cs_scene thin = {.colliders = {&plate, 1}};
    const struct cs_system system = {.scene = &thin};
    struct cs_posed_collider collider;
    cs_posed_collider_at(&system, 0, 0, &collider);
    ck_assert_double_eq_tol(cs_tunnelling_inner_radius(&collider), 0.01, 1e-15);
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        double gap = 1, n[3];
        const bool passes =
            cs_tunnelling_find(&collider, &collider, ways[k].from, ways[k].to, &gap, n);
        ck_assert_msg(passes == ways[k].passes, "way %zu: %d", k, passes);
        if (!passes)
            continue;
        ck_assert_double_eq_tol(gap, ways[k].gap, 1e-9);
        for (int c = 0; c < 3; c++)
            ck_assert_double_eq_tol(n[c], ways[k].n[c], 1e-9);
    }
}

/* A way that crosses a shape from one free side to the opposite one is a passage, and ends in
 * front of the tangent plane at its entry once moved by the gap; by 1000 samples a way, in
 * poses that change within the step. */
TEST(tunnelling_is_that_of_samples) {
    static const int list[] = {SPHERE, BOX, CAPSULE, ROUND};
    int crossed = 0;
    for (size_t k = 0; k < 4; k++) {
        struct cs_posed_collider before, after;
        uint64_t seed = 11;
        cs_posed_collider_at(&at_rest, (uint32_t)list[k], 0, &before);
        after = before;
        for (int c = 0; c < 3; c++)
            after.centre[c] += 0.3 * (c + 1);
        for (int trial = 0; trial < 400; trial++) {
            double a[3], b[3], n[3], n_a[3], n_b[3], gap = 0, least = HUGE_VAL;
            draw_point(&seed, &before, a);
            draw_point(&seed, &after, b);
            const bool passes = cs_tunnelling_find(&before, &after, a, b, &gap, n);
            const double inner = cs_tunnelling_inner_radius(&after);
            for (int c = 0; c < 3; c++)
                a[c] += 0.3 * (c + 1);
            for (int s = 0; s <= 1000; s++) {
                double p[3];
                for (int c = 0; c < 3; c++)
                    p[c] = a[c] + s / 1000.0 * (b[c] - a[c]);
                least = fmin(least, cs_posed_collider_distance(&after, p, n_b));
            }
            const double d_a = cs_posed_collider_distance(&after, a, n_a);
            const double d_b = cs_posed_collider_distance(&after, b, n_b);
            const bool opposed = d_a > 0 && d_b > 0 && least < -0.2 * inner;
            crossed += opposed;
            ck_assert_msg(!opposed || passes, "shape %zu, trial %d: not found", k, trial);
            ck_assert_msg(!passes || least < 0, "shape %zu, trial %d: not there", k, trial);
            if (passes && d_a > 0) {
                // after the push it is in front of a convex shape
                for (int c = 0; c < 3; c++)
                    b[c] -= gap * n[c];
                ck_assert_double_ge(cs_posed_collider_distance(&after, b, n_b), -1e-9);
            }
        }
    }
    ck_assert_int_gt(crossed, 50);
}
