/* Bending of elastic bodies as a term: the kernels of elastic/bending_forces.h. */
#include "model/elastic/bending_forces.h"
#include "model/elastic/bending_sums.h"
#include "model/elastic/normal_curvature.h"
#include "model/force/term.h"

static struct cs_plan_row plan(const struct cs_scene *scene) {
    const struct cs_body *bodies = cs_scene_bodies(scene);
    bool acts = false;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        acts |= cs_elastic_bends(&bodies[b].elastic);
    return (struct cs_plan_row){.built = acts,
                                .reason = acts ? "elastic bodies resist bending" : NULL};
}

static enum cs_status build(struct cs_system *system, struct cs_error *error) {
    return cs_bendings_build(system, error) ? error->status
                                            : cs_normal_curvature_build(system, error);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_bendings_energy(system, at->x);
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    (void)matrix;
    cs_bendings_add_blocks(system, begin, end, blocks);
}

static void add_bound(const struct cs_system *system, const struct cs_gershgorin *sums) {
    cs_bendings_add_bound(system, system->state, sums->stiffness, sums->damping);
}

/* Forces along normals depend on the state; the others do not. */
static void add_state_bound(const struct cs_system *system, const struct cs_eval *at,
                            const struct cs_gershgorin *sums) {
    cs_bendings_add_bound(system, at->x, sums->stiffness, sums->damping);
}

static const char *const ramps[] = {"bodies.elastic.bending.stiffness",
                                    "bodies.elastic.bending.twist",
                                    "bodies.elastic.bending.damping", NULL};

const struct cs_term cs_term_bending = {
    .name = "bending",
    .part_bits = CS_PART_ELASTIC | CS_PART_ELASTIC_DAMPING,
    .plan = plan,
    .build = build,
    .rampable_keys = ramps,
    .prepare = cs_bendings_prepare,
    .add_force = cs_bendings_add,
    .add_jvp = cs_bendings_add,
    .energy = energy,
    .energy_kind = CS_ENERGY_ELASTIC,
    .prepare_matrix = cs_bendings_prepare_matrix,
    .add_blocks = add_blocks,
    .add_matrix_product = cs_bendings_add_product,
    .add_approach = cs_bendings_add_approach,
    .add_bound = add_bound,
    .add_state_bound = add_state_bound,
};
