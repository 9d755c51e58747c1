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
#include "scene/scene.h"

#include <clothsim/clones.h>
#include <math.h>
#include <string.h>

/* particles per row, and per chunk of stored friction */
enum { ROW = CS_COLLIDER_ROW, STORED = 1024 };

/* A query to many particles, and what it adds to. */
struct pass {
    struct cs_point_query query;
    double *to; /* (3,n) vectors in N, or (6,n) blocks */
    const struct cs_gershgorin *bounds;
    double energy;  /* J, of a query in one thread */
    uint32_t first; /* chunk of lagged friction that the first chunk goes to */
};

/* --- planes and spheres, in rows --- */

/* Distances and gradients of one row; a plane's gradient is its normal and is not stored. */
struct row {
    double d[ROW], x[ROW], y[ROW], z[ROW];
    size_t start, count;
};

/* Sets distances in m and gradients of the particles; returns how many are in range. */
CS_INLINE uint32_t measure(const struct cs_posed_collider_law *law, size_t n, const double *x,
                           const bool sphere, struct row *row) {
    const struct cs_posed_collider *collider = &law->collider;
    const double *c = collider->centre, *g = collider->axes[1];
    const double radius = collider->radius, range = law->params.range;
    uint32_t inside = 0;
    for (size_t i = 0; i < row->count; i++) {
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

/* Adds the forces of one row to f at its first particle. rubs: friction or damping act; a
 * constant, so that the loop has no branch. */
CS_INLINE void push(const struct cs_posed_collider_law *law, const struct pass *pass,
                    const bool sphere, const bool rubs, const struct row *row,
                    double *restrict f) {
    const struct cs_contact_force_parts parts = cs_force_parts_of(pass->query.eval.parts);
    const size_t n = pass->query.system->view.n;
    const double *v = pass->query.eval.v + row->start;
    const double *normal = law->collider.axes[1], *u = law->collider.velocity;
    for (size_t i = 0; i < row->count; i++) {
        struct cs_point_contact contact;
        cs_posed_collider_law_set(law, &contact);
        contact.d = row->d[i];
        contact.g[0] = sphere ? row->x[i] : normal[0];
        contact.g[1] = sphere ? row->y[i] : normal[1];
        contact.g[2] = sphere ? row->z[i] : normal[2];
        contact.v[0] = v[i] - u[0];
        contact.v[1] = v[n + i] - u[1];
        contact.v[2] = v[2 * n + i] - u[2];
        double by[3];
        if (rubs)
            cs_point_contact_force_by(&contact, 1, parts, by);
        else
            cs_point_contact_push(&contact, parts, by);
        f[i] += by[0];
        f[n + i] += by[1];
        f[2 * n + i] += by[2];
    }
}

/* The force of all rows of particles, but tangled ones: cs_point_evaluate for |g| = 1. */
CS_INLINE void answer_rows(const struct cs_posed_collider_law *law, const struct pass *pass,
                           size_t begin, size_t end, const bool sphere) {
    const struct cs_eval *at = &pass->query.eval;
    const uint8_t *tangled = pass->query.system->tangled;
    const bool rubs =
        cs_force_parts_of(at->parts).friction * (law->friction + law->damping + law->loss) > 0;
    struct row row;
    for (row.start = begin; row.start < end; row.start += ROW) {
        row.count = end - row.start < ROW ? end - row.start : ROW;
        if (measure(law, pass->query.system->view.n, at->x + row.start, sphere, &row) == 0)
            continue;
        for (size_t i = 0; tangled && i < row.count; i++)
            row.d[i] = tangled[row.start + i] ? law->params.range : row.d[i];
        if (rubs)
            push(law, pass, sphere, true, &row, pass->to + row.start);
        else
            push(law, pass, sphere, false, &row, pass->to + row.start);
    }
}

static CS_CLONES void answer_in_rows(const struct cs_posed_collider_law *law,
                                     const struct pass *pass, size_t begin, size_t end) {
    if (law->collider.shape->bounds == CS_BOUNDS_SPHERE)
        answer_rows(law, pass, begin, end, true);
    else
        answer_rows(law, pass, begin, end, false);
}

/* --- one by one --- */

/* Adds the answer of particle i. in_rows: its vector was added already. */
static void take(struct pass *pass, uint32_t i, const struct cs_point_answer *answer,
                 bool in_rows) {
    const struct cs_point_query *query = &pass->query;
    const size_t n = query->system->view.n;
    switch (query->asked) {
    case CS_QUERY_ENERGY:
        pass->energy += answer->energy;
        return;
    case CS_QUERY_LAGGED:
        cs_lagged_friction_store(query->system->lagged_friction, pass->first + i / STORED,
                                 &answer->contact, 1, &i, &(double){1});
        return;
    case CS_QUERY_BOUND:
        pass->bounds->stiffness[i] += answer->stiffness;
        pass->bounds->damping[i] += answer->damping;
        return;
    case CS_QUERY_MATRIX:
        for (size_t e = 0; e < 6; e++)
            pass->to[e * n + i] += answer->block[e];
        return;
    case CS_QUERY_FORCE:
        if (query->eval.power)
            query->eval.power[i] += answer->energy;
        break;
    case CS_QUERY_JVP:
    case CS_QUERY_APPROACH:
        break;
    }
    for (size_t c = 0; c < 3 && !in_rows; c++)
        pass->to[c * n + i] += answer->vector[c];
}

/* Answers for a particle in impact: b loses its vector, as an impact puts into b what it gives.
 */
static void answer_rebound(const struct cs_rebound *rebound, const struct cs_matrix *matrix,
                           struct cs_point_answer *answer) {
    memset(answer->block, 0, sizeof answer->block);
    cs_rebound_add_block(rebound, matrix, answer->block);
    for (int c = 0; c < 3; c++)
        answer->vector[c] = -rebound->impulse[c];
}

/* Answers for particles [begin, end) at a collider, one by one: those in range of it, which the
 * bounding tests of a row tell, and those in impact with it. */
static void answer_near(const struct cs_posed_collider_law *law, uint32_t collider,
                        struct pass *pass, size_t begin, size_t end, bool in_rows) {
    const struct cs_point_query *query = &pass->query;
    const struct cs_system *system = query->system;
    struct cs_contact_sample_point point = {.n = 1, .w = {1}};
    struct cs_point_answer answer;
    double reach[ROW];
    for (int i = 0; i < ROW; i++)
        reach[i] = law->params.range;
    for (size_t row = begin; row < end; row += ROW) {
        const size_t count = end - row < ROW ? end - row : ROW;
        uint8_t near[ROW];
        const uint32_t n_near = cs_posed_collider_list_near(
            &law->collider, reach, system->view.n, query->eval.x + row, count, near);
        for (uint32_t k = 0; k < n_near; k++) {
            const uint32_t i = point.particles[0] = (uint32_t)row + near[k];
            if (!(query->matrix && cs_rebound_of(system, query->matrix, collider, i)) &&
                cs_point_evaluate(query, law, collider, &point, &answer))
                take(pass, i, &answer, in_rows);
        }
    }
    const bool rebounds = query->matrix && query->matrix->rebounds;
    for (size_t i = rebounds ? begin : end; cs_rebound_next(system, collider, end, &i); i++) {
        answer_rebound(system->rebounds->list + i, query->matrix, &answer);
        take(pass, (uint32_t)i, &answer, in_rows);
    }
}

/* Answers for particles [begin, end) at all colliders. Spheres and planes have a vectorised
 * path with the same formulas, which gives no power. */
static void run(void *arg, size_t begin, size_t end) {
    struct pass *pass = arg;
    const struct cs_point_query *query = &pass->query;
    const bool power = query->asked == CS_QUERY_FORCE && query->eval.power;
    for (uint32_t k = 0; k < query->system->scene->colliders.n; k++) {
        struct cs_posed_collider_law law;
        cs_posed_collider_law_at(query->system, k, query->eval.t, &law);
        const bool in_rows =
            query->asked == CS_QUERY_FORCE && cs_posed_collider_law_is_plain(&law);
        if (in_rows)
            answer_in_rows(&law, pass, begin, end);
        if (!in_rows || (power && !cs_vec3_is_zero(law.collider.velocity)))
            answer_near(&law, k, pass, begin, end, in_rows);
    }
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

const char *const cs_contact_ramps[] = {"colliders.friction", NULL};

static void add_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const bool changes = at->dx || at->dv;
    struct pass pass = {{system, changes ? CS_QUERY_JVP : CS_QUERY_FORCE, *at, NULL}, .to = f};
    run(&pass, at->block->begin, at->block->end);
}

/* Energy of the barrier law over the free particles. */
static double energy(const struct cs_system *system, const struct cs_eval *at) {
    struct pass pass = {{system, CS_QUERY_ENERGY, *at, NULL}, .energy = 0};
    run(&pass, 0, system->view.n);
    return pass.energy;
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    struct pass pass = {cs_point_matrix_query(system, CS_QUERY_MATRIX, matrix), .to = blocks};
    run(&pass, begin, end);
}

static void add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    struct pass pass = {cs_point_matrix_query(system, CS_QUERY_APPROACH, matrix), .to = y};
    cs_vector_parallel_for(system->view.n, run, &pass);
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    struct pass pass = {{system, CS_QUERY_BOUND, *at, NULL}, .bounds = sums};
    run(&pass, 0, system->view.n);
}

static uint32_t friction_chunks(const struct cs_system *system) {
    return (system->view.n + STORED - 1) / STORED;
}

static void store_chunk(void *arg, uint32_t chunk) {
    struct pass *pass = arg;
    const size_t begin = (size_t)chunk * STORED, left = pass->query.system->view.n - begin;
    run(pass, begin, begin + (left < STORED ? left : STORED));
}

static void store_friction(const struct cs_system *system, double t, const double *x,
                           uint32_t first) {
    struct pass pass = {{system, CS_QUERY_LAGGED, {.t = t, .x = x}, NULL}, .first = first};
    cs_pool_run(friction_chunks(system), store_chunk, &pass);
}

const struct cs_term cs_term_contact = {
    .name = "contact force",
    CS_CONTACT_TERM,
    .plan = plan_contact,
    .build = cs_collider_params_table_build,
    .add_force = add_force,
    .add_jvp = add_force,
    .energy = energy,
    .add_blocks = add_blocks,
    .add_approach = add_approach,
    .friction_chunks = friction_chunks,
    .store_friction = store_friction,
    .add_state_bound = add_bound_at,
};
