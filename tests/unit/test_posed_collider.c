/* Obstacles as geometry: distances against sampled shapes and differences, poses in motion. */
#include "base/portable_sine.h"
#include "scene/collider_keys.h"
#include "shapes.h"

#include <math.h>

TEST(every_shape_is_in_shapes_h) {
    check_shapes();
}

/* the smallest distance from points of the core on a grid of 61 x 61 x 61, less the radius */
static double sampled(const struct cs_posed_collider *of, const double p[3]) {
    double least = HUGE_VAL;
    for (int i = -30; i <= 30; i++)
        for (int j = -30; j <= 30; j++)
            for (int k = -30; k <= 30; k++) {
                double squared = 0;
                for (int c = 0; c < 3; c++) {
                    const double q = of->centre[c] +
                                     i / 30.0 * of->half_sizes[0] * of->axes[0][c] +
                                     j / 30.0 * of->half_sizes[1] * of->axes[1][c] +
                                     k / 30.0 * of->half_sizes[2] * of->axes[2][c];
                    squared += (p[c] - q) * (p[c] - q);
                }
                least = fmin(least, squared);
            }
    return sqrt(least) - of->radius;
}

TEST(sine_and_cosine_are_those_of_libm) {
    for (int k = 0; k < 4000; k++) {
        const double angle = 0.013 * k;
        double sine, cosine;
        cs_sine_cosine(angle, &sine, &cosine);
        // one rounding of the angle counted in quarter turns
        ck_assert_double_eq_tol(sine, sin(angle), 1e-15 + 2.3e-16 * angle);
        ck_assert_double_eq_tol(cosine, cos(angle), 1e-15 + 2.3e-16 * angle);
    }
}

/* Outside the core the distance is the smallest one to any point of it, less the radius. The
 * grid's cells are 0.02 m at most, so that it is at most 0.02^2 / distance too large. */
TEST(distance_is_the_least_to_the_core) {
    static const int list[] = {SPHERE, BOX, CAPSULE, ROUND};
    for (size_t k = 0; k < 4; k++) {
        struct cs_posed_collider of;
        uint64_t seed = 7;
        cs_posed_collider_at(&at_rest, (uint32_t)list[k], 0, &of);
        for (int trial = 0; trial < 40; trial++) {
            double p[3], n[3];
            draw_point(&seed, &of, p);
            const double d = cs_posed_collider_distance(&of, p, n), seen = sampled(&of, p);
            if (d < -of.radius + 0.02)
                continue;
            ck_assert_double_le(d, seen + 1e-12);
            ck_assert_double_ge(d, seen - 4e-4 / (d + of.radius));
        }
    }
}

/* Going back by d along -n ends on the surface, where the normal is the same. */
TEST(normal_leads_to_the_surface) {
    for (uint32_t k = 0; k < N_COLLIDERS; k++) {
        struct cs_posed_collider of;
        uint64_t seed = 11;
        cs_posed_collider_at(&at_rest, k, 0, &of);
        for (int trial = 0; trial < 1000; trial++) {
            double p[3], n[3], q[3], at_surface[3];
            draw_point(&seed, &of, p);
            const double d = cs_posed_collider_distance(&of, p, n);
            double squared = 0;
            for (int c = 0; c < 3; c++) {
                q[c] = p[c] - d * n[c];
                squared += n[c] * n[c];
            }
            ck_assert_double_eq_tol(squared, 1, 1e-14);
            ck_assert_double_eq_tol(cs_posed_collider_distance(&of, q, at_surface), 0, 1e-14);
            for (int c = 0; c < 3; c++)
                ck_assert_double_eq_tol(at_surface[c], n[c], 1e-12);
        }
    }
}

TEST(floor_and_plane_are_half_spaces) {
    struct cs_posed_collider of;
    double n[3];
    const double below[3] = {5, -1, 7},
                 off[3] = {0.1 + 2 * 0.48 - 0.6, 0.2 + 2 * 0.6 + 0.48, 0.3 + 2 * 0.64};
    cs_posed_collider_at(&at_rest, FLOOR, 0, &of);
    ck_assert_double_eq(cs_posed_collider_distance(&of, below, n), -1.25);
    ck_assert_double_eq(n[1], 1);
    cs_posed_collider_at(&at_rest, PLANE, 0, &of);
    ck_assert_double_eq_tol(cs_posed_collider_distance(&of, off, n), 2, 1e-15);
}

/* What has no nearest point is pushed upwards. */
TEST(middle_has_a_normal) {
    static const int list[] = {SPHERE, CAPSULE};
    for (size_t k = 0; k < 2; k++) {
        struct cs_posed_collider of;
        double n[3], h[6];
        cs_posed_collider_at(&at_rest, (uint32_t)list[k], 0, &of);
        ck_assert_double_eq(cs_posed_collider_distance(&of, of.centre, n), -of.radius);
        ck_assert(n[0] == 0 && n[1] == 1 && n[2] == 0);
        ck_assert_double_eq(cs_posed_collider_smooth_distance(&of, of.centre, n, h),
                            -of.radius);
        ck_assert(n[0] == 0 && n[1] == 1 && n[2] == 0);
    }
}

/* what is not a number is the largest */
static double larger(double a, double b) {
    return a >= b || isnan(a) ? a : b;
}

/* Gradient and Hessian against central differences with a step of 1e-5 m. Third derivatives
 * reach 60 / band^2, which makes 1e-10 / 0.03^2 the scale of the truncation. Deep inside, where
 * the nearest face changes, the function has a bend: points there are left out. */
TEST(derivatives_match_differences) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const double step = 1e-5;
    double worst[2] = {0, 0};
    for (uint32_t k = 0; k < N_COLLIDERS; k++) {
        struct cs_posed_collider of;
        uint64_t seed = 3;
        cs_posed_collider_at(&at_rest, k, 0, &of);
        for (int trial = 0; trial < 3000; trial++) {
            double p[3], g[3], h[6], ahead[3], behind[3], unused[6];
            draw_point(&seed, &of, p);
            const double d = cs_posed_collider_smooth_distance(&of, p, g, h);
            if (d < -0.5 * of.radius && !cs_shape_is_endless(of.shape))
                continue;
            for (int c = 0; c < 3; c++) {
                const double kept = p[c];
                p[c] = kept + step;
                const double high = cs_posed_collider_smooth_distance(&of, p, ahead, unused);
                p[c] = kept - step;
                const double low = cs_posed_collider_smooth_distance(&of, p, behind, unused);
                p[c] = kept;
                worst[0] = larger(worst[0], fabs((high - low) / (2 * step) - g[c]));
                for (int e = 0; e < 6; e++)
                    if (column[e] == c)
                        worst[1] =
                            larger(worst[1],
                                   fabs((ahead[row[e]] - behind[row[e]]) / (2 * step) - h[e]));
            }
        }
    }
    ck_assert_double_le(worst[0], 2e-7);
    ck_assert_double_le(worst[1], 2e-5);
}

/* On a face of the box the distance is exact to any depth, with a gradient of length 1. */
TEST(faces_are_exact) {
    struct cs_posed_collider of;
    cs_posed_collider_at(&at_rest, BOX, 0, &of);
    for (int depth = -20; depth <= 20; depth++) {
        const double d = 0.01 * depth;
        double p[3], g[3], h[6];
        for (int c = 0; c < 3; c++)
            p[c] = of.centre[c] - (of.half_sizes[1] + of.radius + d) * of.axes[1][c] +
                   0.1 * of.axes[0][c] - 0.07 * of.axes[2][c];
        ck_assert_double_eq_tol(cs_posed_collider_smooth_distance(&of, p, g, h), d, 1e-15);
        for (int c = 0; c < 3; c++)
            ck_assert_double_eq_tol(g[c], -of.axes[1][c], 1e-14);
        for (int e = 0; e < 6; e++)
            ck_assert_double_eq_tol(h[e], 0, 1e-10);
    }
}

/* never smaller than the distance, and larger by at most 0.01 radii outside */
TEST(smooth_distance_is_near_the_distance) {
    static const int list[] = {BOX, CAPSULE, ROUND};
    double excess = 0, shortest = HUGE_VAL;
    bool below = false;
    for (size_t k = 0; k < 3; k++) {
        struct cs_posed_collider of;
        uint64_t seed = 5;
        cs_posed_collider_at(&at_rest, (uint32_t)list[k], 0, &of);
        for (int trial = 0; trial < 200000; trial++) {
            double p[3], n[3], h[6];
            draw_point(&seed, &of, p);
            const double d = cs_posed_collider_distance(&of, p, n);
            const double smooth = cs_posed_collider_smooth_distance(&of, p, n, h);
            if (d >= 0) {
                below |= smooth < d - 1e-15;
                excess = fmax(excess, (smooth - d) / of.radius);
            }
            shortest = fmin(shortest, n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        }
    }
    ck_assert(!below);
    ck_assert_double_gt(shortest, 0.5);
    ck_assert_double_le(excess, 0.01);
    ck_assert_double_ge(excess, 0.003); // it is not the distance itself
}

/* largest change of the Hessian from one of n points of a way to the next */
static double largest_jump(const struct cs_posed_collider *of, const double from[3],
                           const double to[3], int n) {
    double before[6], largest = 0;
    for (int k = 0; k <= n; k++) {
        double p[3], g[3], h[6];
        for (int c = 0; c < 3; c++)
            p[c] = from[c] + (to[c] - from[c]) * ((double)k / n);
        if (cs_posed_collider_smooth_distance(of, p, g, h) <= 0)
            ck_abort_msg("the way leads inside");
        for (int e = 0; e < 6 && k > 0; e++)
            largest = fmax(largest, fabs(h[e] - before[e]));
        memcpy(before, h, sizeof before);
    }
    return largest;
}

/* On ways over faces, edges, corners and ends the Hessian has no jump: halving the distance of
 * points halves the changes between them (a jump would stay), twice over. The distance itself
 * fails this: its Hessian jumps where a face becomes an edge. */
TEST(hessian_has_no_jump) {
    static const int list[] = {BOX, CAPSULE};
    static const double ways[][2][3] = {{{0.5, 0.29, 0.13}, {-0.5, 0.29, 0.13}},
                                        {{0.5, 0.56, 0.45}, {-0.6, 0.56, -0.4}},
                                        {{0.02, 0.7, 0.31}, {0.1, -0.7, 0.33}},
                                        {{0.45, 0.3, 0.2}, {0.45, 0.3, 0.4}}};
    for (size_t k = 0; k < 2; k++) {
        struct cs_posed_collider of;
        cs_posed_collider_at(&at_rest, (uint32_t)list[k], 0, &of);
        for (size_t w = 0; w < sizeof ways / sizeof *ways; w++) {
            double ends[2][3];
            for (int end = 0; end < 2; end++)
                for (int c = 0; c < 3; c++) {
                    ends[end][c] = of.centre[c];
                    for (int axis = 0; axis < 3; axis++)
                        ends[end][c] += ways[w][end][axis] * of.axes[axis][c];
                }
            const double coarse = largest_jump(&of, ends[0], ends[1], 20000);
            const double fine = largest_jump(&of, ends[0], ends[1], 80000);
            ck_assert_double_le(fine, 0.3 * coarse);
        }
    }
}

/* All that is near is found, and next to nothing else: of points whose distance is more than a
 * billionth from the reach. */
TEST(what_is_near_is_told_from_the_rest) {
    static const double reaches[] = {0, 0.01, 0.2};
    for (uint32_t k = 0; k < N_COLLIDERS; k++) {
        struct cs_posed_collider of;
        uint64_t seed = 17;
        bool missed = false, idle = false;
        cs_posed_collider_at(&at_rest, k, 0, &of);
        for (int trial = 0; trial < 30000; trial++) {
            const double reach = reaches[trial % 3];
            double p[3], n[3], h[6];
            draw_point(&seed, &of, p);
            const bool near = cs_posed_collider_is_near(&of, reach, p);
            const double d = cs_posed_collider_distance(&of, p, n);
            missed |= !near &&
                      (d <= reach || cs_posed_collider_smooth_distance(&of, p, n, h) <= reach);
            idle |= near && d > reach + 3e-9;
        }
        ck_assert_msg(!missed, "collider %u of shapes.h: a point within reach is not near", k);
        ck_assert_msg(!idle, "collider %u of shapes.h: a point out of reach is near", k);
    }
}

/* Lines against the least distance of 4001 points on them: it lies within the spacing times the
 * slope of the distance, 1, so that both agree unless it is that near to 0. A plane's line is
 * met as well where its other end is behind. */
TEST(lines_meet_what_their_points_meet) {
    uint32_t met = 0, missed = 0;
    for (uint32_t k = 0; k < N_COLLIDERS; k++) {
        struct cs_posed_collider of;
        uint64_t seed = 13;
        cs_posed_collider_at(&at_rest, k, 0, &of);
        for (int trial = 0; trial < 200; trial++) {
            double from[3], to[3], way[3], p[3], n[3], least = HUGE_VAL;
            draw_point(&seed, &of, from);
            draw_point(&seed, &of, to);
            for (int c = 0; c < 3; c++)
                way[c] = 2 * (to[c] - from[c]);
            for (int s = 0; s <= 4000; s++) {
                for (int c = 0; c < 3; c++)
                    p[c] = from[c] + s / 8000.0 * way[c];
                least = fmin(least, cs_posed_collider_distance(&of, p, n));
            }
            const bool meets = cs_posed_collider_hits_segment(&of, from, way, 0.5);
            ck_assert(meets ? least < 1e-3 : least > -1e-12);
            *(meets ? &met : &missed) += 1;
        }
    }
    ck_assert_uint_gt(met, 200);
    ck_assert_uint_gt(missed, 200);
}

/* --- motion --- */

static struct cs_collider_motion motions[N_COLLIDERS];
static struct cs_system moving = {.scene = &scene, .motions = motions};

static void set_motions(const double rate[3], const double spin[3]) {
    for (int k = 0; k < N_COLLIDERS; k++) {
        motions[k] = (struct cs_collider_motion){
            .t_begin = 1, .t_end = 3, .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        memcpy(motions[k].rate, rate, sizeof motions[k].rate);
        memcpy(motions[k].spin, spin, sizeof motions[k].spin);
        for (int c = 0; c < 3; c++) {
            motions[k].shift_begin[c] = 0.1 * (c + 1);
            motions[k].shift_end[c] = motions[k].shift_begin[c] + 2 * rate[c];
        }
    }
}

/* a quarter turn about y takes x to -z and z to x; the centre goes on by the path alone */
TEST(quarter_turn_is_one) {
    static const double still[3] = {0}, spin[3] = {0, 1.57079632679489661923, 0};
    struct cs_posed_collider before, after;
    set_motions(still, spin);
    cs_posed_collider_at(&moving, BOX, 1, &before);
    cs_posed_collider_at(&moving, BOX, 2, &after);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(after.axes[k][2], -before.axes[k][0], 1e-15);
        ck_assert_double_eq_tol(after.axes[k][0], before.axes[k][2], 1e-15);
        ck_assert_double_eq_tol(after.axes[k][1], before.axes[k][1], 1e-15);
        ck_assert_double_eq(after.centre[k], colliders[BOX].box.centre[k] + 0.1 * (k + 1));
    }
}

/* A point fixed to the obstacle moves with cs_posed_collider_velocity: central differences over
 * 2 ms; truncation |w|^3 r dt^2 / 6. Before, at, and behind the end of the chord alike. */
TEST(velocity_is_that_of_the_matter) {
    static const double rate[3] = {0.3, -0.2, 0.5}, spin[3] = {1, -2, 0.5}, dt = 1e-3;
    static const double own[3] = {0.3, 0.2, -0.4}, times[] = {1.5, 2.2, 3, 3.4};
    set_motions(rate, spin);
    for (uint32_t k = 0; k < N_COLLIDERS; k++)
        for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
            double places[3][3], v[3];
            for (int s = 0; s < 3; s++) {
                struct cs_posed_collider of;
                cs_posed_collider_at(&moving, k, times[i] + (s - 1) * dt, &of);
                for (int c = 0; c < 3; c++)
                    places[s][c] = of.centre[c] + own[0] * of.axes[0][c] +
                                   own[1] * of.axes[1][c] + own[2] * of.axes[2][c];
                if (s == 1)
                    cs_posed_collider_velocity(&of, places[1], v);
            }
            for (int c = 0; c < 3; c++)
                ck_assert_double_eq_tol(v[c], (places[2][c] - places[0][c]) / (2 * dt), 2e-6);
        }
}

/* axes stay unit vectors at right angles, and the shift meets the end of its chord exactly */
TEST(moved_obstacle_stays_rigid) {
    static const double rate[3] = {0.1, 0.7, -0.3}, spin[3] = {40, 3, -25};
    struct cs_posed_collider of;
    set_motions(rate, spin);
    cs_posed_collider_at(&moving, BOX, 3, &of);
    for (int i = 0; i < 3; i++) {
        ck_assert_double_eq(of.centre[i],
                            colliders[BOX].box.centre[i] + motions[BOX].shift_end[i]);
        for (int j = 0; j < 3; j++)
            ck_assert_double_eq_tol(of.axes[i][0] * of.axes[j][0] +
                                        of.axes[i][1] * of.axes[j][1] +
                                        of.axes[i][2] * of.axes[j][2],
                                    i == j, 2e-15);
    }
}

/* the triangles of a shape, in its own frame and placed: each corner on the surface */
TEST(triangles_lie_on_the_surface) {
    for (uint32_t k = 0; k < N_COLLIDERS; k++) {
        struct cs_arena arena = {0};
        struct cs_error error = {0};
        struct cs_trimesh mesh = {0};
        struct cs_posed_collider of;
        cs_posed_collider_at(&at_rest, k, 0, &of);
        of.shape->triangles(&of, &mesh, &arena, &error);
        UNIT_ASSERT_OK(&error);
        ck_assert_uint_gt(mesh.n_triangles, 1);
        for (size_t i = 0; i < mesh.n; i++) {
            const double own[3] = {mesh.positions[i], mesh.positions[mesh.n + i],
                                   mesh.positions[2 * (size_t)mesh.n + i]};
            double p[3], n[3];
            cs_collider_to_world(&of, own, p);
            ck_assert_double_eq_tol(cs_posed_collider_distance(&of, p, n), 0, 1e-14);
        }
        cs_arena_finish(&arena);
    }
}

/* of every shape of the list all that is asked without looking */
TEST(every_shape_answers) {
#define X(name, keys, text)                                                                    \
    ck_assert(cs_##name##_keys.n > 0 && cs_##name##_keys.optional);                            \
    ck_assert(cs_shape_##name.pose &&cs_shape_##name.distance &&cs_shape_##name                \
                  .smooth &&cs_shape_##name.meets_line &&cs_shape_##name.triangles);
    CS_SHAPE_LIST(X)
#undef X
}
