/* perturb.h - starts out of rest, the same on every machine. */
#ifndef CS_PERTURB_H
#define CS_PERTURB_H

#include "model/system/system.h"

/* Adds to the state of the free particles: displacements up to that many m and velocities up to
 * that many m/s in each direction. No spring is then at its rest length. */

/* At random, so that every mode of the cloth is in it. */
void cs_perturb_random(struct cs_system *system, double displacement, double velocity);
/* By waves a few particles long. */
void cs_perturb_smooth(struct cs_system *system, double displacement, double velocity);

#endif
