/* The springs' Jacobian in factored form, A p = sum of (s I + w w^T)(p_a - p_b): the matrix of
 * the linear solver, never assembled.
 *
 * With d = x_b - x_a, length l, u = d / l and f_a = k (1 - L/l) d, the derivative of a spring
 * is
 *
 *   df_a/dx_b = -df_a/dx_a = k ((1 - L/l)(I - u u^T) + u u^T) = k (1 - L/l) I + k (L/l) u u^T
 *
 * In A it is multiplied by -ck >= 0, and a damper adds -cd c I (relative) or -cd c u u^T
 * (axial):
 *
 *   s     = -ck k (1 - L/l) + [-cd c]
 *   |w|^2 = -ck k (L/l)     + [-cd c],   w = |w| u
 *
 * Across a compressed spring (L > l) the eigenvalue s is negative: the spring may buckle. Then
 * A may be indefinite, and conjugate gradients fail. With psd the transverse part is dropped by
 * L/l <- min(L/l, 1) (Choi, Ko 2002; Teran et al. 2005). That gives s = 0 and |w|^2 = -ck k;
 * the axial eigenvalue -ck k is exact in either case.
 *
 * Four numbers per spring instead of six for a block, and two of a large grid: there the
 * product is bound by memory, and its factors are most of what it reads. */
#include "base/pool.h"
#include "model/spring/grid_stencil.h"
#include "model/spring/run_pieces.h"
#include "model/spring/springs.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Diagonal 3x3 blocks: of the springs' derivatives, and of the matrix in factored form.
 *
 * A spring's part of the derivative is ((-B, B), (B, -B)): it adds the same block at both of
 * its ends,
 *
 *   df/dx     -k ((1 - L/l) I + (L/l) u u^T)
 *   df/dv     -c I (relative) or -c u u^T (axial)
 *   matrix    s I + w w^T      (springs_matrix.c)
 *
 * Grids' springs get their blocks in the pass of the force (springs.c); the rest is added here.
 */

/* Symmetric blocks of a piece of a mesh, component by component. */
struct blocks {
    double rows[SYM][PIECE];
};

/* Stores the block of spring i. */
CS_INLINE void put_block(const double *block, size_t i, struct blocks *blocks) {
    for (size_t c = 0; c < SYM; c++)
        blocks->rows[c][i] = block[c];
}

/* Adds the blocks to both ends, sums (6,n), in the order of the springs. */
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

/* Blocks of df/dx of a piece of a mesh. */
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

/* Blocks of df/dv of a piece of a mesh. */
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

/* Adds the blocks of a mesh's run: kxx always, dvv if it has dampers. */
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

/* Relative dampers have a multiple of the identity. Grids summed it in the row xx of dvv alone;
 * this copies it to yy and zz. Mixed components are 0. */
static void add_scalar_part(const struct cs_spring_run *first, size_t n, double *dvv) {
    const size_t particles = first->columns * ((size_t)first->rows_below + 1);
    for (size_t c = 3; c < SYM; c += 2)
        memcpy(dvv + c * n + first->row, dvv + first->row, particles * sizeof *dvv);
}

/* Tells whether run r is the first of a grid. */
static bool begins_grid(const struct cs_springs *springs, uint32_t r) {
    const struct cs_spring_run *run = springs->runs + r;
    return run->columns && (r == 0 || run[-1].body != run->body);
}

/* Serial: a mesh's springs add to both ends in their order. */
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

/* w of spring i of a direction of a grid, found from x or stored. */
CS_INLINE struct difference axis_of(const struct stencil_input *in,
                                    const struct stencil_direction *way, size_t i,
                                    const bool stored) {
    const double *w = way->factors + way->stride + i;
    if (stored)
        return (struct difference){w[0], w[way->stride], w[2 * way->stride]};
    const struct difference d = fan_across(in->x, in->n, i, way->offset);
    return (struct difference){w[0] * d.x, w[0] * d.y, w[0] * d.z};
}

/* Defines a kernel of one of the two functions below. */
#define KERNEL(name, spring, stored, forces, stiff)                                            \
    CS_STENCIL_VARIANT(CS_STENCIL_KERNEL, name, spring(in, way, i, stored, out), forces,       \
                       stiff, 0)

/* The block of one spring of a grid in the matrix. */
CS_INLINE void block_of(const struct stencil_input *in, const struct stencil_direction *way,
                        size_t i, const bool stored, double *out) {
    set_block(way->factors[i], 1, axis_of(in, way, i, stored), out);
}

KERNEL(found_blocks, block_of, false, 0, SYM);
KERNEL(stored_blocks, block_of, true, 0, SYM);

/* Row by row for grids, spring by spring for meshes; serial, so the order of the sums is fixed.
 */
CS_CLONES void cs_springs_factor_diagonal(const struct cs_springs *springs, uint32_t n,
                                          const double *factors, const double *x,
                                          double *sums) {
    const struct spring_job job = {
        .springs = springs, .n = n, .at = {.x = x, .dfdx_blocks = sums}, .factors = factors};
    const struct cs_block all = {0, n, 0, springs->n_runs};
    struct blocks blocks;
    uint32_t n_runs = 1;
    for (uint32_t r = 0; r < springs->n_runs; r += n_runs) {
        const struct cs_spring_run *run = springs->runs + r;
        n_runs = 1;
        if (run->columns) {
            n_runs = add_row_stencil(&job, &all, run, has_anything,
                                     run->factor_rows == 4 ? &stored_blocks : &found_blocks);
            continue;
        }
        const double *s = factors + run->factors, *w = s + run->count;
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

/* Computes the factors of one piece, in place in the run's rows. There is no branch in the
 * loop, so it vectorises. */
CS_INLINE void factor_of(const struct piece *piece, struct ends e,
                         const struct cs_matrix *matrix, const bool listed, const bool stored,
                         double *base) {
    const struct cs_spring_run *run = piece->run;
    const double cd = matrix->cd, ck = matrix->ck;
    /* upper bound of L / l in the matrix */
    const double most = matrix->psd ? 1 : HUGE_VAL;
    const double gamma = run->axial ? 0 : -cd * run->damping;
    const double eta = run->axial ? -cd * run->damping : 0;
    double *restrict s = base + piece->start;
    const size_t stride = run->factor_stride;
    const double L = run->length, k = run->stiffness;
    const size_t count = piece->count;
    CS_INDEPENDENT
    for (size_t i = 0; i < count; i++) {
        const double length = listed ? piece->lengths[i] : L;
        const double stiffness = -ck * (listed ? piece->stiffnesses[i] : k);
        const struct difference d = across(e, i, listed);
        const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
        const double ratio = length * inverse;
        /* for a compressed spring k L / l would exceed the axial stiffness k */
        const double clamped = ratio < most ? ratio : most;
        s[i] = gamma + stiffness * (1 - clamped);
        const double w = sqrt(stiffness * clamped + eta) * inverse;
        s[stride + i] = stored ? w * d.x : w;
        if (stored) {
            s[2 * stride + i] = w * d.y;
            s[3 * stride + i] = w * d.z;
        }
    }
}

/* Arguments of the loops that compute factors. */
struct factoring {
    const struct cs_springs *springs;
    size_t n;
    const struct cs_matrix *matrix;
    double *factors;
};

/* Computes the factors of springs [begin, end) of a run; begin is a multiple of PIECE. */
CS_INLINE void factor_springs(const struct factoring *made, const struct cs_spring_run *run,
                              uint32_t begin, uint32_t end) {
    struct gather_buffer places;
    double *base = made->factors + run->factors;
    for (uint32_t start = begin; start < end; start += PIECE) {
        struct piece piece = piece_of(run, start);
        piece.count = end - start < PIECE ? end - start : PIECE;
        const struct ends e = ends_of(&piece, made->matrix->x, made->n, false, &places);
        if (run->ends)
            factor_of(&piece, e, made->matrix, true, true, base);
        else
            factor_of(&piece, e, made->matrix, false, run->factor_rows == 4, base);
    }
}

/* Factors of RUNS runs. Runs that are cut into chunks are left to factor_chunk. */
CS_CLONES static void factor_runs(void *arg, uint32_t block) {
    const struct factoring *made = arg;
    const struct cs_springs *springs = made->springs;
    for (uint32_t r = RUNS * block; r < springs->n_runs && r < RUNS * (block + 1); r++)
        if (!springs->slots || !springs->runs[r].ends)
            factor_springs(made, springs->runs + r, 0, springs->runs[r].n_factored);
}

/* Factors of one chunk of a mesh's run. */
CS_CLONES static void factor_chunk(void *arg, uint32_t number) {
    const struct factoring *made = arg;
    const struct cs_spring_chunk *chunk = made->springs->chunks + number;
    factor_springs(made, made->springs->runs + chunk->run, chunk->begin, chunk->end);
}

/* Springs are independent here; every factor is written by one thread. */
void cs_springs_factor(const struct cs_springs *springs, uint32_t n,
                       const struct cs_matrix *matrix, double *factors) {
    struct factoring made = {springs, n, matrix, factors};
    cs_pool_run((springs->n_runs + RUNS - 1) / RUNS, factor_runs, &made);
    cs_pool_run(springs->n_chunks, factor_chunk, &made);
}

/* (s I + w w^T) d. The dot product runs from left to right: its order is part of the state
 * hash. */
CS_INLINE struct difference mul_of(double s, const struct difference w,
                                   const struct difference d) {
    const double along = w.x * d.x + w.y * d.y + w.z * d.z;
    return (struct difference){s * d.x + along * w.x, s * d.y + along * w.y,
                               s * d.z + along * w.z};
}

/* The product of one spring of a grid, for the particle where it begins. */
CS_INLINE void mul(const struct stencil_input *in, const struct stencil_direction *way,
                   size_t i, const bool stored, double *out) {
    const double *p = in->dx;
    const size_t n = in->n, b = i + way->offset;
    const struct difference d = {p[i] - p[b], p[n + i] - p[n + b], p[2 * n + i] - p[2 * n + b]};
    fan_put(mul_of(way->factors[i], axis_of(in, way, i, stored), d), out);
}

KERNEL(found_product, mul, false, 3, 0);
KERNEL(stored_product, mul, true, 3, 0);

/* The factors hide the law. */
static const struct stencil_kernel *choose_mul(const struct spring_job *job,
                                               const struct cs_spring_run *first) {
    (void)job;
    return first->factor_rows == 4 ? &stored_product : &found_product;
}

/* Products of a piece of a mesh. `reversed` makes the differences p_a - p_b. */
CS_INLINE void mul_piece(const struct spring_job *job, const struct piece *piece,
                         double *restrict fx, double *restrict fy, double *restrict fz) {
    struct gather_buffer places;
    const struct cs_spring_run *run = piece->run;
    const double *s = job->factors + run->factors + piece->start;
    const double *wx = s + run->count, *wy = wx + run->count, *wz = wy + run->count;
    const struct ends e = ends_of(piece, job->at.dx, job->n, true, &places);
    for (size_t i = 0; i < piece->count; i++) {
        const struct difference w = {wx[i], wy[i], wz[i]};
        const struct difference f = mul_of(s[i], w, across(e, i, true));
        fx[i] = f.x;
        fy[i] = f.y;
        fz[i] = f.z;
    }
}

/* Products of one chunk into its slots. */
CS_CLONES static void wait_mul_chunk(void *job, uint32_t chunk) {
    compute_chunk_to_slots(job, ((const struct spring_job *)job)->springs->chunks + chunk,
                           has_anything, mul_piece);
}

/* Adds the products to the particles of one block. */
CS_CLONES static void mul_add_block(void *arg, uint32_t number) {
    const struct spring_job *job = arg;
    const struct cs_block block = cs_springs_block(job->springs, (uint32_t)job->n, number);
    add_runs(job, &block, has_anything, choose_mul, mul_piece);
}

/* Meshes first, into slots; then each block sums its own particles. */
void cs_springs_mul_add(const struct cs_springs *springs, uint32_t n, const double *factors,
                        const double *x, const double *p, double *y) {
    struct spring_job job = {
        .springs = springs, .n = n, .at = {.x = x, .dx = p}, .factors = factors, .to = y};
    cs_pool_run(springs->n_chunks, wait_mul_chunk, &job);
    cs_pool_run(springs->n_blocks, mul_add_block, &job);
}
