/* The force term of contact samples (contact_samples.h). Particles themselves have contact by
 * term_contact.c. */
#include "model/contact/contact_samples_force.h"
#include "model/force/term.h"

/* Returns whether a collider is round, so that it may need samples. */
static bool any_round(const struct cs_scene *scene) {
    const struct cs_collider *colliders = cs_scene_colliders(scene);
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (cs_shape_needs_points(cs_collider_shape(colliders + c)))
            return true;
    return false;
}

/* The plan does not know lengths yet; reason_idle reports short edges later. */
static struct cs_plan_row plan(const struct cs_scene *scene) {
    const bool asked = scene->contact.law == CS_CONTACT_FORCE && scene->colliders.n,
               built = asked && any_round(scene);
    return (struct cs_plan_row){.built = built,
                                .reason = !asked  ? NULL
                                          : built ? "colliders are finer than edges are long"
                                                  : "every collider is flat"};
}

static const char *idle_why(const struct cs_system *system) {
    return system->contact_samples ? NULL : "edges are short enough for every collider";
}

static void prepare(const struct cs_system *system, const struct cs_eval *at) {
    cs_contact_samples_set(system->contact_samples, at);
}

static void add(const struct cs_system *system, const struct cs_eval *at, double *f) {
    cs_contact_set_add(&system->contact_samples->current_set, at->block->begin, at->block->end,
                       f);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_contact_samples_energy(system->contact_samples, at);
}

static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    cs_contact_samples_set_matrix(system->contact_samples, matrix, kept);
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    (void)matrix;
    cs_contact_set_add_blocks(system->contact_samples->blocks, begin, end, blocks);
}

static void add_product(const struct cs_system *system, const double *p, double *y) {
    cs_contact_set_multiply(&system->contact_samples->matrix, p, y);
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    cs_contact_samples_add_bound(system->contact_samples, at, sums->stiffness, sums->damping);
}

static const char *const ramps[] = {"colliders.friction", NULL};

const struct cs_term cs_term_cover = {
    .name = "contact samples",
    .part_bits = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
    .plan = plan,
    .build = cs_contact_samples_build,
    .reason_idle = idle_why,
    .rampable_keys = ramps,
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
    .add_state_bound = add_bound_at,
};
