/* The linear solver on 4 x 4 particles against a dense Cholesky factor. */
#include "model/solver/linear.h"
#include "sheet.h"

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"areal_density\": 0.4},"        \
    " \"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": 25, \"damping\": 0.7,"          \
    " \"damping_model\": \"%s\"}, \"pins\": [\"top-left\", 7]}], \"forces\": {\"drag\": 0.3}}"

enum { N = 16, ROWS = 3 * N };
#define H (1 / 60.0)

struct solver {
    struct sheet sheet;
    struct cs_arena arena;
    struct cs_linear linear;
};

static void start(struct solver *solver, const char *damping) {
    struct cs_error error = {0};
    sheet_open(&solver->sheet, CS_NEED_SOLVE, SCENE, damping);
    solver->arena = (struct cs_arena){0};
    cs_linear_init(&solver->linear, &solver->sheet.system, &solver->arena, &error);
    UNIT_ASSERT_OK(&error);
}

static void shut(struct solver *solver) {
    cs_arena_finish(&solver->arena);
    sheet_close(&solver->sheet);
}

static bool is_free(const struct solver *solver, size_t row) {
    return solver->sheet.system.inv_mass[row % N] > 0;
}

/* column by column from the product; the identity on pinned rows */
static void dense_of(const struct solver *solver, double a[ROWS][ROWS]) {
    for (size_t j = 0; j < ROWS; j++) {
        double unit[ROWS] = {0}, column[ROWS];
        unit[j] = is_free(solver, j);
        cs_linear_mul(&solver->linear, unit, column);
        for (size_t i = 0; i < ROWS; i++)
            a[i][j] = is_free(solver, j) ? column[i] : i == j;
    }
}

/* lower factor in place; false: not positive definite */
static bool factor(double a[ROWS][ROWS]) {
    for (size_t j = 0; j < ROWS; j++) {
        for (size_t k = 0; k < j; k++)
            a[j][j] -= a[j][k] * a[j][k];
        if (!(a[j][j] > 0))
            return false;
        a[j][j] = sqrt(a[j][j]);
        for (size_t i = j + 1; i < ROWS; i++) {
            for (size_t k = 0; k < j; k++)
                a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
    return true;
}

static void solve_dense(double a[ROWS][ROWS], double u[ROWS]) {
    for (size_t i = 0; i < ROWS; i++) {
        for (size_t k = 0; k < i; k++)
            u[i] -= a[i][k] * u[k];
        u[i] /= a[i][i];
    }
    for (size_t i = ROWS; i-- > 0;) {
        for (size_t k = i + 1; k < ROWS; k++)
            u[i] -= a[k][i] * u[k];
        u[i] /= a[i][i];
    }
}

static void fill_right(const struct solver *solver, double b[ROWS]) {
    for (size_t i = 0; i < ROWS; i++)
        b[i] = is_free(solver, i) ? sin(0.9 * (double)i) : 0;
}

/* |b - A u| / |b| over the free rows */
static double residual_of(const struct solver *solver, const double *b, const double *u) {
    double au[ROWS], left = 0, whole = 0;
    cs_linear_mul(&solver->linear, u, au);
    for (size_t i = 0; i < ROWS; i++) {
        left += (b[i] - au[i]) * (b[i] - au[i]);
        whole += b[i] * b[i];
    }
    return sqrt(left / whole);
}

TEST(matrix_is_symmetric_and_blind_to_pins) {
    static const char *const models[] = {"relative", "axial"};
    for (size_t k = 0; k < 2; k++) {
        struct solver solver;
        static double a[ROWS][ROWS];
        start(&solver, models[k]);
        sheet_stir(&solver.sheet, 0.1, 0);
        cs_linear_setup(
            &solver.linear,
            &(struct cs_matrix){
                .x = solver.sheet.x, .cm = 1, .cd = -H, .ck = -H * H, .psd = false});
        dense_of(&solver, a);
        for (size_t i = 0; i < ROWS; i++)
            for (size_t j = 0; j < ROWS; j++) {
                ck_assert_double_eq_tol(a[i][j], a[j][i], 1e-15);
                if (!is_free(&solver, i) || !is_free(&solver, j))
                    ck_assert_double_eq(a[i][j], i == j);
            }
        shut(&solver);
    }
}

/* from the start 0 and from a wild one, at several tolerances */
TEST(solution_is_that_of_a_dense_factor) {
    struct solver solver;
    static double a[ROWS][ROWS];
    double b[ROWS], expected[ROWS];
    start(&solver, "axial");
    sheet_stir(&solver.sheet, 0.1, 0);
    ck_assert(cs_linear_setup(
        &solver.linear,
        &(struct cs_matrix){
            .x = solver.sheet.x, .cm = 1, .cd = -H, .ck = -H * H, .psd = true}));
    dense_of(&solver, a);
    fill_right(&solver, b);
    memcpy(expected, b, sizeof b);
    ck_assert(factor(a));
    solve_dense(a, expected);
    for (int wild = 0; wild < 2; wild++)
        for (double rtol = 1e-2; rtol > 1e-13; rtol /= 100) {
            double u[ROWS], residual;
            uint64_t iterations;
            for (size_t i = 0; i < ROWS; i++)
                u[i] = wild * 50 * cos((double)i); // on pinned rows too
            ck_assert_int_eq(
                cs_linear_solve(&solver.linear, b, rtol, u, &iterations, &residual),
                CS_LINEAR_DONE);
            ck_assert_double_le(residual, rtol);
            // what it calls the residual is one, up to the rounding of the recurrence
            ck_assert_double_eq_tol(residual_of(&solver, b, u), residual,
                                    1e-14 * (wild ? 1e4 : 1));
            ck_assert(iterations > 0 && iterations <= ROWS);
            for (size_t i = 0; i < ROWS; i++) {
                ck_assert_double_eq_tol(u[i], expected[i], 1e3 * rtol + 1e-10);
                ck_assert(is_free(&solver, i) || u[i] == 0);
            }
        }
    shut(&solver);
}

TEST(good_start_needs_no_iteration) {
    struct solver solver;
    double b[ROWS], u[ROWS] = {0}, residual;
    uint64_t iterations;
    start(&solver, "axial");
    cs_linear_setup(
        &solver.linear,
        &(struct cs_matrix){.x = solver.sheet.x, .cm = 1, .cd = -H, .ck = -H * H, .psd = true});
    fill_right(&solver, b);
    cs_linear_solve(&solver.linear, b, 1e-12, u, &iterations, &residual);
    cs_linear_solve(&solver.linear, b, 1e-10, u, &iterations, &residual);
    ck_assert_uint_eq(iterations, 0);

    // no right-hand side has the answer 0, whatever the start
    memset(b, 0, sizeof b);
    ck_assert_int_eq(cs_linear_solve(&solver.linear, b, 1e-10, u, &iterations, &residual),
                     CS_LINEAR_DONE);
    ck_assert_uint_eq(iterations, 0);
    ck_assert_double_eq(residual, 0);
    for (size_t row = 0; row < ROWS; row++)
        ck_assert_double_eq(u[row], 0);
    shut(&solver);
}

/* Without springs A is diagonal, and the preconditioner is its inverse: one iteration. */
TEST(diagonal_matrix_takes_one_iteration) {
    struct sheet sheet;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_linear linear;
    sheet_open(&sheet, CS_NEED_SOLVE,
               "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"areal_density\": "
               "0.4}, \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}}],"
               " \"forces\": {\"drag\": 0.3, \"drag_unit\": \"Pa s/m\"}}");
    cs_linear_init(&linear, &sheet.system, &arena, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert(cs_linear_setup(
        &linear,
        &(struct cs_matrix){.x = sheet.x, .cm = 2, .cd = -0.5, .ck = -9, .psd = false}));
    double b[ROWS], u[ROWS] = {0}, residual;
    uint64_t iterations;
    for (size_t i = 0; i < ROWS; i++)
        b[i] = (double)i;
    cs_linear_solve(&linear, b, 1e-14, u, &iterations, &residual);
    ck_assert_uint_eq(iterations, 1);
    for (size_t i = 0; i < ROWS; i++)
        ck_assert_double_eq_tol(
            u[i], b[i] / (2 * sheet.system.mass[i % N] + 0.5 * 0.3 * sheet.system.area[i % N]),
            1e-12);
    cs_arena_finish(&arena);
    sheet_close(&sheet);
}

/* A sheet pressed to a third of its size: the exact matrix is indefinite, the clamped one is
 * positive definite. */
TEST(clamped_matrix_is_definite) {
    struct solver solver;
    static double a[ROWS][ROWS];
    start(&solver, "axial");
    for (size_t i = 0; i < ROWS; i++)
        solver.sheet.x[i] /= 3;
    cs_linear_setup(&solver.linear,
                    &(struct cs_matrix){
                        .x = solver.sheet.x, .cm = 1, .cd = -H, .ck = -H * H, .psd = false});
    dense_of(&solver, a);
    ck_assert(!factor(a));
    ck_assert(cs_linear_setup(
        &solver.linear,
        &(struct cs_matrix){
            .x = solver.sheet.x, .cm = 1, .cd = -H, .ck = -H * H, .psd = true}));
    dense_of(&solver, a);
    ck_assert(factor(a));
    shut(&solver);
}

/* Two particles of 0.5 kg, k = 1 N/m, at half the rest length: across the spring the exact A is
 * ((m + a, -a), (-a, m + a)) with a = -|ck|, so that moving together costs m, moving apart
 * m + 2 a, and an own block has m + a. */
TEST(indefinite_matrix_is_found_out) {
    struct sheet pair;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_linear linear;
    sheet_open(&pair, CS_NEED_SOLVE,
               "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": 0.5},"
               " \"springs\": {\"stretch\": 1}}]}");
    cs_linear_init(&linear, &pair.system, &arena, &error);
    UNIT_ASSERT_OK(&error);
    sheet_put(&pair, 0, 0, 0, 0, 0, 0, 0);
    sheet_put(&pair, 1, 0.5, 0, 0, 0, 0, 0);
    const double together[6] = {0, 0, 1, 1, 0, 0}, apart[6] = {0, 0, 1, -1, 0, 0};
    double u[6] = {0}, residual;
    uint64_t iterations;

    // blocks of 0.2: the set-up is fine and the iteration finds out
    ck_assert(cs_linear_setup(
        &linear, &(struct cs_matrix){.x = pair.x, .cm = 1, .cd = 0, .ck = -0.3, .psd = false}));
    ck_assert_int_eq(cs_linear_solve(&linear, together, 1e-12, u, &iterations, &residual),
                     CS_LINEAR_DONE);
    SHEET_ASSERT_AT(&pair, u, 0, 0, 2, 0, 1e-14);
    memset(u, 0, sizeof u);
    ck_assert_int_eq(cs_linear_solve(&linear, apart, 1e-12, u, &iterations, &residual),
                     CS_LINEAR_INDEFINITE);

    // blocks of -0.1: the set-up finds out
    ck_assert(!cs_linear_setup(
        &linear, &(struct cs_matrix){.x = pair.x, .cm = 1, .cd = 0, .ck = -0.6, .psd = false}));

    // clamped there is no stiffness across, and k along
    ck_assert(cs_linear_setup(
        &linear, &(struct cs_matrix){.x = pair.x, .cm = 1, .cd = 0, .ck = -0.6, .psd = true}));
    memset(u, 0, sizeof u);
    ck_assert_int_eq(cs_linear_solve(&linear, apart, 1e-12, u, &iterations, &residual),
                     CS_LINEAR_DONE);
    SHEET_ASSERT_AT(&pair, u, 0, 0, 2, 0, 1e-14);
    const double pulled[6] = {1, -1};
    cs_linear_solve(&linear, pulled, 1e-12, u, &iterations, &residual);
    SHEET_ASSERT_AT(&pair, u, 0, 1 / (0.5 + 2 * 0.6), 0, 0, 1e-12);
    cs_arena_finish(&arena);
    sheet_close(&pair);
}

/* Numbers that are not finite count neither as converged nor as indefinite: in the right-hand
 * side, in the start, in the matrix; so does a right-hand side whose length overflows. */
TEST(what_is_not_finite_is_no_solution) {
    static const double bad[] = {(double)NAN, HUGE_VAL, -HUGE_VAL, 1e200};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        for (int where = 0; where < 3; where++) {
            struct solver solver;
            double b[ROWS], u[ROWS] = {0}, residual;
            uint64_t iterations;
            start(&solver, "axial");
            if (where == 2)
                solver.sheet.system.mass[5] = bad[k];
            cs_linear_setup(
                &solver.linear,
                &(struct cs_matrix){
                    .x = solver.sheet.x, .cm = 1, .cd = -H, .ck = -H * H, .psd = true});
            fill_right(&solver, b);
            if (where < 2)
                (where ? u : b)[5] = bad[k];
            const enum cs_linear_end end =
                cs_linear_solve(&solver.linear, b, 1e-6, u, &iterations, &residual);
            ck_assert_int_eq(end, CS_LINEAR_NOT_FINITE);
            ck_assert_double_eq(residual, 0);
            shut(&solver);
        }
}
