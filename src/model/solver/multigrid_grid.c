/* Multigrid levels of a grid: 2 x 2 cells become one, springs between them are summed and
 * halved. */
#include "model/solver/multigrid_hierarchy.h"

#include "base/pool.h"
#include "model/solver/float_lanes.h"

#include <string.h>

/* the longest step to the side: rows are that far apart, and the dead cells between them serve
 * both */
enum { PADDING = 2 };

enum { ROW_CELLS = 1024 }; /* coarse cells of one block of a loop, about */

static uint32_t round_up(uint32_t n) {
    return (n + CS_LANES - 1) / CS_LANES * CS_LANES;
}

/* dead cells enough at both ends for the longest step, which is two rows */
static struct cs_level level_of(enum cs_level_form form, uint32_t columns, uint32_t rows) {
    struct cs_level level = {
        .form = form, .columns = columns, .rows = rows, .pitch = columns + PADDING};
    level.begin = round_up(2 * level.pitch + PADDING);
    level.end = level.begin + round_up(rows * level.pitch);
    level.n = level.end + level.begin;
    return level;
}

static size_t cell(const struct cs_level *level, size_t row, size_t column) {
    return level->begin + row * level->pitch + column;
}

static size_t cell_of(const struct cs_hierarchy *hierarchy, uint32_t particle) {
    const uint32_t i = particle - hierarchy->first;
    return cell(hierarchy->levels, i / hierarchy->columns, i % hierarchy->columns);
}

/* the number of a step, or of a new one */
static uint32_t step_number(struct cs_level *level, size_t step) {
    uint32_t s = 0;
    while (s < level->n_neighbour_offsets && level->neighbour_offsets[s] != step)
        s++;
    if (s == level->n_neighbour_offsets)
        level->neighbour_offsets[level->n_neighbour_offsets++] = (uint32_t)step;
    return s;
}

static uint32_t run_step(struct cs_hierarchy *hierarchy, const struct cs_spring_run *run) {
    return step_number(hierarchy->levels,
                       cell_of(hierarchy, run->first_b) - cell_of(hierarchy, run->first_a));
}

/* factors on their way into the first level; a block of the loop is some runs */
struct loading {
    struct cs_hierarchy *hierarchy;
    const double *factors;
    double root;
};

enum { RUNS = 64 };

static void load_runs(void *arg, uint32_t block) {
    const struct loading *loading = arg;
    struct cs_hierarchy *hierarchy = loading->hierarchy;
    struct cs_level *level = hierarchy->levels;
    for (uint32_t r = RUNS * block; r < hierarchy->n_runs && r < RUNS * (block + 1); r++) {
        const struct cs_spring_run *run = hierarchy->runs + r;
        const double *from = loading->factors + 4 * (size_t)run->first;
        float *to = level->springs + 4 * (size_t)run_step(hierarchy, run) * level->n +
                    cell_of(hierarchy, run->first_a);
        for (size_t i = 0; i < run->count; i++) {
            float spring[4];
            cs_hierarchy_spring(from + i, run->count, loading->root, spring);
            for (size_t c = 0; c < 4; c++)
                to[c * level->n + i] = spring[c];
        }
    }
}

static void load(struct cs_hierarchy *hierarchy, const double *factors, double scale) {
    struct loading loading = {hierarchy, factors, 1 / sqrt(scale)};
    cs_pool_run((hierarchy->n_runs + RUNS - 1) / RUNS, load_runs, &loading);
}

/* between two levels; a block of the loops is some rows of the coarse one */
struct transfer {
    const struct cs_level *fine, *coarse; /* one of them is written */
    uint32_t rows;
};

static void run_rows(const struct cs_level *fine, const struct cs_level *coarse,
                     void (*task)(void *transfer, uint32_t block)) {
    struct transfer transfer = {fine, coarse, ROW_CELLS / coarse->columns + 1};
    cs_pool_run((coarse->rows + transfer.rows - 1) / transfer.rows, task, &transfer);
}

static uint32_t rows_end(const struct transfer *transfer, uint32_t block) {
    const uint32_t end = (block + 1) * transfer->rows;
    return end < transfer->coarse->rows ? end : transfer->coarse->rows;
}

/* Adds to a row of coarse springs what begins in the cells (row, 2 j + right) of the fine level
 * and goes by step s, unless it stays inside an aggregate. A coarse spring begins at the lower
 * of its cells; only a diagonal to the left within two rows begins at the other one. */
CS_INLINE void add_springs(const struct cs_level *fine, const struct cs_level *coarse,
                           size_t row, size_t right, uint32_t s) {
    const size_t n = fine->n, m = coarse->n, step = fine->neighbour_offsets[s];
    const bool factored = cs_level_is_factored(fine);
    const size_t from = cell(fine, row, right);
    const size_t down = (step + PADDING) / fine->pitch;
    const ptrdiff_t across = (ptrdiff_t)step - (ptrdiff_t)(down * fine->pitch);
    const size_t below = (row + down) / 2 - row / 2;
    const ptrdiff_t beside = ((ptrdiff_t)right + across + 2) / 2 - 1;
    const bool turned = below == 0 && beside < 0;
    const size_t coarse_step = turned ? 1 : below * coarse->pitch + (size_t)beside;
    uint32_t t = 0;
    while (t < coarse->n_neighbour_offsets && coarse->neighbour_offsets[t] != coarse_step)
        t++;
    if (t == coarse->n_neighbour_offsets)
        return; // inside, or from or to where there are no cells
    float *restrict sum =
        coarse->springs + 6 * (size_t)t * m + cell(coarse, row / 2, 0) - turned;
    const float *spring = fine->springs + (factored ? 4 : 6) * (size_t)s * n + from;
    const float *here = fine->diagonal + from, *there = here + step;
    for (size_t j = 0; j < coarse->columns; j++) {
        const float share = here[2 * j] > 0 && there[2 * j] > 0 ? CS_HIERARCHY_SOFTNESS : 0;
        float numbers[6], block[6];
        for (size_t c = 0; c < (factored ? 4 : 6); c++)
            numbers[c] = spring[c * n + 2 * j];
        if (factored)
            cs_hierarchy_block(numbers, block);
        else
            memcpy(block, numbers, sizeof block);
        for (size_t c = 0; c < 6; c++)
            sum[c * m + j] += share * block[c];
    }
}

/* own of a row of coarse cells += that of the fine cells (row, 2 j + right) */
CS_INLINE void add_own(const struct cs_level *fine, const struct cs_level *coarse, size_t row,
                       size_t right) {
    const float *from = fine->diagonal + cell(fine, row, right);
    float *restrict sum = coarse->diagonal + cell(coarse, row / 2, 0);
    for (size_t c = 0; c < 6; c++) {
        if (fine->form == CS_LEVEL_FACTORED && c != 0 && c != 3 && c != 5)
            continue;
        const size_t at = fine->form == CS_LEVEL_FACTORED ? 0 : c * fine->n;
        for (size_t j = 0; j < coarse->columns; j++)
            sum[c * coarse->n + j] += from[at + 2 * j];
    }
}

CS_CLONES static void coarsen_rows(void *arg, uint32_t block) {
    const struct transfer *transfer = arg;
    const struct cs_level *fine = transfer->fine;
    const uint32_t end = 2 * rows_end(transfer, block);
    for (uint32_t row = 2 * block * transfer->rows; row < end && row < fine->rows; row++)
        for (uint32_t right = 0; right < 2; right++) {
            add_own(fine, transfer->coarse, row, right);
            for (uint32_t s = 0; s < fine->n_neighbour_offsets; s++)
                add_springs(fine, transfer->coarse, row, right, s);
        }
}

/* springs (s, i) to dead cells tie the living end's aggregate; i dead or the cell behind it */
static void add_dirichlet_spring(const struct cs_level *fine, struct cs_level *coarse,
                                 uint32_t s, size_t i, size_t alive) {
    const size_t n = fine->n, k = alive - fine->begin;
    const size_t rows = cs_level_is_factored(fine) ? 4 : 6;
    float numbers[6], block[6];
    if (!cs_level_is_alive(fine, alive))
        return;
    for (size_t c = 0; c < rows; c++)
        numbers[c] = fine->springs[(rows * s + c) * n + i];
    if (rows == 4)
        cs_hierarchy_block(numbers, block);
    else
        memcpy(block, numbers, sizeof block);
    float *own = coarse->diagonal + cell(coarse, k / fine->pitch / 2, k % fine->pitch / 2);
    for (size_t c = 0; c < 6; c++)
        own[c * coarse->n] += CS_HIERARCHY_SOFTNESS * block[c];
}

/* one after the other, as two aggregates may share a row: there are few dead cells */
static void add_dirichlet_springs(const struct cs_level *fine, struct cs_level *coarse) {
    for (size_t row = 0; row < fine->rows; row++)
        for (size_t i = cell(fine, row, 0); i < cell(fine, row, fine->columns); i++)
            for (uint32_t s = 0; s < fine->n_neighbour_offsets && !cs_level_is_alive(fine, i);
                 s++) {
                add_dirichlet_spring(fine, coarse, s, i, i + fine->neighbour_offsets[s]);
                add_dirichlet_spring(fine, coarse, s, i - fine->neighbour_offsets[s],
                                     i - fine->neighbour_offsets[s]);
            }
}

static void coarsen(const struct cs_level *fine, struct cs_level *coarse) {
    memset(coarse->springs, 0, 6 * coarse->n_neighbour_offsets * sizeof(float) * coarse->n);
    memset(coarse->diagonal, 0, 6 * sizeof(float) * coarse->n);
    run_rows(fine, coarse, coarsen_rows);
    add_dirichlet_springs(fine, coarse);
}

CS_CLONES static void restrict_rows(void *arg, uint32_t block) {
    const struct transfer *transfer = arg;
    const struct cs_level *fine = transfer->fine, *coarse = transfer->coarse;
    for (uint32_t row = block * transfer->rows; row < rows_end(transfer, block); row++)
        for (size_t c = 0; c < 3; c++) {
            const size_t from = cell(fine, 2 * (size_t)row, 0), columns = coarse->columns;
            /* the row below the last one is padding */
            const float *r = fine->residual + c * fine->n + from, *own = fine->diagonal + from;
            const float *r2 = r + fine->pitch, *own2 = own + fine->pitch;
            float *restrict sum = coarse->residual + c * coarse->n + cell(coarse, row, 0);
            for (size_t j = 0; j < columns; j++)
                sum[j] = ((own[2 * j] > 0 ? r[2 * j] : 0) +
                          (own[2 * j + 1] > 0 ? r[2 * j + 1] : 0)) +
                         ((own2[2 * j] > 0 ? r2[2 * j] : 0) +
                          (own2[2 * j + 1] > 0 ? r2[2 * j + 1] : 0));
        }
}

static void restrict_r(const struct cs_level *fine, struct cs_level *coarse) {
    run_rows(fine, coarse, restrict_rows);
}

CS_CLONES static void prolong_rows(void *arg, uint32_t block) {
    const struct transfer *transfer = arg;
    const struct cs_level *fine = transfer->fine, *coarse = transfer->coarse;
    const uint32_t end = 2 * rows_end(transfer, block);
    for (uint32_t row = 2 * block * transfer->rows; row < end && row < fine->rows; row++)
        for (size_t c = 0; c < 3; c++) {
            const size_t at = cell(fine, row, 0);
            const float *from = coarse->solution + c * coarse->n + cell(coarse, row / 2, 0);
            const float *own = fine->diagonal + at;
            float *restrict d = fine->correction + c * fine->n + at;
            float *restrict x = fine->solution + c * fine->n + at;
            // an odd row's last pair ends in padding, which is dead
            for (size_t j = 0; j < coarse->columns; j++) {
                const float left = own[2 * j] > 0 ? from[j] : 0;
                const float right = own[2 * j + 1] > 0 ? from[j] : 0;
                d[2 * j] = left;
                d[2 * j + 1] = right;
                x[2 * j] += left;
                x[2 * j + 1] += right;
            }
        }
}

static void prolong_x(const struct cs_level *coarse, struct cs_level *fine) {
    run_rows(fine, coarse, prolong_rows);
}

static const struct cs_hierarchy_kind grid = {load, coarsen, restrict_r, prolong_x};

/* the four forward neighbours among aggregates */
static struct cs_level next_of(const struct cs_level *fine) {
    struct cs_level level =
        level_of(CS_LEVEL_GRID_BLOCKS, (fine->columns + 1) / 2, (fine->rows + 1) / 2);
    if (level.columns > 1)
        level.neighbour_offsets[level.n_neighbour_offsets++] = 1;
    if (level.rows > 1)
        level.neighbour_offsets[level.n_neighbour_offsets++] = level.pitch;
    if (level.columns > 1 && level.rows > 1) {
        level.neighbour_offsets[level.n_neighbour_offsets++] = level.pitch + 1;
        level.neighbour_offsets[level.n_neighbour_offsets++] = level.pitch - 1;
    }
    return level;
}

enum cs_status cs_hierarchy_of_grid(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                    struct cs_error *error) {
    struct cs_level *level = hierarchy->levels;
    hierarchy->kind = &grid;
    *level =
        level_of(hierarchy->has_particle_blocks ? CS_LEVEL_FACTORED_BLOCKS : CS_LEVEL_FACTORED,
                 hierarchy->columns, hierarchy->count / hierarchy->columns);
    for (uint32_t r = 0; r < hierarchy->n_runs; r++)
        run_step(hierarchy, hierarchy->runs + r);
    cs_level_alloc(level, 4 * (size_t)level->n_neighbour_offsets * level->n, arena, error);
    for (; !error->status && level->n_neighbour_offsets; level++) {
        level[1] = next_of(level);
        cs_level_alloc(level + 1, 6 * (size_t)level[1].n_neighbour_offsets * level[1].n, arena,
                       error);
    }
    hierarchy->n_levels = (uint32_t)(level - hierarchy->levels) + 1;
    return error->status;
}
