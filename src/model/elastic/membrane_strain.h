/* membrane_strain.h - strains and stresses of membranes. */
#ifndef CS_MEMBRANE_STRAIN_H
#define CS_MEMBRANE_STRAIN_H

#include "model/elastic/membranes.h"

/* Largest magnitude of the principal strains of all triangles: with the eigenvalues e of
 * Green's strain, sqrt(1 + 2 e) - 1, the change of length over the length. NaNs are skipped; 0
 * without membranes. extends: of triangles that extend more than they shrink. */
double cs_membranes_largest_strain(const struct cs_system *system, const double *x,
                                   bool extends);

/* out (n): the principal strain of largest magnitude among a particle's triangles, with its
 * sign, where it is larger than what is there. */
void cs_membranes_particle_strain(const struct cs_system *system, const double *x, double *out);
/* out (n): likewise of the elastic stress of St. Venant and Kirchhoff, in N per m of the sheet
 * at rest; 0 outside membranes. */
void cs_membranes_particle_stress(const struct cs_system *system, const double *x, double *out);

#endif
