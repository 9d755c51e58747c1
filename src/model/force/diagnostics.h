/* diagnostics.h - measures a state: energies, strains, speeds and forces. */
#ifndef CS_DIAGNOSTICS_H
#define CS_DIAGNOSTICS_H

#include "model/system/particle_system.h"

/* Energies of a state in J. Gravity's potential is 0 at the origin. */
struct cs_energy {
    double kinetic, elastic, gravity;
    double other; /* potential of all other forces that have one, such as contact */
};

/* Kinetic energy in J: the sum of m |v|^2 / 2. */
double cs_measure_kinetic(const struct cs_system *system, const double *v);

/* f (3,n) in N = the chosen parts at (t, x, v), on pinned particles too: the pin carries this
 * force, and does work if it moves. Normals become those of x. */
void cs_diagnostics_force(const struct cs_system *system, double t, const double *x,
                          const double *v, uint32_t parts, double *f);

/* sum (3) += factor times the sum of weight a x b over particles; a and b are (3,n), weight (n)
 * or NULL for 1. With the masses, positions and velocities: the angular momentum. */
void cs_diagnostics_add_moment(const struct cs_system *system, const double *weight,
                               double factor, const double *a, const double *b, double sum[3]);

/* All energies of a state at time t; x and v are (3,n). Contact counts as `other`. */
struct cs_energy cs_diagnostics_energy(const struct cs_system *system, double t,
                                       const double *x, const double *v);

/* Total energy, and total without gravity: the energy of motion and of forces between
 * particles. */
static inline double cs_energy_total(const struct cs_energy *energy) {
    return energy->kinetic + energy->elastic + energy->gravity + energy->other;
}

static inline double cs_energy_without_gravity(const struct cs_energy *energy) {
    return energy->kinetic + energy->elastic + energy->other;
}

/* Shortest rest length in m of all springs and edges of membranes; 0 without any. */
double cs_diagnostics_shortest(const struct cs_system *system);

/* Largest |l / L - 1| over all springs, and largest principal strain of membranes; 0 without
 * both. */
double cs_diagnostics_strain(const struct cs_system *system, const double *x);

/* Largest l / L - 1 over the springs of all bodies without a network, which are no cloth, and
 * largest principal strain of membranes, at least 0: tension alone, since folds compress
 * springs without harm. */
double cs_diagnostics_extension(const struct cs_system *system, const double *x);

/* The strain per particle: the strain of largest magnitude among its springs and triangles,
 * with its sign; out (n). */
void cs_diagnostics_particle_strain(const struct cs_system *system, const double *x,
                                    double *out);

/* Returns the largest speed in m/s. *count is the number of particles above the limit or with a
 * NaN, *fastest the first particle that has the largest speed. */
double cs_measure_speed(const struct cs_system *system, const double *v, double limit,
                        uint32_t *fastest, uint32_t *count);

/* Magnitude in N of the total force on each particle, 0 on pinned ones; out (n), work (3,n). */
void cs_diagnostics_particle_force(const struct cs_system *system, double t, const double *x,
                                   const double *v, double *out, double *work);

/* Largest magnitude of n values after the hundredth (rounded down) that is largest has been
 * left out, to the precision of a float. A robust upper end for colour scales. Values that are
 * not finite are skipped; 0 if there is none. */
double cs_diagnostics_magnitude(const double *values, uint32_t n);

/* Smallest and largest of n values; 0 and 0 if n is 0. */
void cs_diagnostics_range(const double *values, uint32_t n, double range[2]);

/* Bounds on frequencies and damping rates, for automatic steps.
 *
 * Gershgorin's theorem with 3x3 blocks instead of numbers (Golub, Van Loan 2013): every
 * eigenvalue of M^-1 K has a magnitude of at most
 *
 *   max over the particles i of (sum over j of |K_ij|) / m_i
 *
 * with the spectral norm of the blocks. omega^2 is that of K = df/dx, and delta is half of that
 * of df/dv: the modes of M x'' = K x + D x' have angular frequencies of at most omega and
 * damping rates of at most 2 delta. */

/* Bounds from all forces, omega in 1/s and delta in 1/s. at: at that state; NULL: for the whole
 * run, as far as forces have such bounds (springs of at least half their rest length, dampers,
 * drag). work has 2n doubles. */
void cs_spectral_bounds_at(const struct cs_system *system, const struct cs_eval *at,
                           double *work, double *omega, double *delta);

/* Friction of contact limits the step of an explicit method only up to a ratio of its damping
 * rate r = mu N/(m ev) to the frequency w = sqrt(K/m) of the contact.
 *
 * The force is at most mu N, so a longer step h is stable: a particle chatters by mu N h/(2 m).
 * With r limited to R w, h is at most 2/(R w). The barrier law has N/(m w) = F/sqrt(K m) <=
 * sqrt(4 psi/(3 m)), and psi is at most the energy m u^2/2 of an impact at the speed u. The
 * chatter is thus at most 0.82 mu u/R, and its energy (0.82 mu/R)^2 of that of the impact:
 * 0.034 mu u and 1.2e-3 mu^2 with the ratio of impacts. Rest is followed further, up to 4 g/ev
 * within the second ratio: under the load of n weights the chatter is mu n ev/8 at most. */
#define CS_FRICTION_IMPACT_RATIO 24.0
#define CS_FRICTION_RATE_RATIO   64.0
#define CS_FRICTION_REST_LOADS   4.0

/* The view's bounds, increased by those of forces that have bounds only at a state
 * (add_state_bound without add_bound in struct cs_term), such as contact. With forces that have
 * both, such as membranes, the bounds of all at the state, not below the view's. is_explicit:
 * for the step of an explicit method. work as above. */
void cs_spectral_bounds_rate(const struct cs_system *system, const struct cs_eval *at,
                             bool is_explicit, double *work, double *omega, double *delta);

/* Tells whether the scene has forces with bounds at a state. */
bool cs_spectral_bounds_depend_on_state(const struct cs_system *system);

/* Tells whether bounds can rise from one step to the next, as those of contact do: bounds of
 * elastic bodies change with their motion. */
bool cs_spectral_bounds_can_jump(const struct cs_system *system);

/* Sets view.omega and view.delta to the bounds for the whole run. */
void cs_spectral_bounds_set(struct cs_system *system, double *work);

#endif
