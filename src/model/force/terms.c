/* The list of forces, and sums over those that a scene has: block by block, in one order. */
#include "model/force/terms.h"

#include "base/pool.h"
#include "base/vector.h"
#include "scene/scene.h"

#include <string.h>

#define X(name) &cs_term_##name,
const struct cs_term *const cs_terms[] = {CS_TERM_LIST(X)};
#undef X
const uint32_t cs_n_terms = sizeof cs_terms / sizeof *cs_terms;
_Static_assert(sizeof cs_terms / sizeof *cs_terms <= CS_TERMS_MAX, "a plan has a row for each");

void cs_term_assert(const struct cs_term *term) {
    const bool linearised = term->part_bits & CS_PART_LINEARISED;
    CS_ASSERT(term->name && term->plan && term->add_force && term->part_bits);
    CS_ASSERT(!!term->energy == !!(term->part_bits & CS_PART_WITH_ENERGY));
    CS_ASSERT(!!term->add_scalar + !!term->add_blocks + !!term->add_diagonal == linearised);
    CS_ASSERT(!linearised || (term->add_jvp && (term->add_bound || term->add_state_bound)));
    CS_ASSERT(!term->add_blocks == !term->add_approach);
    CS_ASSERT(!term->prepare_matrix == !term->add_matrix_product);
    CS_ASSERT(!term->friction_chunks == !term->store_friction);
    CS_ASSERT(!(term->part_bits & ~(CS_PART_LINEARISED | CS_PART_WITH_ENERGY)) ||
              term->max_acceleration);
}

/* Arguments of the loops over blocks. */
struct job {
    const struct cs_system *system;
    struct cs_eval at;
    double *out;
    bool without_blocks; /* leaves out forces with blocks in the matrix */
};

/* Zeroes the particles of a block. */
static void clear(const struct cs_system *system, const struct cs_block *block, double *f) {
    for (size_t c = 0; c < 3; c++)
        memset(f + c * system->view.n + block->begin, 0,
               sizeof *f * (block->end - block->begin));
}

/* Index in the list of pinned particles of the first one from `begin` on: binary search. */
static uint32_t find_pinned(const struct cs_system *system, uint32_t begin) {
    uint32_t low = 0;
    for (uint32_t high = system->n_pinned; low < high;) {
        const uint32_t middle = low + (high - low) / 2;
        if (system->pinned[middle] < begin)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Zeroes the pinned particles of a block: they bear any force without moving. If they do move,
 * what moves them gives -f.v. */
static void clear_pinned(const struct cs_system *system, const struct cs_block *block,
                         const struct cs_eval *at, double *f) {
    const uint32_t first = find_pinned(system, block->begin),
                   end = find_pinned(system, block->end);
    for (size_t c = 0; c < 3; c++)
        for (uint32_t p = first; p < end; p++) {
            const size_t k = c * system->view.n + system->pinned[p];
            if (at && at->power)
                at->power[system->pinned[p]] -= f[k] * at->v[k];
            f[k] = 0;
        }
}

/* Tells whether a term is among the chosen parts. */
static bool is_asked(const struct cs_term *term, const struct job *job) {
    return term->part_bits & job->at.parts && !(job->without_blocks && term->add_blocks);
}

/* Prepares the chosen terms, one after the other; each uses all threads. */
static void prepare(const struct job *job) {
    const struct cs_system *system = job->system;
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->prepare && is_asked(system->terms[k], job))
            system->terms[k]->prepare(system, &job->at);
}

/* Adds the terms from number `first` on at a block, in the order of the list. */
static void add_terms(const struct job *job, const struct cs_block *block, uint32_t first) {
    const struct cs_system *system = job->system;
    struct cs_eval at = job->at;
    at.block = block;
    for (uint32_t k = first; k < system->n_terms; k++) {
        const struct cs_term *term = system->terms[k];
        const bool asked = is_asked(term, job);
        // without a direction it is the force
        if (asked && !at.dx && !at.dv)
            term->add_force(system, &at, job->out);
        else if (asked && term->add_jvp)
            term->add_jvp(system, &at, job->out);
    }
    clear_pinned(system, block, &at, job->out);
}

/* Sums forces at one block, or their derivative along dx and dv, term by term in the order of
 * the list. A block is written by one thread. */
static void sum_block(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_system *system = job->system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    double *power = job->at.power;
    clear(system, &block, job->out);
    if (power)
        memset(power + block.begin, 0, sizeof *power * (block.end - block.begin));
    add_terms(job, &block, 0);
}

/* A sum row by row with a loop over particles after it. */
struct rows_job {
    struct job job;
    const struct cs_loop *loop;
    uint32_t reach; /* particles in two of the longest rows: no spring reaches further */
};

/* Tells if forces can be summed row by row: springs come first in the list and are those of
 * grids, and each other force reads its own particle alone. */
static bool goes_by_rows(struct rows_job *rows) {
    const struct cs_system *system = rows->job.system;
    bool goes =
        system->springs.n_runs && !rows->job.at.power && system->terms[0] == &cs_term_springs;
    for (uint32_t k = 1; k < system->n_terms; k++)
        goes &= system->terms[k]->is_local;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        goes &= !body->mesh;
        rows->reach = body->columns > rows->reach / 2 ? 2 * body->columns : rows->reach;
    }
    return goes;
}

/* Particles of a block whose places no other block reads. */
static struct cs_block inner_of(const struct rows_job *rows, const struct cs_block *block) {
    const uint32_t from = block->begin > 0 ? rows->reach : 0;
    const uint32_t to = block->end < rows->job.system->view.n ? rows->reach : 0;
    if (block->end - block->begin <= from + to)
        return (struct cs_block){.begin = block->end, .end = block->end};
    return (struct cs_block){.begin = block->begin + from, .end = block->end - to};
}

static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static uint32_t larger(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

static void run_part(const struct rows_job *rows, uint32_t begin, uint32_t end) {
    if (begin < end)
        rows->loop->part(rows->loop->arg, begin, end);
}

/* Springs reach two rows down: a row is complete, and read for the last time, with those that
 * begin in it. Zeroes run ahead of the springs, and the other forces follow them. */
static void sum_rows(void *arg, uint32_t number) {
    const struct rows_job *rows = arg;
    const struct cs_system *system = rows->job.system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    const struct cs_block inner = inner_of(rows, &block);
    struct cs_block ahead = {.end = block.begin}, done = ahead, next = block;
    struct cs_eval at = rows->job.at;
    at.block = &next;
    for (; done.end < block.end; next.first_run = next.end_run) {
        const struct cs_block some =
            cs_springs_rows(&system->springs, system->view.n, next.first_run, block.end_run);
        next.end_run = some.end_run;
        done.begin = done.end;
        done.end = larger(done.end, smaller(some.begin, block.end));
        ahead.begin = ahead.end;
        ahead.end = larger(larger(ahead.end, done.end), smaller(some.end, block.end));
        clear(system, &ahead, rows->job.out);
        cs_springs_add_force(&system->springs, system->view.n, &at, rows->job.out);
        add_terms(&rows->job, &done, 1);
        run_part(rows, larger(done.begin, inner.begin), smaller(done.end, inner.end));
    }
}

/* Runs the loop over the first and last rows of a block, which other blocks have read. */
static void finish_rows(void *arg, uint32_t number) {
    const struct rows_job *rows = arg;
    const struct cs_system *system = rows->job.system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    const struct cs_block inner = inner_of(rows, &block);
    run_part(rows, block.begin, inner.begin);
    run_part(rows, inner.end, block.end);
}

void cs_terms_force_then(const struct cs_system *system, const struct cs_eval *at, double *f,
                         const struct cs_loop *loop) {
    struct rows_job rows = {{.system = system, .at = *at, .out = f}, loop, 0};
    if (!loop || !goes_by_rows(&rows)) {
        cs_terms_force(system, at, f);
        if (loop)
            cs_vector_parallel_for(system->view.n, loop->part, loop->arg);
        return;
    }
    cs_pool_run(system->springs.n_blocks, sum_rows, &rows);
    if (system->springs.n_blocks > 1)
        cs_pool_run(system->springs.n_blocks, finish_rows, &rows);
}

void cs_terms_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    struct job job = {.system = system, .at = *at, .out = f};
    job.at.dx = job.at.dv = NULL;
    prepare(&job);
    cs_pool_run(system->springs.n_blocks, sum_block, &job);
}

void cs_terms_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    struct job job = {.system = system, .at = *at, .out = df};
    prepare(&job);
    cs_pool_run(system->springs.n_blocks, sum_block, &job);
}

void cs_terms_scalar_damping(const struct cs_system *system, double t, const double *x,
                             const double *v, double *df) {
    struct job job = {
        .system = system,
        .at = {.t = t, .x = x, .v = v, .parts = CS_PART_LINEARISED, .dv = v},
        .out = df,
        .without_blocks = true,
    };
    prepare(&job);
    cs_pool_run(system->springs.n_blocks, sum_block, &job);
}

/* Adds a term's diagonal part of the matrix to blocks (6,n); a number goes to xx, yy and zz. */
static void add_share(const struct cs_system *system, const struct cs_matrix *matrix,
                      const struct cs_term *term, double *blocks) {
    if (term->add_blocks)
        term->add_blocks(system, matrix, 0, system->view.n, blocks);
    for (size_t c = 0; c < 6 && term->add_scalar; c += c ? 2 : 3)
        term->add_scalar(system, matrix, 0, system->view.n, blocks + c * system->view.n);
}

void cs_terms_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                             bool kept) {
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->prepare_matrix)
            system->terms[k]->prepare_matrix(system, matrix, kept);
}

void cs_terms_add_product(const struct cs_system *system, const double *p, double *y) {
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->add_matrix_product)
            system->terms[k]->add_matrix_product(system, p, y);
}

void cs_terms_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                       double *y) {
    const struct cs_block all = {.begin = 0, .end = system->view.n};
    clear(system, &all, y);
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->add_approach)
            system->terms[k]->add_approach(system, matrix, y);
    clear_pinned(system, &all, NULL, y);
}

/* Adds the diagonal parts of all terms but the springs. */
static void add_shares(const struct cs_system *system, const struct cs_matrix *matrix,
                       double *blocks) {
    cs_terms_prepare_matrix(system, matrix, false);
    for (uint32_t k = 0; k < system->n_terms; k++)
        add_share(system, matrix, system->terms[k], blocks);
}

/* Adds the diagonal blocks of grids' springs at one block, without a force. */
static void diagonal_block(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_system *system = job->system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    struct cs_eval at = job->at;
    at.block = &block;
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->add_diagonal)
            system->terms[k]->add_force(system, &at, NULL);
}

/* Zeroes both arrays of blocks. */
static void clear_diagonal(const struct cs_system *system, const struct cs_eval *at) {
    const size_t bytes = 6 * sizeof *at->dfdx_blocks * system->view.n;
    memset(at->dfdx_blocks, 0, bytes);
    memset(at->dfdv_blocks, 0, bytes);
}

/* Adds the blocks that the pass over grids' springs did not: those of meshes and of the other
 * forces. A matrix with ck = 1 alone is df/dx, and one with cd = 1 alone is df/dv. */
static void finish_diagonal(const struct cs_system *system, const struct cs_eval *at) {
    const struct cs_matrix k = {.t = at->t, .x = at->x, .v = at->v, .ck = 1};
    const struct cs_matrix d = {.t = at->t, .x = at->x, .v = at->v, .cd = 1};
    for (uint32_t term = 0; term < system->n_terms; term++)
        if (system->terms[term]->add_diagonal)
            system->terms[term]->add_diagonal(system, at);
    add_shares(system, &k, at->dfdx_blocks);
    add_shares(system, &d, at->dfdv_blocks);
}

void cs_terms_diagonal(const struct cs_system *system, const struct cs_eval *at, double *kxx,
                       double *dvv) {
    struct job job = {.system = system, .at = *at};
    job.at.dfdx_blocks = kxx;
    job.at.dfdv_blocks = dvv;
    clear_diagonal(system, &job.at);
    cs_pool_run(system->springs.n_blocks, diagonal_block, &job);
    finish_diagonal(system, &job.at);
}

void cs_terms_force_diagonal(const struct cs_system *system, const struct cs_eval *at,
                             double *f, double *blocks) {
    struct cs_eval both = *at;
    both.dfdx_blocks = blocks;
    both.dfdv_blocks = blocks + 6 * (size_t)system->view.n;
    clear_diagonal(system, &both);
    cs_terms_force(system, &both, f);
    finish_diagonal(system, &both);
}

void cs_terms_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                     uint32_t parts, double *blocks) {
    memset(blocks, 0, 6 * sizeof *blocks * system->view.n);
    cs_terms_prepare_matrix(system, matrix, false);
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->part_bits & parts)
            add_share(system, matrix, system->terms[k], blocks);
}

void cs_terms_add_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                         size_t begin, size_t end, double *diagonal, double *blocks) {
    for (uint32_t k = 0; k < system->n_terms; k++) {
        const struct cs_term *term = system->terms[k];
        if (term->add_scalar)
            term->add_scalar(system, matrix, begin, end, diagonal);
        if (term->add_blocks)
            term->add_blocks(system, matrix, begin, end, blocks);
    }
}

bool cs_terms_have_blocks(const struct cs_system *system) {
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->add_blocks)
            return true;
    return false;
}

/* Arrays that a term reads in a scene. */
static uint32_t use_of(const struct cs_term *term, const struct cs_scene *scene) {
    return term->uses ? term->uses(scene) : 0;
}

bool cs_terms_need_normals(const struct cs_system *system, uint32_t parts) {
    for (uint32_t k = 0; system->normals && k < system->n_terms; k++)
        if (system->terms[k]->part_bits & parts &&
            use_of(system->terms[k], system->scene) & CS_USE_NORMALS)
            return true;
    return false;
}

uint32_t cs_terms_use(const struct cs_scene *scene, const struct cs_plan *plan) {
    uint32_t uses = 0;
    for (uint32_t k = 0; k < cs_n_terms; k++)
        uses |= plan->forces[k].built ? use_of(cs_terms[k], scene) : 0;
    return uses;
}
