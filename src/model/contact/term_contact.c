/* Contact of particles with colliders by force: each particle feels the law of point_contact.h
 * from each collider in whose range it is. Particles act one by one, so the matrix has diagonal
 * blocks only. Colliders come in the scene's order, which is the order of the sums. */
#include "model/contact/contact_rows.h"
#include "model/force/terms.h"

/* Returns whether a collider is no mesh; meshes have contact by pairs. */
static bool any_without_mesh(const struct cs_scene *scene) {
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (!cs_scene_colliders(scene)[c].mesh.present)
            return true;
    return false;
}

/* A scene with contact by projection has no row in the plan. */
static struct cs_plan_row plan(const struct cs_scene *scene) {
    const bool asked = scene->contact.law == CS_CONTACT_FORCE,
               built = asked && any_without_mesh(scene);
    return (struct cs_plan_row){.built = built,
                                .reason = !asked               ? NULL
                                          : built              ? "contact.law is force"
                                          : scene->colliders.n ? "every collider is a mesh"
                                                               : "no colliders"};
}

static const char *const ramps[] = {"colliders.friction", NULL};

static struct cs_posed_collider_law near_of(const struct cs_system *system, uint32_t collider,
                                            double t) {
    struct cs_posed_collider_law near;
    cs_posed_collider_law_at(system, collider, t, &near);
    return near;
}

static void read(const double *from, size_t n, size_t i, double to[3]) {
    for (size_t c = 0; c < 3; c++)
        to[c] = from ? from[c * n + i] : 0;
}

/* Sets *touch for particle i; returns false if it is out of range. v NULL: at rest. */
static bool touch_of(const struct cs_posed_collider_law *near, size_t n, const double *x,
                     const double *v, size_t i, struct cs_point_contact *touch) {
    double p[3], w[3];
    read(x, n, i, p);
    read(v, n, i, w);
    return cs_posed_collider_law_in_range(near, p, w, touch);
}

static void add_at(double *f, size_t n, size_t i, const double a[3]) {
    for (size_t c = 0; c < 3; c++)
        f[c * n + i] += a[c];
}

/* Spheres and planes have a vectorised path with the same formulas. */
static void add_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const size_t n = system->view.n;
    const struct cs_contact_force_parts parts = cs_force_parts_of(at->parts);
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law near = near_of(system, c, at->t);
        struct cs_point_contact touch;
        if (cs_contact_rows_supported(&near)) {
            cs_contact_rows_add(&near, n, at, parts, f);
            continue;
        }
        for (size_t i = at->block->begin; i < at->block->end; i++)
            if (touch_of(&near, n, at->x, at->v, i, &touch)) {
                double a[3];
                cs_point_contact_force(&touch, parts, a);
                add_at(f, n, i, a);
            }
    }
}

/* Motion of a particle relative to the collider along the direction of a Jacobian product. */
static struct cs_point_contact_motion move_of(const struct cs_posed_collider_law *near,
                                              size_t n, const struct cs_eval *at, size_t i) {
    double dp[3], dv[3];
    read(at->dx, n, i, dp);
    read(at->dv, n, i, dv);
    return cs_posed_collider_law_motion(near, dp, dv);
}

static void add_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    const size_t n = system->view.n;
    const struct cs_contact_force_parts parts = cs_force_parts_of(at->parts);
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law near = near_of(system, c, at->t);
        struct cs_point_contact touch;
        for (size_t i = at->block->begin; i < at->block->end; i++)
            if (touch_of(&near, n, at->x, at->v, i, &touch)) {
                const struct cs_point_contact_motion move = move_of(&near, n, at, i);
                double a[3];
                cs_point_contact_jvp(&touch, parts, &move, a);
                add_at(df, n, i, a);
            }
    }
}

/* Energy of the barrier law over the free particles. */
static double energy(const struct cs_system *system, const struct cs_eval *at) {
    const size_t n = system->view.n;
    double sum = 0;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law near = near_of(system, c, at->t);
        struct cs_point_contact touch;
        for (size_t i = 0; i < n; i++)
            if (system->inv_mass[i] > 0 && touch_of(&near, n, at->x, NULL, i, &touch))
                sum += cs_barrier_energy(touch.d, touch.range, touch.k);
    }
    return sum;
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    const size_t n = system->view.n;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law near = near_of(system, c, matrix->t);
        struct cs_point_contact touch;
        for (size_t i = begin; i < end; i++)
            if (touch_of(&near, n, matrix->x, matrix->v, i, &touch)) {
                double b[6] = {0};
                cs_point_contact_add_block(&touch, matrix, b);
                for (size_t e = 0; e < 6; e++)
                    blocks[e * n + i] += b[e];
            }
    }
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    const size_t n = system->view.n;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law near = near_of(system, c, at->t);
        struct cs_point_contact touch;
        if (cs_contact_rows_supported(&near)) {
            cs_contact_rows_add_bounds(&near, n, at, sums);
            continue;
        }
        for (size_t i = 0; i < n; i++)
            if (touch_of(&near, n, at->x, at->v, i, &touch)) {
                double stiffness, damping;
                cs_point_contact_bound(&touch, &stiffness, &damping);
                sums->stiffness[i] += stiffness;
                sums->damping[i] += damping;
            }
    }
}

const struct cs_term cs_term_contact = {
    .name = "contact force",
    .part_bits = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
    .plan = plan,
    .rampable_keys = ramps,
    .build = cs_collider_params_table_build,
    .add_force = add_force,
    .add_jvp = add_jvp,
    .energy = energy,
    .energy_kind = CS_ENERGY_OTHER,
    .energy_column = "other",
    .work_column = "friction",
    .add_blocks = add_blocks,
    .add_state_bound = add_bound_at,
};
