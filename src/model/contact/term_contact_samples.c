/* The force term of contact samples (contact_samples.h). Particles themselves have contact by
 * term_contact.c. */
#include "base/pool.h"
#include "model/contact/lagged_friction.h"
#include "model/contact/point_query.h"
#include "model/force/term.h"
#include "scene/body_pairs.h"
#include "scene/collider_keys.h"

#include <clothsim/clones.h>
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
    const enum cs_point_quantity quantity = job->query.quantity;
    struct cs_point_answer answer;
    if (!cs_point_evaluate(&job->query, law, job->samples->chunks[number].collider, point,
                           &answer) ||
        cs_contact_sample_mass(system, point) == HUGE_VAL)
        return;
    // of a force: the power that the collider gives
    if (quantity == CS_POINT_ENERGY || quantity == CS_POINT_FORCE)
        chunk->energy += answer.energy;
    else if (quantity == CS_POINT_LAGGED)
        cs_lagged_friction_store(system->lagged_friction, job->first + number, &answer.contact,
                                 point->n, point->particles, point->w);
    if (quantity == CS_POINT_ENERGY || quantity == CS_POINT_LAGGED)
        return;
    struct cs_contact *to =
        cs_contact_set_append(job->set, number, point->n, point->particles, point->w);
    if (!to)
        return;
    if (quantity == CS_POINT_MATRIX) {
        memcpy(to->block, answer.block, sizeof to->block);
        return;
    }
    double *vectors = cs_contact_vectors(job->set, number, to);
    // row i of the matrix has w_i w_j times one block, and the weights sum to 1
    for (uint32_t k = 0; k < point->n && quantity == CS_POINT_BOUND; k++) {
        to->block[k] = answer.stiffness * point->w[k];
        to->weights[k] = point->w[k] * answer.damping;
    }
    for (size_t k = 0; k < 3 * (size_t)point->n && quantity != CS_POINT_BOUND; k++)
        vectors[k] = point->w[k / 3] * answer.vector[k % 3];
}

/* Middle of the box of `count` particles from `first` on, or of those listed; returns half its
 * diagonal in m. No sample of these vertices is further from the middle. */
CS_INLINE double box_of(const double *x, size_t n, const uint32_t *listed, size_t first,
                        size_t count, double middle[3]) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double *at = x + c * n + first;
        double low = at[listed ? listed[0] : 0], high = low;
        for (size_t k = 1; k < count; k++) {
            const double p = at[listed ? listed[k] : k];
            low = p < low ? p : low;
            high = p > high ? p : high;
        }
        middle[c] = 0.5 * (low + high);
        squared += 0.25 * (high - low) * (high - low);
    }
    return sqrt(squared);
}

/* Returns whether samples of an item may be within the range of a law, by its box. */
static bool item_is_near(const struct job *job, const struct cs_contact_sample_chunk *chunk,
                         const struct cs_posed_collider_law *law, uint32_t i) {
    const uint32_t *vertices = chunk->vertices + (size_t)chunk->vertices_per_item * i;
    const size_t n = job->query.system->view.n;
    double middle[3];
    // constant numbers, so that there are no loops
    const double half = chunk->vertices_per_item == 2
                            ? box_of(job->query.eval.x, n, vertices, 0, 2, middle)
                            : box_of(job->query.eval.x, n, vertices, 0, 3, middle);
    return cs_posed_collider_is_near(&law->collider, law->params.range + half, middle);
}

/* Lists the items of a chunk near its collider. The box of all comes before theirs. */
static void list_items(const struct job *job, struct cs_contact_sample_chunk *chunk) {
    const struct cs_posed_collider_law *law = job->samples->listed + chunk->collider;
    const size_t count = (size_t)chunk->last - chunk->first + 1;
    double middle[3];
    const double all =
        box_of(job->query.eval.x, job->query.system->view.n, NULL, chunk->first, count, middle);
    chunk->n_near = 0;
    if (!cs_posed_collider_is_near(&law->collider, law->params.range + all, middle))
        return;
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

/* Poses all colliders, evaluates all chunks and gathers their contacts. */
static void do_chunks(struct job *job) {
    const struct cs_system *system = job->query.system;
    struct cs_contact_samples *samples = job->samples;
    const double *x = job->query.eval.x;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        struct cs_posed_collider_law *law = samples->colliders + c;
        cs_posed_collider_law_at(system, c, job->query.eval.t, law);
        const struct cs_posed_collider_law *listed = samples->listed + c;
        // planes need no samples
        job->lists |= cs_shape_needs_points(law->collider.shape) &&
                      !(cs_contact_samples_approach(system->view.n, &listed->collider,
                                                    samples->x_listed, &law->collider, x) <
                        (1 - 1e-6) * (listed->params.range - law->params.range));
    }
    for (uint32_t c = 0; c < system->scene->colliders.n && job->lists; c++) {
        samples->listed[c] = samples->colliders[c];
        samples->listed[c].params.range *= CS_CONTACT_SAMPLE_REACH;
    }
    if (job->lists)
        memcpy(samples->x_listed, x, 3 * sizeof *x * system->view.n);
    cs_pool_run(samples->n_chunks, do_chunk, job);
    cs_contact_set_gather(job->set);
}

/* Runs a query over all samples, into current_set. */
static struct cs_contact_set *run(const struct cs_system *system,
                                  enum cs_point_quantity quantity, const struct cs_eval *at,
                                  const struct cs_matrix *matrix) {
    struct cs_contact_samples *samples = system->contact_samples;
    struct job job = {
        {system, quantity, *at, matrix}, samples, &samples->current_set, 0, false};
    do_chunks(&job);
    return job.set;
}

static uint32_t friction_chunks(const struct cs_system *system) {
    return system->contact_samples->n_chunks;
}

static void store_friction(const struct cs_system *system, double t, const double *x,
                           uint32_t first) {
    struct cs_contact_samples *samples = system->contact_samples;
    struct job job = {{system, CS_POINT_LAGGED, {.t = t, .x = x}, NULL},
                      samples,
                      &samples->current_set,
                      first,
                      false};
    do_chunks(&job);
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
        run(system, at->dx || at->dv ? CS_POINT_JVP : CS_POINT_FORCE, at, NULL));
}

static void add_sample_forces(const struct cs_system *system, const struct cs_eval *at,
                              double *f) {
    cs_contact_set_add(&system->contact_samples->current_set, at->block->begin, at->block->end,
                       f);
    if (at->power && at->block->begin == 0)
        at->power[0] += cs_contact_set_energy(&system->contact_samples->current_set);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_contact_set_energy(run(system, CS_POINT_ENERGY, at, NULL));
}

/* Into samples->matrix for products, else into current_set, for blocks alone, which bound the
 * whole matrix if matrix->bound is set: products need the exact blocks. */
static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    struct cs_contact_samples *samples = system->contact_samples;
    struct cs_contact_set *set = kept ? &samples->matrix : &samples->current_set;
    struct job job = {{system,
                       CS_POINT_MATRIX,
                       {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL},
                       matrix},
                      samples,
                      set,
                      0,
                      false};
    set->diagonal_bound = !kept && matrix->bound;
    do_chunks(&job);
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
    const struct cs_eval at = {
        .t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_POTENTIAL};
    struct cs_contact_set *set = run(system, CS_POINT_APPROACH, &at, matrix);
    cs_contact_set_write_vectors(set);
    cs_contact_set_add(set, 0, system->view.n, y);
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    cs_contact_set_add_bound(run(system, CS_POINT_BOUND, at, NULL), sums->stiffness,
                             sums->damping);
}

static const char *const ramps[] = {"colliders.friction", NULL};

const struct cs_term cs_term_cover = {
    .name = "contact samples",
    .part_bits = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
    .plan = plan_samples,
    .build = cs_contact_samples_build,
    .reason_idle = idle_why,
    .rampable_keys = ramps,
    .prepare = prepare,
    .add_force = add_sample_forces,
    .add_jvp = add_sample_forces,
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
