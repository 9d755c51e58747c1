/* Bending forces f = -K x in two passes: the moments A D k of each stencil, by all threads, and
 * then at each particle the sum of its weights times moments, in one order. */
#include "model/elastic/bending_forces.h"

#include "base/pool.h"

#include <clothsim/clones.h>
#include <math.h>
#include <string.h>

/* Arguments of the loops over blocks: y (3,n) += factor K p. */
struct job {
    const struct cs_system *system;
    const double *p;
    double factor;
    double *y;
    bool apart; /* without the diagonal of the matrix kept last */
};

static struct cs_moduli moduli_of(const struct cs_system *system,
                                  const struct cs_bending *bending) {
    return cs_bending_moduli(&cs_scene_bodies(system->scene)[bending->body].elastic);
}

/* Particles of a body in a block, counted from its first; false: none. */
static bool find_range(const struct cs_bending *bending, const struct cs_block *block,
                       uint32_t range[2]) {
    const uint32_t first = bending->first, after = first + bending->count;
    const uint32_t begin = block->begin > first ? block->begin : first;
    const uint32_t end = block->end < after ? block->end : after;
    range[0] = begin - first;
    range[1] = end - first;
    return begin < end;
}

/* --- moments of a grid --- */

/* Factors of one row of particles: of differences along and across it, of curvatures in moments
 * inside and at the row's ends, of twists. */
struct row_law {
    double along, across;
    struct cs_moduli inner;
    double end_weft, twist;
};

/* The law of a row. On a row that is a rim `across` is 0. */
static struct row_law law_of(const struct cs_bending *bending, const struct cs_moduli *moduli,
                             uint32_t row) {
    const uint32_t w = bending->columns;
    const double dx = bending->spacing[0], dy = bending->spacing[1];
    const bool across = row > 0 && row + 1 < bending->rows;
    struct cs_bending_stencil end, inner;
    cs_bending_stencil_at(bending, moduli, row * w, &end);
    cs_bending_stencil_at(bending, moduli, row * w + (w > 2), &inner);
    return (struct row_law){.along = 1 / (dx * dx),
                            .across = across ? 1 / (dy * dy) : 0,
                            .inner = inner.moduli,
                            .end_weft = end.moduli.weft,
                            .twist = 2 * moduli->shear};
}

/* The moments of one component p of a row in X, Y and T; up, down: the rows beside it, or p
 * where there is none, which makes the twists 0. */
CS_CLONES static void row_moments(const struct row_law *of, size_t w,
                                  const double *const rows[3], double *restrict X,
                                  double *restrict Y, double *restrict T) {
    const struct row_law law = *of;
    const double *up = rows[0], *p = rows[1], *down = rows[2];
    for (size_t i = 1; i + 1 < w; i++) {
        const double x = law.along * ((p[i - 1] - p[i]) + (p[i + 1] - p[i]));
        const double y = law.across * ((up[i] - p[i]) + (down[i] - p[i]));
        X[i] = law.inner.warp * x + law.inner.coupling * y;
        Y[i] = law.inner.coupling * x + law.inner.weft * y;
    }
    for (size_t i = 0; i < w; i += w - 1) {
        X[i] = 0;
        Y[i] = law.end_weft * law.across * ((up[i] - p[i]) + (down[i] - p[i]));
    }
    for (size_t i = 0; i + 1 < w; i++)
        T[i] = law.twist * ((p[i] - p[i + 1]) - (down[i] - down[i + 1]));
    T[w - 1] = 0;
}

static void grid_moments(const struct job *job, const struct cs_bending *bending,
                         const struct cs_moduli *moduli, uint32_t row) {
    const struct row_law law = law_of(bending, moduli, row);
    const size_t w = bending->columns, at = (size_t)row * w, plane = bending->count;
    for (size_t c = 0; c < 3; c++) {
        const double *p = job->p + c * job->system->view.n + bending->first + at;
        const double *const rows[3] = {row > 0 ? p - w : p, p,
                                       row + 1 < bending->rows ? p + w : p};
        double *X = bending->moments + c * plane + at;
        row_moments(&law, w, rows, X, X + 3 * plane, X + 6 * plane);
    }
}

/* --- moments of a mesh --- */

/* A D k of stencil s; differences to its first point keep W independent of a translation. */
static void mesh_moments(const struct job *job, const struct cs_bending *bending,
                         const struct cs_moduli *moduli, uint32_t s) {
    const size_t n = job->system->view.n;
    const uint32_t *points = bending->points + CS_BENDING_POINTS * (size_t)s;
    const double *weights = bending->weights + CS_BENDING_WEIGHTS * (size_t)s;
    const double area = bending->areas[s];
    for (size_t c = 0; c < 3; c++) {
        const double *p = job->p + c * n + bending->first;
        double k[3] = {0, 0, 0};
        for (size_t j = 1; j < CS_BENDING_POINTS; j++)
            for (size_t a = 0; a < 3; a++)
                k[a] += weights[CS_BENDING_POINTS * a + j] * (p[points[j]] - p[points[0]]);
        double *to = bending->moments + c * bending->n + s;
        to[0] = area * (moduli->warp * k[0] + moduli->coupling * k[1]);
        to[3 * (size_t)bending->n] = area * (moduli->coupling * k[0] + moduli->weft * k[1]);
        to[6 * (size_t)bending->n] = area * moduli->shear * k[2];
    }
}

/* Stencils of a mesh per block of a loop. */
enum { PIECE = 256 };

static void mesh_block(void *arg, uint32_t number) {
    const struct job *job = arg;
    for (uint32_t b = 0, first = 0; b < job->system->bendings->n; b++) {
        const struct cs_bending *bending = job->system->bendings->bodies + b;
        const uint32_t blocks = bending->columns ? 0 : (bending->n + PIECE - 1) / PIECE;
        const struct cs_moduli moduli = moduli_of(job->system, bending);
        if (number >= first && number < first + blocks)
            for (uint32_t s = (number - first) * PIECE;
                 s < bending->n && s < (number - first + 1) * PIECE; s++)
                mesh_moments(job, bending, &moduli, s);
        first += blocks;
    }
}

static void grid_block(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_system *system = job->system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    for (uint32_t b = 0; b < system->bendings->n; b++) {
        const struct cs_bending *bending = system->bendings->bodies + b;
        const struct cs_moduli moduli = moduli_of(system, bending);
        uint32_t range[2];
        if (bending->columns && find_range(bending, &block, range))
            for (uint32_t row = range[0] / bending->columns; row < range[1] / bending->columns;
                 row++)
                grid_moments(job, bending, &moduli, row);
    }
}

static void find_moments(struct job *job) {
    uint32_t blocks = 0;
    for (uint32_t b = 0; b < job->system->bendings->n; b++) {
        const struct cs_bending *bending = job->system->bendings->bodies + b;
        blocks += bending->columns ? 0 : (bending->n + PIECE - 1) / PIECE;
    }
    cs_pool_run(job->system->springs.n_blocks, grid_block, job);
    cs_pool_run(blocks, mesh_block, job);
}

/* --- sums at particles --- */

/* Moments of one component at a row and its neighbours. Where a neighbour lacks, its moments
 * are those of a rim, which are 0. */
struct moment_rows {
    const double *X, *Y, *up, *down; /* up, down: Y of the rows beside it */
    const double *T, *above;         /* above: T of the row before it */
    double along, across, twist;     /* weights times the factor of the sum */
};

/* y += weights times moments. X and T end in a 0 in every row, and T begins after one: what
 * stands before a row's first particle and after its last is 0. */
CS_CLONES static void add_row(const struct moment_rows *of, size_t w, double *restrict y) {
    const struct moment_rows at = *of;
    for (size_t i = 0; i < w; i++) {
        const double *X = at.X + i, *T = at.T + i, *above = at.above + i;
        y[i] += at.along * ((X[-1] - X[0]) + (X[1] - X[0])) +
                at.across * ((at.up[i] - at.Y[i]) + (at.down[i] - at.Y[i])) +
                at.twist * ((T[0] - T[-1]) - (above[0] - above[-1]));
    }
}

/* One component of a row of a grid. */
static void add_grid_row(const struct cs_bending *bending, const double *moments, uint32_t row,
                         double factor, double *y) {
    const size_t w = bending->columns, plane = 3 * (size_t)bending->count, at = (size_t)row * w;
    const double dx = bending->spacing[0], dy = bending->spacing[1];
    const double *Y = moments + plane + at, *T = moments + 2 * plane;
    const bool is_first = row == 0, is_last = row + 1 == bending->rows;
    const struct moment_rows rows = {
        .X = moments + at,
        .Y = Y,
        .up = is_first ? Y : Y - w,
        .down = is_last ? Y : Y + w,
        .T = T + at,
        .above = is_first ? T + bending->count - w : T + at - w,
        .along = factor / (dx * dx),
        .across = factor / (dy * dy),
        .twist = factor * 2 / (dx * dy),
    };
    add_row(&rows, w, y);
}

static void add_mesh_particle(const struct job *job, const struct cs_bending *bending,
                              uint32_t i) {
    const size_t n = job->system->view.n, stride = bending->n;
    double sum[3] = {0, 0, 0};
    for (uint32_t k = bending->incident_begin[i]; k < bending->incident_begin[i + 1]; k++) {
        const size_t s = bending->incident[k] / 8, place = bending->incident[k] % 8;
        const double *weights = bending->weights + CS_BENDING_WEIGHTS * s + place;
        for (size_t a = 0; a < 3; a++)
            for (size_t c = 0; c < 3; c++)
                sum[c] +=
                    weights[CS_BENDING_POINTS * a] * bending->moments[(3 * a + c) * stride + s];
    }
    for (size_t c = 0; c < 3; c++)
        job->y[c * n + bending->first + i] += job->factor * sum[c];
}

/* y += factor K p at a block. */
static void add_block(const struct job *job, const struct cs_block *block) {
    const size_t n = job->system->view.n;
    for (uint32_t b = 0; b < job->system->bendings->n; b++) {
        const struct cs_bending *bending = job->system->bendings->bodies + b;
        uint32_t range[2];
        if (!find_range(bending, block, range))
            continue;
        for (uint32_t i = range[0]; !bending->columns && i < range[1]; i++)
            add_mesh_particle(job, bending, i);
        for (uint32_t i = range[0]; bending->columns && i < range[1]; i += bending->columns)
            for (size_t c = 0; c < 3; c++)
                add_grid_row(bending, bending->moments + c * bending->count,
                             i / bending->columns, job->factor,
                             job->y + c * n + bending->first + i);
    }
}

void cs_bendings_prepare(const struct cs_system *system, const struct cs_eval *at) {
    struct job job = {.system = system, .p = at->dx ? at->dx : at->x};
    if (at->dx || !at->dv)
        find_moments(&job);
}

void cs_bendings_add(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const struct job job = {.system = system, .factor = -1, .y = f};
    if (at->dx || !at->dv)
        add_block(&job, at->block);
}

/* --- energy, bounds, matrix: stencil by stencil --- */

/* D k of a stencil for a weight each, or a component of k. */
static void multiply(const struct cs_moduli *moduli, const double k[3], double out[3]) {
    out[0] = moduli->warp * k[0] + moduli->coupling * k[1];
    out[1] = moduli->coupling * k[0] + moduli->weft * k[1];
    out[2] = moduli->shear * k[2];
}

static double stencil_energy(const struct cs_bending_stencil *stencil, size_t n,
                             const double *x) {
    double energy = 0;
    for (size_t c = 0; c < 3; c++) {
        const double *p = x + c * n;
        double k[3] = {0, 0, 0}, M[3];
        for (uint32_t j = 1; j < stencil->n; j++)
            for (int a = 0; a < 3; a++)
                k[a] += stencil->weights[a][j] * (p[stencil->at[j]] - p[stencil->at[0]]);
        multiply(&stencil->moduli, k, M);
        energy += 0.5 * (k[0] * M[0] + k[1] * M[1] + k[2] * M[2]);
    }
    return energy;
}

double cs_bendings_energy(const struct cs_system *system, const double *x) {
    double sum = 0;
    for (uint32_t b = 0; b < system->bendings->n; b++) {
        const struct cs_bending *bending = system->bendings->bodies + b;
        const struct cs_moduli moduli = moduli_of(system, bending);
        for (uint32_t s = 0; s < bending->n; s++) {
            struct cs_bending_stencil stencil;
            cs_bending_stencil_at(bending, &moduli, s, &stencil);
            sum += stencil_energy(&stencil, system->view.n, x);
        }
    }
    return sum;
}

/* Adds rows of a stencil's matrix: its diagonal, or the sum of magnitudes. */
static void add_rows(const struct cs_bending_stencil *stencil, bool diagonal, double *sums) {
    for (uint32_t i = 0; i < stencil->n; i++)
        for (uint32_t j = diagonal ? i : 0; j < (diagonal ? i + 1 : stencil->n); j++) {
            const double(*b)[CS_BENDING_POINTS] = stencil->weights;
            double M[3];
            multiply(&stencil->moduli, (const double[3]){b[0][j], b[1][j], b[2][j]}, M);
            sums[stencil->at[i]] += fabs(b[0][i] * M[0] + b[1][i] * M[1] + b[2][i] * M[2]);
        }
}

static void add_body_rows(const struct cs_bending *bending, const struct cs_moduli *moduli,
                          bool diagonal, double *sums) {
    for (uint32_t s = 0; s < bending->n; s++) {
        struct cs_bending_stencil stencil;
        cs_bending_stencil_at(bending, moduli, s, &stencil);
        add_rows(&stencil, diagonal, sums);
    }
}

/* Finds diagonal and row sums of K where the moduli are not those that they were found for. */
static void update_rows(const struct cs_system *system) {
    struct cs_bendings *all = system->bendings;
    for (uint32_t b = 0; b < all->n; b++) {
        const struct cs_bending *bending = all->bodies + b;
        const struct cs_moduli moduli = moduli_of(system, bending);
        const struct cs_moduli *of = all->moduli + b;
        if (of->warp == moduli.warp && of->weft == moduli.weft &&
            of->coupling == moduli.coupling && of->shear == moduli.shear)
            continue;
        memset(all->diagonal + bending->first, 0, bending->count * sizeof *all->diagonal);
        memset(all->row_sums + bending->first, 0, bending->count * sizeof *all->row_sums);
        add_body_rows(bending, &moduli, true, all->diagonal);
        add_body_rows(bending, &moduli, false, all->row_sums);
        all->moduli[b] = moduli;
    }
}

void cs_bendings_add_bound(const struct cs_system *system, double *sums) {
    update_rows(system);
    for (uint32_t i = 0; i < system->view.n; i++)
        sums[i] += system->bendings->row_sums[i];
}

/* A stencil of m points is at most m times its diagonal: what matrix->bound asks for. */
void cs_bendings_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                                bool kept) {
    struct cs_bendings *all = system->bendings;
    const double factor = -matrix->ck * (matrix->bound && !kept ? CS_BENDING_POINTS : 1);
    update_rows(system);
    for (uint32_t i = 0; i < system->view.n; i++)
        all->blocks[i] = factor * all->diagonal[i];
    if (kept)
        all->kept = -matrix->ck;
}

static void product_block(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_system *system = job->system;
    const struct cs_bendings *all = system->bendings;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    add_block(job, &block);
    for (size_t c = 0; job->apart && c < 3; c++)
        for (size_t i = c * system->view.n + block.begin, k = block.begin; k < block.end;
             i++, k++)
            job->y[i] -= all->kept * all->diagonal[k] * job->p[i];
}

static void add_product(const struct cs_system *system, const double *p, bool apart,
                        double *y) {
    struct job job = {
        .system = system, .p = p, .factor = system->bendings->kept, .y = y, .apart = apart};
    find_moments(&job);
    cs_pool_run(system->springs.n_blocks, product_block, &job);
}

void cs_bendings_add_product(const struct cs_system *system, const double *p, double *y) {
    add_product(system, p, true, y);
}

void cs_bendings_add_approach(const struct cs_system *system, const double *v, double *y) {
    add_product(system, v, false, y);
}
