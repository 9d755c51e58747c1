/* Contact of what lies between particles with obstacles: the points of model/cover/cover.h as a
 * term. Particles themselves have it from term_contact.c. */
#include "model/cover/cover_force.h"
#include "model/force/term.h"

static bool any_round(const struct cs_scene *scene) {
    const struct cs_collider *colliders = cs_scene_colliders(scene);
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (cs_shape_needs_points(cs_collider_shape(colliders + c)))
            return true;
    return false;
}

/* Lengths are known to idle_why alone. */
static struct cs_plan_row plan(const struct cs_scene *scene) {
    const bool asked = scene->contact.law == CS_CONTACT_FORCE && scene->colliders.n,
               built = asked && any_round(scene);
    return (struct cs_plan_row){.built = built,
                                .why = !asked  ? NULL
                                       : built ? "colliders are finer than edges are long"
                                               : "every collider is flat"};
}

static const char *idle_why(const struct cs_system *system) {
    return system->covers ? NULL : "edges are short enough for every collider";
}

static void prepare(const struct cs_system *system, const struct cs_eval *at) {
    cs_covers_set(system->covers, at);
}

static void add(const struct cs_system *system, const struct cs_eval *at, double *f) {
    cs_pair_set_add(&system->covers->now, at->block->begin, at->block->end, f);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_covers_energy(system->covers, at);
}

static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    cs_covers_set_matrix(system->covers, matrix, kept);
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    (void)matrix;
    cs_pair_set_add_blocks(system->covers->blocks, begin, end, blocks);
}

static void add_product(const struct cs_system *system, const double *p, double *y) {
    cs_pair_set_multiply(&system->covers->matrix, p, y);
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    cs_covers_add_bound(system->covers, at, sums->stiffness, sums->damping);
}

static const char *const ramps[] = {"colliders.friction", NULL};

const struct cs_term cs_term_cover = {
    .name = "contact edges",
    .parts = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
    .plan = plan,
    .build = cs_covers_build,
    .idle_why = idle_why,
    .ramps = ramps,
    .prepare = prepare,
    .add_force = add,
    .add_jvp = add,
    .energy = energy,
    .energy_kind = CS_ENERGY_OTHER,
    .energy_column = "other",
    .work_column = "friction",
    .prepare_matrix = prepare_matrix,
    .add_blocks = add_blocks,
    .add_product = add_product,
    .add_bound_at = add_bound_at,
};
