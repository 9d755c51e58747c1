/* Contact of particles with colliders by force: each particle feels the law of point_contact.h
 * from each collider in whose range it is. Particles act one by one, so the matrix has diagonal
 * blocks only. Colliders come in the scene's order, which is the order of the sums. */
#include "base/pool.h"
#include "base/vector.h"
#include "model/contact/collider_params.h"
#include "model/contact/friction_anchors.h"
#include "model/contact/friction_chord.h"
#include "model/contact/lagged_friction.h"
#include "model/contact/rebound.h"
#include "model/force/term.h"
#include "model/force/terms.h"

#include <clothsim/clones.h>
#include <math.h>

/* particles per row, and per chunk of stored friction */
enum { ROW = 64, STORED = 1024 };

/* Distances and gradients of one row; a plane's gradient is its normal and is not stored. */
struct row {
    double d[ROW], x[ROW], y[ROW], z[ROW];
    size_t start, count; /* of a row of bounds */
};

/* Sets distances in m and gradients of `count` particles; returns how many are in range. */
CS_INLINE uint32_t measure(const struct cs_posed_collider_law *near, size_t n, const double *x,
                           size_t count, const bool sphere, struct row *row) {
    const struct cs_posed_collider *pose = &near->collider;
    const double *c = pose->centre, *g = pose->axes[1];
    const double radius = pose->radius, range = near->params.range;
    uint32_t inside = 0;
    for (size_t i = 0; i < count; i++) {
        const double rx = x[i] - c[0], ry = x[n + i] - c[1], rz = x[2 * n + i] - c[2];
        if (sphere) {
            const double length = sqrt(rx * rx + ry * ry + rz * rz), inverse = 1 / length;
            row->d[i] = length - radius;
            row->x[i] = rx * inverse;
            row->y[i] = ry * inverse;
            row->z[i] = rz * inverse;
        } else
            row->d[i] = g[0] * rx + g[1] * ry + g[2] * rz;
        inside += row->d[i] < range;
    }
    return inside;
}

/* Adds the forces of one row. rubs: friction or damping act; a constant, so that the loop has
 * no branch. */
CS_INLINE void push(const struct cs_posed_collider_law *near, size_t n, const double *v,
                    size_t count, struct cs_contact_force_parts parts, const bool sphere,
                    const bool rubs, const struct row *row, double *restrict f) {
    const double *normal = near->collider.axes[1], *u = near->collider.velocity;
    const double k = near->params.k, range = near->params.range;
    const double mu = parts.friction * near->friction, tau = parts.friction * near->damping;
    const double least = near->friction_speed * near->friction_speed;
    for (size_t i = 0; i < count; i++) {
        const double gx = sphere ? row->x[i] : normal[0];
        const double gy = sphere ? row->y[i] : normal[1];
        const double gz = sphere ? row->z[i] : normal[2];
        const struct cs_barrier law = cs_barrier_at(row->d[i], range, k);
        double along = parts.elastic * law.force;
        double fx = 0, fy = 0, fz = 0;
        if (rubs) {
            const double vx = v[i] - u[0], vy = v[n + i] - u[1], vz = v[2 * n + i] - u[2];
            const double approach = gx * vx + gy * vy + gz * vz;
            const double tx = vx - gx * approach, ty = vy - gy * approach;
            const double tz = vz - gz * approach;
            const double rub = mu * law.force / sqrt(tx * tx + ty * ty + tz * tz + least);
            along -= tau * law.stiffness * approach;
            fx = rub * tx, fy = rub * ty, fz = rub * tz;
        }
        f[i] += along * gx - fx;
        f[n + i] += along * gy - fy;
        f[2 * n + i] += along * gz - fz;
    }
}

/* Adds the forces of all rows of a block. */
CS_INLINE void add(const struct cs_posed_collider_law *near, size_t n, const struct cs_eval *at,
                   struct cs_contact_force_parts parts, const bool sphere, double *f) {
    const bool rubs = parts.friction * (near->friction + near->damping) > 0;
    for (size_t start = at->block->begin; start < at->block->end; start += ROW) {
        const size_t left = at->block->end - start, count = left < ROW ? left : ROW;
        struct row row;
        if (measure(near, n, at->x + start, count, sphere, &row) == 0)
            continue;
        if (rubs)
            push(near, n, at->v + start, count, parts, sphere, true, &row, f + start);
        else
            push(near, n, at->v + start, count, parts, sphere, false, &row, f + start);
    }
}

/* f (3,n) += the force of point_contact.h at the particles of at->block; equal to it but for
 * rounding. */
static CS_CLONES void contact_rows_add(const struct cs_posed_collider_law *near, size_t n,
                                       const struct cs_eval *at,
                                       struct cs_contact_force_parts parts, double *f) {
    if (near->collider.shape->bounds == CS_BOUNDS_SPHERE)
        add(near, n, at, parts, true, f);
    else
        add(near, n, at, parts, false, f);
}

/* Adds the bounds of one row, those of cs_point_contact_bound for |g| = 1. */
CS_INLINE void bound(const struct cs_posed_collider_law *near, const struct cs_eval *at,
                     size_t n, const struct row *row, const bool sphere,
                     const struct cs_gershgorin *sums) {
    const double *normal = near->collider.axes[1], *u = near->collider.velocity;
    const double *v = at->v + row->start;
    double *restrict stiffness = sums->stiffness + row->start;
    double *restrict damping = sums->damping + row->start;
    const double k = near->params.k, range = near->params.range;
    const double least = near->friction_speed * near->friction_speed;
    for (size_t i = 0; i < row->count; i++) {
        const double gx = sphere ? row->x[i] : normal[0];
        const double gy = sphere ? row->y[i] : normal[1];
        const double gz = sphere ? row->z[i] : normal[2];
        const struct cs_barrier law = cs_barrier_at(row->d[i], range, k);
        const double vx = v[i] - u[0], vy = v[n + i] - u[1], vz = v[2 * n + i] - u[2];
        const double approach = gx * vx + gy * vy + gz * vz;
        const double tx = vx - gx * approach, ty = vy - gy * approach, tz = vz - gz * approach;
        stiffness[i] += law.stiffness;
        damping[i] += near->damping * law.stiffness +
                      near->friction * law.force / sqrt(tx * tx + ty * ty + tz * tz + least);
    }
}

CS_INLINE void add_bounds(const struct cs_posed_collider_law *near, size_t n,
                          const struct cs_eval *at, const bool sphere,
                          const struct cs_gershgorin *sums) {
    for (size_t start = 0; start < n; start += ROW) {
        const size_t left = n - start;
        struct row row;
        row.start = start, row.count = left < ROW ? left : ROW;
        if (measure(near, n, at->x + start, row.count, sphere, &row) > 0)
            bound(near, at, n, &row, sphere, sums);
    }
}

/* sums += the bounds of point_contact.h at all particles, likewise. */
static CS_CLONES void contact_rows_add_bounds(const struct cs_posed_collider_law *near,
                                              size_t n, const struct cs_eval *at,
                                              const struct cs_gershgorin *sums) {
    if (near->collider.shape->bounds == CS_BOUNDS_SPHERE)
        add_bounds(near, n, at, true, sums);
    else
        add_bounds(near, n, at, false, sums);
}

/* A scene with contact by projection has no row in the plan; meshes have contact by pairs. */
static struct cs_plan_row plan(const struct cs_scene *scene) {
    const bool asked = scene->contact.law == CS_CONTACT_FORCE,
               built = cs_rebounds_possible(scene);
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
        struct cs_bristle bristle;
        if (cs_posed_collider_law_is_plain(&near)) {
            contact_rows_add(&near, n, at, parts, f);
            continue;
        }
        for (size_t i = at->block->begin; i < at->block->end; i++)
            if (touch_of(&near, n, at->x, at->v, i, &touch)) {
                double a[3];
                cs_point_contact_force(&touch, parts, a);
                if (parts.friction > 0 &&
                    cs_bristle_of_particle(system, c, &near, at->x, i, &bristle))
                    cs_bristle_add_force(&touch, &bristle, a);
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
        struct cs_bristle bristle;
        for (size_t i = at->block->begin; i < at->block->end; i++)
            if (touch_of(&near, n, at->x, at->v, i, &touch)) {
                const struct cs_point_contact_motion move = move_of(&near, n, at, i);
                double a[3];
                cs_point_contact_jvp(&touch, parts, &move, a);
                if (parts.friction > 0 &&
                    cs_bristle_of_particle(system, c, &near, at->x, i, &bristle))
                    cs_bristle_add_jvp(&touch, &bristle, &move, a);
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
        struct cs_bristle bristle;
        for (size_t i = begin; i < end; i++) {
            const struct cs_rebound *rebound = cs_rebound_of(system, matrix, c, i);
            struct cs_contact_pull pull = {.h = -matrix->cd};
            double b[6] = {0};
            if (rebound)
                cs_rebound_add_block(rebound, matrix, b);
            else if (touch_of(&near, n, matrix->x, matrix->v, i, &touch)) {
                if (matrix->chord) {
                    cs_contact_pull_add(&pull, matrix, n, i, system->inv_mass[i], 1);
                    cs_friction_chord_add_block(&touch, matrix, &pull, b);
                } else
                    cs_point_contact_add_block(&touch, matrix, b);
                if (cs_bristle_of_particle(system, c, &near, matrix->x, i, &bristle))
                    cs_bristle_add_matrix(&touch, &bristle, matrix, &pull, b);
            } else
                continue;
            for (size_t e = 0; e < 6; e++)
                blocks[e * n + i] += b[e];
        }
    }
}

/* One collider of add_approach. */
struct approach {
    const struct cs_system *system;
    uint32_t collider;
    struct cs_posed_collider_law near;
    const struct cs_matrix *matrix;
    double *y;
};

/* b loses y: an impact puts into b what it gives. */
static void add_approaches(void *arg, size_t begin, size_t end) {
    const struct approach *to = arg;
    const size_t n = to->system->view.n;
    struct cs_point_contact touch;
    struct cs_bristle bristle;
    for (size_t i = begin; i < end; i++) {
        const struct cs_rebound *rebound =
            cs_rebound_of(to->system, to->matrix, to->collider, i);
        double a[3] = {0};
        if (rebound)
            for (int c = 0; c < 3; c++)
                a[c] = -rebound->impulse[c];
        else if (touch_of(&to->near, n, to->matrix->x, to->matrix->v, i, &touch)) {
            cs_point_contact_approach(&touch, to->matrix, a);
            if (cs_bristle_of_particle(to->system, to->collider, &to->near, to->matrix->x, i,
                                       &bristle))
                cs_bristle_add_approach(&touch, &bristle, to->matrix, a);
        } else
            continue;
        add_at(to->y, n, i, a);
    }
}

static void add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        struct approach to = {system, c, near_of(system, c, matrix->t), matrix, y};
        cs_vector_parallel_for(system->view.n, add_approaches, &to);
    }
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    const size_t n = system->view.n;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law near = near_of(system, c, at->t);
        struct cs_point_contact touch;
        struct cs_bristle bristle;
        if (cs_posed_collider_law_is_plain(&near)) {
            contact_rows_add_bounds(&near, n, at, sums);
            continue;
        }
        for (size_t i = 0; i < n; i++)
            if (touch_of(&near, n, at->x, at->v, i, &touch)) {
                double stiffness, damping;
                cs_point_contact_bound(&touch, &stiffness, &damping);
                if (cs_bristle_of_particle(system, c, &near, at->x, i, &bristle))
                    cs_bristle_raise_bound(&bristle, &stiffness, &damping);
                sums->stiffness[i] += stiffness;
                sums->damping[i] += damping;
            }
    }
}

/* One call of store_friction. */
struct storing {
    const struct cs_system *system;
    const double t, *x;
    uint32_t first;
};

static uint32_t friction_chunks(const struct cs_system *system) {
    return (system->view.n + STORED - 1) / STORED;
}

static void store_chunk(void *arg, uint32_t chunk) {
    const struct storing *storing = arg;
    const struct cs_system *system = storing->system;
    const uint32_t n = system->view.n, first = chunk * STORED;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law near = near_of(system, c, storing->t);
        struct cs_point_contact touch;
        for (uint32_t i = first; i < n && i < first + STORED; i++)
            if (system->inv_mass[i] > 0 && touch_of(&near, n, storing->x, NULL, i, &touch))
                cs_lagged_friction_store(system->lagged_friction, storing->first + chunk,
                                         &touch, 1, &i, &(double){1});
    }
}

static void store_friction(const struct cs_system *system, double t, const double *x,
                           uint32_t first) {
    struct storing storing = {system, t, x, first};
    cs_pool_run(friction_chunks(system), store_chunk, &storing);
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
    .add_approach = add_approach,
    .friction_chunks = friction_chunks,
    .store_friction = store_friction,
    .add_state_bound = add_bound_at,
};
