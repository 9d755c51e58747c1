/* Spring runs against the definition of the 12 neighbours, and their kernels against a loop
 * over single springs. */
#include "model/spring/springs.h"
#include "sheet.h"

#define GRID                                                                                   \
    "{\"cloth\": {\"grid\": [%d, %d], \"size\": [3, 2]}, \"mass\": {\"total\": 1},"            \
    " \"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": 25, \"damping\": %s}}"
#define SCENE "{\"bodies\": [" GRID "]}"

/* rows of which a tile packs several, of one tile of particles, of a tile and one or two, of
 * several */
enum { N_GRIDS = 17 };
static const int grids[N_GRIDS][2] = {{1, 1},   {2, 1},  {1, 2},  {2, 2},  {3, 2},  {1, 5},
                                      {4, 1},   {7, 5},  {3, 4},  {64, 4}, {65, 5}, {66, 3},
                                      {300, 3}, {16, 9}, {24, 7}, {25, 6}, {5, 40}};

/* What a body's springs are by definition: particles (row, column) and (row + down,
 * column + right) are joined for these six steps and no other. */
static const struct {
    int right, down;
    uint32_t kind;
    double stiffness;
} steps[6] = {{1, 0, CS_SPRING_STRETCH, 200}, {0, 1, CS_SPRING_STRETCH, 200},
              {1, 1, CS_SPRING_SHEAR, 75},    {-1, 1, CS_SPRING_SHEAR, 75},
              {2, 0, CS_SPRING_BEND, 25},     {0, 2, CS_SPRING_BEND, 25}};

/* which of the six steps leads from particle a to b, or 6 */
static int step_between(uint32_t a, uint32_t b, int columns) {
    const int down = (int)b / columns - (int)a / columns;
    const int right = (int)b % columns - (int)a % columns;
    int d = 0;
    while (d < 6 && (steps[d].right != right || steps[d].down != down))
        d++;
    return d;
}

static int count_by_definition(int columns, int rows) {
    int count = 0;
    for (int a = 0; a < columns * rows; a++)
        for (int d = 0; d < 6; d++) {
            const int right = a % columns + steps[d].right, down = a / columns + steps[d].down;
            count += right >= 0 && right < columns && down < rows;
        }
    return count;
}

/* as many as there should be, each one of the six steps, none twice: so all are there */
TEST(runs_are_the_twelve_neighbours) {
    for (size_t g = 0; g < N_GRIDS; g++) {
        const int columns = grids[g][0], rows = grids[g][1];
        struct sheet sheet;
        sheet_open(&sheet, 0, SCENE, columns, rows, "0");
        const struct cs_springs *springs = &sheet.system.springs;
        ck_assert_uint_eq(springs->n, count_by_definition(columns, rows));
        uint8_t *seen = calloc(sheet.n, 6);
        ck_assert_ptr_nonnull(seen);
        uint32_t next = 0;
        for (uint32_t r = 0; r < springs->n_runs; r++) {
            const struct cs_spring_run *run = springs->runs + r;
            ck_assert_uint_eq(run->first, next);
            ck_assert_uint_gt(run->count, 0);
            next += run->count;
            for (uint32_t i = 0; i < run->count; i++) {
                const int d = step_between(run->first_a + i, run->first_b + i, columns);
                ck_assert_int_lt(d, 6);
                ck_assert_uint_eq(seen[6 * (run->first_a + i) + (uint32_t)d]++, 0);
                ck_assert_uint_eq(run->kind, steps[d].kind);
                ck_assert_double_eq(run->stiffness, steps[d].stiffness);
                const double across = columns > 1 ? 3.0 / (columns - 1) * steps[d].right : 0;
                const double along = rows > 1 ? 2.0 / (rows - 1) * steps[d].down : 0;
                ck_assert_double_eq_tol(run->length, sqrt(across * across + along * along),
                                        1e-15);
            }
        }
        ck_assert_uint_eq(next, springs->n);
        free(seen);
        sheet_close(&sheet);
    }
}

TEST(second_body_has_its_own_particles) {
    struct sheet sheet;
    sheet_open(&sheet, 0, "{\"bodies\": [" GRID ", " GRID "]}", 3, 2, "0", 2, 2, "0.5");
    const struct cs_springs *springs = &sheet.system.springs;
    const uint32_t first = (uint32_t)count_by_definition(3, 2);
    ck_assert_uint_eq(springs->n, first + (uint32_t)count_by_definition(2, 2));
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const bool second = run->first >= first;
        ck_assert_uint_eq(run->body, second);
        ck_assert(second ? run->first_a >= 6 : run->first_b + run->count <= 6);
        ck_assert_double_eq(run->damping, second ? 0.5 : 0);
    }
    sheet_close(&sheet);
}

TEST(kinds_without_stiffness_have_no_springs) {
    struct sheet sheet;
    sheet_open(&sheet, 0,
               "{\"bodies\": [{\"cloth\": {\"grid\": [5, 4]}, \"mass\": {\"total\": 1},"
               " \"springs\": {\"stretch\": 0, \"shear\": 3, \"bend\": 0}}]}");
    ck_assert_uint_eq(sheet.system.springs.n, 2 * 4 * 3);
    for (uint32_t r = 0; r < sheet.system.springs.n_runs; r++)
        ck_assert_uint_eq(sheet.system.springs.runs[r].kind, CS_SPRING_SHEAR);
    sheet_close(&sheet);
}

/* a stiffness in N is divided by the rest length of each spring */
TEST(stiffness_in_newtons_is_by_length) {
    struct sheet sheet;
    sheet_open(&sheet, 0,
               "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"size\": [3, 2]}, \"mass\": "
               "{\"total\": 1}, \"springs\": {\"stiffness_unit\": \"N\", \"stretch\": 6,"
               " \"shear\": 6, \"bend\": 6}}]}");
    for (uint32_t r = 0; r < sheet.system.springs.n_runs; r++) {
        const struct cs_spring_run *run = sheet.system.springs.runs + r;
        ck_assert_double_eq_tol(run->stiffness * run->length, 6, 1e-14);
    }
    sheet_close(&sheet);
}

/* f += force of one spring, from the formula in springs.h */
static void add_spring(const struct sheet *sheet, const struct cs_spring_run *run, uint32_t i,
                       uint32_t parts, double *f) {
    const size_t n = sheet->n, a = run->first_a + i, b = run->first_b + i;
    double u[3], w[3], length = 0, along = 0;
    for (size_t c = 0; c < 3; c++) {
        u[c] = sheet->x[c * n + b] - sheet->x[c * n + a];
        w[c] = sheet->v[c * n + b] - sheet->v[c * n + a];
        length += u[c] * u[c];
    }
    length = sqrt(length);
    for (size_t c = 0; c < 3; c++) {
        u[c] /= length;
        along += w[c] * u[c];
    }
    static const uint32_t part_of[] = {CS_PART_STRETCH, CS_PART_SHEAR, CS_PART_BEND};
    const double pull =
        parts & part_of[run->kind] ? run->stiffness * (length - run->length) : 0;
    const double damping = parts & CS_PART_DAMPING ? run->damping : 0;
    for (size_t c = 0; c < 3; c++) {
        const double push = pull * u[c] + damping * (run->axial ? along * u[c] : w[c]);
        f[c * n + a] += push;
        f[c * n + b] -= push;
    }
}

/* every grid, both damping models and none, every kind of part alone and all */
TEST(force_is_the_sum_of_single_springs) {
    static const char *const dampings[] = {"0", "0.7, \"damping_model\": \"axial\"",
                                           "0.7, \"damping_model\": \"relative\""};
    static const uint32_t parts[] = {CS_PART_STRETCH, CS_PART_SHEAR,
                                     CS_PART_BEND,    CS_PART_DAMPING,
                                     CS_PART_GRAVITY, CS_PART_STRETCH | CS_PART_DAMPING,
                                     CS_PART_ALL};
    for (size_t g = 0; g < N_GRIDS; g++)
        for (size_t m = 0; m < 3; m++) {
            struct sheet sheet;
            sheet_open(&sheet, 0, SCENE, grids[g][0], grids[g][1], dampings[m]);
            sheet_stir(&sheet, 0.3, 2);
            const struct cs_springs *springs = &sheet.system.springs;
            const struct cs_block all = cs_springs_block(springs, (uint32_t)sheet.n, 0);
            double *found = calloc(sheet.n, 6 * sizeof *found);
            ck_assert_ptr_nonnull(found);
            double *expected = found + 3 * sheet.n;
            for (size_t p = 0; p < sizeof parts / sizeof *parts; p++) {
                memset(found, 0, 6 * sheet.n * sizeof *found);
                cs_springs_add_force(
                    springs, (uint32_t)sheet.n,
                    &(struct cs_eval){
                        .x = sheet.x, .v = sheet.v, .parts = parts[p], .block = &all},
                    found);
                for (uint32_t r = 0; r < springs->n_runs; r++)
                    for (uint32_t i = 0; i < springs->runs[r].count; i++)
                        add_spring(&sheet, springs->runs + r, i, parts[p], expected);
                for (size_t i = 0; i < 3 * sheet.n; i++)
                    ck_assert_double_eq_tol(found[i], expected[i], 1e-11);
            }
            free(found);
            sheet_close(&sheet);
        }
}

/* own blocks of one spring at both ends, from the formula in springs.h: minus
 * k (1 - L/l) I + k L/l u u^T of df/dx, and minus d u u^T or d I of df/dv */
static void add_own_blocks(const struct sheet *sheet, const struct cs_spring_run *run,
                           uint32_t i, double *kxx, double *dvv) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const size_t n = sheet->n, ends[2] = {run->first_a + i, run->first_b + i};
    double u[3], length = 0;
    for (size_t c = 0; c < 3; c++) {
        u[c] = sheet->x[c * n + ends[1]] - sheet->x[c * n + ends[0]];
        length += u[c] * u[c];
    }
    length = sqrt(length);
    for (size_t e = 0; e < 6; e++)
        for (size_t end = 0; end < 2; end++) {
            const double along = u[row[e]] * u[column[e]] / (length * length);
            const double same = row[e] == column[e], slack = 1 - run->length / length;
            kxx[e * n + ends[end]] -= run->stiffness * (slack * same + (1 - slack) * along);
            dvv[e * n + ends[end]] -= run->damping * (run->axial ? along : same);
        }
}

TEST(own_blocks_are_the_sum_of_single_springs) {
    static const char *const dampings[] = {"0", "0.7, \"damping_model\": \"axial\"",
                                           "0.7, \"damping_model\": \"relative\""};
    for (size_t g = 0; g < N_GRIDS; g++)
        for (size_t m = 0; m < 3; m++) {
            struct sheet sheet;
            sheet_open(&sheet, 0, SCENE, grids[g][0], grids[g][1], dampings[m]);
            sheet_stir(&sheet, 0.1, 0);
            const struct cs_springs *springs = &sheet.system.springs;
            double *found = calloc(sheet.n, 24 * sizeof *found);
            ck_assert_ptr_nonnull(found);
            double *expected = found + 12 * sheet.n;
            const struct cs_block all = cs_springs_block(springs, (uint32_t)sheet.n, 0);
            const struct cs_eval at = {.x = sheet.x,
                                       .v = sheet.v,
                                       .parts = CS_PART_DAMPED_SPRINGS,
                                       .dfdx_blocks = found,
                                       .dfdv_blocks = found + 6 * sheet.n,
                                       .block = &all};
            cs_springs_add_force(springs, (uint32_t)sheet.n, &at, NULL);
            cs_springs_finish_diagonal(springs, (uint32_t)sheet.n, &at);
            for (uint32_t r = 0; r < springs->n_runs; r++)
                for (uint32_t i = 0; i < springs->runs[r].count; i++)
                    add_own_blocks(&sheet, springs->runs + r, i, expected,
                                   expected + 6 * sheet.n);
            for (size_t i = 0; i < 12 * sheet.n; i++)
                ck_assert_double_eq_tol(found[i], expected[i], 1e-12 * (1 + fabs(expected[i])));
            free(found);
            sheet_close(&sheet);
        }
}

/* column i of the factored matrix, at particle i itself */
TEST(own_blocks_of_the_factors_are_those_of_the_product) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    for (size_t g = 0; g < N_GRIDS; g++) {
        struct sheet sheet;
        sheet_open(&sheet, 0, SCENE, grids[g][0], grids[g][1], "0.7");
        sheet_stir(&sheet, 0.1, 0);
        const struct cs_springs *springs = &sheet.system.springs;
        const size_t n = sheet.n;
        double *blocks = calloc(12 * n + springs->n_factors, sizeof *blocks);
        ck_assert_ptr_nonnull(blocks);
        double *unit = blocks + 6 * n, *y = unit + 3 * n, *factors = y + 3 * n;
        cs_springs_factor(
            springs, (uint32_t)n,
            &(struct cs_matrix){.x = sheet.x, .cd = -0.02, .ck = -4e-4, .psd = false}, factors);
        cs_springs_factor_diagonal(springs, (uint32_t)n, factors, sheet.x, blocks);
        for (size_t i = 0; i < n; i++)
            for (size_t e = 0; e < 6; e++) {
                unit[(size_t)column[e] * n + i] = 1;
                memset(y, 0, 3 * n * sizeof *y);
                cs_springs_mul_add(springs, (uint32_t)n, factors, sheet.x, unit, y);
                ck_assert_double_eq_tol(blocks[e * n + i], y[(size_t)row[e] * n + i], 1e-14);
                unit[(size_t)column[e] * n + i] = 0;
            }
        free(blocks);
        sheet_close(&sheet);
    }
}

/* w stored, or found from x as in large grids: products and diagonals are equal to the bit, and
 * no factor that they need is left out */
TEST(products_with_w_stored_and_found_are_equal) {
    for (size_t g = 0; g < N_GRIDS; g++) {
        struct sheet sheet;
        sheet_open(&sheet, 0, SCENE, grids[g][0], grids[g][1], "0.7");
        sheet_stir(&sheet, 0.1, 1);
        const struct cs_springs *springs = &sheet.system.springs;
        const struct cs_matrix matrix = {.x = sheet.x, .cd = -0.02, .ck = -4e-4, .psd = true};
        const uint32_t n = (uint32_t)sheet.n;
        double *made[2], *factors = calloc(springs->n_factors + 1, sizeof *factors);
        for (uint32_t k = 0; k < 2; k++) {
            made[k] = calloc(n, 9 * sizeof *made[k]);
            for (uint32_t r = 0; r < springs->n_runs; r++)
                ((struct cs_spring_run *)springs->runs)[r].factor_rows = k ? 2 : 4;
            for (size_t i = 0; i < springs->n_factors; i++)
                factors[i] = (double)NAN;
            cs_springs_factor(springs, n, &matrix, factors);
            cs_springs_mul_add(springs, n, factors, sheet.x, sheet.v, made[k]);
            cs_springs_factor_diagonal(springs, n, factors, sheet.x, made[k] + 3 * sheet.n);
        }
        ck_assert_mem_eq(made[0], made[1], 9 * sheet.n * sizeof *made[0]);
        ck_assert(n < 3 || made[0][3 * sheet.n] > 0);
        for (size_t i = 0; i < 9 * sheet.n; i++)
            ck_assert_double_finite(made[0][i]);
        free(made[0]), free(made[1]), free(factors);
        sheet_close(&sheet);
    }
}

TEST(force_is_added_to_what_is_there) {
    struct sheet pair;
    double f[6] = {1, 2, 3, 4, 5, 6};
    sheet_open(&pair, 0, SCENE, 2, 1, "0");
    const struct cs_block all = cs_springs_block(&pair.system.springs, 2, 0);
    sheet_put(&pair, 1, pair.x[0], pair.x[2] + 3.5, pair.x[4], 0, 0, 0);
    cs_springs_add_force(
        &pair.system.springs, 2,
        &(struct cs_eval){.x = pair.x, .v = pair.v, .parts = CS_PART_ALL, .block = &all}, f);
    SHEET_ASSERT_AT(&pair, f, 0, 1, 3 + 200 * 0.5, 5, 1e-12);
    SHEET_ASSERT_AT(&pair, f, 1, 2, 4 - 200 * 0.5, 6, 1e-12);
    sheet_close(&pair);
}

/* two particles in one place have no direction: no force, and nothing that is not finite */
TEST(particles_in_one_place_feel_no_spring) {
    struct sheet pair;
    double f[6] = {0}, df[6] = {0};
    sheet_open(&pair, 0, SCENE, 2, 1, "0.7");
    const struct cs_block all = cs_springs_block(&pair.system.springs, 2, 0);
    sheet_put(&pair, 0, 1, 2, 3, 1, 0, 0);
    sheet_put(&pair, 1, 1, 2, 3, -1, 0, 0);
    cs_springs_add_force(
        &pair.system.springs, 2,
        &(struct cs_eval){.x = pair.x, .v = pair.v, .parts = CS_PART_ALL, .block = &all}, f);
    cs_springs_add_jvp(
        &pair.system.springs, 2,
        &(struct cs_eval){
            .x = pair.x, .v = pair.v, .parts = CS_PART_DAMPING, .dv = pair.v, .block = &all},
        df);
    for (size_t i = 0; i < 6; i++) {
        ck_assert_double_eq(f[i], 0);
        ck_assert_double_finite(df[i]);
    }
    ck_assert_double_eq(cs_springs_energy(&pair.system.springs, 2, pair.x, CS_PART_ALL),
                        0.5 * 200 * 9);
    sheet_close(&pair);
}

/* 1/2 k (l - L)^2 of each spring, by part */
TEST(energy_is_the_sum_of_single_springs) {
    struct sheet sheet;
    sheet_open(&sheet, 0, SCENE, 7, 5, "0");
    ck_assert_double_eq_tol(
        cs_springs_energy(&sheet.system.springs, 35, sheet.x, CS_PART_SPRINGS), 0, 1e-28);
    sheet_stir(&sheet, 0.3, 0);
    double expected[CS_SPRING_KINDS] = {0};
    for (uint32_t r = 0; r < sheet.system.springs.n_runs; r++) {
        const struct cs_spring_run *run = sheet.system.springs.runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            double squared = 0;
            for (size_t c = 0; c < 3; c++) {
                const double d =
                    sheet.x[c * 35 + run->first_b + i] - sheet.x[c * 35 + run->first_a + i];
                squared += d * d;
            }
            expected[run->kind] += 0.5 * run->stiffness * pow(sqrt(squared) - run->length, 2);
        }
    }
    for (uint32_t kind = 0; kind < CS_SPRING_KINDS; kind++)
        ck_assert_double_eq_tol(cs_springs_energy(&sheet.system.springs, 35, sheet.x,
                                                  (uint32_t)CS_PART_STRETCH << kind),
                                expected[kind], 1e-12);
    ck_assert_double_eq_tol(cs_springs_energy(&sheet.system.springs, 35, sheet.x, CS_PART_ALL),
                            expected[0] + expected[1] + expected[2], 1e-12);
    sheet_close(&sheet);
}

/* in magnitude, of springs whose ends are numbers */
static double largest_strain(const struct sheet *sheet) {
    const struct cs_springs *springs = &sheet->system.springs;
    double largest = 0;
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0; i < springs->runs[r].count; i++) {
            const struct cs_spring_run *run = springs->runs + r;
            double squared = 0;
            for (size_t c = 0; c < 3; c++) {
                const double *x = sheet->x + c * sheet->n;
                const double d = x[cs_spring_b(run, i)] - x[cs_spring_a(run, i)];
                squared += d * d;
            }
            largest = fmax(largest, fabs(sqrt(squared) / cs_spring_length(run, i) - 1));
        }
    return largest;
}

TEST(largest_strain_is_that_of_single_springs) {
    double most = 0;
    for (size_t g = 0; g < N_GRIDS; g++) {
        struct sheet sheet;
        sheet_open(&sheet, 0, SCENE, grids[g][0], grids[g][1], "0");
        for (int k = 0; k < 3; k++) {
            const double found =
                cs_springs_largest_strain(&sheet.system.springs, (uint32_t)sheet.n, sheet.x);
            ck_assert_double_eq(found, largest_strain(&sheet));
            most = fmax(most, found);
            sheet_stir(&sheet, 0.1, 0);
            if (k == 1)
                sheet.x[sheet.n / 2] = (double)NAN;
        }
        sheet_close(&sheet);
    }
    ck_assert_double_gt(most, 0.1);
}
