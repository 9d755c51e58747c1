/* normals.h - particle normals, for the wind. */
#ifndef CS_NORMALS_H
#define CS_NORMALS_H

#include "model/system/particle_system.h"

/* Writes system->normals (3,n), by all threads: at each particle the unit vector along (right -
 * left) x (up - down), where the particle itself replaces a missing neighbour (cloth thesis,
 * eq. 4.6-4.9). On a mesh, along the sum of the normals of its triangles, each as long as its
 * triangle is large. Where that vector is 0 the normal is 0. */
void cs_normals_update(const struct cs_system *system, const double *x);

/* Change dn of the unit normal of particle i of a body when at->x changes along at->dx. */
void cs_normal_derivative(const struct cs_system *system, const struct cs_body_range *body,
                          uint32_t i, const struct cs_eval *at, double dn[3]);

#endif
