/* The linear solver with multigrid against a sparse Cholesky factor (CHOLMOD) of a matrix that
 * is assembled from the equations, spring by spring. */
#include "crumple.h"
#include "scene/force_keys.h"

#include <suitesparse/cholmod.h>

struct matrix {
    const struct crumple *crumple;
    cholmod_triplet *list;
};

static void add(struct matrix *matrix, size_t row, size_t column, double value) {
    cholmod_triplet *list = matrix->list;
    if (row < column)
        return; // the lower triangle
    ((int *)list->i)[list->nnz] = (int)row;
    ((int *)list->j)[list->nnz] = (int)column;
    ((double *)list->x)[list->nnz++] = value;
}

/* h^2 k ((1 - L/l) (I - u u^T) clamped to 0 + u u^T) + h d u u^T, at both ends' rows */
static void add_spring(struct matrix *matrix, const struct cs_spring_run *run, uint32_t i) {
    const struct sheet *sheet = &matrix->crumple->sheet;
    const double h = CRUMPLE_H_STEP, *x = sheet->x;
    const size_t n = sheet->n, a = cs_spring_a(run, i), b = cs_spring_b(run, i);
    const bool free_a = sheet->system.inv_mass[a] > 0, free_b = sheet->system.inv_mass[b] > 0;
    const double d[3] = {x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]};
    const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const double k = h * h * cs_spring_stiffness(run, i);
    const double across = fmax(0, k * (1 - cs_spring_length(run, i) / length));
    const double along = k + (run->axial ? h * run->damping : 0);
    ck_assert(run->axial);
    for (size_t c = 0; c < 3; c++)
        for (size_t e = 0; e < 3; e++) {
            const double value =
                (c == e ? across : 0) + (along - across) * d[c] * d[e] / (length * length);
            if (free_a)
                add(matrix, c * n + a, e * n + a, value);
            if (free_b)
                add(matrix, c * n + b, e * n + b, value);
            if (free_a && free_b) {
                add(matrix, c * n + a, e * n + b, -value);
                add(matrix, c * n + b, e * n + a, -value);
            }
        }
}

/* the solution, in memory of the caller */
static double *solve_direct(const struct crumple *crumple) {
    const struct sheet *sheet = &crumple->sheet;
    const size_t n3 = 3 * sheet->n;
    const struct cs_springs *springs = &sheet->system.springs;
    const double drag = CRUMPLE_H_STEP * sheet->scene.forces->drag;
    cholmod_common common;
    cholmod_start(&common);
    struct matrix matrix = {crumple,
                            cholmod_allocate_triplet(n3, n3, n3 + 36 * (size_t)springs->n, -1,
                                                     CHOLMOD_REAL, &common)};
    for (size_t i = 0; i < n3; i++)
        add(&matrix, i, i, sheet->system.mass[i % sheet->n] + drag);
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0; i < springs->runs[r].count; i++)
            add_spring(&matrix, springs->runs + r, i);
    cholmod_sparse *a = cholmod_triplet_to_sparse(matrix.list, 0, &common);
    cholmod_factor *factor = cholmod_analyze(a, &common);
    ck_assert(cholmod_factorize(a, factor, &common) && common.status == CHOLMOD_OK);
    cholmod_dense right = {n3, 1, n3, n3, crumple->b, NULL, CHOLMOD_REAL, CHOLMOD_DOUBLE};
    cholmod_dense *found = cholmod_solve(CHOLMOD_A, factor, &right, &common);
    double *u = memcpy(malloc(n3 * sizeof *u), found->x, n3 * sizeof *u);
    cholmod_free_dense(&found, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&a, &common);
    cholmod_free_triplet(&matrix.list, &common);
    cholmod_finish(&common);
    return u;
}

/* |u - v| / |v| by the masses */
static double distance(const struct crumple *crumple, const double *u, const double *v) {
    double left = 0, whole = 0;
    for (size_t i = 0; i < 3 * crumple->sheet.n; i++) {
        const double m = crumple->sheet.system.mass[i % crumple->sheet.n];
        left += m * (u[i] - v[i]) * (u[i] - v[i]);
        whole += m * v[i] * v[i];
    }
    return sqrt(left / whole);
}

#define GRID(pins)                                                                             \
    "{\"cloth\": {\"grid\": [33, 27]}, \"mass\": {\"particle\": %.17g}, \"springs\": "         \
    "{\"stretch\": %.17g, \"shear\": %.17g, \"bend\": %.17g, \"damping\": 1e-9}" pins "}"
#define MESH(shape, rest)                                                                      \
    "{\"mesh\": {\"shape\": " shape "}, \"mass\": {\"particle\": %.17g}, \"springs\": "        \
    "{\"stretch\": %.17g, \"bend\": %.17g, \"damping\": 1e-9}" rest "}"

/* a grid, free and pinned, a closed mesh, a network, and several bodies */
static void open_case(struct crumple *crumple, int kind, double m, double k) {
    struct sheet *sheet = &crumple->sheet;
    if (kind == 0)
        sheet_open(sheet, CS_NEED_SOLVE, "{\"bodies\": [" GRID("") "]}", m, k, k / 3, k / 9);
    else if (kind == 1)
        sheet_open(sheet, CS_NEED_SOLVE,
                   "{\"bodies\": [" GRID(", \"pins\": [\"top\", 400, 401, 402, 500]") "]}", m,
                   k, k / 3, k / 9);
    else if (kind == 2)
        sheet_open(sheet, CS_NEED_SOLVE,
                   "{\"bodies\": [" MESH("\"sphere\", \"detail\": 9", "") "]}", m, k, k / 5);
    else if (kind == 3)
        sheet_open(sheet, CS_NEED_SOLVE,
                   "{\"bodies\": [" MESH("\"limbs\", \"detail\": 20",
                                         ", \"network\": {\"springs\": 2}") "]}",
                   m, k, k / 5);
    else
        sheet_open(sheet, CS_NEED_SOLVE,
                   "{\"bodies\": [" MESH("\"sphere\", \"detail\": 3", "") ", " GRID(
                       ", \"pins\": [\"bottom-left\"]") ", " GRID("") "]}",
                   m, k, k / 5, m, k, k / 3, k / 9, m, k / 10, k / 30, 0.0);
    crumple_start(crumple, 0.02);
}

TEST(solution_is_the_direct_one) {
    static const double masses[] = {1e-4, 1e-9}, stiffness[] = {1e2, 1e5, 1e8};
    for (int kind = 0; kind < 5; kind++)
        for (int row = 0; row < 6; row++) {
            struct crumple crumple;
            const double m = masses[row % 2], k = stiffness[row / 2];
            open_case(&crumple, kind, m, k);
            ck_assert(crumple_setup(&crumple, true) && crumple.linear.stiff);
            double *expected = solve_direct(&crumple);
            ck_assert_int_eq(crumple_solve(&crumple, 1e-9), CS_LINEAR_DONE);
            const double off = distance(&crumple, crumple.u, expected);
            // to what double precision has left of a translation, which costs m of h^2 k
            const double h = CRUMPLE_H_STEP;
            ck_assert_msg(off <= 1e-9 + 2e-15 * h * h * k / m, "case %d, m %g, k %g: off %g",
                          kind, m, k, off);
            free(expected);
            crumple_shut(&crumple);
        }
}
