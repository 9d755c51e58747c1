/* Contact of particles with colliders by force: each particle feels the law of point_contact.h
 * from each collider in whose range it is. Particles act one by one, so the matrix has diagonal
 * blocks only. Colliders come in the scene's order, which is the order of the sums. */
#include "base/pool.h"
#include "base/vector.h"
#include "model/contact/lagged_friction.h"
#include "model/contact/point_query.h"
#include "model/contact/rebound.h"
#include "model/force/term.h"
#include "scene/body_pairs.h"

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
CS_INLINE uint32_t measure(const struct cs_posed_collider_law *law, size_t n, const double *x,
                           size_t count, const bool sphere, struct row *row) {
    const struct cs_posed_collider *collider = &law->collider;
    const double *c = collider->centre, *g = collider->axes[1];
    const double radius = collider->radius, range = law->params.range;
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
CS_INLINE void push(const struct cs_posed_collider_law *law, size_t n, const double *v,
                    size_t count, struct cs_contact_force_parts parts, const bool sphere,
                    const bool rubs, const struct row *row, double *restrict f) {
    const double *normal = law->collider.axes[1], *u = law->collider.velocity;
    const double k = law->params.k, range = law->params.range;
    const double mu = parts.friction * law->friction, tau = parts.friction * law->damping;
    const double loss = parts.friction * law->loss;
    const double least = law->friction_speed * law->friction_speed;
    for (size_t i = 0; i < count; i++) {
        const double gx = sphere ? row->x[i] : normal[0];
        const double gy = sphere ? row->y[i] : normal[1];
        const double gz = sphere ? row->z[i] : normal[2];
        const struct cs_barrier barrier = cs_barrier_at(row->d[i], range, k);
        double along = parts.elastic * barrier.force;
        double fx = 0, fy = 0, fz = 0;
        if (rubs) {
            const double vx = v[i] - u[0], vy = v[n + i] - u[1], vz = v[2 * n + i] - u[2];
            const double approach = gx * vx + gy * vy + gz * vz;
            const double tx = vx - gx * approach, ty = vy - gy * approach;
            const double tz = vz - gz * approach;
            const double rub = mu * barrier.force / sqrt(tx * tx + ty * ty + tz * tz + least);
            along -= tau * barrier.stiffness * approach;
            if (loss > 0)
                along -= loss * barrier.force * approach /
                         sqrt(cs_restitution_square(row->d[i], range, law->rate, approach));
            fx = rub * tx, fy = rub * ty, fz = rub * tz;
        }
        f[i] += along * gx - fx;
        f[n + i] += along * gy - fy;
        f[2 * n + i] += along * gz - fz;
    }
}

/* Adds the forces of all rows of a block, but on tangled particles. */
CS_INLINE void add(const struct cs_posed_collider_law *law, const struct cs_system *system,
                   const struct cs_eval *at, struct cs_contact_force_parts parts,
                   const bool sphere, double *f) {
    const uint8_t *tangled = system->tangled;
    const size_t n = system->view.n;
    const bool rubs = parts.friction * (law->friction + law->damping + law->loss) > 0;
    for (size_t start = at->block->begin; start < at->block->end; start += ROW) {
        const size_t left = at->block->end - start, count = left < ROW ? left : ROW;
        struct row row;
        if (measure(law, n, at->x + start, count, sphere, &row) == 0)
            continue;
        for (size_t i = 0; tangled && i < count; i++)
            row.d[i] = tangled[start + i] ? law->params.range : row.d[i];
        if (rubs)
            push(law, n, at->v + start, count, parts, sphere, true, &row, f + start);
        else
            push(law, n, at->v + start, count, parts, sphere, false, &row, f + start);
    }
}

/* f (3,n) += the force of point_contact.h at the particles of at->block; equal to it but for
 * rounding. */
static CS_CLONES void contact_rows_add(const struct cs_posed_collider_law *law,
                                       const struct cs_system *system, const struct cs_eval *at,
                                       struct cs_contact_force_parts parts, double *f) {
    if (law->collider.shape->bounds == CS_BOUNDS_SPHERE)
        add(law, system, at, parts, true, f);
    else
        add(law, system, at, parts, false, f);
}

/* Adds the bounds of one row, those of cs_point_contact_bound for |g| = 1. */
CS_INLINE void bound(const struct cs_posed_collider_law *law, const struct cs_eval *at,
                     size_t n, const struct row *row, const bool sphere,
                     const struct cs_gershgorin *sums) {
    const double *normal = law->collider.axes[1], *u = law->collider.velocity;
    const double *v = at->v + row->start;
    double *restrict stiffness = sums->stiffness + row->start;
    double *restrict damping = sums->damping + row->start;
    const double k = law->params.k, range = law->params.range;
    const double least = law->friction_speed * law->friction_speed;
    for (size_t i = 0; i < row->count; i++) {
        const double gx = sphere ? row->x[i] : normal[0];
        const double gy = sphere ? row->y[i] : normal[1];
        const double gz = sphere ? row->z[i] : normal[2];
        const struct cs_barrier barrier = cs_barrier_at(row->d[i], range, k);
        const double vx = v[i] - u[0], vy = v[n + i] - u[1], vz = v[2 * n + i] - u[2];
        const double approach = gx * vx + gy * vy + gz * vz;
        const double tx = vx - gx * approach, ty = vy - gy * approach, tz = vz - gz * approach;
        stiffness[i] += barrier.stiffness;
        if (law->loss > 0)
            damping[i] += law->loss * barrier.force /
                          sqrt(cs_restitution_square(row->d[i], range, law->rate, approach));
        damping[i] += law->damping * barrier.stiffness +
                      law->friction * barrier.force / sqrt(tx * tx + ty * ty + tz * tz + least);
    }
}

CS_INLINE void add_bounds(const struct cs_posed_collider_law *law, size_t n,
                          const struct cs_eval *at, const bool sphere,
                          const struct cs_gershgorin *sums) {
    for (size_t start = 0; start < n; start += ROW) {
        const size_t left = n - start;
        struct row row;
        row.start = start, row.count = left < ROW ? left : ROW;
        if (measure(law, n, at->x + start, row.count, sphere, &row) > 0)
            bound(law, at, n, &row, sphere, sums);
    }
}

/* sums += the bounds of point_contact.h at all particles, likewise. */
static CS_CLONES void contact_rows_add_bounds(const struct cs_posed_collider_law *law, size_t n,
                                              const struct cs_eval *at,
                                              const struct cs_gershgorin *sums) {
    if (law->collider.shape->bounds == CS_BOUNDS_SPHERE)
        add_bounds(law, n, at, true, sums);
    else
        add_bounds(law, n, at, false, sums);
}

/* A scene with contact by projection has no row in the plan; meshes have contact by pairs. */
static struct cs_plan_row plan_contact(const struct cs_scene *scene) {
    const bool asked = cs_scene_contact_is_force(scene) && scene->colliders.n,
               built = cs_rebounds_possible(scene);
    return (struct cs_plan_row){.built = built,
                                .reason = !asked  ? NULL
                                          : built ? "contact.law is force"
                                                  : "every collider is a mesh"};
}

static const char *const ramps[] = {"colliders.friction", NULL};

static struct cs_posed_collider_law near_of(const struct cs_system *system, uint32_t collider,
                                            double t) {
    struct cs_posed_collider_law law;
    cs_posed_collider_law_at(system, collider, t, &law);
    return law;
}

/* Answers for particle i, as a sample of one vertex; false if it is out of range. Most are:
 * they are told by the bounding test alone. */
static bool evaluate(const struct cs_point_query *query,
                     const struct cs_posed_collider_law *law, uint32_t collider, size_t i,
                     struct cs_point_answer *answer) {
    const size_t n = query->system->view.n;
    const double *x = query->eval.x, p[3] = {x[i], x[n + i], x[2 * n + i]};
    if (!cs_posed_collider_is_near(&law->collider, law->params.range, p))
        return false;
    const struct cs_contact_sample_point point = {.n = 1, .particles = {(uint32_t)i}, .w = {1}};
    return cs_point_evaluate(query, law, collider, &point, answer);
}

static void add_at(double *f, size_t n, size_t i, const double a[3]) {
    for (size_t c = 0; c < 3; c++)
        f[c * n + i] += a[c];
}

/* Adds forces or their changes of the particles of a block near one collider, unless f is NULL,
 * and the power that the collider gives. */
static void add_vectors(const struct cs_point_query *query,
                        const struct cs_posed_collider_law *law, uint32_t collider, double *f) {
    const struct cs_block *block = query->eval.block;
    struct cs_point_answer answer;
    for (size_t i = block->begin; i < block->end; i++) {
        if (!evaluate(query, law, collider, i, &answer))
            continue;
        if (f)
            add_at(f, query->system->view.n, i, answer.vector);
        if (query->eval.power && query->quantity == CS_POINT_FORCE)
            query->eval.power[i] += answer.energy;
    }
}

/* Spheres and planes have a vectorised path with the same formulas, and give power if they
 * move. */
static void add_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const struct cs_contact_force_parts parts = cs_force_parts_of(at->parts);
    const struct cs_point_query query = {system, CS_POINT_FORCE, *at, NULL};
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law law = near_of(system, c, at->t);
        const bool plain = cs_posed_collider_law_is_plain(&law);
        // rows give no power
        if (plain)
            contact_rows_add(&law, system, at, parts, f);
        if (!plain || (at->power && !cs_vec3_is_zero(law.collider.velocity)))
            add_vectors(&query, &law, c, plain ? NULL : f);
    }
}

static void add_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    const struct cs_point_query query = {system, CS_POINT_JVP, *at, NULL};
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law law = near_of(system, c, at->t);
        add_vectors(&query, &law, c, df);
    }
}

/* Energy of the barrier law over the free particles. */
static double energy(const struct cs_system *system, const struct cs_eval *at) {
    const struct cs_point_query query = {system, CS_POINT_ENERGY, *at, NULL};
    struct cs_point_answer answer;
    double sum = 0;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law law = near_of(system, c, at->t);
        for (size_t i = 0; i < system->view.n; i++)
            if (evaluate(&query, &law, c, i, &answer))
                sum += answer.energy;
    }
    return sum;
}

/* A query for the matrix or the approach of a step. */
static struct cs_point_query matrix_job(const struct cs_system *system,
                                        enum cs_point_quantity quantity,
                                        const struct cs_matrix *matrix) {
    return (struct cs_point_query){
        system,
        quantity,
        {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL},
        matrix};
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    const size_t n = system->view.n;
    const struct cs_point_query query = matrix_job(system, CS_POINT_MATRIX, matrix);
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law law = near_of(system, c, matrix->t);
        for (size_t i = begin; i < end; i++) {
            const struct cs_rebound *rebound = cs_rebound_of(system, matrix, c, i);
            struct cs_point_answer answer = {.block = {0}};
            if (rebound)
                cs_rebound_add_block(rebound, matrix, answer.block);
            else if (!evaluate(&query, &law, c, i, &answer))
                continue;
            for (size_t e = 0; e < 6; e++)
                blocks[e * n + i] += answer.block[e];
        }
    }
}

/* One collider of add_approach. */
struct approach {
    struct cs_point_query query;
    uint32_t collider;
    struct cs_posed_collider_law law;
    double *y;
};

/* b loses y: an impact puts into b what it gives. */
static void add_approaches(void *arg, size_t begin, size_t end) {
    const struct approach *to = arg;
    const struct cs_system *system = to->query.system;
    for (size_t i = begin; i < end; i++) {
        const struct cs_rebound *rebound =
            cs_rebound_of(system, to->query.matrix, to->collider, i);
        struct cs_point_answer answer;
        if (!rebound && !evaluate(&to->query, &to->law, to->collider, i, &answer))
            continue;
        for (int c = 0; c < 3 && rebound; c++)
            answer.vector[c] = -rebound->impulse[c];
        add_at(to->y, system->view.n, i, answer.vector);
    }
}

static void add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        struct approach to = {matrix_job(system, CS_POINT_APPROACH, matrix), c,
                              near_of(system, c, matrix->t), y};
        cs_vector_parallel_for(system->view.n, add_approaches, &to);
    }
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    const struct cs_point_query query = {system, CS_POINT_BOUND, *at, NULL};
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law law = near_of(system, c, at->t);
        struct cs_point_answer answer;
        if (cs_posed_collider_law_is_plain(&law)) {
            contact_rows_add_bounds(&law, system->view.n, at, sums);
            continue;
        }
        for (size_t i = 0; i < system->view.n; i++)
            if (evaluate(&query, &law, c, i, &answer)) {
                sums->stiffness[i] += answer.stiffness;
                sums->damping[i] += answer.damping;
            }
    }
}

/* One call of store_friction. */
struct storing {
    struct cs_point_query query;
    uint32_t first;
};

static uint32_t friction_chunks(const struct cs_system *system) {
    return (system->view.n + STORED - 1) / STORED;
}

static void store_chunk(void *arg, uint32_t chunk) {
    const struct storing *storing = arg;
    const struct cs_system *system = storing->query.system;
    const uint32_t n = system->view.n, first = chunk * STORED;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        const struct cs_posed_collider_law law = near_of(system, c, storing->query.eval.t);
        struct cs_point_answer answer;
        for (uint32_t i = first; i < n && i < first + STORED; i++)
            if (evaluate(&storing->query, &law, c, i, &answer))
                cs_lagged_friction_store(system->lagged_friction, storing->first + chunk,
                                         &answer.contact, 1, &i, &(double){1});
    }
}

static void store_friction(const struct cs_system *system, double t, const double *x,
                           uint32_t first) {
    struct storing storing = {{system, CS_POINT_LAGGED, {.t = t, .x = x}, NULL}, first};
    cs_pool_run(friction_chunks(system), store_chunk, &storing);
}

const struct cs_term cs_term_contact = {
    .name = "contact force",
    .part_bits = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
    .plan = plan_contact,
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
