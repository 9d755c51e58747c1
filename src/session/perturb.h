/* perturb.h - perturbs the start of a scene reproducibly.
 *
 * The functions add to the state of free particles: displacements of up to `displacement` m and
 * velocities of up to `velocity` m/s in each direction. */
#ifndef CS_PERTURB_H
#define CS_PERTURB_H

#include "model/system/particle_system.h"

/* Adds noise without correlation between particles: it has a component along every mode. After
 * it no spring is at its rest length. */
void cs_perturb_random(struct cs_system *system, double displacement, double velocity);
/* Adds waves of a few particles' length. Their sines come from libm, so the last bits may
 * depend on the library. */
void cs_perturb_smooth(struct cs_system *system, double displacement, double velocity);

#endif
