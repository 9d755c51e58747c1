/* The force term of contact between surfaces: a body with itself, two bodies, or a body and a
 * mesh collider. */
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/force/term.h"
#include "scene/body_pairs.h"

static struct cs_plan_row plan(const struct cs_scene *scene) {
    const bool built = cs_scene_has_body_contact(scene);
    return (struct cs_plan_row){
        .built = built,
        .reason = built ? "self_contact, pairs of bodies, or a mesh collider" : NULL};
}

static const char *const ramps[] = {"colliders.friction", NULL};

static void prepare(const struct cs_system *system, const struct cs_eval *at) {
    cs_pairs_set(system->pairs, at);
}

static void add(const struct cs_system *system, const struct cs_eval *at, double *f) {
    cs_pairs_add(system->pairs, at->block->begin, at->block->end, f);
    if (at->power && at->block->begin == 0)
        at->power[0] += cs_pairs_power(system->pairs, at);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_pairs_energy(system->pairs, at);
}

static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    cs_pairs_set_matrix(system->pairs, matrix, kept);
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    (void)matrix;
    cs_pairs_add_blocks(system->pairs, begin, end, blocks);
}

static void add_product(const struct cs_system *system, const double *p, double *y) {
    cs_pairs_multiply(system->pairs, p, y);
}

static void add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    cs_pairs_add_approach(system->pairs, matrix, y);
}

static uint32_t friction_chunks(const struct cs_system *system) {
    return system->pairs->candidates.n_chunks;
}

static void store_friction(const struct cs_system *system, double t, const double *x,
                           uint32_t first) {
    cs_pairs_store_friction(system->pairs, t, x, first);
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    cs_pairs_add_bound(system->pairs, at, sums->stiffness, sums->damping);
}

const struct cs_term cs_term_pairs = {
    .name = "contact pairs",
    .part_bits = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
    .plan = plan,
    .rampable_keys = ramps,
    .build = cs_pairs_build,
    .prepare = prepare,
    .add_force = add,
    .add_jvp = add,
    .energy = energy,
    .energy_kind = CS_ENERGY_OTHER,
    .energy_column = "other",
    .work_column = "friction",
    .prepare_matrix = prepare_matrix,
    .add_blocks = add_blocks,
    .add_matrix_product = add_product,
    .add_approach = add_approach,
    .friction_chunks = friction_chunks,
    .store_friction = store_friction,
    .add_state_bound = add_bound_at,
};
