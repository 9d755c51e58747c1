/* constant_matrix.c - assembles the matrix as a list of entries, and decides when to factor
 * it again; the decisions are listed in constant_matrix.h. */
#include "constant_matrix.h"

#include <math.h>
#include <string.h>

/* The arrays that the factor is compared with; false if out of memory. */
static bool alloc_arrays(struct constant_matrix *matrix) {
    const struct cs_host *host = matrix->host;
    const size_t vector = sizeof(double) * (size_t)host->view->n;
    return (matrix->drag = host->alloc(host->ctx, vector)) &&
           (matrix->drag_begin = host->alloc(host->ctx, vector)) &&
           (matrix->drag_end = host->alloc(host->ctx, vector)) &&
           (matrix->inv_mass = host->alloc(host->ctx, vector)) &&
           (matrix->springs =
                host->alloc(host->ctx, 2 * sizeof(double) * (size_t)host->view->n_springs));
}

enum cs_step constant_matrix_init(struct constant_matrix *matrix, const struct cs_host *host) {
    matrix->host = host;
    if (!alloc_arrays(matrix))
        return CS_STEP_FAIL;
    if (!cholmod_start(&matrix->common))
        return host->fail(host->ctx, "CHOLMOD does not start");
    matrix->started = true;
    matrix->common.print = 0;
    matrix->common.supernodal = CHOLMOD_SIMPLICIAL;
    // one fixed ordering: the best of several would depend on the build of the library
    matrix->common.nmethods = 1;
    matrix->common.method[0].ordering = CHOLMOD_AMD;
    return CS_STEP_OK;
}

void constant_matrix_restart(struct constant_matrix *matrix) {
    matrix->h = 0;
    // its elimination order too: results after a restart depend on nothing before it
    cholmod_free_factor(&matrix->factor, &matrix->common);
}

/* drag (n) in N s/m at t: minus the force on velocities of 1 m/s. ones, f: (3,n). */
static void read_drag(const struct constant_matrix *matrix, double t, const double *x,
                      const double *ones, double *f, double *drag) {
    const struct cs_host *host = matrix->host;
    host->force(host->ctx, t, x, ones, CS_PART_DRAG, f);
    for (size_t i = 0; i < host->view->n; i++)
        drag[i] = -f[i];
}

void constant_matrix_read_drag(struct constant_matrix *matrix, double t0, double t1,
                               const double *x, double *ones, double *f) {
    const size_t n = matrix->host->view->n;
    for (size_t i = 0; i < 3 * n; i++)
        ones[i] = 1;
    // the end first: the host's values are then those of the begin, where the steps start
    read_drag(matrix, t1, x, ones, f, matrix->drag_end);
    read_drag(matrix, t0, x, ones, f, matrix->drag_begin);
    matrix->begin = t0;
    matrix->end = t1;
    // between two advances drag changes only by an event, which a restart follows
    matrix->drag_changes =
        memcmp(matrix->drag_begin, matrix->drag_end, n * sizeof *matrix->drag_begin) != 0;
    memcpy(matrix->drag, matrix->drag_begin, n * sizeof *matrix->drag);
}

/* Sets drag to its value at t, the end of the step: it is implicit. */
static void follow_drag(struct constant_matrix *matrix, double t) {
    const double share = (t - matrix->begin) / (matrix->end - matrix->begin);
    for (size_t i = 0; i < matrix->host->view->n; i++)
        matrix->drag[i] =
            matrix->drag_begin[i] + (matrix->drag_end[i] - matrix->drag_begin[i]) * share;
}

/* Copies the springs' constants of now; true if the factor has others. */
static bool follow_springs(struct constant_matrix *matrix) {
    const struct cs_view *view = matrix->host->view;
    const size_t bytes = view->n_springs * sizeof(double);
    double *stiffness = matrix->springs, *damping = stiffness + view->n_springs;
    if (bytes == 0)
        return false;
    if (!memcmp(stiffness, view->stiffness, bytes) && !memcmp(damping, view->damping, bytes))
        return false;
    memcpy(stiffness, view->stiffness, bytes);
    memcpy(damping, view->damping, bytes);
    return true;
}

/* Copies the pins of now, which a commit may have changed; true if the factor has others. */
static bool follow_pins(struct constant_matrix *matrix) {
    const struct cs_view *view = matrix->host->view;
    const size_t bytes = view->n * sizeof *matrix->inv_mass;
    if (!memcmp(matrix->inv_mass, view->inv_mass, bytes))
        return false;
    memcpy(matrix->inv_mass, view->inv_mass, bytes);
    return true;
}

/* Appends an entry; entries in the same position are summed by CHOLMOD. */
static void add_entry(cholmod_triplet *list, size_t row, size_t column, double value) {
    ((int *)list->i)[list->nnz] = (int)row;
    ((int *)list->j)[list->nnz] = (int)column;
    ((double *)list->x)[list->nnz++] = value;
}

/* Lists the lower triangle of A: M + h drag on the diagonal, and h c + h^2 k of each spring
 * in the rows of its free ends. Pinned ends have zeros, so that the elimination order does not
 * depend on which particles are pinned when it is found: a resumed run finds it again. */
static void list_entries(const struct constant_matrix *matrix, double h,
                         cholmod_triplet *list) {
    const struct cs_view *view = matrix->host->view;
    for (size_t i = 0; i < view->n; i++)
        add_entry(list, i, i, view->mass[i] + h * matrix->drag[i]);
    for (size_t s = 0; s < view->n_springs; s++) {
        const size_t a = view->ends[2 * s], b = view->ends[2 * s + 1];
        const double weight = h * view->damping[s] + h * h * view->stiffness[s];
        const bool free_a = view->inv_mass[a] > 0, free_b = view->inv_mass[b] > 0;
        if (free_a)
            add_entry(list, a, a, weight);
        if (free_b)
            add_entry(list, b, b, weight);
        add_entry(list, a > b ? a : b, a > b ? b : a, free_a && free_b ? -weight : 0);
    }
}

/* A as a sparse matrix, which the caller frees; NULL if out of memory. */
static cholmod_sparse *assemble(struct constant_matrix *matrix, double h) {
    const struct cs_view *view = matrix->host->view;
    const size_t n = view->n, most = n + 3 * (size_t)view->n_springs;
    cholmod_triplet *list =
        cholmod_allocate_triplet(n, n, most, -1, CHOLMOD_REAL, &matrix->common);
    if (!list)
        return NULL;
    list_entries(matrix, h, list);
    cholmod_sparse *sparse = cholmod_triplet_to_sparse(list, most, &matrix->common);
    cholmod_free_triplet(&list, &matrix->common);
    return sparse;
}

/* Factors A for steps of h: ordering by AMD at the first time since a restart, then numbers. */
static enum cs_step factor(struct constant_matrix *matrix, double h) {
    const struct cs_host *host = matrix->host;
    matrix->h = 0;
    cholmod_sparse *sparse = assemble(matrix, h);
    if (sparse && !matrix->factor)
        matrix->factor = cholmod_analyze(sparse, &matrix->common);
    if (sparse && matrix->factor)
        cholmod_factorize(sparse, matrix->factor, &matrix->common);
    cholmod_free_sparse(&sparse, &matrix->common);
    if (matrix->common.status != CHOLMOD_OK)
        return host->fail(host->ctx,
                          "CHOLMOD cannot factor the matrix for steps of %g s (status %d: %s)",
                          h, matrix->common.status,
                          matrix->common.status == CHOLMOD_OUT_OF_MEMORY
                              ? "out of memory"
                              : "numbers out of the range of doubles");
    matrix->h = h;
    return CS_STEP_OK;
}

enum cs_step constant_matrix_prepare(struct constant_matrix *matrix, double t, double h) {
    const bool springs = follow_springs(matrix), others = follow_pins(matrix) || springs;
    if (matrix->drag_changes)
        follow_drag(matrix, t + h);
    // the lengths of frames differ by rounding: decision 4
    if (!others && !matrix->drag_changes && fabs(h - matrix->h) <= 1e-9 * h)
        return CS_STEP_OK;
    return factor(matrix, h);
}

void constant_matrix_archive(struct constant_matrix *matrix, const struct cs_archive *archive) {
    const struct cs_view *view = matrix->host->view;
    archive->reals(archive->ctx, &matrix->h, 1);
    archive->reals(archive->ctx, matrix->drag, view->n);
    archive->reals(archive->ctx, matrix->inv_mass, view->n);
    archive->reals(archive->ctx, matrix->springs, 2 * (size_t)view->n_springs);
}

/* Where pins have changed since the factor was made, the next step makes another, with the drag
 * of then: pinned particles have none. */
enum cs_step constant_matrix_load(struct constant_matrix *matrix,
                                  const struct cs_archive *archive) {
    const struct cs_view *view = matrix->host->view;
    constant_matrix_archive(matrix, archive);
    return matrix->h > 0 &&
                   !memcmp(matrix->inv_mass, view->inv_mass, view->n * sizeof *view->inv_mass)
               ? factor(matrix, matrix->h)
               : CS_STEP_OK;
}

enum cs_step constant_matrix_solve(struct constant_matrix *matrix, double *b,
                                   const double **u) {
    const struct cs_host *host = matrix->host;
    const size_t n = host->view->n;
    cholmod_dense right = {.nrow = n,
                           .ncol = 4,
                           .nzmax = 4 * n,
                           .d = n,
                           .x = b,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
    if (!cholmod_solve2(CHOLMOD_A, matrix->factor, &right, NULL, &matrix->u, NULL, &matrix->y,
                        &matrix->solve_work, &matrix->common))
        return host->fail(host->ctx, "CHOLMOD cannot solve (status %d)", matrix->common.status);
    *u = matrix->u->x;
    return CS_STEP_OK;
}

void constant_matrix_finish(struct constant_matrix *matrix) {
    if (!matrix->started)
        return;
    cholmod_free_dense(&matrix->u, &matrix->common);
    cholmod_free_dense(&matrix->y, &matrix->common);
    cholmod_free_dense(&matrix->solve_work, &matrix->common);
    cholmod_free_factor(&matrix->factor, &matrix->common);
    cholmod_finish(&matrix->common);
    matrix->started = false;
}
