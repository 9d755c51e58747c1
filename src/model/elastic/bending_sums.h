/* bending_sums.h - energy and bounds of bending. */
#ifndef CS_BENDING_SUMS_H
#define CS_BENDING_SUMS_H

#include "model/elastic/bendings.h"

/* Energy in J. */
double cs_bendings_energy(const struct cs_system *system, const double *x);

/* Adds the row sums at positions x to stiffness (n) in N/m and damping (n) in N s/m. */
void cs_bendings_add_bound(const struct cs_system *system, const double *x, double *stiffness,
                           double *damping);

/* Finds diagonal and row sums of K where the moduli are not those that they were found for. */
void cs_bendings_update_rows(const struct cs_system *system);

#endif
