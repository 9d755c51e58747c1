/* Gravity: f = m g; its potential -m g.x is 0 at the origin. */
#include "model/force/terms.h"

static void add_force(const struct cs_system *system, double t, const double *x,
                      const double *v, uint32_t parts, const struct cs_block *block,
                      double *f) {
    (void)t, (void)x, (void)v, (void)parts;
    const size_t n = system->view.n;
    for (size_t c = 0; c < 3; c++) {
        const double g = system->scene->forces.gravity[c];
        for (size_t i = block->begin; i < block->end && g != 0; i++)
            f[c * n + i] += system->mass[i] * g;
    }
}

static double energy(const struct cs_system *system, const double *x) {
    const uint32_t n = system->view.n;
    const double *g = system->scene->forces.gravity;
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum -= system->mass[i] *
               (g[0] * x[i] + g[1] * x[n + (size_t)i] + g[2] * x[2 * (size_t)n + i]);
    return sum;
}

const struct cs_term cs_term_gravity = {
    .parts = CS_PART_GRAVITY,
    .feature = CS_FEATURE_GRAVITY,
    .add_force = add_force,
    .energy = energy,
};
