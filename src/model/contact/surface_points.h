/* surface_points.h - where the points of all surfaces are at a time: the particles of the
 * system, and behind them the vertices of the colliders that are meshes, which are not in the
 * state.
 *
 * Arrays of points are (3, n_points of surfaces.h), as those of particles are (3,n); without
 * such colliders they are the same, and nothing is copied.
 */
#ifndef CS_CONTACT_SURFACE_POINTS_H
#define CS_CONTACT_SURFACE_POINTS_H

#include "model/system/surfaces.h"

struct cs_points;

/* Makes system->surfaces, and where colliders are meshes system->points, if they are not there.
 * CS_ERR_MEMORY. */
enum cs_status cs_surface_points_build(struct cs_system *system, struct cs_error *error);

/* Places of the points at t, with the particles at x (3,n). One place for each end of a step:
 * what it gives is good until it is asked for the same end again. */
enum cs_points_end { CS_POINTS_BEGIN, CS_POINTS_END };
const double *cs_surface_points_positions(const struct cs_system *system,
                                          enum cs_points_end end, double t, const double *x);

/* The points' velocities at t, with v (3,n) those of the particles or NULL: 0; good until it is
 * called again. NULL where all are 0. */
const double *cs_surface_points_velocities(const struct cs_system *system, double t,
                                           const double *v);

/* 1/kg; 0: a point that is held, or of an obstacle. */
static inline double cs_surface_points_inverse_mass(const struct cs_system *system,
                                                    uint32_t point) {
    return point < system->view.n ? system->inv_mass[point] : 0;
}

#endif
