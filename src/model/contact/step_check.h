/* step_check.h - whether a step has gone into contact further than it can know. */
#ifndef CS_CONTACT_STEP_CHECK_H
#define CS_CONTACT_STEP_CHECK_H

#include "model/contact/collider_params.h"
#include "model/contact/posed_collider.h"

/* A step sees of contact at most its force and its stiffness where it begins. For a particle
 * that goes straight from x0 at t0 to x1 at t1, with the approach s of its distance d to an
 * obstacle,
 *
 *   e = |psi(d - s) - psi(d) - F s - K s^2/2|
 *
 * is the energy that the step does not see, at the worst of points along the way that lie half
 * a range apart (so that nothing is jumped over). True if e is below CS_UNRESOLVED_ENERGY_MAX
 * of what the particle has: the kinetic energy of the move against the obstacle and psi(d). x0,
 * x1 (3,n) in m. Particles that are not finite are left for the blow-up test. */
#define CS_UNRESOLVED_ENERGY_MAX 0.02
bool cs_collider_contact_resolves_step(const struct cs_system *system, double t0,
                                       const double *x0, double t1, const double *x1);

/* One obstacle during a step of h seconds: for points that are no particles. */
struct cs_collider_step {
    const struct cs_system *system;
    const double *x0, *x1; /* (3,n) m */
    double h;
    struct cs_posed_collider at_t0, at_t1;
    struct cs_collider_params params;
};
/* Sets all but x0 and x1. */
void cs_collider_step_set(struct cs_collider_step *passing, const struct cs_system *system,
                          uint32_t collider, double t0, double t1);

/* true if `count` particles from `begin` on, and what lies between them, stay out of range. */
bool cs_collider_step_is_far(const struct cs_collider_step *passing, size_t begin,
                             size_t count);

/* true if a point of that mass in kg, going from `from` to `to`, has e above that share. */
bool cs_collider_step_misses_contact(const struct cs_collider_step *passing, double mass,
                                     const double from[3], const double to[3]);

#endif
