/* Bending of elastic bodies as a term: the kernels of elastic/bending_forces.h. */
#include "model/elastic/bending_forces.h"
#include "model/force/term.h"

static struct cs_plan_row plan(const struct cs_scene *scene) {
    const struct cs_body *bodies = cs_scene_bodies(scene);
    bool acts = false;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        acts |= bodies[b].elastic.present && bodies[b].elastic.bending.present;
    return (struct cs_plan_row){.built = acts,
                                .reason = acts ? "elastic bodies resist bending" : NULL};
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_bendings_energy(system, at->x);
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    const size_t n = system->view.n;
    (void)matrix;
    for (size_t c = 0; c < 6; c += c ? 2 : 3)
        for (size_t i = begin; i < end; i++)
            blocks[c * n + i] += system->bendings->blocks[i];
}

static void add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    cs_bendings_add_approach(system, matrix->v, y);
}

static void add_bound(const struct cs_system *system, const struct cs_gershgorin *sums) {
    cs_bendings_add_bound(system, sums->stiffness);
}

static const char *const ramps[] = {"bodies.elastic.bending.stiffness",
                                    "bodies.elastic.bending.twist", NULL};

const struct cs_term cs_term_bending = {
    .name = "bending",
    .part_bits = CS_PART_POTENTIAL,
    .plan = plan,
    .build = cs_bendings_build,
    .rampable_keys = ramps,
    .prepare = cs_bendings_prepare,
    .add_force = cs_bendings_add,
    .add_jvp = cs_bendings_add,
    .energy = energy,
    .energy_kind = CS_ENERGY_ELASTIC,
    .prepare_matrix = cs_bendings_prepare_matrix,
    .add_blocks = add_blocks,
    .add_matrix_product = cs_bendings_add_product,
    .add_approach = add_approach,
    .add_bound = add_bound,
};
