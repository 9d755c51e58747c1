/* Preconditioned conjugate gradients on (cm M + cd df/dv + ck df/dx) u = b, without a stored
 * matrix (Hestenes, Stiefel 1952; Saad 2003, algorithm 9.1).
 *
 * With the preconditioner B, one iteration is
 *
 *   z = B^-1 r,   p = z + (r.z / r'.z') p     (r', z' of the iteration before)
 *   q = A p,      a = r.z / p.q,   u += a p,   r -= a q
 *
 * Exact arithmetic makes successive p conjugate in A. Changing B breaks that, so the iteration
 * restarts from p = z after a fall-back.
 *
 * The product A p is summed from three parts in a fixed order: masses and diagonal blocks,
 * springs (springs_matrix.c), and the forces with entries between arbitrary particles (contact
 * pairs). */
#include "model/solver/linear.h"

#include "base/vector.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/elastic/membrane_forces.h"
#include "model/force/terms.h"

#include <clothsim/clones.h>
#include <clothsim/small.h>
#include <math.h>
#include <string.h>

/* blocks are only allocated if a force has a 3x3 part; a scene without contact multiplies by
 * scalars. */
enum cs_status cs_linear_init(struct cs_linear *linear, const struct cs_system *system,
                              struct cs_arena *arena, struct cs_error *error) {
    const size_t n = system->view.n;
    *linear = (struct cs_linear){.system = system};
    CS_ARENA_ARRAY(arena, linear->factors, system->springs.n_factors, error);
    linear->mass = cs_arena_alloc_array(arena, n, sizeof(double), error);
    linear->inverse = cs_arena_alloc_array(arena, 6 * n, sizeof(double), error);
    if (cs_terms_have_blocks(system))
        linear->blocks = cs_arena_alloc_array(arena, 6 * n, sizeof(double), error);
    linear->r = cs_arena_alloc_array(arena, 3 * n, sizeof(double), error);
    linear->p = cs_arena_alloc_array(arena, 3 * n, sizeof(double), error);
    linear->z = linear->q = cs_arena_alloc_array(arena, 3 * n, sizeof(double), error);
    return error->status ? error->status
                         : cs_multigrid_init(&linear->multigrid, system, arena, error);
}

/* Fills mass and blocks for particles [begin, end): cm m_i, and the forces' diagonal parts. */
static void set_mass(void *arg, size_t begin, size_t end) {
    struct cs_linear *linear = arg;
    const struct cs_system *system = linear->system;
    for (size_t i = begin; i < end; i++)
        linear->mass[i] = linear->matrix.cm * system->mass[i];
    for (size_t c = 0; linear->blocks && c < 6; c++)
        memset(linear->blocks + c * system->view.n + begin, 0, (end - begin) * sizeof(double));
    cs_terms_add_matrix(system, &linear->matrix, begin, end, linear->mass, linear->blocks);
}

/* Counts the blocks of a range that are not positive definite, and inverts the others, without
 * a branch. */
CS_CLONES static double invert_part(const void *arg, size_t begin, size_t end) {
    const struct cs_linear *linear = arg;
    const size_t n = linear->system->view.n;
    double *restrict blocks = linear->inverse, indefinite = 0;
    CS_INDEPENDENT
    for (size_t i = begin; i < end; i++) {
        double block[6], cofactors[6];
        cs_sym3_read(n, blocks, i, block);
        const double determinant = cs_sym3_cofactors(block, cofactors);
        const double factor = 1 / determinant;
        const bool definite = cs_sym3_is_definite(block, cofactors, determinant);
        for (size_t c = 0; c < 6; c++)
            blocks[c * n + i] = definite ? cofactors[c] * factor : block[c];
        indefinite += definite ? 0 : 1;
    }
    return indefinite;
}

/* Sets the block Jacobi preconditioner: inverse = (mass I + blocks + springs' diagonal)^-1.
 * Contact pairs are in `blocks` with their diagonal blocks only. Returns false if a block of
 * A's diagonal is not positive definite; then A is not either, because a principal submatrix of
 * it is not. */
static bool invert_blocks(struct cs_linear *linear) {
    const size_t n = linear->system->view.n;
    if (linear->blocks)
        memcpy(linear->inverse, linear->blocks, 6 * n * sizeof(double));
    else
        memset(linear->inverse, 0, 6 * n * sizeof(double));
    /* xx, yy and zz are the rows 0, 3 and 5 */
    for (size_t c = 0; c < 6; c += c ? 2 : 3)
        for (size_t i = 0; i < n; i++)
            linear->inverse[c * n + i] += linear->mass[i];
    cs_springs_factor_diagonal(&linear->system->springs, (uint32_t)n, linear->factors,
                               linear->matrix.x, linear->inverse);
    return cs_vector_sum(n, invert_part, linear) == 0;
}

/* Mean mass of a particle in kg, the unit of the scales below. */
static double mean_mass(const struct cs_system *system) {
    double sum = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        sum += system->mass[i];
    return sum / system->view.n;
}

/* A contact pair gets those springs in the multigrid whose blocks have a trace above this
 * fraction of cm times the mean mass. Weaker ones stay in the diagonal, where mass dominates
 * them. Chosen by trial on stacks of 2 and 4 sheets, winding, layers and bear_drape. */
#define LEAST 0.03

/* Computes the levels' numbers. mass (cm + stiffness) is about the largest entry of A, and the
 * scale for single precision. Lack of memory is noted in the pairs, whose owner reports it. */
static void set_multigrid(struct cs_linear *linear) {
    struct cs_pairs *pairs = linear->system->pairs;
    const struct cs_membranes *membranes = linear->system->membranes;
    const double mass = mean_mass(linear->system), cm = linear->matrix.cm;
    if (membranes)
        cs_membrane_surrogate_factor(linear->system, linear->factors);
    const struct cs_multigrid_matrix matrix = {.factors = linear->factors,
                                               .x = linear->matrix.x,
                                               .mass = linear->mass,
                                               .blocks = linear->blocks,
                                               .as_springs = membranes ? membranes->kept : NULL,
                                               .pairs = pairs,
                                               .trace_min = LEAST * mass * cm,
                                               .scale = mass * (cm + linear->stiffness)};
    if (!cs_multigrid_setup(&linear->multigrid, &matrix))
        pairs->failed = true;
}

/* Counts the free particles of a range that pairs hold more than CS_LINEAR_STIFF times as
 * stiffly as their masses do, by the traces of the pairs' diagonal blocks. */
static double count_held_by_pairs(const void *arg, size_t begin, size_t end) {
    const struct cs_linear *linear = arg;
    const struct cs_system *system = linear->system;
    const size_t n = system->view.n;
    double *blocks = linear->inverse, held = 0; // scratch: the inverses are made later
    for (size_t c = 0; c < 6; c++)
        memset(blocks + c * n + begin, 0, (end - begin) * sizeof *blocks);
    cs_pair_matrix_add_blocks(&system->pairs->solver_matrix, begin, end, blocks);
    for (size_t i = begin; i < end; i++)
        held += system->inv_mass[i] * (blocks[i] + blocks[3 * n + i] + blocks[5 * n + i]) >
                CS_LINEAR_STIFF * linear->matrix.cm;
    return held;
}

/* Tells whether the matrix is stiff for blocks: by springs, or by contact between surfaces. */
static bool is_stiff(const struct cs_linear *linear) {
    const struct cs_pairs *pairs = linear->system->pairs;
    return linear->stiffness > CS_LINEAR_STIFF * linear->matrix.cm ||
           (pairs && cs_pair_vertices_count(pairs) > 0 &&
            cs_vector_sum(linear->system->view.n, count_held_by_pairs, linear) > 0);
}

/*   1. Take the springs' factors at the matrix's state.
 *   2. Let each force prepare its part; contact stores its pairs for products.
 *   3. Fill masses and diagonal blocks.
 *   4. Set the preconditioner: levels if the matrix is stiff, else the inverse blocks. */
bool cs_linear_setup(struct cs_linear *linear, const struct cs_matrix *matrix) {
    const struct cs_system *system = linear->system;
    const struct cs_view *view = &system->view;
    const double stiffness =
        -matrix->ck * view->omega * view->omega - 2 * matrix->cd * view->delta;
    linear->matrix = *matrix;
    linear->stiffness = stiffness;
    linear->levels_failed = false;
    cs_springs_factor(&system->springs, view->n, matrix, linear->factors);
    cs_terms_prepare_matrix(system, matrix, true);
    linear->stiff =
        cs_multigrid_is_used(system->scene) && linear->multigrid.n > 0 && is_stiff(linear);
    linear->levels_are_set = linear->stiff;
    cs_vector_parallel_for(view->n, set_mass, linear);
    if (linear->stiff)
        set_multigrid(linear);
    /* An exact matrix that is indefinite mostly has an indefinite block, so test the blocks
     * even if multigrid makes them unnecessary. */
    return (linear->stiff && matrix->psd) || invert_blocks(linear);
}

/* Restricts a vector to the free particles. Pinned rows and columns of A are thereby left out.
 */
static void clear_pinned(const struct cs_system *system, double *p) {
    for (size_t c = 0; c < 3; c++)
        for (uint32_t k = 0; k < system->n_pinned; k++)
            p[c * system->view.n + system->pinned[k]] = 0;
}

/* Arguments of a loop that multiplies from one array (3,n) into another. */
struct product {
    const struct cs_linear *linear;
    const double *from;
    double *to;
    bool without_blocks;
};

/* to += blocks times from, for symmetric blocks (6,n) in the order xx, xy, xz, yy, yz, zz. */
CS_INLINE void add_blocks(const struct product *product, const double *b, size_t begin,
                          size_t end) {
    const size_t n = product->linear->system->view.n;
    const double *p = product->from;
    double *restrict y = product->to;
    CS_INDEPENDENT
    for (size_t i = begin; i < end; i++) {
        const double px = p[i], py = p[n + i], pz = p[2 * n + i];
        y[i] += b[i] * px + b[n + i] * py + b[2 * n + i] * pz;
        y[n + i] += b[n + i] * px + b[3 * n + i] * py + b[4 * n + i] * pz;
        y[2 * n + i] += b[2 * n + i] * px + b[4 * n + i] * py + b[5 * n + i] * pz;
    }
}

/* to = (mass I + blocks) from: the first part of A p, which overwrites the result. */
CS_CLONES static void mul_mass(void *arg, size_t begin, size_t end) {
    const struct product *product = arg;
    const double *mass = product->linear->mass;
    const size_t n = product->linear->system->view.n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = begin; i < end; i++)
            product->to[c * n + i] = mass[i] * product->from[c * n + i];
    if (product->linear->blocks && !product->without_blocks)
        add_blocks(product, product->linear->blocks, begin, end);
}

/* y = A p, of the forces that the product is to have. */
static void multiply(struct product *product) {
    const struct cs_linear *linear = product->linear;
    const struct cs_system *system = linear->system;
    cs_vector_parallel_for(system->view.n, mul_mass, product);
    cs_springs_mul_add(&system->springs, system->view.n, linear->factors, linear->matrix.x,
                       product->from, product->to);
    if (!product->without_blocks)
        cs_terms_add_product(system, product->from, product->to);
    clear_pinned(system, product->to);
}

void cs_linear_mul(const struct cs_linear *linear, const double *p, double *y) {
    multiply(&(struct product){linear, p, y, false});
}

void cs_linear_mul_scalar(const struct cs_linear *linear, const double *p, double *y) {
    multiply(&(struct product){linear, p, y, true});
}

/* z = D^-1 r with the inverse diagonal blocks. */
CS_CLONES static void mul_inverse(void *arg, size_t begin, size_t end) {
    const struct product *product = arg;
    const size_t n = product->linear->system->view.n;
    const double *b = product->linear->inverse, *r = product->from;
    double *restrict z = product->to;
    CS_INDEPENDENT
    for (size_t i = begin; i < end; i++) {
        const double x = r[i], y = r[n + i], w = r[2 * n + i];
        z[i] = b[i] * x + b[n + i] * y + b[2 * n + i] * w;
        z[n + i] = b[n + i] * x + b[3 * n + i] * y + b[4 * n + i] * w;
        z[2 * n + i] = b[2 * n + i] * x + b[4 * n + i] * y + b[5 * n + i] * w;
    }
}

void cs_linear_precondition(struct cs_linear *linear, const double *r, double norm, double *z) {
    struct product product = {linear, r, z, false};
    if (linear->stiff)
        cs_multigrid_apply(&linear->multigrid, r, norm, z);
    else
        cs_vector_parallel_for(linear->system->view.n, mul_inverse, &product);
}

/* Falls back to block Jacobi until the next setup. Single precision has 24 bits: it cannot
 * represent a matrix whose masses differ by more, and the V-cycle then loses positive
 * definiteness or stalls. The blocks' definiteness is known here: psd makes all definite, and
 * without psd setup tested them. */
static void give_up_multigrid(struct cs_linear *linear) {
    linear->stiff = false;
    linear->levels_failed = true;
    invert_blocks(linear);
}

/* Replaces blocks by multigrid for the rest of a solve. Every solve begins with what setup
 * chose: it does not depend on the solves before it, and a resumed run repeats it. */
static void begin_multigrid(struct cs_linear *linear) {
    if (!linear->levels_are_set)
        set_multigrid(linear);
    linear->levels_are_set = linear->stiff = true;
}

/* Tells whether blocks have had their share of iterations, and levels exist that may replace
 * them. */
static bool are_blocks_slow(const struct cs_linear *linear, uint64_t iterations) {
    return !linear->stiff && !linear->levels_failed && linear->multigrid.n > 0 &&
           iterations == CS_LINEAR_SLOW_ITERATIONS;
}

/* Ways out of the loop, in the order of the tests:
 *   1. norm <= goal: done. The residual is the recurrence's, not recomputed from u.
 *   2. The iteration limit: rounding or the condition number prevents convergence.
 *   3. r.z <= 0 with multigrid, or 500 iterations with it: fall back to blocks and restart.
 *   4. 25 iterations with blocks, where levels exist: multigrid takes over, with a restart.
 *   5. p.A p <= 0: A is indefinite.
 *   6. |b|, |r| or p.A p is not finite: b, A or the start is not, or a product overflowed. All
 *      comparisons are written so that a NaN never counts as converged.
 *
 * The start u counts: Newton and multistep methods pass a good guess and save iterations. */
static enum cs_linear_end iterate(struct cs_linear *linear, const double *b, double rtol,
                                  double *u, uint64_t *iterations, double *residual) {
    const size_t n3 = 3 * (size_t)linear->system->view.n;
    const uint64_t limit = 10 * (uint64_t)linear->system->view.n + 100;
    double *r = linear->r, *z = linear->z, *p = linear->p, *q = linear->q;

    /* r = b - A u on the free particles; |b| there is the unit of the residual */
    clear_pinned(linear->system, u);
    cs_linear_mul(linear, u, q);
    memcpy(r, b, n3 * sizeof *r);
    clear_pinned(linear->system, r);
    const double size = sqrt(cs_vector_dot(n3, r, r)), goal = rtol * size;
    *iterations = 0;
    *residual = 0;
    if (size == 0) {
        memset(u, 0, n3 * sizeof *u);
        return CS_LINEAR_DONE;
    }
    // goal would be infinite, and every residual below it
    if (!isfinite(size))
        return CS_LINEAR_NOT_FINITE;
    cs_vector_kernels.linear_sum(n3, 1, r, -1, q, r);
    double norm = sqrt(cs_vector_dot(n3, r, r)), rz = 0;

    bool fresh = true; // restart: the direction does not depend on the last one
    while (!(norm <= goal)) {
        if (!isfinite(norm))
            return CS_LINEAR_NOT_FINITE;
        if (*iterations == limit) {
            *residual = norm / size;
            return CS_LINEAR_LIMIT;
        }
        if (are_blocks_slow(linear, *iterations)) {
            begin_multigrid(linear);
            fresh = true;
        }
        cs_linear_precondition(linear, r, norm, z);
        const double next = cs_vector_dot(n3, r, z);
        if (linear->stiff && (*iterations == CS_LINEAR_STALL_ITERATIONS || !(next > 0))) {
            give_up_multigrid(linear);
            fresh = true;
            continue;
        }
        if (fresh)
            memcpy(p, z, n3 * sizeof *p);
        else
            cs_vector_kernels.linear_sum(n3, 1, z, next / rz, p, p);
        fresh = false;
        rz = next;
        cs_linear_mul(linear, p, q);
        const double curvature = cs_vector_dot(n3, p, q);
        if (!isfinite(curvature))
            return CS_LINEAR_NOT_FINITE;
        if (curvature <= 0)
            return CS_LINEAR_INDEFINITE;
        const double step = rz / curvature;
        cs_vector_kernels.linear_sum(n3, 1, u, step, p, u);
        cs_vector_kernels.linear_sum(n3, 1, r, -step, q, r);
        norm = sqrt(cs_vector_dot(n3, r, r));
        ++*iterations;
    }
    *residual = norm / size;
    return CS_LINEAR_DONE;
}

enum cs_linear_end cs_linear_solve(struct cs_linear *linear, const double *b, double rtol,
                                   double *u, uint64_t *iterations, double *residual) {
    const bool chosen = linear->stiff;
    const enum cs_linear_end end = iterate(linear, b, rtol, u, iterations, residual);
    linear->stiff = chosen && !linear->levels_failed;
    return end;
}
