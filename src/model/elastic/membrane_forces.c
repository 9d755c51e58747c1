/* Forces of membranes and their derivatives: row by row on a grid, each cell for both of its
 * triangles, and by gathered corners on a mesh. A particle sums its triangles in one order
 * whatever the number of threads. */
#include "model/elastic/membrane_forces.h"

#include "base/pool.h"

#include <string.h>

/* The loop of one kernel, compiled for several instruction sets. */
#define KERNEL(name, call)                                                                     \
    CS_CLONES static void name(const struct membrane_law *of,                                  \
                               const struct membrane_rows *at) {                               \
        const struct membrane_law law = *of;                                                   \
        const struct membrane_rows rows = *at;                                                 \
        CS_INDEPENDENT                                                                         \
        for (size_t i = 0; i < rows.count; i++)                                                \
            call;                                                                              \
    }
KERNEL(mesh_force, membrane_force(&law, &rows, i, 0))
KERNEL(mesh_jvp, membrane_jvp(&law, &rows, i, 0))
KERNEL(mesh_damped_force, membrane_force(&law, &rows, i, MEMBRANE_DAMPED))
KERNEL(mesh_damped_jvp, membrane_jvp(&law, &rows, i, MEMBRANE_DAMPED))
KERNEL(mesh_product, membrane_product(&law, &rows, i))

typedef void kernel_function(const struct membrane_law *law, const struct membrane_rows *rows);

/* By kind and damping. */
static kernel_function *const kernels[3][2] = {
    [MEMBRANE_FORCE] = {mesh_force, mesh_damped_force},
    [MEMBRANE_JVP] = {mesh_jvp, mesh_damped_jvp},
    [MEMBRANE_PRODUCT] = {mesh_product, mesh_product}};

struct membrane_law cs_membrane_law_of(const struct membrane_job *job,
                                       const struct cs_membrane *membrane) {
    const struct cs_elastic *elastic = cs_scene_elastic(job->system->scene, membrane->body);
    struct membrane_law law = {.moduli = cs_membrane_moduli(elastic),
                               .elastic = job->elastic + job->per_damping * elastic->damping,
                               .damping = job->damping * elastic->damping};
    if (membrane->columns)
        cs_membrane_stiffness(membrane, 0, &law.moduli, law.K);
    return law;
}

/* Rows of zeros, for a vector that is not given. */
static const double zeros[MEMBRANE_PIECE + 1];
static const struct membrane_corners no_corners = {{zeros, zeros, zeros}, 0};

/* --- grids --- */

/* Two rows of particles of an array (3,n). */
struct row_pair {
    const double *row[2];
    size_t n;
};

static struct row_pair pair_of(const double *p, size_t top, size_t w, size_t n) {
    return p ? (struct row_pair){{p + top, p + top + w}, n}
             : (struct row_pair){{zeros, zeros}, 0};
}

/* Forms of a kernel: the change along dx and dv; with damping. */
enum { EDGE_CHANGE = 1, EDGE_DAMPED = 2 };

/* Input and output of a row of cells; dx and dv: of derivatives and products. */
struct membrane_cells {
    struct row_pair x, v, dx, dv;
    const double *rest; /* squares of the lengths: along rows, diagonal, along columns */
    double *f[2];
    size_t f_stride[2], count;
};

/* Tensions along rows, above and below; of the diagonal, of both triangles of a cell; of its
 * left edge and of its right edge, of the triangle in the cell alone. */
struct membrane_edge_tensions {
    double top[MEMBRANE_PIECE], bottom[MEMBRANE_PIECE], diagonal[MEMBRANE_PIECE];
    double left[MEMBRANE_PIECE], right[MEMBRANE_PIECE];
};

/* An edge of a cell, from particle i of row a to j of row b. */
struct edge {
    size_t a, i, b, j;
};

CS_INLINE double across_edge(const struct row_pair *p, struct edge e, size_t c) {
    return p->row[e.b][c * p->n + e.j] - p->row[e.a][c * p->n + e.i];
}

/* elastic q + damping q' of an edge, or its change. */
CS_INLINE double edge_strain(const struct membrane_law *law, const struct membrane_cells *at,
                             const struct edge e, const double rest, const unsigned form) {
    double square = 0, rate = 0;
    for (size_t c = 0; c < 3; c++) {
        const double d = across_edge(&at->x, e, c);
        const double change = form & EDGE_CHANGE ? across_edge(&at->dx, e, c) : 0;
        square += form & EDGE_CHANGE ? 2 * (d * change) : d * d;
        if (form & EDGE_CHANGE && form & EDGE_DAMPED)
            rate += change * across_edge(&at->v, e, c) + d * across_edge(&at->dv, e, c);
        else if (form & EDGE_DAMPED)
            rate += d * across_edge(&at->v, e, c);
    }
    const double q = law->elastic * (form & EDGE_CHANGE ? square : square - rest);
    return form & EDGE_DAMPED ? q + law->damping * (2 * rate) : q;
}

CS_INLINE void cell_tensions(const struct membrane_law *law, const struct membrane_cells *at,
                             size_t i, const unsigned form,
                             struct membrane_edge_tensions *out) {
    const double *L = at->rest;
    const double diagonal = edge_strain(law, at, (struct edge){0, i + 1, 1, i}, L[1], form);
    const double upper[3] = {edge_strain(law, at, (struct edge){0, i, 0, i + 1}, L[0], form),
                             diagonal,
                             edge_strain(law, at, (struct edge){0, i, 1, i}, L[2], form)};
    const double lower[3] = {
        edge_strain(law, at, (struct edge){1, i, 1, i + 1}, L[0], form), diagonal,
        edge_strain(law, at, (struct edge){0, i + 1, 1, i + 1}, L[2], form)};
    // the diagonal belongs to both triangles
    double t[3], s[3];
    membrane_tension_by_k(law->K, upper, t);
    membrane_tension_by_k(law->K, lower, s);
    out->top[i] = t[0];
    out->bottom[i] = s[0];
    out->diagonal[i] = t[1] + s[1];
    out->left[i] = t[2];
    out->right[i] = s[2];
}

#define TENSIONS(name, form)                                                                   \
    CS_CLONES static void name(const struct membrane_law *of,                                  \
                               const struct membrane_cells *cells,                             \
                               struct membrane_edge_tensions *out) {                           \
        const struct membrane_law law = *of;                                                   \
        const struct membrane_cells at = *cells;                                               \
        CS_INDEPENDENT                                                                         \
        for (size_t i = 0; i < at.count; i++)                                                  \
            cell_tensions(&law, &at, i, form, out);                                            \
    }
TENSIONS(find_tensions, 0)
TENSIONS(find_damped, EDGE_DAMPED)
TENSIONS(find_changes, EDGE_CHANGE)
TENSIONS(find_damped_changes, EDGE_CHANGE | EDGE_DAMPED)

/* The stored tensions of cells from `cell` on, times -1. */
static void read_tensions(const struct membrane_job *job, size_t t, size_t count,
                          struct membrane_edge_tensions *out) {
    const size_t stride = job->system->membranes->n_triangles;
    for (size_t i = 0; i < count; i++, t += 2) {
        const double *upper = job->tensions + t, *lower = upper + 1;
        out->top[i] = -upper[0];
        out->bottom[i] = -lower[0];
        out->diagonal[i] = -(upper[stride] + lower[stride]);
        out->left[i] = -upper[2 * stride];
        out->right[i] = -lower[2 * stride];
    }
}

/* Adds tensions times the edges of p to particle i above and below; has_left, has_right: cells
 * beside it in the piece. */
CS_INLINE void add_edges(const struct membrane_edge_tensions *t, const struct row_pair *p,
                         const struct membrane_cells *at, size_t i, const bool has_left,
                         const bool has_right) {
    const double side = (has_right ? t->left[i] : 0) + (has_left ? t->right[i - 1] : 0);
    for (size_t c = 0; c < 3; c++) {
        const double *a = p->row[0] + c * p->n, *b = p->row[1] + c * p->n;
        double up = side * (b[i] - a[i]), down = side * (a[i] - b[i]);
        if (has_right) {
            up += t->top[i] * (a[i + 1] - a[i]);
            down += t->bottom[i] * (b[i + 1] - b[i]) + t->diagonal[i] * (a[i + 1] - b[i]);
        }
        if (has_left) {
            up += t->top[i - 1] * (a[i - 1] - a[i]) + t->diagonal[i - 1] * (b[i - 1] - a[i]);
            down += t->bottom[i - 1] * (b[i - 1] - b[i]);
        }
        at->f[0][c * at->f_stride[0] + i] += up;
        at->f[1][c * at->f_stride[1] + i] += down;
    }
}

CS_CLONES static void add_tensions(const struct membrane_edge_tensions *of,
                                   const struct row_pair *pair,
                                   const struct membrane_cells *cells) {
    const struct membrane_cells at = *cells;
    const struct row_pair p = *pair;
    add_edges(of, &p, &at, 0, false, true);
    CS_INDEPENDENT
    for (size_t i = 1; i < at.count; i++)
        add_edges(of, &p, &at, i, true, true);
    add_edges(of, &p, &at, at.count, true, false);
}

/* Cells [begin, begin + count) of a row; asked: the rows of particles above and below that are
 * added to. */
struct cells {
    uint32_t row, begin, count;
    bool asked[2];
};

/* Adds both triangles of cells: the tensions of their edges, or the changes, then at each
 * particle its edges. */
static void add_cells(const struct membrane_job *job, const struct cs_membrane *membrane,
                      const struct membrane_law *law, const struct cells *cells) {
    double unasked[3 * (MEMBRANE_PIECE + 1)];
    struct membrane_edge_tensions tensions;
    const size_t n = job->system->view.n, w = membrane->columns, cell = cells->row * (w - 1);
    const size_t top = membrane->first + cells->row * w + cells->begin;
    const bool damped = law->damping != 0, is_product = job->kind == MEMBRANE_PRODUCT;
    struct membrane_cells at = {.x = pair_of(job->x, top, w, n),
                                .v = pair_of(job->v, top, w, n),
                                .dx = pair_of(job->dx, top, w, n),
                                .dv = pair_of(job->dv, top, w, n),
                                .rest = membrane->rest + CS_MEMBRANE_P,
                                .count = cells->count};
    if (!cells->asked[0] || !cells->asked[1])
        memset(unasked, 0, sizeof unasked);
    for (size_t side = 0; side < 2; side++) {
        at.f[side] = cells->asked[side] ? job->to + top + side * w : unasked;
        at.f_stride[side] = cells->asked[side] ? n : MEMBRANE_PIECE + 1;
    }
    if (is_product)
        read_tensions(job, membrane->begin + 2 * (cell + cells->begin), at.count, &tensions);
    else
        (damped ? find_damped : find_tensions)(law, &at, &tensions);
    add_tensions(&tensions, job->kind == MEMBRANE_FORCE ? &at.x : &at.dx, &at);
    if (job->kind == MEMBRANE_FORCE)
        return;
    (damped ? find_damped_changes : find_changes)(law, &at, &tensions);
    add_tensions(&tensions, &at.x, &at);
}

/* All rows of cells with a particle in the rows [begin, end) of a grid; those at the border are
 * computed for both blocks. */
static void add_grid(const struct membrane_job *job, const struct cs_membrane *membrane,
                     uint32_t begin, uint32_t end) {
    struct membrane_law law = cs_membrane_law_of(job, membrane);
    const uint32_t columns = membrane->columns - 1;
    const uint32_t last = end < membrane->rows ? end : membrane->rows - 1;
    // a product is with the negative derivative
    law.elastic *= job->kind == MEMBRANE_PRODUCT ? -1 : 1;
    for (uint32_t row = begin > 0 ? begin - 1 : 0; row < last; row++)
        for (uint32_t at = 0; at < columns; at += MEMBRANE_PIECE) {
            const uint32_t left = columns - at;
            const struct cells cells = {row,
                                        at,
                                        left < MEMBRANE_PIECE ? left : MEMBRANE_PIECE,
                                        {row >= begin, row + 1 < end}};
            add_cells(job, membrane, &law, &cells);
        }
}

/* --- meshes --- */

/* Buffer of one vector at the corners of a piece. */
struct gathered {
    double rows[9][MEMBRANE_PIECE];
};

/* Gathers an array (3,n) at the corners of a piece; NULL: zeros. */
static struct membrane_corners gather(const struct cs_membrane *membrane, size_t n,
                                      const double *p, size_t begin, size_t count,
                                      struct gathered *to) {
    struct membrane_corners corners = {.stride = MEMBRANE_PIECE};
    if (!p)
        return no_corners;
    for (size_t k = 0; k < 3; k++) {
        for (size_t i = 0; i < count; i++) {
            const size_t at = membrane->first + membrane->triangles[3 * (begin + i) + k];
            for (size_t c = 0; c < 3; c++)
                to->rows[3 * k + c][i] = p[c * n + at];
        }
        corners.row[k] = to->rows[3 * k];
    }
    return corners;
}

/* Arguments of a loop over the pieces of a mesh. */
struct mesh_loop {
    const struct membrane_job *job;
    const struct cs_membrane *membrane;
    struct membrane_law law;
};

static void compute_piece(void *arg, uint32_t piece) {
    // corners of triangles gathered into rows, which kernels read
    const struct mesh_loop *loop = arg;
    const struct membrane_job *job = loop->job;
    const struct cs_membrane *membrane = loop->membrane;
    const size_t begin = (size_t)piece * MEMBRANE_PIECE, n = job->system->view.n;
    const size_t left = membrane->n - begin;
    const size_t count = left < MEMBRANE_PIECE ? left : MEMBRANE_PIECE;
    struct gathered x, v, dx, dv;
    const struct membrane_rows rows = {
        .x = gather(membrane, n, job->x, begin, count, &x),
        .v = gather(membrane, n, job->v, begin, count, &v),
        .dx = gather(membrane, n, job->dx, begin, count, &dx),
        .dv = gather(membrane, n, job->dv, begin, count, &dv),
        .rest = membrane->rest + begin,
        .rest_stride = membrane->n,
        .tensions = job->tensions ? job->tensions + membrane->begin + begin : NULL,
        .tensions_stride = job->system->membranes->n_triangles,
        .out = membrane->forces + begin,
        .out_stride = membrane->n,
        .count = count};
    kernels[job->kind][loop->law.damping != 0](&loop->law, &rows);
}

void cs_membrane_job_prepare(const struct membrane_job *job) {
    const struct cs_membranes *membranes = job->system->membranes;
    for (uint32_t b = 0; b < membranes->n; b++) {
        struct mesh_loop loop = {.job = job, .membrane = membranes->bodies + b};
        if (loop.membrane->columns)
            continue;
        loop.law = cs_membrane_law_of(job, loop.membrane);
        cs_pool_run((loop.membrane->n + MEMBRANE_PIECE - 1) / MEMBRANE_PIECE, compute_piece,
                    &loop);
    }
}

/* Adds the stored forces to particles [begin, end) of a mesh, in the order of its triangles. */
static void add_mesh(const struct membrane_job *job, const struct cs_membrane *membrane,
                     uint32_t begin, uint32_t end) {
    const size_t n = job->system->view.n;
    for (uint32_t i = begin; i < end; i++)
        for (uint32_t k = membrane->incident_begin[i]; k < membrane->incident_begin[i + 1]; k++)
            for (size_t c = 0; c < 3; c++)
                job->to[c * n + membrane->first + i] +=
                    membrane->forces[(3 * (membrane->incident[k] % 4) + c) * membrane->n +
                                     membrane->incident[k] / 4];
}

void cs_membrane_job_add(const struct membrane_job *job, const struct cs_block *block) {
    const struct cs_membranes *membranes = job->system->membranes;
    for (uint32_t b = 0; b < membranes->n; b++) {
        const struct cs_membrane *membrane = membranes->bodies + b;
        const uint32_t first = membrane->first, after = first + membrane->count;
        const uint32_t begin = block->begin > first ? block->begin - first : 0;
        const uint32_t end = block->end < after ? block->end : after;
        if (block->begin >= after || end <= first + begin)
            continue;
        if (membrane->columns)
            add_grid(job, membrane, begin / membrane->columns,
                     (end - first) / membrane->columns);
        else
            add_mesh(job, membrane, begin, end - first);
    }
}

/* --- the force of the chosen parts --- */

static struct membrane_job job_of(const struct cs_system *system, const struct cs_eval *at,
                                  double *to) {
    const bool changes = at->dx || at->dv;
    return (struct membrane_job){.system = system,
                                 .kind = changes ? MEMBRANE_JVP : MEMBRANE_FORCE,
                                 .x = at->x,
                                 .v = at->v,
                                 .dx = at->dx,
                                 .dv = at->dv,
                                 .elastic = at->parts & CS_PART_ELASTIC ? 1 : 0,
                                 .damping = at->parts & CS_PART_ELASTIC_DAMPING ? 1 : 0,
                                 .to = to};
}

void cs_membranes_prepare(const struct cs_system *system, const struct cs_eval *at) {
    const struct membrane_job job = job_of(system, at, NULL);
    cs_membrane_job_prepare(&job);
}

void cs_membranes_add(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const struct membrane_job job = job_of(system, at, f);
    cs_membrane_job_add(&job, at->block);
}
