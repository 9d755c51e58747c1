/* Forces of membranes and their derivatives: row by row on a grid, each cell for both of its
 * triangles, and by gathered corners on a mesh. A particle sums its triangles in one order
 * whatever the number of threads. */
#include "model/elastic/membrane_forces.h"

#include "base/pool.h"

#include <math.h>

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
KERNEL(grid_force, membrane_force(&law, &rows, i, 0))
KERNEL(grid_jvp, membrane_jvp(&law, &rows, i, 0))
KERNEL(grid_damped_force, membrane_force(&law, &rows, i, MEMBRANE_DAMPED))
KERNEL(grid_damped_jvp, membrane_jvp(&law, &rows, i, MEMBRANE_DAMPED))
KERNEL(grid_product, membrane_product(&law, &rows, i, 0))
KERNEL(mesh_force, membrane_force(&law, &rows, i, MEMBRANE_LISTED))
KERNEL(mesh_jvp, membrane_jvp(&law, &rows, i, MEMBRANE_LISTED))
KERNEL(mesh_damped_force, membrane_force(&law, &rows, i, MEMBRANE_LISTED | MEMBRANE_DAMPED))
KERNEL(mesh_damped_jvp, membrane_jvp(&law, &rows, i, MEMBRANE_LISTED | MEMBRANE_DAMPED))
KERNEL(mesh_product, membrane_product(&law, &rows, i, MEMBRANE_LISTED))

typedef void kernel_function(const struct membrane_law *law, const struct membrane_rows *rows);

/* By kind, mesh and damping. */
static kernel_function *const kernels[3][2][2] = {
    [MEMBRANE_FORCE] = {{grid_force, grid_damped_force}, {mesh_force, mesh_damped_force}},
    [MEMBRANE_JVP] = {{grid_jvp, grid_damped_jvp}, {mesh_jvp, mesh_damped_jvp}},
    [MEMBRANE_PRODUCT] = {{grid_product, grid_product}, {mesh_product, mesh_product}}};

static void run_kernel(const struct membrane_job *job, const struct cs_membrane *membrane,
                       const struct membrane_law *law, const struct membrane_rows *rows) {
    kernels[job->kind][!membrane->columns][law->damping != 0](law, rows);
}

struct membrane_law cs_membrane_law_of(const struct membrane_job *job,
                                       const struct cs_membrane *membrane) {
    const struct cs_elastic *elastic =
        &cs_scene_bodies(job->system->scene)[membrane->body].elastic;
    struct membrane_law law = {.moduli = cs_membrane_moduli(elastic),
                               .elastic = job->elastic + job->per_damping * elastic->damping,
                               .damping = job->damping * elastic->damping};
    if (membrane->columns)
        cs_membrane_stiffness(membrane, 0, &law.moduli, law.K);
    return law;
}

/* Rows of zeros, for a vector that is not given. */
static const double zeros[MEMBRANE_PIECE];
static const struct membrane_corners no_corners = {{zeros, zeros, zeros}, 0};

/* --- grids --- */

/* Rows of an array (3,n) at the corners of one half of a row's cells, from column `begin` on.
 */
static struct membrane_corners grid_corners(const struct cs_membrane *membrane, size_t n,
                                            const double *p, size_t top, bool half) {
    if (!p)
        return no_corners;
    const double *a = p + top, *below = a + membrane->columns;
    return half ? (struct membrane_corners){{below + 1, below, a + 1}, n}
                : (struct membrane_corners){{a, a + 1, below}, n};
}

CS_CLONES static void add_row(size_t count, const double *restrict from, double *restrict to) {
    for (size_t i = 0; i < count; i++)
        to[i] += from[i];
}

/* Adds the forces on one corner of a piece, three rows, from particle `at` on. */
static void add_corner(const struct membrane_job *job, double (*rows)[MEMBRANE_PIECE],
                       size_t corner, size_t count, size_t at) {
    for (size_t c = 0; c < 3; c++)
        add_row(count, rows[3 * corner + c], job->to + c * job->system->view.n + at);
}

/* Cells [begin, begin + count) of a row; asked: the rows of particles above and below that are
 * added to. */
struct cells {
    uint32_t row, begin, count;
    bool asked[2];
};

/* Adds both triangles of cells. */
static void add_cells(const struct membrane_job *job, const struct cs_membrane *membrane,
                      const struct membrane_law *law, const struct cells *cells) {
    double out[2][9][MEMBRANE_PIECE];
    const size_t n = job->system->view.n, count = cells->count;
    const size_t top = membrane->first + (size_t)cells->row * membrane->columns + cells->begin;
    const size_t cell = (size_t)cells->row * (membrane->columns - 1) + cells->begin;
    for (size_t half = 0; half < 2; half++) {
        const size_t t = membrane->begin + 2 * cell + half;
        const struct membrane_rows rows = {.x = grid_corners(membrane, n, job->x, top, half),
                                           .v = grid_corners(membrane, n, job->v, top, half),
                                           .dx = grid_corners(membrane, n, job->dx, top, half),
                                           .dv = grid_corners(membrane, n, job->dv, top, half),
                                           .rest = membrane->rest,
                                           .tensions = job->tensions ? job->tensions + t : NULL,
                                           .tensions_stride =
                                               job->system->membranes->n_triangles,
                                           .tension_step = 2,
                                           .out = out[half][0],
                                           .out_stride = MEMBRANE_PIECE,
                                           .count = count};
        run_kernel(job, membrane, law, &rows);
    }
    // one order for each particle: the corners of its triangles by their numbers
    if (cells->asked[0]) {
        add_corner(job, out[0], 0, count, top);
        add_corner(job, out[0], 1, count, top + 1);
        add_corner(job, out[1], 2, count, top + 1);
    }
    if (cells->asked[1]) {
        add_corner(job, out[0], 2, count, top + membrane->columns);
        add_corner(job, out[1], 1, count, top + membrane->columns);
        add_corner(job, out[1], 0, count, top + membrane->columns + 1);
    }
}

/* All rows of cells with a particle in the rows [begin, end) of a grid; those at the border are
 * computed for both blocks. */
static void add_grid(const struct membrane_job *job, const struct cs_membrane *membrane,
                     uint32_t begin, uint32_t end) {
    const struct membrane_law law = cs_membrane_law_of(job, membrane);
    const uint32_t columns = membrane->columns - 1;
    const uint32_t last = end < membrane->rows ? end : membrane->rows - 1;
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
        .tension_step = 1,
        .out = membrane->forces + begin,
        .out_stride = membrane->n,
        .count = count};
    run_kernel(job, membrane, &loop->law, &rows);
}

void cs_membrane_job_prepare(const struct membrane_job *job) {
    const struct cs_membranes *all = job->system->membranes;
    for (uint32_t b = 0; b < all->n; b++) {
        struct mesh_loop loop = {.job = job, .membrane = all->bodies + b};
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
    const struct cs_membranes *all = job->system->membranes;
    for (uint32_t b = 0; b < all->n; b++) {
        const struct cs_membrane *membrane = all->bodies + b;
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
                                 .elastic = at->parts & CS_PART_POTENTIAL ? 1 : 0,
                                 .damping = at->parts & CS_PART_DISSIPATIVE ? 1 : 0,
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
