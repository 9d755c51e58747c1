/* Elastic bodies as terms: membranes by the kernels of elastic/membrane_forces.h, their bending
 * by those of elastic/normal_stencil.h. */
#include "model/elastic/membrane_forces.h"
#include "model/elastic/normal_stencil.h"
#include "model/force/term.h"
#include "scene/body_keys.h"

static struct cs_plan_row membrane_plan(const struct cs_scene *scene) {
    const bool acts = cs_scene_first_elastic(scene) < scene->bodies.n;
    return (struct cs_plan_row){.built = acts, .reason = acts ? "bodies are elastic" : NULL};
}

static enum cs_status membrane_build(struct cs_system *system, struct cs_error *error) {
    return cs_membranes_build(system, error) ? error->status
                                             : cs_membrane_surrogate_build(system, error);
}

static void membrane_add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                                size_t begin, size_t end, double *blocks) {
    const size_t n = system->view.n;
    (void)matrix;
    for (size_t c = 0; c < 6; c++)
        for (size_t i = begin; i < end; i++)
            blocks[c * n + i] += system->membranes->blocks[c * n + i];
}

/* Sums at rest. A stretched membrane is stiffer: methods ask for the bound at a state. */
static void membrane_add_bound(const struct cs_system *system,
                               const struct cs_gershgorin *sums) {
    cs_membranes_add_bound(system, NULL, sums->stiffness, sums->damping);
}

static void membrane_add_state_bound(const struct cs_system *system, const struct cs_eval *at,
                                     const struct cs_gershgorin *sums) {
    cs_membranes_add_bound(system, at, sums->stiffness, sums->damping);
}

static const char *const membrane_ramps[] = {"bodies.elastic.membrane.young",
                                             "bodies.elastic.membrane.shear",
                                             "bodies.elastic.damping", NULL};

const struct cs_term cs_term_membrane = {
    .name = "membrane",
    .part_bits = CS_PART_ELASTIC | CS_PART_ELASTIC_DAMPING,
    .plan = membrane_plan,
    .build = membrane_build,
    .rampable_keys = membrane_ramps,
    .prepare = cs_membranes_prepare,
    .add_force = cs_membranes_add,
    .add_jvp = cs_membranes_add,
    .energy = cs_membranes_energy,
    .energy_kind = CS_ENERGY_ELASTIC,
    .prepare_matrix = cs_membranes_prepare_matrix,
    .add_blocks = membrane_add_blocks,
    .add_matrix_product = cs_membranes_add_product,
    .add_approach = cs_membranes_add_approach,
    .add_bound = membrane_add_bound,
    .add_state_bound = membrane_add_state_bound,
};

static struct cs_plan_row bending_plan(const struct cs_scene *scene) {
    const struct cs_body *bodies = cs_scene_bodies(scene);
    bool acts = false;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        acts |= cs_elastic_bends(&bodies[b].elastic);
    return (struct cs_plan_row){.built = acts,
                                .reason = acts ? "elastic bodies resist bending" : NULL};
}

static enum cs_status bending_build(struct cs_system *system, struct cs_error *error) {
    return cs_bendings_build(system, error) ? error->status
                                            : cs_normal_curvature_build(system, error);
}

static double bending_energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_bendings_energy(system, at->x);
}

static void bending_add_bound(const struct cs_system *system,
                              const struct cs_gershgorin *sums) {
    cs_bendings_add_bound(system, system->state, sums->stiffness, sums->damping);
}

/* Forces along normals depend on the state; the others do not. */
static void bending_add_state_bound(const struct cs_system *system, const struct cs_eval *at,
                                    const struct cs_gershgorin *sums) {
    cs_bendings_add_bound(system, at->x, sums->stiffness, sums->damping);
}

static const char *const bending_ramps[] = {"bodies.elastic.bending.stiffness",
                                            "bodies.elastic.bending.twist",
                                            "bodies.elastic.bending.damping", NULL};

const struct cs_term cs_term_bending = {
    .name = "bending",
    .part_bits = CS_PART_ELASTIC | CS_PART_ELASTIC_DAMPING,
    .plan = bending_plan,
    .build = bending_build,
    .rampable_keys = bending_ramps,
    .prepare = cs_bendings_prepare,
    .add_force = cs_bendings_add,
    .add_jvp = cs_bendings_add,
    .energy = bending_energy,
    .energy_kind = CS_ENERGY_ELASTIC,
    .prepare_matrix = cs_bendings_prepare_matrix,
    .add_blocks = cs_bendings_add_blocks,
    .add_matrix_product = cs_bendings_add_product,
    .add_approach = cs_bendings_add_approach,
    .add_bound = bending_add_bound,
    .add_state_bound = bending_add_state_bound,
};
