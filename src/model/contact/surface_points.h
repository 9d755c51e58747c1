/* surface_points.h - positions and velocities of the points of all surfaces: the particles,
 * followed by the vertices of mesh colliders, which are not part of the state.
 *
 * Arrays of points are (3, n_points of surfaces.h), those of particles (3,n). Without mesh
 * colliders both are the same array, and nothing is copied. */
#ifndef CS_CONTACT_SURFACE_POINTS_H
#define CS_CONTACT_SURFACE_POINTS_H

#include "model/system/surfaces.h"

struct cs_points;

/* Builds system->surfaces, and system->points if a collider is a mesh, unless they exist.
 * CS_ERR_MEMORY. */
enum cs_status cs_surface_points_build(struct cs_system *system, struct cs_error *error);

/* Positions of all points at t, with the particles at x (3,n). Each end of a step has a buffer
 * of its own; the result is valid until the next call for the same end. */
enum cs_points_end { CS_POINTS_BEGIN, CS_POINTS_END };
const double *cs_surface_points_positions(const struct cs_system *system,
                                          enum cs_points_end end, double t, const double *x);

/* Velocities of all points at t, with those of particles in v (3,n), or 0 if v is NULL. Valid
 * until the next call; NULL if all are 0. */
const double *cs_surface_points_velocities(const struct cs_system *system, double t,
                                           const double *v);

/* 1/kg; 0: a pinned particle or a point of a collider. */
static inline double cs_surface_points_inverse_mass(const struct cs_system *system,
                                                    uint32_t point) {
    return point < system->view.n ? system->inv_mass[point] : 0;
}

#endif
