/* Diagonal blocks: of the springs' derivatives, and of the factored form of springs_matrix.c.
 */
#include "model/spring/springs.h"

#include "model/spring/grid_stencil.h"
#include "model/spring/spring_law.h"

#include <string.h>

/* symmetric blocks of a piece of a mesh */
struct blocks {
    double rows[SYM][PIECE];
};

CS_INLINE void put_block(const double *block, size_t i, struct blocks *blocks) {
    for (size_t c = 0; c < SYM; c++)
        blocks->rows[c][i] = block[c];
}

/* Adds them to both ends, sums (6,n). */
CS_INLINE void add_blocks(const struct piece *piece, const struct blocks *blocks, size_t n,
                          double *sums) {
    double *a = sums + piece->run->first_a, *b = sums + piece->run->first_b;
    const uint32_t *ends = piece->run->ends + 2 * (size_t)piece->start;
    for (size_t i = 0; i < piece->count; i++)
        for (size_t c = 0; c < SYM; c++) {
            a[c * n + ends[2 * i]] += blocks->rows[c][i];
            b[c * n + ends[2 * i + 1]] += blocks->rows[c][i];
        }
}

/* of a piece of a mesh */
CS_INLINE void stiff_piece(const struct piece *piece, const struct ends e,
                           struct blocks *blocks) {
    const size_t count = piece->count;
    for (size_t i = 0; i < count; i++) {
        double block[SYM];
        stiff_block(turned_of(across(e, i, true), piece->lengths[i]), piece->stiffnesses[i],
                    block);
        put_block(block, i, blocks);
    }
}

CS_INLINE void damped_piece(const struct piece *piece, const struct ends e,
                            struct blocks *blocks) {
    const double d = -piece->run->damping;
    const bool axial = piece->run->axial;
    const size_t count = piece->count;
    for (size_t i = 0; i < count; i++) {
        double block[SYM];
        set_block(axial ? 0 : d, axial ? d : 0, turned_of(across(e, i, true), 0).u, block);
        put_block(block, i, blocks);
    }
}

CS_INLINE void run_diagonal(const struct cs_spring_run *run, size_t n, const double *x,
                            double *kxx, double *dvv) {
    struct gather_buffer places;
    struct blocks blocks;
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        const struct ends e = ends_of(&piece, x, n, false, &places);
        stiff_piece(&piece, e, &blocks);
        add_blocks(&piece, &blocks, n, kxx);
        if (run->damping == 0)
            continue;
        damped_piece(&piece, e, &blocks);
        add_blocks(&piece, &blocks, n, dvv);
    }
}

/* The rest of a number times the identity, which grids have in the first row of dvv. */
static void add_scalar_part(const struct cs_spring_run *first, size_t n, double *dvv) {
    const size_t particles = first->columns * ((size_t)first->rows_below + 1);
    for (size_t c = 3; c < SYM; c += 2)
        memcpy(dvv + c * n + first->row, dvv + first->row, particles * sizeof *dvv);
}

static bool begins_grid(const struct cs_springs *springs, uint32_t r) {
    const struct cs_spring_run *run = springs->runs + r;
    return run->columns && (r == 0 || run[-1].body != run->body);
}

CS_CLONES void cs_springs_finish_diagonal(const struct cs_springs *springs, uint32_t n,
                                          const struct cs_eval *at) {
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        if (!run->columns)
            run_diagonal(run, n, at->x, at->dfdx_blocks, at->dfdv_blocks);
        else if (begins_grid(springs, r) && run->damping != 0 && !run->axial)
            add_scalar_part(run, n, at->dfdv_blocks);
    }
}

CS_INLINE void diagonal_block(const struct stencil_input *in,
                              const struct stencil_direction *way, size_t i, double *out) {
    const double *s = way->factors;
    const size_t count = way->count;
    (void)in;
    set_block(s[i], 1, (struct difference){s[count + i], s[2 * count + i], s[3 * count + i]},
              out);
}

CS_STENCIL_KERNEL(own_blocks, diagonal_block, 0, SYM, 0);

CS_CLONES void cs_springs_factor_diagonal(const struct cs_springs *springs, uint32_t n,
                                          const double *factors, double *sums) {
    const struct spring_job job = {
        .springs = springs, .n = n, .at = {.dfdx_blocks = sums}, .factors = factors};
    const struct cs_block all = {0, n, 0, springs->n_runs};
    struct blocks blocks;
    uint32_t n_runs = 1;
    for (uint32_t r = 0; r < springs->n_runs; r += n_runs) {
        const struct cs_spring_run *run = springs->runs + r;
        n_runs = 1;
        if (run->columns) {
            n_runs = add_row_stencil(&job, &all, run, has_anything, &own_blocks);
            continue;
        }
        const double *s = factors + 4 * (size_t)run->first, *w = s + run->count;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const struct piece piece = piece_of(run, start);
            for (size_t i = 0, k = start; i < piece.count; i++, k++) {
                const size_t count = run->count;
                double block[SYM];
                set_block(s[k], 1, (struct difference){w[k], w[count + k], w[2 * count + k]},
                          block);
                put_block(block, i, &blocks);
            }
            add_blocks(&piece, &blocks, n, sums);
        }
    }
}
