/* Bounds on frequencies and damping rates by Gershgorin's circles, from all forces. */
#include "model/force/bounds.h"

#include "model/force/terms.h"

#include <math.h>
#include <string.h>

void cs_bounds_at(const struct cs_system *system, const struct cs_eval *at, double *work,
                  double *omega, double *delta) {
    const size_t n = system->view.n;
    const struct cs_row_sums sums = {work, work + n};
    double squared = 0;
    memset(work, 0, 2 * n * sizeof *work);
    for (uint32_t k = 0; k < system->n_terms; k++) {
        const struct cs_term *term = system->terms[k];
        if (at && term->add_bound_at)
            term->add_bound_at(system, at, &sums);
        else if (term->add_bound)
            term->add_bound(system, &sums);
    }
    *delta = 0;
    for (size_t i = 0; i < n; i++) {
        squared = fmax(squared, sums.stiffness[i] * system->inv_mass[i]);
        *delta = fmax(*delta, 0.5 * sums.damping[i] * system->inv_mass[i]);
    }
    *omega = sqrt(squared);
}

void cs_bounds_set(struct cs_system *system, double *work) {
    cs_bounds_at(system, NULL, work, &system->view.omega, &system->view.delta);
}
