/* Bounds on frequencies and damping rates by Gershgorin's circles, from all forces. */
#include "model/force/diagnostics.h"

#include "model/force/terms.h"

#include <math.h>
#include <string.h>

/* Largest row sum over mass, of stiffness, and half of that of damping. Pinned particles have
 * the inverse mass 0 and do not count. */
static void take_largest(const struct cs_system *system, const struct cs_gershgorin *sums,
                         double *squared, double *delta) {
    *squared = *delta = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        *squared = fmax(*squared, sums->stiffness[i] * system->inv_mass[i]);
        *delta = fmax(*delta, 0.5 * sums->damping[i] * system->inv_mass[i]);
    }
}

void cs_spectral_bounds_at(const struct cs_system *system, const struct cs_eval *at,
                           double *work, double *omega, double *delta) {
    const size_t n = system->view.n;
    const struct cs_gershgorin sums = {work, work + n};
    double squared;
    memset(work, 0, 2 * n * sizeof *work);
    for (uint32_t k = 0; k < system->n_terms; k++) {
        const struct cs_term *term = system->terms[k];
        if (at && term->add_state_bound)
            term->add_state_bound(system, at, &sums);
        else if (term->add_bound)
            term->add_bound(system, &sums);
    }
    take_largest(system, &sums, &squared, delta);
    *omega = sqrt(squared);
}

/* Tells whether a force has bounds only at a state. */
static bool has_rate(const struct cs_term *term) {
    return term->add_state_bound && !term->add_bound;
}

bool cs_spectral_bounds_depend_on_state(const struct cs_system *system) {
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (has_rate(system->terms[k]))
            return true;
    return false;
}

void cs_spectral_bounds_rate(const struct cs_system *system, const struct cs_eval *at,
                             double *work, double *omega, double *delta) {
    const size_t n = system->view.n;
    const struct cs_gershgorin sums = {work, work + n};
    double squared;
    memset(work, 0, 2 * n * sizeof *work);
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (has_rate(system->terms[k]))
            system->terms[k]->add_state_bound(system, at, &sums);
    take_largest(system, &sums, &squared, delta);
    // triangle inequality: the bounds of omega^2 and of delta add up
    *omega = sqrt(system->view.omega * system->view.omega + squared);
    *delta += system->view.delta;
}

void cs_spectral_bounds_set(struct cs_system *system, double *work) {
    cs_spectral_bounds_at(system, NULL, work, &system->view.omega, &system->view.delta);
}
