/* shape_core.h - distance, line test and surface of a core and all points within a radius of
 * it.
 */
#ifndef CS_SHAPE_CORE_H
#define CS_SHAPE_CORE_H

#include "scene/collider.h"

#include <math.h>

/* Returns the distance of p from a point, in m; n = unit vector away from it, up if p is
 * there. */
static inline double cs_core_from_point(const double p[3], const double centre[3],
                                        double n[3]) {
    double squared = 0;
    for (int c = 0; c < 3; c++) {
        n[c] = p[c] - centre[c];
        squared += n[c] * n[c];
    }
    const double length = sqrt(squared);
    for (int c = 0; c < 3; c++)
        n[c] = length > 0 ? n[c] / length : c == 1;
    return length;
}

/* Completes a right-handed orthonormal frame about the given unit vector axes[1]. */
void cs_core_complete_axes(double axes[3][3]);

/* Sets x = p in the own frame, and out = the vector to it from the nearest point of the core.
 * Returns true if p is in the core; out is then 0. */
bool cs_core_holds(const struct cs_posed_collider *collider, const double p[3], double x[3],
                   double out[3]);

/* Returns the distance in m of a point outside the core from the surface, and sets the normal n
 * in the world; `out` as of cs_core_holds. */
double cs_core_beyond(const struct cs_posed_collider *collider, const double out[3],
                      double n[3]);

/* Returns the axis along which x, of the own frame, is nearest to a face of the core. */
int cs_core_nearest_face(const struct cs_posed_collider *collider, const double x[3]);

/* Three times the height of a chord of one diagonal, for cloth seen at a slant, but at most a
 * quarter of the radius. A chord of length l lies l^2 / (8 r) deep; here l^2 = 2 cell^2. */
static inline double cs_core_chord_depth(const struct cs_posed_collider *collider,
                                         double cell) {
    return fmin(3 * cell * cell / (4 * collider->radius), collider->radius / 4);
}

/* Calls of struct cs_shape (collider.h), for shapes with a core. */
double cs_core_smooth(const struct cs_posed_collider *collider, const double p[3],
                      double gradient[3], double hessian[6]);
bool cs_core_meets_line(const struct cs_posed_collider *collider, const double from[3],
                        const double way[3], double share);
enum cs_status cs_core_triangles(const struct cs_posed_collider *collider,
                                 struct cs_trimesh *mesh, struct cs_arena *arena,
                                 struct cs_error *error);

/* Maps a direction to the surface: the surface of a cube is blown up to a sphere and pulled
 * apart by the core. A direction d becomes the point sides core + radius d of the own frame;
 * sides are the signs of d. Grids of directions on the faces of the cube have even steps of
 * angle. The line in the middle of a face exists twice, once for each sign: the strips between
 * the two are the flat parts. If the core has no extent they coincide. Normalises the
 * direction, which is the normal. */
static inline void cs_core_surface(const struct cs_posed_collider *collider,
                                   const double sides[3], double direction[3],
                                   double place[3]) {
    cs_vec3_normalise(direction);
    for (int k = 0; k < 3; k++)
        place[k] = sides[k] * collider->half_sizes[k] + collider->radius * direction[k];
}

#endif
