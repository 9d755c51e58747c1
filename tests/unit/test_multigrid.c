/* The solver with multigrid is right, and needs few iterations; test_level.c has the levels. */
#include "base/pool.h"
#include "crumple.h"

static double true_residual(struct crumple *crumple) {
    const size_t n3 = 3 * crumple->sheet.n;
    double *y = calloc(n3, sizeof *y);
    cs_linear_mul(&crumple->linear, crumple->u, y);
    cs_vector_kernels.linear_sum(n3, 1, crumple->b, -1, y, y);
    const double left = cs_vector_kernels.dot(n3, y, y);
    free(y);
    return sqrt(left / cs_vector_kernels.dot(n3, crumple->b, crumple->b));
}

/* what the recurrence calls the residual is one, whatever single precision does inside */
TEST(residual_is_the_true_one) {
    for (int kind = 0; kind < KINDS; kind++)
        for (double k = 1; k < 1e7; k *= 1e3) {
            struct crumple crumple;
            open_kind(&crumple, kind, k);
            crumple_setup(&crumple, true);
            for (double rtol = 1e-2; rtol > 1e-9; rtol /= 100) {
                ck_assert_int_eq(crumple_solve(&crumple, rtol), CS_LINEAR_DONE);
                ck_assert_double_le(crumple.residual, rtol);
                ck_assert_double_le(true_residual(&crumple), rtol * (1 + 1e-3));
            }
            crumple_shut(&crumple);
        }
}

/* Counts of iterations do not depend on the machine. At 64 x 64 the blocks of the diagonal
 * alone need 100 and more. */
TEST(few_iterations_at_any_stiffness_and_size) {
    static const struct {
        int r;
        double rtol;
        uint64_t most;
    } rows[] = {{32, 1e-3, 16}, {64, 1e-3, 16}, {128, 1e-3, 18}, {64, 1e-6, 24}};
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++)
        for (int pinned = 0; pinned < 2; pinned++)
            for (double k = 1e2; k < 1e9; k *= 100) {
                struct crumple crumple;
                const int r = rows[row].r;
                sheet_open(&crumple.sheet, CS_NEED_SOLVE, "{\"bodies\": [" CRUMPLE_GRID "]}",
                           CRUMPLE_GRID_VALUES(r, k, pinned ? CRUMPLE_PINS : ""));
                crumple_start(&crumple, 1.0 / r);
                crumple_setup(&crumple, true);
                ck_assert_int_eq(crumple_solve(&crumple, rows[row].rtol), CS_LINEAR_DONE);
                ck_assert_msg(crumple.iterations <= rows[row].most,
                              "r %d, k %g, pinned %d: %llu iterations to %g, expected %llu", r,
                              k, pinned, (unsigned long long)crumple.iterations, rows[row].rtol,
                              (unsigned long long)rows[row].most);
                crumple_shut(&crumple);
            }
}

TEST(few_iterations_on_meshes) {
    for (int detail = 12; detail <= 24; detail *= 2)
        for (double k = 1e2; k < 1e9; k *= 100) {
            struct crumple crumple;
            sheet_open(&crumple.sheet, CS_NEED_SOLVE, "{\"bodies\": [" SPHERE SPRINGS "]}",
                       detail, "", k, k);
            crumple_start(&crumple, 0.5 / detail);
            crumple_setup(&crumple, true);
            ck_assert_int_eq(crumple_solve(&crumple, 1e-3), CS_LINEAR_DONE);
            ck_assert_msg(crumple.iterations <= 16, "detail %d, k %g: %llu iterations", detail,
                          k, (unsigned long long)crumple.iterations);
            crumple_shut(&crumple);
        }
}

/* A flat sheet has its mass across and nothing else, which single precision cannot see beside
 * the stiffness along, wherever it lies. */
TEST(flat_sheets_are_solved) {
    for (double stretched = 0.9; stretched < 1.15; stretched += 0.1)
        for (double k = 1e4; k < 1e9; k *= 100) {
            struct crumple crumple;
            sheet_open(&crumple.sheet, CS_NEED_SOLVE,
                       "{\"bodies\": [{\"cloth\": {\"grid\": [64, 64], \"place\": {\"rotate\": "
                       "[0.3, 0.2, 0.1, 0.9]}}, \"mass\": {\"total\": 0.2}, \"springs\": "
                       "{\"stretch\": %.17g, \"shear\": %.17g, \"bend\": %.17g}}]}",
                       k, k / 3, k / 10);
            double *x = crumple.sheet.x;
            double *flat = malloc(3 * crumple.sheet.n * sizeof *flat);
            memcpy(flat, x, 3 * crumple.sheet.n * sizeof *flat);
            crumple_start(&crumple, 0);
            for (size_t i = 0; i < 3 * crumple.sheet.n; i++)
                x[i] = stretched * flat[i];
            crumple_setup(&crumple, true);
            ck_assert_int_eq(crumple_solve(&crumple, 1e-3), CS_LINEAR_DONE);
            ck_assert_uint_lt(crumple.iterations, CS_LINEAR_STALL_ITERATIONS);
            free(flat);
            crumple_shut(&crumple);
        }
}

/* masses from 1e-9 kg on in one system, with stiffness to fit and not */
TEST(range_of_single_precision_is_no_limit) {
    for (double heavy = 1e-9; heavy < 1e7; heavy *= 1e4)
        for (double k = 1e2; k < 1e9; k *= 1e3) {
            struct crumple crumple;
            sheet_open(
                &crumple.sheet, CS_NEED_SOLVE,
                "{\"bodies\": [{\"cloth\": {\"grid\": [30, 30]}, \"mass\": {\"particle\":"
                " 1e-9}, \"springs\": {\"stretch\": %.17g}, \"pins\": [3]},"
                " {\"cloth\": {\"grid\": [30, 30]}, \"mass\": {\"particle\": %.17g},"
                " \"springs\": {\"stretch\": 100, \"shear\": 3}}]}",
                k, heavy);
            crumple_start(&crumple, 0.02);
            crumple_setup(&crumple, true);
            ck_assert_int_eq(crumple_solve(&crumple, 1e-6), CS_LINEAR_DONE);
            ck_assert_double_le(true_residual(&crumple), 1.01e-6);
            crumple_shut(&crumple);
        }
}

/* A spread of masses inside one body that no preconditioner in single precision can do: the
 * solver gives up on it and is right all the same. */
TEST(blocks_take_over_where_precision_ends) {
    struct crumple crumple;
    sheet_open(&crumple.sheet, CS_NEED_SOLVE, "{\"bodies\": [" CRUMPLE_GRID "]}",
               CRUMPLE_GRID_VALUES(30, 1e3, ""));
    crumple_start(&crumple, 0.02);
    crumple_setup(&crumple, true);
    // as if there were no levels but wrong ones
    struct cs_level *level = crumple.linear.multigrid.hierarchies->levels;
    for (size_t i = 0; i < 6 * (size_t)level->n; i++)
        level->inverse[i] = -level->inverse[i];
    ck_assert_int_eq(crumple_solve(&crumple, 1e-6), CS_LINEAR_DONE);
    ck_assert(!crumple.linear.stiff);
    ck_assert_double_le(true_residual(&crumple), 1.01e-6);
    crumple_shut(&crumple);
}

/* Without clamping: a stretched sheet is definite and solved; a pressed one is found out. */
TEST(exact_matrix_is_solved_or_found_indefinite) {
    for (int pressed = 0; pressed < 2; pressed++) {
        struct crumple crumple;
        sheet_open(&crumple.sheet, CS_NEED_SOLVE, "{\"bodies\": [" CRUMPLE_GRID "]}",
                   CRUMPLE_GRID_VALUES(40, 1e4, ""));
        crumple_start(&crumple, 0.001);
        for (size_t i = 0; i < 3 * crumple.sheet.n; i++)
            crumple.sheet.x[i] *= pressed ? 0.95 : 1.3;
        const bool setup = crumple_setup(&crumple, false);
        const enum cs_linear_end end = crumple_solve(&crumple, 1e-6);
        if (pressed) {
            ck_assert(!setup || end == CS_LINEAR_INDEFINITE);
        } else {
            ck_assert(setup && end == CS_LINEAR_DONE && crumple.linear.stiff);
            ck_assert_double_le(true_residual(&crumple), 1.01e-6);
        }
        crumple_shut(&crumple);
    }
}

/* the rule of linear.h */
TEST(levels_are_used_where_they_pay) {
    static const struct {
        int r;
        double k;
        bool stiff;
    } rows[] = {{24, 1e6, false}, {25, 1e6, true}, {64, 0.1, false}, {64, 1, true}};
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++) {
        struct crumple crumple;
        sheet_open(&crumple.sheet, CS_NEED_SOLVE, "{\"bodies\": [" CRUMPLE_GRID "]}",
                   CRUMPLE_GRID_VALUES(rows[row].r, rows[row].k, ""));
        crumple_start(&crumple, 0.01);
        crumple_setup(&crumple, true);
        ck_assert_int_eq(crumple.linear.stiff, rows[row].stiff);
        ck_assert_int_eq(cs_multigrid_is_used(&crumple.sheet.scene), rows[row].r > 24);
        ck_assert_int_eq(crumple.linear.multigrid.n, rows[row].r > 24);
        crumple_shut(&crumple);
    }
}

TEST(threads_change_no_bit) {
    for (int kind = 0; kind < KINDS; kind++) {
        struct cs_error error = {0};
        double *alone = NULL;
        for (uint32_t threads = 1; threads <= 3; threads++) {
            struct crumple crumple;
            if (kind == 0)
                sheet_open(&crumple.sheet, CS_NEED_SOLVE, "{\"bodies\": [" CRUMPLE_GRID "]}",
                           CRUMPLE_GRID_VALUES(150, 1e4, CRUMPLE_PINS));
            if (kind == 0)
                crumple_start(&crumple, 0.01);
            else
                open_kind(&crumple, kind, 1e4);
            const size_t bytes = 3 * sizeof(double) * crumple.sheet.n;
            ck_assert_int_eq(cs_pool_start(threads, &error), CS_OK);
            crumple_setup(&crumple, true);
            ck_assert_int_eq(crumple_solve(&crumple, 1e-6), CS_LINEAR_DONE);
            cs_pool_stop();
            if (!alone)
                alone = memcpy(malloc(bytes), crumple.u, bytes);
            ck_assert_int_eq(memcmp(alone, crumple.u, bytes), 0);
            crumple_shut(&crumple);
        }
        free(alone);
    }
}
