/* Contact with obstacles as a force: each particle feels the law of touch.h from each obstacle
 * whose range it is in. Particles touch one by one, so that the matrix has a block at each and
 * nothing between them. Obstacles come in the scene's order; that is the order of the sums. */
#include "model/contact/obstacle.h"
#include "model/contact/pairing.h"
#include "model/contact/touch.h"
#include "model/force/contact_rows.h"
#include "model/force/terms.h"

/* a scene with the other law has no line of it */
static struct cs_plan_row plan(const struct cs_scene *scene) {
    const bool asked = scene->contact.law == CS_CONTACT_FORCE,
               built = asked && scene->colliders.n;
    return (struct cs_plan_row){.built = built,
                                .bytes =
                                    built ? scene->colliders.n * sizeof(struct cs_pairing) : 0,
                                .why = !asked  ? NULL
                                       : built ? "contact.law is force"
                                               : "no colliders"};
}

static const char *const ramps[] = {"colliders.friction", NULL};

static struct cs_near near_of(const struct cs_system *system, uint32_t collider, double t) {
    const struct cs_scene *scene = system->scene;
    struct cs_near near = {.pairing = system->pairings[collider],
                           .mu = cs_scene_colliders(scene)[collider].friction,
                           .ev = scene->contact.friction_speed,
                           .tau = scene->contact.damping};
    cs_obstacle_at(system, collider, t, &near.pose);
    return near;
}

static struct cs_touch_parts parts_of(uint32_t parts) {
    return (struct cs_touch_parts){.elastic = parts & CS_PART_POTENTIAL ? 1 : 0,
                                   .rubbing = parts & CS_PART_DISSIPATIVE ? 1 : 0};
}

/* How particle i touches; false: it is out of range. v may be NULL: at rest. */
static bool touch_of(const struct cs_near *near, size_t n, const double *x, const double *v,
                     size_t i, struct cs_touch *touch) {
    const double p[3] = {x[i], x[n + i], x[2 * n + i]};
    double surface[3] = {0};
    if (!cs_obstacle_is_near(&near->pose, near->pairing.range, p))
        return false;
    touch->d = cs_obstacle_smooth(&near->pose, p, touch->g, touch->h);
    if (!(touch->d < near->pairing.range))
        return false;
    cs_obstacle_velocity(&near->pose, p, surface);
    for (size_t c = 0; c < 3; c++)
        touch->v[c] = (v ? v[c * n + i] : 0) - surface[c];
    touch->range = near->pairing.range;
    touch->k = near->pairing.k;
    touch->mu = near->mu;
    touch->ev = near->ev;
    touch->tau = near->tau;
    return true;
}

static void add_at(double *f, size_t n, size_t i, const double a[3]) {
    for (size_t c = 0; c < 3; c++)
        f[c * n + i] += a[c];
}

static void add_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const size_t n = system->view.n;
    const struct cs_touch_parts parts = parts_of(at->parts);
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_near near = near_of(system, c, at->t);
        struct cs_touch touch;
        if (cs_contact_has_rows(&near)) {
            cs_contact_add_rows(&near, n, at, parts, f);
            continue;
        }
        for (size_t i = at->block->begin; i < at->block->end; i++)
            if (touch_of(&near, n, at->x, at->v, i, &touch)) {
                double a[3];
                cs_touch_force(&touch, parts, a);
                add_at(f, n, i, a);
            }
    }
}

/* what a direction does to a touching particle: it moves, and so does the surface below it */
static struct cs_touch_move move_of(const struct cs_near *near, size_t n,
                                    const struct cs_eval *at, size_t i) {
    struct cs_touch_move move;
    const double *spin = near->pose.spin;
    for (size_t c = 0; c < 3; c++) {
        move.dp[c] = at->dx ? at->dx[c * n + i] : 0;
        move.dv[c] = at->dv ? at->dv[c * n + i] : 0;
    }
    for (size_t c = 0; c < 3; c++) {
        const size_t d = (c + 1) % 3, e = (c + 2) % 3;
        move.dv[c] -= spin[d] * move.dp[e] - spin[e] * move.dp[d];
    }
    return move;
}

static void add_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    const size_t n = system->view.n;
    const struct cs_touch_parts parts = parts_of(at->parts);
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_near near = near_of(system, c, at->t);
        struct cs_touch touch;
        for (size_t i = at->block->begin; i < at->block->end; i++)
            if (touch_of(&near, n, at->x, at->v, i, &touch)) {
                const struct cs_touch_move move = move_of(&near, n, at, i);
                double a[3];
                cs_touch_jvp(&touch, parts, &move, a);
                add_at(df, n, i, a);
            }
    }
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    const size_t n = system->view.n;
    double sum = 0;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_near near = near_of(system, c, at->t);
        struct cs_touch touch;
        for (size_t i = 0; i < n; i++)
            if (system->inv_mass[i] > 0 && touch_of(&near, n, at->x, NULL, i, &touch))
                sum += cs_law_energy(touch.d, touch.range, touch.k);
    }
    return sum;
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    const size_t n = system->view.n;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_near near = near_of(system, c, matrix->t);
        struct cs_touch touch;
        for (size_t i = begin; i < end; i++)
            if (touch_of(&near, n, matrix->x, matrix->v, i, &touch)) {
                double b[6] = {0};
                cs_touch_add_block(&touch, matrix, b);
                for (size_t e = 0; e < 6; e++)
                    blocks[e * n + i] += b[e];
            }
    }
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    const size_t n = system->view.n;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_near near = near_of(system, c, at->t);
        struct cs_touch touch;
        if (cs_contact_has_rows(&near)) {
            cs_contact_add_row_bounds(&near, n, at, sums);
            continue;
        }
        for (size_t i = 0; i < n; i++)
            if (touch_of(&near, n, at->x, at->v, i, &touch)) {
                double stiffness, damping;
                cs_touch_bound(&touch, &stiffness, &damping);
                sums->stiffness[i] += stiffness;
                sums->damping[i] += damping;
            }
    }
}

const struct cs_term cs_term_contact = {
    .name = "contact force",
    .parts = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
    .plan = plan,
    .ramps = ramps,
    .build = cs_pairings_build,
    .add_force = add_force,
    .add_jvp = add_jvp,
    .energy = energy,
    .energy_kind = CS_ENERGY_OTHER,
    .add_blocks = add_blocks,
    .add_bound_at = add_bound_at,
};
