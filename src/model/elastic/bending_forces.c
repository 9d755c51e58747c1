/* Bending forces f = -K x in two passes: the moments A D k of each stencil, by all threads, and
 * then at each particle the sum of its weights times moments, in one order. Bodies that are
 * curved at rest, and damping: normal_curvature.c. */
#include "model/elastic/normal_stencil.h"

#include "base/pool.h"
#include "scene/elastic_keys.h"

#include <clothsim/clones.h>

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
    return cs_bending_moduli(cs_scene_elastic(system->scene, bending->body));
}

/* Stencils of a mesh whose energy is quadratic. */
static uint32_t mesh_stencils(const struct cs_bending *bending) {
    return bending->columns || bending->rest ? 0 : bending->n;
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

/* --- grids --- */

/* In a row of particles let E be the second difference along it, one-sided at its ends, and N
 * the one across it. The force is the second difference along the row of X, the moment along
 * it, plus the one across of Z: of the moment across and of the twist, since the twists of
 * cells are differences of E between rows. */

/* Factors of E and N in X, in Z, and in Z at the ends of the row, with the area and the weights
 * of the sum; in rows at rims there is no N. */
struct row_law {
    double X[2], Z[2], end[2];
};

static struct row_law law_of(const struct cs_bending *bending, uint32_t row, double factor,
                             const struct cs_moduli *moduli) {
    const double dx = bending->spacing[0], dy = bending->spacing[1];
    const double along = 1 / (dx * dx), across = row > 0 ? 1 / (dy * dy) : 0;
    const double twist = factor * (4 * moduli->shear / (dx * dy)), by = factor / (dy * dy);
    struct cs_bending_stencil end, inner;
    cs_bending_stencil_at(bending, moduli, row * bending->columns, &end);
    cs_bending_stencil_at(bending, moduli, row * bending->columns + (bending->columns > 2),
                          &inner);
    const struct cs_moduli *D = &inner.moduli;
    return (struct row_law){
        {factor * along * D->warp * along, factor * along * D->coupling * across},
        {by * D->coupling * along + twist, by * D->weft * across},
        {twist, by * end.moduli.weft * across}};
}

/* Columns of a piece of a grid, whose moments are on the stack. */
enum { COLUMNS = 128 };

/* Columns [begin, end) of a grid w wide. */
struct columns {
    size_t begin, end, w;
};

/* Moments of one component in a row of a piece, from its first column on; X also before and
 * after it. At the ends of rows and beyond X is 0. */
struct moments {
    double before, X[COLUMNS + 1], Z[COLUMNS];
};

/* Differences at column i of component p of a row; up, down: the rows beside it. */
CS_INLINE double along_row(const double *const rows[3], size_t i) {
    return (rows[1][i - 1] - rows[1][i]) + (rows[1][i + 1] - rows[1][i]);
}

CS_INLINE double across_row(const double *const rows[3], size_t i) {
    return (rows[0][i] - rows[1][i]) + (rows[2][i] - rows[1][i]);
}

CS_CLONES static void row_moments(const struct row_law *of, const struct columns *at,
                                  const double *const rows[3], struct moments *to) {
    const struct row_law law = *of;
    const double *const p[3] = {rows[0], rows[1], rows[2]};
    const size_t w = at->w, begin = at->begin, end = at->end, last = end - begin;
    const size_t left = begin > 0 ? begin : 1, right = end < w ? end : w - 1;
    double *X = to->X, *Z = to->Z;
    to->before = X[0] = X[last - 1] = X[last] = 0;
    CS_INDEPENDENT
    for (size_t i = left; i < right; i++) {
        const double E = along_row(p, i), N = across_row(p, i);
        X[i - begin] = law.X[0] * E + law.X[1] * N;
        Z[i - begin] = law.Z[0] * E + law.Z[1] * N;
    }
    // one-sided at the ends of the row
    if (begin == 0)
        Z[0] = law.end[0] * (p[1][1] - p[1][0]) + law.end[1] * across_row(p, 0);
    if (end == w)
        Z[last - 1] =
            law.end[0] * (p[1][w - 2] - p[1][w - 1]) + law.end[1] * across_row(p, w - 1);
    if (begin > 1)
        to->before = law.X[0] * along_row(p, begin - 1) + law.X[1] * across_row(p, begin - 1);
    if (end + 1 < w)
        X[last] = law.X[0] * along_row(p, end) + law.X[1] * across_row(p, end);
}

/* y += the second differences of X along and of Z across. */
CS_CLONES static void add_row(const struct moments *at, const double *up, const double *down,
                              size_t count, double *restrict y) {
    const double *X = at->X, *Z = at->Z;
    y[0] += ((at->before - X[0]) + (X[1] - X[0])) + ((up[0] - Z[0]) + (down[0] - Z[0]));
    for (size_t i = 1; i < count; i++)
        y[i] += ((X[i - 1] - X[i]) + (X[i + 1] - X[i])) + ((up[i] - Z[i]) + (down[i] - Z[i]));
}

/* Rows [begin, end) of one component of a piece of a grid. */
struct grid_rows {
    const struct row_law *laws; /* of rows at rims, and inside */
    struct columns columns;
    uint32_t n, begin, end; /* n: all rows */
    const double *p;
    double *y;
};

/* Moments of the row before, of the row, and of the next take turns in three buffers. */
static void add_rows(const struct grid_rows *at) {
    const size_t w = at->columns.w;
    struct moments ring[3];
    for (uint32_t next = at->begin > 0 ? at->begin - 1 : 0; next <= at->end; next++) {
        const double *p = at->p + next * w;
        const bool is_inside = next > 0 && next + 1 < at->n;
        const double *const rows[3] = {is_inside ? p - w : p, p, is_inside ? p + w : p};
        if (next < at->n)
            row_moments(at->laws + is_inside, &at->columns, rows, ring + next % 3);
        if (next <= at->begin)
            continue;
        const uint32_t row = next - 1;
        const struct moments *own = ring + row % 3;
        add_row(own, (row > 0 ? ring + (row - 1) % 3 : own)->Z,
                (next < at->n ? ring + next % 3 : own)->Z, at->columns.end - at->columns.begin,
                at->y + row * w + at->columns.begin);
    }
}

/* Rows [begin, end) of a grid. */
static void add_grid(const struct job *job, const struct cs_bending *bending, uint32_t begin,
                     uint32_t end) {
    const struct cs_moduli moduli = moduli_of(job->system, bending);
    const struct row_law laws[2] = {law_of(bending, 0, job->factor, &moduli),
                                    law_of(bending, bending->rows > 2, job->factor, &moduli)};
    const size_t n = job->system->view.n, w = bending->columns;
    for (size_t c = 0; c < 3; c++)
        for (size_t at = 0; at < w; at += COLUMNS)
            add_rows(&(struct grid_rows){laws,
                                         {at, at + COLUMNS < w ? at + COLUMNS : w, w},
                                         bending->rows,
                                         begin,
                                         end,
                                         job->p + c * n + bending->first,
                                         job->y + c * n + bending->first});
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
        const uint32_t blocks = (mesh_stencils(bending) + PIECE - 1) / PIECE;
        const struct cs_moduli moduli = moduli_of(job->system, bending);
        if (number >= first && number < first + blocks)
            for (uint32_t s = (number - first) * PIECE;
                 s < bending->n && s < (number - first + 1) * PIECE; s++)
                mesh_moments(job, bending, &moduli, s);
        first += blocks;
    }
}

static void find_moments(struct job *job) {
    uint32_t blocks = 0;
    for (uint32_t b = 0; b < job->system->bendings->n; b++) {
        const struct cs_bending *bending = job->system->bendings->bodies + b;
        blocks += (mesh_stencils(bending) + PIECE - 1) / PIECE;
    }
    cs_pool_run(blocks, mesh_block, job);
}

/* --- sums at particles --- */

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
    for (uint32_t b = 0; b < job->system->bendings->n; b++) {
        const struct cs_bending *bending = job->system->bendings->bodies + b;
        uint32_t range[2];
        if (bending->rest || !find_range(bending, block, range))
            continue;
        for (uint32_t i = range[0]; !bending->columns && i < range[1]; i++)
            add_mesh_particle(job, bending, i);
        if (bending->columns)
            add_grid(job, bending, range[0] / bending->columns, range[1] / bending->columns);
    }
}

/* Positions, or their direction, whose force is asked for; NULL: none, the force of velocities
 * alone, or without the elastic part. */
static const double *direction_of(const struct cs_eval *at) {
    const double *p = at->dx || at->dv ? at->dx : at->x;
    return at->parts & CS_PART_ELASTIC ? p : NULL;
}

void cs_bendings_prepare(const struct cs_system *system, const struct cs_eval *at) {
    struct job job = {.system = system, .p = direction_of(at)};
    if (job.p)
        find_moments(&job);
    if (system->bendings->normal.x)
        cs_normal_curvature_prepare(system, at);
}

void cs_bendings_add(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const struct job job = {.system = system, .p = direction_of(at), .factor = -1, .y = f};
    if (job.p)
        add_block(&job, at->block);
    if (system->bendings->normal.x)
        cs_normal_curvature_add(system, at->block, -1, f);
}

/* --- the matrix --- */

/* A stencil of m points is at most m times its diagonal: what matrix->bound asks for. */
void cs_bendings_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                                bool kept) {
    struct cs_bendings *bendings = system->bendings;
    const double factor = -matrix->ck * (matrix->bound && !kept ? CS_BENDING_POINTS : 1);
    cs_bendings_update_rows(system);
    for (uint32_t i = 0; i < system->view.n; i++)
        bendings->blocks[i] = factor * bendings->diagonal[i];
    if (kept)
        bendings->kept = -matrix->ck;
    if (bendings->normal.x)
        cs_normal_curvature_prepare_matrix(system, matrix, kept);
}

void cs_bendings_add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                            size_t begin, size_t end, double *blocks) {
    (void)matrix;
    const struct cs_bendings *bendings = system->bendings;
    const size_t n = system->view.n;
    for (size_t c = 0; c < 6; c += c ? 2 : 3)
        for (size_t i = begin; i < end; i++)
            blocks[c * n + i] += bendings->blocks[i];
    for (size_t c = 0; bendings->normal.x && c < 6; c++)
        for (size_t i = begin; i < end; i++)
            blocks[c * n + i] += bendings->normal.blocks[c * n + i];
}

/* y -= the diagonal blocks of the kept matrix times p. */
static void take_blocks_out(const struct job *job, const struct cs_block *block) {
    static const size_t entries[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const struct cs_bendings *bendings = job->system->bendings;
    const size_t n = job->system->view.n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = c * n + block->begin, k = block->begin; k < block->end; i++, k++)
            job->y[i] -= bendings->kept * bendings->diagonal[k] * job->p[i];
    for (size_t c = 0; bendings->normal.x && c < 3; c++)
        for (size_t d = 0; d < 3; d++)
            for (size_t k = block->begin; k < block->end; k++)
                job->y[c * n + k] -=
                    bendings->normal.kept[entries[c][d] * n + k] * job->p[d * n + k];
}

static void product_block(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_system *system = job->system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    add_block(job, &block);
    if (system->bendings->normal.x)
        cs_normal_curvature_add(system, &block, 1, job->y);
    if (job->apart)
        take_blocks_out(job, &block);
}

/* y += A p of the matrix kept last; apart: without its diagonal blocks, and with its damping.
 */
static void add_product(const struct cs_system *system, const double *p, bool apart,
                        double *y) {
    struct job job = {
        .system = system, .p = p, .factor = system->bendings->kept, .y = y, .apart = apart};
    find_moments(&job);
    if (system->bendings->normal.x)
        cs_normal_curvature_prepare_product(system, p, !apart);
    cs_pool_run(system->springs.n_blocks, product_block, &job);
}

void cs_bendings_add_product(const struct cs_system *system, const double *p, double *y) {
    add_product(system, p, true, y);
}

void cs_bendings_add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                              double *y) {
    add_product(system, matrix->v, false, y);
}
