/* The force term of contact samples (contact_samples.h). Particles themselves have contact by
 * term_contact.c. */
#include "base/pool.h"
#include "model/contact/lagged_friction.h"
#include "model/contact/point_query.h"
#include "model/force/term.h"
#include "scene/body_pairs.h"
#include "scene/collider_keys.h"

#include <math.h>
#include <string.h>

/* One query for all chunks. */
struct job {
    struct cs_point_query query;
    struct cs_contact_samples *samples;
    struct cs_contact_set *set;
    uint32_t first; /* chunk of lagged friction that the first chunk goes to */
    bool lists;     /* items near colliders are listed again */
};

/* Evaluates one sample if it is in range and can move. */
static void meet(const struct job *job, const struct cs_posed_collider_law *law,
                 const struct cs_contact_sample_point *point, uint32_t number) {
    struct cs_contact_chunk *chunk = job->set->chunks + number;
    const struct cs_system *system = job->query.system;
    const enum cs_contact_query asked = job->query.asked;
    struct cs_point_answer answer;
    if (!cs_point_evaluate(&job->query, law, job->samples->chunks[number].collider, point,
                           &answer) ||
        cs_contact_sample_mass(system, point) == HUGE_VAL)
        return;
    // of a force: the power that the collider gives
    if (asked == CS_QUERY_ENERGY || asked == CS_QUERY_FORCE)
        chunk->energy += answer.energy;
    else if (asked == CS_QUERY_LAGGED)
        cs_lagged_friction_store(system->lagged_friction, job->first + number, &answer.contact,
                                 point->n, point->particles, point->w);
    if (asked == CS_QUERY_ENERGY || asked == CS_QUERY_LAGGED)
        return;
    struct cs_contact *to =
        cs_contact_set_append(job->set, number, point->n, point->particles, point->w);
    if (!to)
        return;
    // row i of the matrix has w_i w_j times one block, and the weights sum to 1
    if (asked == CS_QUERY_MATRIX)
        memcpy(to->block, answer.block, sizeof to->block);
    else if (asked == CS_QUERY_BOUND)
        to->vector[0] = answer.stiffness, to->vector[1] = answer.damping;
    else
        memcpy(to->vector, answer.vector, sizeof to->vector);
}

/* Returns whether samples of an item may be within the range of a law. */
static bool item_is_near(const struct job *job, const struct cs_contact_sample_chunk *chunk,
                         const struct cs_posed_collider_law *law, uint32_t i) {
    return cs_contact_sample_item_is_near(chunk, i, &law->collider, law->params.range,
                                          job->query.system->view.n, job->query.eval.x);
}

/* Lists the items of a chunk near its collider. */
static void list_items(const struct job *job, struct cs_contact_sample_chunk *chunk) {
    const struct cs_posed_collider_law *law = job->samples->listed + chunk->collider;
    chunk->n_near = 0;
    for (uint32_t i = chunk->begin; i < chunk->end; i++) {
        chunk->near[chunk->n_near] = (uint8_t)(i - chunk->begin);
        chunk->n_near +=
            chunk->subdivisions[i - chunk->begin] && item_is_near(job, chunk, law, i);
    }
}

/* Evaluates one chunk. Lists and boxes of items come before single samples. */
static void do_chunk(void *arg, uint32_t number) {
    const struct job *job = arg;
    struct cs_contact_sample_chunk *chunk = job->samples->chunks + number;
    const struct cs_posed_collider_law *law = job->samples->colliders + chunk->collider;
    cs_contact_set_clear(job->set, number);
    if (job->lists)
        list_items(job, chunk);
    for (uint32_t k = 0; k < chunk->n_near; k++) {
        const uint32_t i = chunk->begin + chunk->near[k];
        struct cs_contact_sample_point point;
        if (item_is_near(job, chunk, law, i))
            for (cs_contact_sample_first(chunk, i, &point); cs_contact_sample_next(&point);)
                meet(job, law, &point, number);
    }
}

/* Poses all colliders; returns whether the lists of items are to be made again. */
static bool pose_colliders(const struct cs_point_query *query,
                           struct cs_contact_samples *samples) {
    const uint32_t n_colliders = query->system->scene->colliders.n;
    const size_t n = query->system->view.n;
    const double *x = query->eval.x;
    bool lists = false;
    for (uint32_t c = 0; c < n_colliders; c++) {
        struct cs_posed_collider_law *law = samples->colliders + c;
        cs_posed_collider_law_at(query->system, c, query->eval.t, law);
        const struct cs_posed_collider_law *listed = samples->listed + c;
        // planes need no samples
        lists |= cs_shape_needs_points(law->collider.shape) &&
                 !(cs_posed_collider_is_shifted(&listed->collider, &law->collider) &&
                   cs_contact_samples_motion(n, listed->collider.centre, samples->x_listed,
                                             law->collider.centre, x) <
                       (1 - 1e-6) * (listed->params.range - law->params.range));
    }
    for (uint32_t c = 0; c < n_colliders && lists; c++) {
        samples->listed[c] = samples->colliders[c];
        samples->listed[c].params.range *= CS_CONTACT_SAMPLE_MARGIN;
    }
    if (lists)
        memcpy(samples->x_listed, x, 3 * sizeof *x * n);
    return lists;
}

/* Runs a query over all samples into a set, and gathers its contacts. */
static struct cs_contact_set *run(struct cs_point_query query, struct cs_contact_set *set,
                                  uint32_t first) {
    struct cs_contact_samples *samples = query.system->contact_samples;
    struct job job = {query, samples, set, first, pose_colliders(&query, samples)};
    cs_pool_run(samples->n_chunks, do_chunk, &job);
    cs_contact_set_gather(set);
    return set;
}

/* The same of a state, into current_set. */
static struct cs_contact_set *run_at(const struct cs_system *system,
                                     enum cs_contact_query asked, const struct cs_eval *at) {
    return run((struct cs_point_query){system, asked, *at, NULL},
               &system->contact_samples->current_set, 0);
}

static uint32_t friction_chunks(const struct cs_system *system) {
    return system->contact_samples->n_chunks;
}

static void store_friction(const struct cs_system *system, double t, const double *x,
                           uint32_t first) {
    run((struct cs_point_query){system, CS_QUERY_LAGGED, {.t = t, .x = x}, NULL},
        &system->contact_samples->current_set, first);
}

/* Returns whether a collider is round, so that it may need samples. */
static bool any_round(const struct cs_scene *scene) {
    const struct cs_collider *colliders = cs_scene_colliders(scene);
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (cs_shape_needs_points(cs_collider_shape(colliders + c)))
            return true;
    return false;
}

/* The plan does not know lengths yet; reason_idle reports short edges later. */
static struct cs_plan_row plan_samples(const struct cs_scene *scene) {
    const bool asked = cs_scene_contact_is_force(scene) && scene->colliders.n,
               built = asked && any_round(scene);
    return (struct cs_plan_row){.built = built,
                                .reason = !asked  ? NULL
                                          : built ? "colliders are finer than edges are long"
                                                  : "every collider is flat"};
}

static const char *idle_why(const struct cs_system *system) {
    return system->contact_samples ? NULL : "edges are short enough for every collider";
}

/* Forces at a state, or their change if a direction is set. */
static void prepare(const struct cs_system *system, const struct cs_eval *at) {
    cs_contact_set_write_vectors(
        run_at(system, at->dx || at->dv ? CS_QUERY_JVP : CS_QUERY_FORCE, at));
}

static void add_sample_forces(const struct cs_system *system, const struct cs_eval *at,
                              double *f) {
    cs_contact_set_add(&system->contact_samples->current_set, at->block->begin, at->block->end,
                       f);
    if (at->power && at->block->begin == 0)
        at->power[0] += cs_contact_set_energy(&system->contact_samples->current_set);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_contact_set_energy(run_at(system, CS_QUERY_ENERGY, at));
}

/* Into samples->matrix for products, else into current_set, for blocks alone, which bound the
 * whole matrix if matrix->bound is set: products need the exact blocks. */
static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    struct cs_contact_samples *samples = system->contact_samples;
    struct cs_contact_set *set = kept ? &samples->matrix : &samples->current_set;
    set->diagonal_bound = !kept && matrix->bound;
    run(cs_point_matrix_query(system, CS_QUERY_MATRIX, matrix), set, 0);
    cs_contact_set_write_blocks(set);
    samples->blocks = set;
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    (void)matrix;
    cs_contact_set_add_blocks(system->contact_samples->blocks, begin, end, blocks);
}

static void add_product(const struct cs_system *system, const double *p, double *y) {
    cs_contact_set_multiply(&system->contact_samples->matrix, p, y);
}

/* into the set that the matrix does not use */
static void add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    struct cs_contact_set *set = run(cs_point_matrix_query(system, CS_QUERY_APPROACH, matrix),
                                     &system->contact_samples->current_set, 0);
    cs_contact_set_write_vectors(set);
    cs_contact_set_add(set, 0, system->view.n, y);
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    cs_contact_set_add_bound(run_at(system, CS_QUERY_BOUND, at), sums->stiffness,
                             sums->damping);
}

const struct cs_term cs_term_cover = {
    .name = "contact samples",
    CS_CONTACT_TERM,
    .plan = plan_samples,
    .build = cs_contact_samples_build,
    .reason_idle = idle_why,
    .prepare = prepare,
    .add_force = add_sample_forces,
    .add_jvp = add_sample_forces,
    .energy = energy,
    .prepare_matrix = prepare_matrix,
    .add_blocks = add_blocks,
    .add_matrix_product = add_product,
    .add_approach = add_approach,
    .friction_chunks = friction_chunks,
    .store_friction = store_friction,
    .add_state_bound = add_bound_at,
};
