/* Aggregation multigrid as a preconditioner: one V-cycle for each body, or for all that
 * touch each other, in single precision.
 *
 * Setup copies the matrix over `scale` into the first level and coarsens level by level. An
 * application scales the residual by its norm, runs the cycle and scales back:
 *   (A / scale) x = r / size,   z = (size / scale) x
 * Conjugate gradients in double precision correct its rounding, up to which the cycle has to be
 * symmetric and positive definite. */
#include "model/solver/multigrid.h"

#include "base/pool.h"
#include "model/elastic/membranes.h"
#include "model/force/terms.h"
#include "model/solver/extra_springs.h"
#include "scene/body_pairs.h"
#include "scene/body_particles.h"
#include "scene/elastic_keys.h"
#include "scene/scene.h"

#include <clothsim/clones.h>

/* Particles of a mesh that one row holds, and particles per block of a loop. A grid's rows are
 * its own; a mesh has no rows, so it is cut into artificial ones to share the loops below. */
enum { ROW = 4096 };

static bool any_body_above(const struct cs_scene *scene, uint32_t particles) {
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        if (cs_body_count(cs_scene_body(scene, b)) > particles)
            return true;
    return false;
}

bool cs_multigrid_is_used(const struct cs_scene *scene) {
    return any_body_above(scene, CS_MULTIGRID_PARTICLES);
}

bool cs_multigrid_is_in_reserve(const struct cs_scene *scene) {
    return cs_scene_has_body_contact(scene) &&
           any_body_above(scene, CS_MULTIGRID_RESERVE_PARTICLES);
}

/* Tells whether contact by force acts between a body and one of the bodies [begin, end). The
 * friction is not needed here. */
static bool meets_any(const struct cs_scene *scene, uint32_t body, uint32_t begin,
                      uint32_t end) {
    double friction;
    for (uint32_t b = begin; b < end; b++)
        if (cs_scene_bodies_collide(scene, body, b, &friction))
            return true;
    return false;
}

/* Tells whether two different bodies may touch. */
static bool is_joint(const struct cs_scene *scene) {
    for (uint32_t b = 1; b < scene->bodies.n; b++)
        if (meets_any(scene, b, 0, b))
            return true;
    return false;
}

/* Describes a body to its hierarchy: its particles, and its runs of springs or of those that
 * stand for its membrane. Runs of one body stand together, in the order of the bodies. */
static struct cs_hierarchy hierarchy_of(const struct cs_system *system, uint32_t body) {
    const struct cs_body_range *range = system->bodies + body;
    const bool elastic = cs_scene_elastic(system->scene, body)->present;
    const struct cs_spring_run *runs = elastic ? system->membranes->runs : system->springs.runs;
    const uint32_t n_runs = elastic ? system->membranes->n_runs : system->springs.n_runs;
    uint32_t begin = 0;
    while (begin < n_runs && runs[begin].body != body)
        begin++;
    uint32_t end = begin;
    while (end < n_runs && runs[end].body == body)
        end++;
    return (struct cs_hierarchy){
        .first = range->first,
        .count = range->count,
        .columns = range->mesh ? ROW : range->columns,
        .runs = runs + begin,
        .n_runs = end - begin,
        .has_particle_blocks = cs_terms_have_blocks(system),
        .has_body_contact = meets_any(system->scene, body, 0, system->scene->bodies.n)};
}

/* Allocates what contact needs: arrays shared by all bodies, once, and those of this
 * body's levels. */
static void load_contact(struct cs_multigrid *multigrid, struct cs_hierarchy *hierarchy,
                         struct cs_arena *arena, struct cs_error *error) {
    if (!multigrid->internal_blocks) {
        CS_ARENA_ARRAY(arena, multigrid->internal_blocks, 6 * multigrid->system->view.n, error);
        if (!error->status)
            cs_pair_vertices_init(&multigrid->pair_vertices, arena, error);
    }
    if (!error->status)
        cs_coupling_init(hierarchy, arena, error);
}

/* Lists the levels of all bodies, gives them joint vectors, and numbers their parents. */
static void join_levels(struct cs_multigrid *multigrid, struct cs_arena *arena,
                        struct cs_error *error) {
    const uint32_t n = multigrid->n;
    cs_hierarchies_make_equally_deep(multigrid->hierarchies, n, arena, error);
    const uint32_t n_levels = multigrid->hierarchies->n_levels;
    CS_ARENA_ARRAY(arena, multigrid->joint_levels, (size_t)n_levels * n, error);
    for (uint32_t k = 0; k < n_levels && !error->status; k++) {
        struct cs_level **levels = multigrid->joint_levels + (size_t)k * n;
        for (uint32_t b = 0; b < n; b++)
            levels[b] = multigrid->hierarchies[b].levels + k;
        cs_level_alloc_vectors(&(struct cs_level_group){levels, n}, arena, error);
    }
    if (!error->status)
        cs_coarsest_init(&multigrid->coarsest, arena, error);
}

/* Gives every level of a body its own vectors. */
static void separate_levels(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                            struct cs_error *error) {
    for (uint32_t k = 0; k < hierarchy->n_levels && !error->status; k++) {
        struct cs_level *level = hierarchy->levels + k;
        cs_level_alloc_vectors(&(struct cs_level_group){&level, 1}, arena, error);
    }
}

/* Allocates the parents' joint numbers of all cells of the vectors of a level that begins at
 * cell 0 of them, and gives them to the other bodies' levels. */
static void add_joint_parents(struct cs_multigrid *multigrid, struct cs_arena *arena,
                              struct cs_error *error) {
    for (uint32_t b = 0; b < multigrid->n; b++)
        for (uint32_t k = 0; k < multigrid->hierarchies[b].n_levels && !error->status; k++) {
            struct cs_level *level = multigrid->hierarchies[b].levels + k;
            level->joint_parents =
                level->first ? multigrid->hierarchies->levels[k].joint_parents
                             : cs_arena_alloc_array(arena, level->stride,
                                                    sizeof *level->joint_parents, error);
        }
}

enum cs_status cs_multigrid_init(struct cs_multigrid *multigrid, const struct cs_system *system,
                                 struct cs_arena *arena, struct cs_error *error) {
    *multigrid = (struct cs_multigrid){.system = system};
    if (!cs_multigrid_is_used(system->scene) && !cs_multigrid_is_in_reserve(system->scene))
        return CS_OK;
    const uint32_t n = system->scene->bodies.n;
    CS_ARENA_ARRAY(arena, multigrid->hierarchies, n, error);
    for (uint32_t b = 0; b < n && !error->status; b++) {
        struct cs_hierarchy *hierarchy = multigrid->hierarchies + multigrid->n++;
        *hierarchy = hierarchy_of(system, b);
        (system->bodies[b].mesh ? cs_hierarchy_of_mesh : cs_hierarchy_of_grid)(hierarchy, arena,
                                                                               error);
    }
    // vectors need the sizes of all levels, lists their joint numbers
    if (!error->status && is_joint(system->scene))
        join_levels(multigrid, arena, error);
    for (uint32_t b = 0; b < n && !multigrid->joint_levels && !error->status; b++)
        separate_levels(multigrid->hierarchies + b, arena, error);
    if (cs_scene_has_body_contact(system->scene))
        add_joint_parents(multigrid, arena, error);
    for (uint32_t b = 0; b < n && !error->status; b++)
        if (multigrid->hierarchies[b].has_body_contact)
            load_contact(multigrid, multigrid->hierarchies + b, arena, error);
    return error->status;
}

/* Arguments of a loop that copies numbers between particles, in double precision, and the first
 * level's cells, in single precision. gain multiplies every number. */
struct exchange {
    const struct cs_multigrid *multigrid;
    const struct cs_hierarchy *hierarchy;
    const double *from;
    double *to;
    double gain;
};

/* Arguments of a loop that loads the matrix. */
struct loading {
    struct exchange exchange; /* first member: run() passes its address */
    const struct cs_multigrid_matrix *matrix;
    const double *inner; /* (6,n) parts of `blocks` that extra springs replace; NULL: none */
};

/* Rows of one block of a loop: about ROW particles, and whole rows, so that no two blocks share
 * one. */
static uint32_t rows_of_block(const struct cs_hierarchy *hierarchy) {
    return (ROW + hierarchy->columns - 1) / hierarchy->columns;
}

/* Runs a task over blocks of whole rows with all threads. */
static void run(struct exchange *exchange, void (*task)(void *exchange, uint32_t block)) {
    const struct cs_hierarchy *hierarchy = exchange->hierarchy;
    const uint32_t particles = rows_of_block(hierarchy) * hierarchy->columns;
    cs_pool_run((hierarchy->count + particles - 1) / particles, task, exchange);
}

/* Row k of a block: `count` particles from `particle` on, in cells from `cell` on. */
struct row {
    size_t particle, cell, count;
};

/* count is 0 beyond the body's last row. */
static struct row row_of(const struct cs_hierarchy *hierarchy, uint32_t block, uint32_t k) {
    const size_t row = (size_t)block * rows_of_block(hierarchy) + k;
    const size_t before = row * hierarchy->columns;
    const size_t left = hierarchy->count > before ? hierarchy->count - before : 0;
    return (struct row){hierarchy->first + before,
                        hierarchy->levels->begin + row * hierarchy->levels->pitch,
                        left < hierarchy->columns ? left : hierarchy->columns};
}

/* Sets the first level's diagonal from masses and blocks, 0 where a particle is pinned. Blocks
 * of pairs that become extra springs are subtracted, because springs bring their own diagonal.
 * A level of form CS_LEVEL_FACTORED has one number per cell, and its matrix has no blocks. */
CS_CLONES static void load_diagonal(void *arg, uint32_t block) {
    static const bool on_diagonal[6] = {true, false, false, true, false, true};
    const struct loading *loading = arg;
    const struct cs_hierarchy *hierarchy = loading->exchange.hierarchy;
    const struct cs_level *level = hierarchy->levels;
    const double *mass = loading->matrix->mass, *blocks = loading->matrix->blocks;
    const double *inner = loading->inner, *as_springs = loading->matrix->as_springs;
    const double *inv_mass = loading->exchange.multigrid->system->inv_mass;
    const size_t n = loading->exchange.multigrid->system->view.n;
    for (uint32_t k = 0; k < rows_of_block(hierarchy); k++) {
        const struct row row = row_of(hierarchy, block, k);
        for (size_t c = 0; c < (level->form == CS_LEVEL_FACTORED ? 1 : 6); c++) {
            float *own = level->diagonal + c * level->n + row.cell;
            for (size_t i = 0, at = row.particle; i < row.count; i++, at++) {
                double value = on_diagonal[c] ? mass[at] : 0;
                if (blocks)
                    value += blocks[c * n + at];
                value -= as_springs ? as_springs[c * n + at] : 0;
                if (inner)
                    value -= inner[c * n + at];
                /* 0 marks a dead cell: a pinned particle does not move */
                own[i] = inv_mass[at] > 0 ? (float)(loading->exchange.gain * value) : 0;
            }
        }
    }
}

/* Copies the scaled residual into the first level. */
CS_CLONES static void load_r(void *arg, uint32_t block) {
    const struct exchange *exchange = arg;
    const struct cs_hierarchy *hierarchy = exchange->hierarchy;
    const size_t n = exchange->multigrid->system->view.n;
    for (uint32_t k = 0; k < rows_of_block(hierarchy); k++) {
        const struct row row = row_of(hierarchy, block, k);
        for (size_t c = 0; c < 3; c++) {
            const double *from = exchange->from + c * n + row.particle;
            float *to = hierarchy->levels->residual + c * hierarchy->levels->stride + row.cell;
            for (size_t i = 0; i < row.count; i++)
                to[i] = (float)(exchange->gain * from[i]);
        }
    }
}

/* Copies the first level's solution back, scaled. */
CS_CLONES static void store_x(void *arg, uint32_t block) {
    const struct exchange *exchange = arg;
    const struct cs_hierarchy *hierarchy = exchange->hierarchy;
    const size_t n = exchange->multigrid->system->view.n;
    for (uint32_t k = 0; k < rows_of_block(hierarchy); k++) {
        const struct row row = row_of(hierarchy, block, k);
        for (size_t c = 0; c < 3; c++) {
            const float *from =
                hierarchy->levels->solution + c * hierarchy->levels->stride + row.cell;
            double *to = exchange->to + c * n + row.particle;
            for (size_t i = 0; i < row.count; i++)
                to[i] = exchange->gain * (double)from[i];
        }
    }
}

/* Makes the first level's extra springs from the stored contact pairs, if the body is in
 * contact. Sets loading->inner to the blocks that they replace. Returns false if out of
 * memory. */
static bool load_links(struct loading *loading, struct cs_hierarchy *hierarchy) {
    const struct cs_multigrid *multigrid = loading->exchange.multigrid;
    const struct cs_pairs *pairs = loading->matrix->pairs;
    struct cs_coupling coupling = {hierarchy,
                                   multigrid->hierarchies,
                                   pairs,
                                   &multigrid->pair_vertices,
                                   multigrid->system->inv_mass,
                                   loading->exchange.gain,
                                   loading->matrix->trace_min,
                                   multigrid->internal_blocks};
    if (!hierarchy->has_body_contact)
        return true;
    hierarchy->levels->extra_springs->is_nonempty = false;
    if (!pairs || !cs_pair_vertices_count(pairs))
        return true;
    loading->inner = multigrid->internal_blocks;
    return cs_coupling_load(&coupling);
}

/* Computes the numbers of all levels of a body. Extra springs come first: they decide which
 * blocks the diagonal must not contain. Returns false if out of memory for extra springs. */
static bool load_levels(struct loading *loading, struct cs_hierarchy *hierarchy) {
    struct cs_level *level = hierarchy->levels;
    bool done = load_links(loading, hierarchy);
    run(&loading->exchange, load_diagonal);
    hierarchy->kind->load(hierarchy, loading->matrix->factors, loading->matrix->x,
                          loading->exchange.multigrid->system->view.n, loading->matrix->scale);
    cs_level_invert(level);
    for (; level < hierarchy->levels + hierarchy->n_levels - 1; level++) {
        hierarchy->kind->coarsen(level, level + 1);
        if (hierarchy->has_body_contact)
            done = cs_coupling_coarsen(level, level + 1) && done;
        cs_level_invert(level + 1);
    }
    return done;
}

/* Level k of a body, or of all bodies if they touch each other. *one is the level of the body.
 */
static struct cs_level_group group_of(const struct cs_multigrid *multigrid,
                                      struct cs_hierarchy *hierarchy, uint32_t k,
                                      struct cs_level **one) {
    if (multigrid->joint_levels)
        return (struct cs_level_group){multigrid->joint_levels + (size_t)k * multigrid->n,
                                       multigrid->n};
    *one = hierarchy->levels + k;
    return (struct cs_level_group){one, 1};
}

/* Lists the pairs by particle once, for all bodies, and then loads body by body. */
bool cs_multigrid_setup(struct cs_multigrid *multigrid,
                        const struct cs_multigrid_matrix *matrix) {
    bool done = true;
    multigrid->scale = matrix->scale;
    if (multigrid->internal_blocks && cs_pair_vertices_count(matrix->pairs))
        done = cs_pair_vertices_find(&multigrid->pair_vertices, matrix->pairs);
    for (uint32_t k = 0; k < multigrid->n; k++) {
        struct cs_hierarchy *hierarchy = multigrid->hierarchies + k;
        struct loading loading = {
            {multigrid, hierarchy, NULL, NULL, 1 / matrix->scale}, matrix, NULL};
        done = load_levels(&loading, hierarchy) && done;
    }
    if (multigrid->joint_levels) {
        const struct cs_level_group last = group_of(multigrid, multigrid->hierarchies,
                                                    multigrid->hierarchies->n_levels - 1, NULL);
        cs_coarsest_factor(&multigrid->coarsest, &last);
    }
    return done;
}

/* One V-cycle: sets the first level's solution for its residual.
 *   1. Down: smooth from 0, compute the residual, sum it over aggregates.
 *   2. On the last level D^-1 is the exact solution, because it has no springs, except between
 *      bodies that touch: then they are solved together.
 *   3. Up: add the aggregates' solution to their cells, and smooth again.
 *
 * The smoother is the same symmetric map both times, which makes the cycle symmetric. */
static void cycle(struct cs_multigrid *multigrid, struct cs_hierarchy *hierarchies,
                  uint32_t n) {
    const uint32_t last = hierarchies->n_levels - 1;
    struct cs_level *one;
    for (uint32_t k = 0; k < last; k++) {
        const struct cs_level_group group = group_of(multigrid, hierarchies, k, &one);
        cs_level_smooth_down(&group);
        for (uint32_t b = 0; b < n; b++)
            hierarchies[b].kind->restrict_r(hierarchies[b].levels + k,
                                            hierarchies[b].levels + k + 1);
    }
    // bodies apart have no extra springs there, which leaves the diagonal
    const struct cs_level_group coarsest = group_of(multigrid, hierarchies, last, &one);
    if (cs_level_is_coupled(&coarsest))
        cs_coarsest_solve(&multigrid->coarsest, &coarsest);
    for (uint32_t b = 0; b < n && !cs_level_is_coupled(&coarsest); b++)
        cs_level_solve_diagonal(coarsest.levels[b]);
    for (uint32_t k = last; k-- > 0;) {
        const struct cs_level_group group = group_of(multigrid, hierarchies, k, &one);
        for (uint32_t b = 0; b < n; b++)
            hierarchies[b].kind->prolong_x(hierarchies[b].levels + k + 1,
                                           hierarchies[b].levels + k);
        cs_level_smooth_up(&group);
    }
}

/* Preconditions n bodies that are smoothed together. */
static void apply_to(struct cs_multigrid *multigrid, struct cs_hierarchy *hierarchies,
                     uint32_t n, const struct exchange *exchange, double size) {
    for (uint32_t b = 0; b < n; b++) {
        struct exchange in = {multigrid, hierarchies + b, exchange->from, NULL, 1 / size};
        run(&in, load_r);
    }
    cycle(multigrid, hierarchies, n);
    for (uint32_t b = 0; b < n; b++) {
        struct exchange out = {multigrid, hierarchies + b, NULL, exchange->to,
                               size / multigrid->scale};
        run(&out, store_x);
    }
}

/* Bodies that never touch are independent, because springs never join two of them. */
void cs_multigrid_apply(struct cs_multigrid *multigrid, const double *r, double size,
                        double *z) {
    const struct exchange exchange = {.from = r, .to = z};
    const uint32_t together = multigrid->joint_levels ? multigrid->n : 1;
    for (uint32_t k = 0; k < multigrid->n; k += together)
        apply_to(multigrid, multigrid->hierarchies + k, together, &exchange, size);
}
