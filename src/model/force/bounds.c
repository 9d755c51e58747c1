#include "model/force/bounds.h"

#include <math.h>

void cs_bounds_set(struct cs_system *system, double *work) {
    const uint32_t n = system->view.n;
    double *stiffness = work, *damping = work + n;
    for (uint32_t i = 0; i < 2 * n; i++)
        work[i] = 0;
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            const uint32_t a = cs_spring_a(run, i), b = cs_spring_b(run, i);
            stiffness[a] += cs_spring_stiffness(run, i);
            stiffness[b] += cs_spring_stiffness(run, i);
            damping[a] += run->damping;
            damping[b] += run->damping;
        }
    }

    double squared = 0, delta = 0;
    const struct cs_forces *forces = &system->scene->forces;
    for (uint32_t i = 0; i < n; i++) {
        const double drag =
            forces->drag *
            (system->area && forces->drag_unit == CS_DRAG_AREA ? system->area[i] : 1);
        squared = fmax(squared, 2 * stiffness[i] * system->inv_mass[i]);
        delta = fmax(delta, (damping[i] + 0.5 * drag) * system->inv_mass[i]);
    }
    system->view.omega = sqrt(squared);
    system->view.delta = delta;
}
