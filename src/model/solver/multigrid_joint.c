/* Levels of bodies in contact with each other: equally many, with joint vectors.
 *
 * The last level has a few cells per body, joined by extra springs alone. Its matrix is dense
 * and small, and Cholesky's factors solve it exactly.
 *
 * A smoother does not suffice there. Two bodies that press on each other move together against
 * their mass alone, which is far below the stiffness of the contact on the diagonal. */
#include "model/solver/contact_coupling.h"
#include "model/solver/extra_springs.h"

#include <math.h>
#include <string.h>

enum { ROWS = 3 * CS_COARSEST_CELLS, LANES = CS_EXTRA_SPRINGS_LANES };

/* Adds levels after the last ones. */
void cs_hierarchies_make_equally_deep(struct cs_hierarchy *hierarchies, uint32_t n,
                                      struct cs_arena *arena, struct cs_error *error) {
    uint32_t most = 0;
    for (uint32_t b = 0; b < n; b++)
        most = hierarchies[b].n_levels > most ? hierarchies[b].n_levels : most;
    for (uint32_t b = 0; b < n; b++)
        while (hierarchies[b].n_levels < most && !error->status)
            hierarchies[b].kind->extend(hierarchies + b, arena, error);
}

/* Zeroed by the arena; dead cells stay 0 ever after. */
enum cs_status cs_level_alloc_vectors(const struct cs_level_group *group,
                                      struct cs_arena *arena, struct cs_error *error) {
    float *vectors[4] = {0};
    uint32_t stride = 0;
    for (uint32_t b = 0; b < group->n; b++) {
        group->levels[b]->first = stride;
        stride += group->levels[b]->n;
    }
    // one array for all: a body then reads those of the others by joint numbers
    for (int k = 0; k < 4; k++)
        vectors[k] = cs_arena_alloc_array(arena, 3 * (size_t)stride, sizeof(float), error);
    for (uint32_t b = 0; b < group->n && !error->status; b++) {
        struct cs_level *level = group->levels[b];
        level->stride = stride;
        level->residual = vectors[0] + level->first;
        level->solution = vectors[1] + level->first;
        level->correction = vectors[2] + level->first;
        level->correction_next = vectors[3] + level->first;
    }
    return error->status;
}

enum cs_status cs_coarsest_init(struct cs_coarsest *coarsest, struct cs_arena *arena,
                                struct cs_error *error) {
    *coarsest = (struct cs_coarsest){0};
    CS_ARENA_ARRAY(arena, coarsest->cells, CS_COARSEST_CELLS, error);
    CS_ARENA_ARRAY(arena, coarsest->factors, (size_t)ROWS * ROWS, error);
    return error->status;
}

/* Lists the living cells of all bodies by their joint numbers, which ascend. Returns false if
 * there are too many. */
static bool list_cells(struct cs_coarsest *coarsest, const struct cs_level_group *last) {
    coarsest->n = 0;
    for (uint32_t b = 0; b < last->n; b++) {
        const struct cs_level *level = last->levels[b];
        for (uint32_t i = level->begin; i < level->end; i++) {
            if (!cs_level_is_alive(level, i))
                continue;
            // the rest is smoothed instead
            if (coarsest->n == CS_COARSEST_CELLS)
                return false;
            coarsest->cells[coarsest->n++] = level->first + i;
        }
    }
    return true;
}

/* factors += a symmetric block at the rows of cell i and the columns of cell j, 0 <= j <= i. */
static void add_block(struct cs_coarsest *coarsest, uint32_t i, uint32_t j,
                      const double block[6]) {
    static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (size_t r = 0; r < 3; r++)
        for (size_t c = 0; c < 3; c++)
            coarsest->factors[(3 * (size_t)i + r) * ROWS + 3 * (size_t)j + c] +=
                block[at[r][c]];
}

/* Adds the extra springs of cell i: each to the diagonal of its own end, and beside it in the
 * lower triangle. Both ends have the same spring up to rounding. */
static void add_springs(struct cs_coarsest *coarsest, const struct cs_level *level,
                        uint32_t i) {
    const uint32_t cell = coarsest->cells[i] - level->first, lane = cell % LANES;
    const struct cs_extra_springs_slots slots =
        cs_extra_springs_of(level->extra_springs, cell / LANES);
    for (uint32_t k = 0; k < slots.n; k++) {
        const uint32_t to = slots.cells[k * LANES + lane];
        uint32_t j = 0;
        double block[6];
        // few cells: no map is worth its memory
        while (j < coarsest->n && coarsest->cells[j] != to)
            j++;
        for (uint32_t c = 0; c < 6; c++)
            block[c] = (double)slots.springs[(6 * k + c) * LANES + lane];
        if (j == coarsest->n || j == i)
            continue;
        add_block(coarsest, i, i, block);
        for (int c = 0; c < 6; c++)
            block[c] = -block[c];
        if (j < i)
            add_block(coarsest, i, j, block);
    }
}

/* Sets the matrix of the living cells. The diagonal gets 2^-20 of itself on top, as the
 * smoother's D does, against rounding. */
static void set_matrix(struct cs_coarsest *coarsest, const struct cs_level_group *last) {
    uint32_t i = 0;
    memset(coarsest->factors, 0, 3 * (size_t)coarsest->n * ROWS * sizeof *coarsest->factors);
    for (uint32_t b = 0; b < last->n; b++) {
        const struct cs_level *level = last->levels[b];
        for (; i < coarsest->n && coarsest->cells[i] < level->first + level->n; i++) {
            const size_t cell = coarsest->cells[i] - level->first;
            // a first level may be the last one too, and have one mass per cell
            const bool numbers = level->form == CS_LEVEL_FACTORED;
            double block[6] = {0};
            for (size_t c = 0; c < 6; c++)
                if (!numbers || c == 0 || c == 3 || c == 5)
                    block[c] = (double)level->diagonal[(numbers ? 0 : c * level->n) + cell];
            add_block(coarsest, i, i, block);
            if (level->extra_springs && level->extra_springs->is_nonempty)
                add_springs(coarsest, level, i);
        }
    }
    for (size_t r = 0; r < 3 * (size_t)coarsest->n; r++)
        coarsest->factors[r * ROWS + r] *= 1 + 1.0 / (1 << 20);
}

/* Replaces the lower triangle by L of L L^T, with inverses on its diagonal. Returns false if a
 * pivot is not above 1e-9 of its entry of the diagonal. */
static bool factor(double *a, size_t n) {
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = a[i * ROWS + j];
            for (size_t k = 0; k < j; k++)
                sum -= a[i * ROWS + k] * a[j * ROWS + k];
            if (j < i)
                a[i * ROWS + j] = sum * a[j * ROWS + j];
            else if (sum > 1e-9 * a[i * ROWS + i])
                a[i * ROWS + i] = 1 / sqrt(sum);
            else
                return false;
        }
    return true;
}

void cs_coarsest_factor(struct cs_coarsest *coarsest, const struct cs_level_group *last) {
    const bool fits = list_cells(coarsest, last);
    if (fits)
        set_matrix(coarsest, last);
    if (!fits || !factor(coarsest->factors, 3 * (size_t)coarsest->n))
        coarsest->n = 0;
}

/* x = (L L^T)^-1 x. */
static void substitute(const double *a, size_t n, double *x) {
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < i; k++)
            x[i] -= a[i * ROWS + k] * x[k];
        x[i] *= a[i * ROWS + i];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++)
            x[i] -= a[k * ROWS + i] * x[k];
        x[i] *= a[i * ROWS + i];
    }
}

/* Two smoothings without a correction between them: a symmetric and positive map (multigrid.h,
 * with C = 0). */
static void smooth_twice(const struct cs_level_group *last) {
    cs_level_smooth_down(last);
    for (uint32_t b = 0; b < last->n; b++)
        for (size_t c = 0; c < 3; c++)
            memset(last->levels[b]->correction + c * last->levels[b]->stride, 0,
                   last->levels[b]->n * sizeof(float));
    cs_level_smooth_up(last);
}

void cs_coarsest_solve(const struct cs_coarsest *coarsest, const struct cs_level_group *last) {
    const struct cs_level *first = last->levels[0];
    double x[ROWS];
    if (!coarsest->n) {
        smooth_twice(last);
        return;
    }
    for (size_t i = 0; i < 3 * (size_t)coarsest->n; i++)
        x[i] = (double)first->residual[i % 3 * first->stride + coarsest->cells[i / 3]];
    substitute(coarsest->factors, 3 * (size_t)coarsest->n, x);
    for (size_t i = 0; i < 3 * (size_t)coarsest->n; i++)
        first->solution[i % 3 * first->stride + coarsest->cells[i / 3]] = (float)x[i];
}
