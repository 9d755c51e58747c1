/* shape_core.h - what shapes share that are a core and all points within a radius of it. */
#ifndef CS_SHAPE_CORE_H
#define CS_SHAPE_CORE_H

#include "scene/collider.h"

#include <math.h>

/* Distance of p from a point; n = unit vector away from it, up where there is none. */
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

/* axes[1] is there: sets the others at right angles to it, right-handed. */
void cs_core_complete_axes(double axes[3][3]);

/* x = p in the own frame, out = its way there from the core's nearest point; true: it is in the
 * core. */
bool cs_core_holds(const struct cs_posed_collider *collider, const double p[3], double x[3],
                   double out[3]);

/* Distance from the surface of a point that is not in the core, and the normal there. */
double cs_core_beyond(const struct cs_posed_collider *collider, const double out[3],
                      double n[3]);

/* The axis along which x, of the own frame, is nearest to a face of the core. */
int cs_core_nearest_face(const struct cs_posed_collider *collider, const double x[3]);

/* Three times the height of a chord of one diagonal, for cloth seen at a slant. */
static inline double cs_core_chord_depth(const struct cs_posed_collider *collider,
                                         double cell) {
    return fmin(3 * cell * cell / (4 * collider->radius), collider->radius / 4);
}

/* Calls of struct cs_shape. */
double cs_core_smooth(const struct cs_posed_collider *collider, const double p[3],
                      double gradient[3], double hessian[6]);
bool cs_core_meets_line(const struct cs_posed_collider *collider, const double from[3],
                        const double way[3], double share);
enum cs_status cs_core_triangles(const struct cs_posed_collider *collider,
                                 struct cs_trimesh *mesh, struct cs_arena *arena,
                                 struct cs_error *error);

/* The surface is that of a cube blown up to a ball and pulled apart: a direction d stands for
 * the point sides core + radius d of the own frame, the sides being the signs of d. Grids of
 * directions on the faces of the cube are evenly spaced by angle. The line in the middle of a
 * face is there twice, once of each sign: the strips and faces between the two are the flat
 * parts, and where the core has no extent both are one. Makes the direction a unit vector,
 * which is the normal. */
static inline void cs_core_surface(const struct cs_posed_collider *collider,
                                   const double sides[3], double direction[3],
                                   double place[3]) {
    cs_vec3_normalise(direction);
    for (int k = 0; k < 3; k++)
        place[k] = sides[k] * collider->half_sizes[k] + collider->radius * direction[k];
}

#endif
