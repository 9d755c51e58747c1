/* posed_collider.h - colliders as geometry: where one is at a time, how far a point is from it,
 * and how fast its surface moves there. Contact, visibility and pictures share this. The shapes
 * are in scene/collider.h.
 */
#ifndef CS_POSED_COLLIDER_H
#define CS_POSED_COLLIDER_H

#include "model/system/system.h"
#include "scene/collider.h"

/* How an event moves one collider until the next turn of its path: the shift is
 * from + rate (t - since), and it turns at `spin` on from `turn`. Beyond `until` both go on, so
 * that a stage of a method that lies there sees no bend. */
struct cs_collider_motion {
    double t_begin, t_end;                        /* s */
    double shift_begin[3], shift_end[3], rate[3]; /* m, m, m/s: the shift at both ends */
    double rotation[9];                           /* rows of the rotation reached at `since` */
    double spin[3];                               /* rad/s */
    uint32_t event; /* number of the event that moves it + 1; 0: none */
};

/* Poses of the system's colliders at t, in the scene's order: out (scene->colliders.n), or only
 * collider k. + - * / and sqrt only. */
void cs_posed_colliders_at(const struct cs_system *system, double t,
                           struct cs_posed_collider *out);
void cs_posed_collider_at(const struct cs_system *system, uint32_t k, double t,
                          struct cs_posed_collider *out);

/* The shift and the rotation, by rows, that a motion has reached at t. */
void cs_posed_collider_translate(const struct cs_collider_motion *motion, double t,
                                 double shift[3]);
void cs_posed_collider_rotate(const struct cs_collider_motion *motion, double t,
                              double turn[9]);

/* Distance in m of p from the surface, without thickness, and the outward unit normal n of the
 * surface point that is nearest. Negative inside, where it is exact too. In the centre of a
 * sphere, or on the axis of a capsule, n points up. Not finite where p is not, and of a mesh.
 */
static inline double cs_posed_collider_distance(const struct cs_posed_collider *obstacle,
                                                const double p[3], double n[3]) {
    return obstacle->shape->distance(obstacle, 0, p, n);
}

/* The same from the surface moved out by the collider's thickness, which is where projection
 * puts a particle. */
static inline double cs_posed_collider_signed_distance(const struct cs_posed_collider *obstacle,
                                                       const double p[3], double n[3]) {
    return obstacle->shape->distance(obstacle, obstacle->collider->thickness, p, n);
}

/* true if p may be nearer to the surface than `reach` (m, 0 or more) or inside: a test of a few
 * nanoseconds before a distance is asked for. False only where the distance, exact or smooth,
 * is larger; what is not a number may be told either way. */
static inline bool cs_posed_collider_is_near(const struct cs_posed_collider *obstacle,
                                             double reach, const double p[3]) {
    const double d[3] = {p[0] - obstacle->centre[0], p[1] - obstacle->centre[1],
                         p[2] - obstacle->centre[2]};
    // far above the rounding of either side
    const double all = (obstacle->radius + reach) * (1 + 1e-9);
    const double *normal = obstacle->axes[1];
    double squared = 0;
    switch (obstacle->shape->bounds) {
    case CS_BOUNDS_SPHERE:
        return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= all * all;
    case CS_BOUNDS_HALF_SPACE:
        return normal[0] * d[0] + normal[1] * d[1] + normal[2] * d[2] <= all + 1e-9;
    case CS_BOUNDS_MESH:
        return false;
    case CS_BOUNDS_BOX:
        for (int k = 0; k < 3; k++) {
            const double *axis = obstacle->axes[k];
            const double x = axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2];
            const double out = (x < 0 ? -x : x) - obstacle->half_sizes[k];
            squared += out > 0 ? out * out : 0;
        }
    }
    return squared <= all * all;
}

/* The distance as the force of contact takes it: never smaller than the distance outside, with
 * three continuous derivatives there. Sphere, plane and the flat faces of a box: exact. At the
 * ends of a capsule's axis and at the edges of a box the nearest point of the core moves over
 * from one feature to the next within a band of half the radius to both sides, by a quintic
 * (soft.h); the distance is at most 0.005 of the radius too large on an edge and 0.01 on
 * a corner.
 * gradient  of that function; its length is 1 where the distance is exact, never 0
 * hessian   1/m, of that function: xx, xy, xz, yy, yz, zz; 0 where n points up by default
 * Inside the core of a box it goes on as the distance does, with the same bend where the
 * nearest face changes. */
static inline double cs_posed_collider_smooth_distance(const struct cs_posed_collider *obstacle,
                                                       const double p[3], double gradient[3],
                                                       double hessian[6]) {
    return obstacle->shape->smooth(obstacle, p, gradient, hessian);
}

/* true if the line from `from` to from + share way comes into the obstacle. */
static inline bool cs_posed_collider_hits_segment(const struct cs_posed_collider *obstacle,
                                                  const double from[3], const double way[3],
                                                  double share) {
    return obstacle->shape->meets_line(obstacle, from, way, share);
}

/* v = velocity in m/s of the obstacle's matter at p. */
void cs_posed_collider_velocity(const struct cs_posed_collider *obstacle, const double p[3],
                                double v[3]);

#endif
