/* Springs with dampers: the kernels of springs.h as a term. */
#include "model/force/terms.h"

static void add_force(const struct cs_system *system, double t, const double *x,
                      const double *v, uint32_t parts, const struct cs_block *block,
                      double *f) {
    (void)t;
    cs_springs_add_force(&system->springs, system->view.n, x, v, parts, block, f);
}

static double energy(const struct cs_system *system, const double *x) {
    return cs_springs_energy(&system->springs, system->view.n, x, CS_PART_SPRINGS);
}

static void add_jvp(const struct cs_system *system, double t, const double *x, const double *v,
                    uint32_t parts, const double *dx, const double *dv,
                    const struct cs_block *block, double *df) {
    (void)t;
    cs_springs_add_jvp(&system->springs, system->view.n, x, v, parts, dx, dv, block, df);
}

static void add_diagonal(const struct cs_system *system, const double *x, double *kxx,
                         double *dvv) {
    cs_springs_add_diagonal(&system->springs, system->view.n, x, kxx, dvv);
}

const struct cs_term cs_term_springs = {
    .parts = CS_PART_SPRINGS | CS_PART_DAMPING,
    .feature = CS_FEATURE_SPRINGS,
    .add_force = add_force,
    .energy = energy,
    .add_jvp = add_jvp,
    .add_diagonal = add_diagonal,
};
