/* normals.h - particle normals, for the wind. */
#ifndef CS_NORMALS_H
#define CS_NORMALS_H

#include "model/system/system.h"

/* Writes system->normals (3,n): at each particle the unit vector along
 * (right - left) x (up - down), the particle itself standing in for a neighbour that is missing
 * (cloth thesis, eq. 4.6-4.9); of a mesh, along the sum of its triangles' normals, each as long
 * as the triangle is large. Where that is 0 the normal is 0. */
void cs_normals_update(const struct cs_system *system, const double *x);

/* Change of the unit normal of particle i of a body when at->x changes along at->dx. */
void cs_normal_derivative(const struct cs_system *system, const struct cs_body_range *body,
                          uint32_t i, const struct cs_eval *at, double dn[3]);

#endif
