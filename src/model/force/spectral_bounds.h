/* spectral_bounds.h - how stiff a system is, for automatic steps. */
#ifndef CS_SPECTRAL_BOUNDS_H
#define CS_SPECTRAL_BOUNDS_H

#include "model/system/system.h"

/* Gershgorin bounds from the 3x3 blocks of all forces. Of the sums of their norms in the rows
 * of free particles, over the mass: omega^2 is the largest of df/dx, delta half the largest of
 * df/dv. at: at that state; NULL: what holds for the whole run, as far as forces can say:
 * springs that are not shorter than half their rest length, dampers, drag. work has 2n doubles.
 */
void cs_spectral_bounds_at(const struct cs_system *system, const struct cs_eval *at,
                           double *work, double *omega, double *delta);

/* The bounds of the view, and on top of them those of the forces that have bounds at a state
 * alone (struct cs_term: add_bound_at without add_bound). work as above. */
void cs_spectral_bounds_rate(const struct cs_system *system, const struct cs_eval *at,
                             double *work, double *omega, double *delta);
/* Whether the scene has such forces. */
bool cs_spectral_bounds_depend_on_state(const struct cs_system *system);

/* Sets view.omega and view.delta to those of the whole run. */
void cs_spectral_bounds_set(struct cs_system *system, double *work);

#endif
