/* The force term of contact samples (contact_samples.h). Particles themselves have contact by
 * term_contact.c. */
#include "base/pool.h"
#include "base/vec3.h"
#include "model/contact/contact_samples.h"
#include "model/contact/friction_anchors.h"
#include "model/contact/friction_chord.h"
#include "model/contact/lagged_friction.h"
#include "model/force/term.h"

#include <math.h>
#include <string.h>

/* Forces, energies, matrices and bounds of contact samples on the
 * vertices of their edges and triangles. All functions use all threads. */

/* quantity that is evaluated */
enum ask { ASK_FORCE, ASK_CHANGE, ASK_APPROACH, ASK_ENERGY, ASK_MATRIX, ASK_BOUND, ASK_LAGGED };

/* One query for all chunks. */
struct job {
    struct cs_contact_samples *covers;
    struct cs_contact_set *set;
    enum ask ask;
    struct cs_eval eval;
    const struct cs_matrix *matrix;
    uint32_t first; /* chunk of lagged friction that the first chunk goes to */
};

/* w_i f at each vertex */
static void set_contact(const double f[3], const struct cs_contact_sample_point *point,
                        struct cs_contact_entry *place) {
    for (uint32_t k = 0; k < place->n; k++)
        for (int c = 0; c < 3; c++)
            place->vectors[k][c] = point->w[k] * f[c];
}

/* Bounds of one sample. Row i of its matrix has w_i w_j times one block, and the weights sum to
 * 1, so that the row sum is w_i times the bound of the point. */
static void bound(const struct cs_point_contact *contact, const struct cs_bristle *bristle,
                  const struct cs_contact_sample_point *point,
                  struct cs_contact_matrix_part *part) {
    double stiffness, damping;
    cs_point_contact_bound(contact, &stiffness, &damping);
    if (bristle)
        cs_bristle_raise_bound(bristle, &stiffness, &damping);
    for (uint32_t k = 0; k < point->n; k++) {
        part->block[k] = stiffness * point->w[k];
        part->weights[k] = point->w[k] * damping;
    }
}

/* Matrix terms of one sample: (w w^T) x B, without a gradient. */
static void fill_matrix(const struct job *job, const struct cs_point_contact *contact,
                        const struct cs_bristle *bristle,
                        const struct cs_contact_sample_point *point,
                        struct cs_contact_matrix_part *part) {
    const struct cs_system *system = job->covers->system;
    struct cs_contact_pull pull = {.h = -job->matrix->cd};
    memset(part->block, 0, sizeof part->block);
    memcpy(part->weights, point->w, sizeof point->w);
    for (uint32_t k = 0; k < point->n && job->matrix->chord; k++)
        cs_contact_pull_add(&pull, job->matrix, system->view.n, point->particles[k],
                            system->inv_mass[point->particles[k]], point->w[k]);
    if (job->matrix->chord)
        cs_friction_chord_add_block(contact, job->matrix, &pull, part->block);
    else
        cs_point_contact_add_block(contact, job->matrix, part->block);
    if (bristle)
        cs_bristle_add_matrix(contact, bristle, job->matrix, &pull, part->block);
}

/* Matrix terms or bounds of one sample. */
static void answer_part(const struct job *job, const struct cs_contact_sample_point *point,
                        const struct cs_point_contact *contact,
                        const struct cs_bristle *bristle, struct cs_contact_chunk *chunk) {
    struct cs_contact_matrix_part *part = cs_contact_chunk_part(chunk);
    if (part && job->ask == ASK_MATRIX)
        fill_matrix(job, contact, bristle, point, part);
    else if (part)
        bound(contact, bristle, point, part);
}

/* Force of one sample, its change, or its approach. */
static void answer_force(const struct job *job, const struct cs_posed_collider_law *near,
                         const struct cs_contact_sample_point *point,
                         const struct cs_point_contact *contact,
                         const struct cs_bristle *bristle, struct cs_contact_entry *place) {
    const size_t n = job->covers->system->view.n;
    const struct cs_contact_force_parts parts = cs_force_parts_of(job->eval.parts);
    double f[3];
    if (job->ask == ASK_CHANGE) {
        double dp[3], dv[3];
        cs_contact_sample_interpolate(point, n, job->eval.dx, dp);
        cs_contact_sample_interpolate(point, n, job->eval.dv, dv);
        const struct cs_point_contact_motion move = cs_posed_collider_law_motion(near, dp, dv);
        cs_point_contact_jvp(contact, parts, &move, f);
        if (bristle && parts.friction > 0)
            cs_bristle_add_jvp(contact, bristle, &move, f);
    } else if (job->ask == ASK_APPROACH) {
        cs_point_contact_approach(contact, job->matrix, f);
        if (bristle)
            cs_bristle_add_approach(contact, bristle, job->matrix, f);
    } else {
        cs_point_contact_force(contact, parts, f);
        if (bristle && parts.friction > 0)
            cs_bristle_add_force(contact, bristle, f);
    }
    set_contact(f, point, place);
}

/* Evaluates one sample if it is in range and can move. */
static void meet(const struct job *job, const struct cs_posed_collider_law *near,
                 const struct cs_contact_sample_point *point, uint32_t number) {
    struct cs_contact_chunk *chunk = job->set->chunks + number;
    const struct cs_system *system = job->covers->system;
    struct cs_point_contact contact;
    struct cs_bristle found, *bristle = NULL;
    double p[3], v[3];
    cs_contact_sample_interpolate(point, system->view.n, job->eval.x, p);
    cs_contact_sample_interpolate(point, system->view.n, job->eval.v, v);
    if (!cs_posed_collider_law_in_range(near, p, v, &contact) ||
        cs_contact_sample_mass(system, point) == HUGE_VAL)
        return;
    if (job->ask == ASK_ENERGY) {
        chunk->energy += cs_barrier_energy(contact.d, contact.range, contact.k);
        return;
    }
    if (job->ask == ASK_LAGGED) {
        cs_lagged_friction_store(system->lagged_friction, job->first + number, &contact,
                                 point->n, point->particles, point->w);
        return;
    }
    struct cs_contact_entry *place = cs_contact_chunk_next(chunk);
    if (!place)
        return;
    place->n = point->n;
    if (cs_bristle_of_sample(system, near, point, p, &found))
        bristle = &found;
    memcpy(place->particles, point->particles, sizeof point->particles);
    if (job->ask == ASK_MATRIX || job->ask == ASK_BOUND)
        answer_part(job, point, &contact, bristle, chunk);
    else
        answer_force(job, near, point, &contact, bristle, place);
}

/* Middle of the box of particles [first, last]; returns half its diagonal in m. */
static double box_of(const double *x, size_t n, uint32_t first, uint32_t last,
                     double middle[3]) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double *at = x + c * n;
        double low = at[first], high = low;
        for (size_t i = (size_t)first + 1; i <= last; i++) {
            low = at[i] < low ? at[i] : low;
            high = at[i] > high ? at[i] : high;
        }
        middle[c] = 0.5 * (low + high);
        squared += 0.25 * (high - low) * (high - low);
    }
    return sqrt(squared);
}

/* The same for the vertices of one item: no sample of it is further from the middle. */
static double reach_of(const struct cs_contact_sample_chunk *chunk, uint32_t item, size_t n,
                       const double *x, double middle[3]) {
    const uint32_t *at = chunk->vertices + (size_t)chunk->vertices_per_item * item;
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        double low = x[c * n + at[0]], high = low;
        for (uint32_t k = 1; k < chunk->vertices_per_item; k++) {
            const double p = x[c * n + at[k]];
            low = p < low ? p : low;
            high = p > high ? p : high;
        }
        middle[c] = 0.5 * (low + high);
        squared += 0.25 * (high - low) * (high - low);
    }
    return sqrt(squared);
}

/* Evaluates one chunk. Boxes of the chunk and of each item come before single samples. */
static void do_chunk(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_contact_sample_chunk *chunk = job->covers->chunks + number;
    const struct cs_posed_collider_law *near = job->covers->colliders + chunk->collider;
    const size_t n = job->covers->system->view.n;
    double middle[3];
    cs_contact_chunk_clear(job->set->chunks + number);
    const double all = box_of(job->eval.x, n, chunk->first, chunk->last, middle);
    if (!cs_posed_collider_is_near(&near->collider, near->params.range + all, middle))
        return;
    for (uint32_t i = chunk->begin; i < chunk->end; i++) {
        struct cs_contact_sample_point point;
        if (!chunk->subdivisions[i - chunk->begin])
            continue;
        const double reach = near->params.range + reach_of(chunk, i, n, job->eval.x, middle);
        if (cs_posed_collider_is_near(&near->collider, reach, middle))
            for (cs_contact_sample_first(chunk, i, &point); cs_contact_sample_next(&point);)
                meet(job, near, &point, number);
    }
}

/* Poses all colliders, evaluates all chunks and counts their contacts. */
static void do_chunks(struct job *job) {
    const struct cs_system *system = job->covers->system;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++)
        cs_posed_collider_law_at(system, c, job->eval.t, job->covers->colliders + c);
    cs_pool_run(job->covers->n_chunks, do_chunk, job);
    cs_contact_set_count(job->set);
}

/* Sets samples->current_set to the forces at a state, or to their change if at->dx or at->dv is
 * set. */
static void contact_samples_set(struct cs_contact_samples *samples, const struct cs_eval *at) {
    struct job job = {.covers = samples,
                      .set = &samples->current_set,
                      .ask = at->dx || at->dv ? ASK_CHANGE : ASK_FORCE,
                      .eval = *at};
    do_chunks(&job);
    cs_contact_set_gather(&samples->current_set);
}

/* Elastic energy in J. */
static double contact_samples_energy(struct cs_contact_samples *samples,
                                     const struct cs_eval *at) {
    struct job job = {
        .covers = samples, .set = &samples->current_set, .ask = ASK_ENERGY, .eval = *at};
    do_chunks(&job);
    return cs_contact_set_energy(&samples->current_set);
}

/* Sets samples->blocks to the matrix. kept: samples->matrix, for products; otherwise
 * current_set, for blocks alone, which bound the whole matrix if matrix->bound is set. */
/* Bounds of the diagonal are only for matrices that are not kept: products need the exact
 * blocks. */
static void contact_samples_set_matrix(struct cs_contact_samples *samples,
                                       const struct cs_matrix *matrix, bool kept) {
    struct cs_contact_set *set = kept ? &samples->matrix : &samples->current_set;
    struct job job = {
        .covers = samples,
        .set = set,
        .ask = ASK_MATRIX,
        .eval = {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL},
        .matrix = matrix};
    set->diagonal_bound = !kept && matrix->bound;
    do_chunks(&job);
    cs_contact_set_gather(set);
    samples->blocks = set;
}

/* Adds the Gershgorin row sums of df/dx (N/m) and df/dv (N s/m) at a state. */
static void contact_samples_add_bound(struct cs_contact_samples *samples,
                                      const struct cs_eval *at, double *stiffness,
                                      double *damping) {
    struct job job = {
        .covers = samples, .set = &samples->current_set, .ask = ASK_BOUND, .eval = *at};
    do_chunks(&job);
    cs_contact_set_add_bound(&samples->current_set, stiffness, damping);
}

static uint32_t friction_chunks(const struct cs_system *system) {
    return system->contact_samples->n_chunks;
}

static void store_friction(const struct cs_system *system, double t, const double *x,
                           uint32_t first) {
    struct job job = {.covers = system->contact_samples,
                      .set = &system->contact_samples->current_set,
                      .ask = ASK_LAGGED,
                      .eval = {.t = t, .x = x},
                      .first = first};
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
    contact_samples_set(system->contact_samples, at);
}

static void add(const struct cs_system *system, const struct cs_eval *at, double *f) {
    cs_contact_set_add(&system->contact_samples->current_set, at->block->begin, at->block->end,
                       f);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return contact_samples_energy(system->contact_samples, at);
}

static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    contact_samples_set_matrix(system->contact_samples, matrix, kept);
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
    struct cs_contact_samples *samples = system->contact_samples;
    struct job job = {
        .covers = samples,
        .set = &samples->current_set,
        .ask = ASK_APPROACH,
        .eval = {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_POTENTIAL},
        .matrix = matrix};
    do_chunks(&job);
    cs_contact_set_gather(&samples->current_set);
    cs_contact_set_add(&samples->current_set, 0, system->view.n, y);
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    contact_samples_add_bound(system->contact_samples, at, sums->stiffness, sums->damping);
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
    .add_approach = add_approach,
    .friction_chunks = friction_chunks,
    .store_friction = store_friction,
    .add_state_bound = add_bound_at,
};
