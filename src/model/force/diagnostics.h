/* diagnostics.h - what a state is like: energy, strain, force. */
#ifndef CS_DIAGNOSTICS_H
#define CS_DIAGNOSTICS_H

#include "model/system/system.h"

struct cs_energy {
    double kinetic, elastic, gravity; /* J; gravity's potential is 0 at the origin */
    double other;                     /* J, potential of all other forces that have one */
};
/* J; the kinetic part alone. */
double cs_measure_kinetic(const struct cs_system *system, const double *v);
struct cs_energy cs_diagnostics_energy(const struct cs_system *system, double t,
                                       const double *x, const double *v);

/* All of it, and all but gravity's: what motion and forces between things hold. */
static inline double cs_energy_total(const struct cs_energy *energy) {
    return energy->kinetic + energy->elastic + energy->gravity + energy->other;
}
static inline double cs_energy_without_gravity(const struct cs_energy *energy) {
    return energy->kinetic + energy->elastic + energy->other;
}

/* Largest |length / rest length - 1| over all springs; 0 without springs. */
double cs_diagnostics_strain(const struct cs_system *system, const double *x);

/* The same per particle: the largest strain (signed) of the springs at it; out (n). */
void cs_diagnostics_particle_strain(const struct cs_system *system, const double *x,
                                    double *out);

/* Largest speed in m/s. *count: particles that are not at the limit or below it, *fastest: the
 * first that is as fast as the fastest. */
double cs_measure_speed(const struct cs_system *system, const double *v, double limit,
                        uint32_t *fastest, uint32_t *count);

/* Magnitude of the whole force on each particle, 0 on pinned ones; out (n), work (3,n). */
void cs_diagnostics_particle_force(const struct cs_system *system, double t, const double *x,
                                   const double *v, double *out, double *work);

/* Largest magnitude of n values but for the hundredth (rounded down) that is farthest from 0;
 * values that are not finite are passed over. To the precision of a float. */
double cs_diagnostics_magnitude(const double *values, uint32_t n);

/* Smallest and largest of n values. */
void cs_diagnostics_range(const double *values, uint32_t n, double range[2]);

#endif
