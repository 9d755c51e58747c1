/* Impacts and prods over an interval: f = m a, the same a for all particles of an impact, the
 * same f for all that a prod sees. To a method they are gravity: what leaves springs out, or
 * takes what is outside apart, has them with it. */
#include "model/force/terms.h"

static void add_force(const struct cs_system *system, double t, const double *x,
                      const double *v, uint32_t parts, const struct cs_block *block,
                      double *f) {
    (void)t, (void)x, (void)v, (void)parts;
    const size_t n = system->view.n;
    const double *push = system->push;
    for (size_t c = 0; push && c < 3; c++)
        for (size_t i = block->begin; i < block->end; i++)
            f[c * n + i] += system->mass[i] * push[c * n + i];
}

const struct cs_term cs_term_push = {
    .parts = CS_PART_EXTERNAL,
    .feature = CS_FEATURE_EVENTS,
    .add_force = add_force,
};
