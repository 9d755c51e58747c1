/* posed_collider.h - colliders as geometry at a time: pose, distance of a point, velocity of
 * the surface. Contact, visibility and pictures share it; the shapes are in scene/collider.h.
 */
#ifndef CS_POSED_COLLIDER_H
#define CS_POSED_COLLIDER_H

#include "model/system/particle_system.h"
#include "scene/collider.h"

#include <string.h>

/* Motion of one collider by an event, until the next change of its path. Its shift is
 * s = shift_begin + rate (t - t_begin), and it rotates with `spin` on from `rotation` to R(t):
 * its centre is at c + s + pivot + R arm, c in the scene. Both continue beyond t_end, so that a
 * stage of a method that lies there meets no kink. */
struct cs_collider_motion {
    double t_begin, t_end;                        /* s */
    double shift_begin[3], shift_end[3], rate[3]; /* m, m, m/s: the shift at both ends */
    /* rotation reached at t_begin, by rows */
    double rotation[9];
    double spin[3]; /* rad/s */
    /* m, from the shifted centre at rest to the point of rotation, and from there to the centre
     * of the collider in its own frame; 0: it turns about its centre. */
    double pivot[3], arm[3];
    uint32_t event; /* number of the event that moves it + 1; 0: none */
    /* While a ramp changes the radius: radius_begin + radius_rate (t - t_growth) in m and m/s.
     * growth: its rate and that of the thickness; 0: neither changes. */
    bool radius_changes;
    double t_growth, radius_begin, radius_rate, growth;
};

/* Poses of all colliders at t in the scene's order: out (scene->colliders.n); or of collider k
 * alone. Only + - * / and sqrt are used, so that all machines have the same bits. */
void cs_posed_colliders_at(const struct cs_system *system, double t,
                           struct cs_posed_collider *out);
void cs_posed_collider_at(const struct cs_system *system, uint32_t k, double t,
                          struct cs_posed_collider *out);

/* Poses at time 0, wherever events have moved the colliders since. */
void cs_posed_colliders_at_start(const struct cs_system *system, struct cs_posed_collider *out);

/* Shift in m and rotation (by rows) of a motion at t. */
void cs_posed_collider_translate(const struct cs_collider_motion *motion, double t,
                                 double shift[3]);
void cs_posed_collider_rotate(const struct cs_collider_motion *motion, double t,
                              double turn[9]);

/* Signed distance in m of p from the surface without thickness, negative inside, exact on both
 * sides; n: outward unit normal of the nearest surface point. At the centre of a sphere and on
 * the axis of a capsule n points up. Not finite if p is not, and for a mesh. */
static inline double cs_posed_collider_distance(const struct cs_posed_collider *collider,
                                                const double p[3], double n[3]) {
    return collider->shape->distance(collider, 0, p, n);
}

/* The same from the surface offset by the collider's thickness, onto which projection moves
 * particles. */
double cs_posed_collider_signed_distance(const struct cs_posed_collider *collider,
                                         const double p[3], double n[3]);

/* Returns whether p may be within `reach` (m, >= 0) of the surface or inside; a test of a few
 * nanoseconds before a distance is computed. False only if the distance, exact or smooth, is
 * larger. NaN may give either. */
static inline bool cs_posed_collider_is_near(const struct cs_posed_collider *collider,
                                             double reach, const double p[3]) {
    const double d[3] = {p[0] - collider->centre[0], p[1] - collider->centre[1],
                         p[2] - collider->centre[2]};
    // far above the rounding of either side
    const double all = (collider->radius + reach) * (1 + 1e-9);
    const double *normal = collider->axes[1];
    double squared = 0;
    switch (collider->shape->bounds) {
    case CS_BOUNDS_SPHERE:
        return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= all * all;
    case CS_BOUNDS_HALF_SPACE:
        return normal[0] * d[0] + normal[1] * d[1] + normal[2] * d[2] <= all + 1e-9;
    case CS_BOUNDS_MESH:
        return false;
    case CS_BOUNDS_BOX:
        for (int k = 0; k < 3; k++) {
            const double *axis = collider->axes[k];
            const double x = axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2];
            const double out = (x < 0 ? -x : x) - collider->half_sizes[k];
            squared += out > 0 ? out * out : 0;
        }
    }
    return squared <= all * all;
}

/* Lists those of `count` points, in their order, that the same test passes with `reach` (count)
 * of each; x: of the first point, in rows of n. Returns their number. */
enum { CS_COLLIDER_ROW = 64 }; /* points at most */
uint32_t cs_posed_collider_list_near(const struct cs_posed_collider *collider,
                                     const double *reach, size_t n, const double *x,
                                     size_t count, uint8_t list[CS_COLLIDER_ROW]);

/* Returns whether two poses of a collider differ by a shift alone. */
static inline bool cs_posed_collider_is_shifted(const struct cs_posed_collider *a,
                                                const struct cs_posed_collider *b) {
    return a->radius == b->radius && !memcmp(a->axes, b->axes, sizeof a->axes);
}

/* Smooth distance in m, on which the contact force depends: never smaller than the distance
 * outside, with three continuous derivatives there. It is exact for spheres, planes and the
 * flat faces of boxes. At the ends of a capsule's axis and at the edges of a box the nearest
 * point of the core moves from one feature to the next, by the quintic of scene/shape_core.h.
 * It does so within a band of half the radius to both sides. The distance is there too large by
 * at most 0.005 of the radius on an edge and 0.01 on a corner. Inside the core of a box it goes
 * on as the distance does, with the same bend where the nearest face changes.
 *
 * gradient  of that function; its length is 1 where the distance is exact, never 0
 * hessian   of that function in 1/m: xx, xy, xz, yy, yz, zz; 0 where n points up by default */
static inline double cs_posed_collider_smooth_distance(const struct cs_posed_collider *collider,
                                                       const double p[3], double gradient[3],
                                                       double hessian[6]) {
    return collider->shape->smooth(collider, p, gradient, hessian);
}

/* Returns whether the segment from `from` to from + share way enters the collider. */
static inline bool cs_posed_collider_hits_segment(const struct cs_posed_collider *collider,
                                                  const double from[3], const double way[3],
                                                  double share) {
    return collider->shape->meets_line(collider, from, way, share);
}

/* out = vector i of x (3,n), which colliders are asked about. */
static inline void cs_point_read(const double *x, size_t n, size_t i, double out[3]) {
    for (size_t c = 0; c < 3; c++)
        out[c] = x[c * n + i];
}

/* v = velocity in m/s of the collider's matter at p: velocity + spin x (p - rotation_centre),
 * and growth along the normal. */
void cs_posed_collider_velocity(const struct cs_posed_collider *collider, const double p[3],
                                double v[3]);

/* Largest depth in m of a free particle behind the surface of a collider at t, by the law of
 * contact that acts or without one, at least 0. Thickness does not count, and meshes, which may
 * be open, have no inside. */
double cs_posed_colliders_depth(const struct cs_system *system, double t, const double *x);

/* Position in m of vertex i of a mesh, and its velocity in m/s, by its pose, its motion and its
 * key frames; v may be NULL. */
void cs_posed_collider_vertex(const struct cs_posed_collider *collider, uint32_t i, double p[3],
                              double v[3]);

#endif
