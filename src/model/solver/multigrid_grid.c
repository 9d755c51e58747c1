/* Multigrid levels of a grid: 2 x 2 cells become one; the springs between them are summed and
 * halved.
 *
 * Cells lie row by row, `pitch` apart, with two dead cells after each row and two dead rows and
 * more at both ends. A spring is stored at the cell where it begins, by its kind: a step of +1,
 * +2, pitch, pitch + 1, pitch - 1 or 2 pitch cells. Loops therefore run over all cells with
 * constant offsets and without tests for borders: springs that leave the grid end in dead cells
 * and have the factor 0.
 *
 * Every coarse level has four kinds of springs: right, down, and the two diagonals. A spring
 * over two fine cells joins neighbouring aggregates and becomes one of these. */
#include "model/solver/multigrid_hierarchy.h"

#include "base/pool.h"

#include <string.h>

/* Longest step of a spring along a row. As many dead cells separate two rows, for the end of
 * the one and the beginning of the next. */
enum { PADDING = 2 };

/* Coarse cells of one block of a loop, about; blocks are whole rows. */
enum { ROW_CELLS = 1024 };

/* Rounds up to whole multiples of CS_LANES cells. */
static uint32_t round_up(uint32_t n) {
    return (n + CS_LANES - 1) / CS_LANES * CS_LANES;
}

/* Lays out a level. The dead cells at either end cover the longest step, two rows and two
 * cells. */
static struct cs_level level_of(enum cs_level_form form, uint32_t columns, uint32_t rows) {
    struct cs_level level = {
        .form = form, .columns = columns, .rows = rows, .pitch = columns + PADDING};
    level.begin = round_up(2 * level.pitch + PADDING);
    level.end = level.begin + round_up(rows * level.pitch);
    level.n = level.end + level.begin;
    return level;
}

/* Index of the cell at a row and a column. */
static size_t cell(const struct cs_level *level, size_t row, size_t column) {
    return level->begin + row * level->pitch + column;
}

/* Index of a particle's cell on the first level. */
static size_t cell_of(const struct cs_hierarchy *hierarchy, uint32_t particle) {
    const uint32_t i = particle - hierarchy->first;
    return cell(hierarchy->levels, i / hierarchy->columns, i % hierarchy->columns);
}

/* Returns the number of a spring's step, and adds the step if it is new. The first level has at
 * most six: those of enum cs_spring_direction. */
static uint32_t step_number(struct cs_level *level, size_t step) {
    uint32_t s = 0;
    while (s < level->n_neighbour_offsets && level->neighbour_offsets[s] != step)
        s++;
    if (s == level->n_neighbour_offsets)
        level->neighbour_offsets[level->n_neighbour_offsets++] = (uint32_t)step;
    return s;
}

/* Step number of a run: all its springs lead equally far through the cells. */
static uint32_t run_step(struct cs_hierarchy *hierarchy, const struct cs_spring_run *run) {
    return step_number(hierarchy->levels,
                       cell_of(hierarchy, run->first_b) - cell_of(hierarchy, run->first_a));
}

/* Arguments of the loop that copies factors into the first level; one block is RUNS runs. */
struct loading {
    struct cs_hierarchy *hierarchy;
    const double *factors, *x;
    size_t n;
    double root;
};

/* Runs per block of that loop. Runs write to different springs, so their order does not matter.
 */
enum { RUNS = 64 };

/* Copies s and w of a run's springs to the rows of its step, cell by cell. */
CS_CLONES static void load_runs(void *arg, uint32_t block) {
    const struct loading *loading = arg;
    const struct cs_hierarchy *hierarchy = loading->hierarchy;
    const struct cs_level *level = hierarchy->levels;
    const size_t n = loading->n, m = level->n;
    const double root = loading->root;
    for (uint32_t r = RUNS * block; r < hierarchy->n_runs && r < RUNS * (block + 1); r++) {
        const struct cs_spring_run *run = hierarchy->runs + r;
        const double *s = loading->factors + run->factors, *w = s + run->factor_stride;
        const bool stored = run->factor_rows == 4;
        const double *a = loading->x + run->first_a, *b = loading->x + run->first_b;
        float *to = level->springs + 4 * (size_t)run_step(loading->hierarchy, run) * m +
                    cell_of(hierarchy, run->first_a);
        CS_INDEPENDENT
        for (size_t i = 0; i < run->count; i++) {
            double sw[4] = {s[i]};
            for (size_t c = 0; c < 3; c++)
                sw[1 + c] = stored ? w[c * run->factor_stride + i]
                                   : w[i] * (b[c * n + i] - a[c * n + i]);
            float spring[4];
            cs_hierarchy_spring(sw, root, true, spring);
            for (size_t c = 0; c < 4; c++)
                to[c * m + i] = spring[c];
        }
    }
}

/* Springs that no run has stay 0 since allocation. */
static void load(struct cs_hierarchy *hierarchy, const double *factors, const double *x,
                 size_t n, double scale) {
    struct loading loading = {hierarchy, factors, x, n, 1 / sqrt(scale)};
    cs_pool_run((hierarchy->n_runs + RUNS - 1) / RUNS, load_runs, &loading);
}

/* Arguments of a loop between two levels; one block is `rows` rows of the coarse level. */
struct transfer {
    const struct cs_level *fine, *coarse; /* one of them is written */
    uint32_t rows;
};

/* Runs a task over blocks of coarse rows. A block writes only to its own coarse rows, or to the
 * two fine rows of each. */
static void run_rows(const struct cs_level *fine, const struct cs_level *coarse,
                     void (*task)(void *transfer, uint32_t block)) {
    struct transfer transfer = {fine, coarse, ROW_CELLS / coarse->columns + 1};
    cs_pool_run((coarse->rows + transfer.rows - 1) / transfer.rows, task, &transfer);
}

/* End of a block's coarse rows. */
static uint32_t rows_end(const struct transfer *transfer, uint32_t block) {
    const uint32_t end = (block + 1) * transfer->rows;
    return end < transfer->coarse->rows ? end : transfer->coarse->rows;
}

/* Adds to a row of coarse springs those that begin in the cells (row, 2 j + right) of the fine
 * level and lead by step s. They are dropped if they stay inside an aggregate or have a dead
 * end.
 *
 * Let the step be `down` rows and `across` columns, -1 <= across <= 2. From column 2 j + right
 * the other end is in the aggregate `beside` columns and `below` rows away:
 *
 *   below  = floor((row + down) / 2) - floor(row / 2)
 *   beside = floor((right + across) / 2)
 *
 * A coarse spring begins at the lower-numbered of its two cells. Only a spring that leads to
 * the left within one coarse row (`turned`) has its lower cell at the other end; it is stored
 * there. */
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

/* Adds the diagonal of the fine cells (row, 2 j + right) to a row of coarse cells. A fine level
 * of form FACTORED has one mass per cell, which goes to xx, yy and zz. */
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

/* Coarsens blocks of rows. The order of the sums is fixed: rows, then left and right, then
 * steps. */
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

/* Adds spring (s, i), one end of which is dead, to the diagonal of the aggregate of its living
 * end `alive`. Does nothing if `alive` is dead too. */
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

/* Visits the springs of all dead cells, in both directions. Serial, because aggregates of two
 * blocks may meet at one dead cell, and because dead cells are few. */
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

/* P^T A P with halved springs. Springs to dead cells follow after the loop. */
static void coarsen(const struct cs_level *fine, struct cs_level *coarse) {
    memset(coarse->springs, 0, 6 * coarse->n_neighbour_offsets * sizeof(float) * coarse->n);
    memset(coarse->diagonal, 0, 6 * sizeof(float) * coarse->n);
    run_rows(fine, coarse, coarsen_rows);
    add_dirichlet_springs(fine, coarse);
}

/* Sums the residual of the four cells of an aggregate, in pairs by row. Dead cells count as 0:
 * their residual is not meaningful. */
CS_CLONES static void restrict_rows(void *arg, uint32_t block) {
    const struct transfer *transfer = arg;
    const struct cs_level *fine = transfer->fine, *coarse = transfer->coarse;
    for (uint32_t row = block * transfer->rows; row < rows_end(transfer, block); row++)
        for (size_t c = 0; c < 3; c++) {
            const size_t from = cell(fine, 2 * (size_t)row, 0), columns = coarse->columns;
            /* the row below the last one is padding */
            const float *r = fine->residual + c * fine->stride + from,
                        *own = fine->diagonal + from;
            const float *r2 = r + fine->pitch, *own2 = own + fine->pitch;
            float *restrict sum = coarse->residual + c * coarse->stride + cell(coarse, row, 0);
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

/* Gives the coarse solution to the living cells of each aggregate: as the correction, whose
 * product the next sweep subtracts, and added to the solution. */
CS_CLONES static void prolong_rows(void *arg, uint32_t block) {
    const struct transfer *transfer = arg;
    const struct cs_level *fine = transfer->fine, *coarse = transfer->coarse;
    const uint32_t end = 2 * rows_end(transfer, block);
    for (uint32_t row = 2 * block * transfer->rows; row < end && row < fine->rows; row++)
        for (size_t c = 0; c < 3; c++) {
            const size_t at = cell(fine, row, 0);
            const float *from =
                coarse->solution + c * coarse->stride + cell(coarse, row / 2, 0);
            const float *own = fine->diagonal + at;
            float *restrict d = fine->correction + c * fine->stride + at;
            float *restrict x = fine->solution + c * fine->stride + at;
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

/* Lays out the next level: half the cells per axis, rounded up, and up to four steps to forward
 * neighbours. */
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

/* Adds a level of half the cells per axis after the last one. */
static void extend(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                   struct cs_error *error) {
    struct cs_level *level = hierarchy->levels + hierarchy->n_levels;
    *level = next_of(level - 1);
    if (!cs_level_alloc(level, 6 * (size_t)level->n_neighbour_offsets * level->n, arena, error))
        hierarchy->n_levels++;
}

static const struct cs_hierarchy_kind grid = {load, coarsen, restrict_r, prolong_x, extend};

enum cs_status cs_hierarchy_of_grid(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                    struct cs_error *error) {
    struct cs_level *level = hierarchy->levels;
    hierarchy->kind = &grid;
    /* the first level's steps come from the springs that the body has */
    *level =
        level_of(hierarchy->has_particle_blocks ? CS_LEVEL_FACTORED_BLOCKS : CS_LEVEL_FACTORED,
                 hierarchy->columns, hierarchy->count / hierarchy->columns);
    for (uint32_t r = 0; r < hierarchy->n_runs; r++)
        run_step(hierarchy, hierarchy->runs + r);
    cs_level_alloc(level, 4 * (size_t)level->n_neighbour_offsets * level->n, arena, error);
    hierarchy->n_levels = 1;
    /* coarsen until one cell is left, or none has a spring */
    while (!error->status && level[hierarchy->n_levels - 1].n_neighbour_offsets)
        extend(hierarchy, arena, error);
    return error->status;
}
