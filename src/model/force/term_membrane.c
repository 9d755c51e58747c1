/* Membranes of elastic bodies as a term: the kernels of elastic/membrane_forces.h. */
#include "model/elastic/membrane_forces.h"
#include "model/elastic/membrane_matrix.h"
#include "model/elastic/membrane_surrogate.h"
#include "model/force/term.h"

static struct cs_plan_row plan(const struct cs_scene *scene) {
    const bool acts = cs_scene_first_elastic(scene) < scene->bodies.n;
    return (struct cs_plan_row){.built = acts, .reason = acts ? "bodies are elastic" : NULL};
}

static enum cs_status build(struct cs_system *system, struct cs_error *error) {
    return cs_membranes_build(system, error) ? error->status
                                             : cs_membrane_surrogate_build(system, error);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_membranes_energy(system, at->x);
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    const size_t n = system->view.n;
    (void)matrix;
    for (size_t c = 0; c < 6; c++)
        for (size_t i = begin; i < end; i++)
            blocks[c * n + i] += system->membranes->blocks[c * n + i];
}

/* Sums at rest. A stretched membrane is stiffer: methods ask for the bound at a state. */
static void add_bound(const struct cs_system *system, const struct cs_gershgorin *sums) {
    cs_membranes_add_bound(system, NULL, sums->stiffness, sums->damping);
}

static void add_state_bound(const struct cs_system *system, const struct cs_eval *at,
                            const struct cs_gershgorin *sums) {
    cs_membranes_add_bound(system, at, sums->stiffness, sums->damping);
}

static const char *const ramps[] = {"bodies.elastic.membrane.young",
                                    "bodies.elastic.membrane.shear", "bodies.elastic.damping",
                                    NULL};

const struct cs_term cs_term_membrane = {
    .name = "membrane",
    .part_bits = CS_PART_ELASTIC | CS_PART_ELASTIC_DAMPING,
    .plan = plan,
    .build = build,
    .rampable_keys = ramps,
    .prepare = cs_membranes_prepare,
    .add_force = cs_membranes_add,
    .add_jvp = cs_membranes_add,
    .energy = energy,
    .energy_kind = CS_ENERGY_ELASTIC,
    .prepare_matrix = cs_membranes_prepare_matrix,
    .add_blocks = add_blocks,
    .add_matrix_product = cs_membranes_add_product,
    .add_approach = cs_membranes_add_approach,
    .add_bound = add_bound,
    .add_state_bound = add_state_bound,
};
