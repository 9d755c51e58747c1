/* A body that meets itself in the solver's levels: its pairs are springs there, and the solver
 * needs few iterations. */
#include "base/pool.h"
#include "crumple.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/force/terms.h"
#include "model/solver/extra_springs.h"

#include <clothsim/small.h>

/* A sheet folded into four layers, 0.9 ranges apart, that rub. */
struct folded {
    struct crumple crumple;
    struct cs_arena arena;
    double *x, *y; /* (3,n) */
};

#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d], \"size\": [1, 1]}, \"mass\": "             \
    "{\"areal_density\": 0.2}, \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 0.5, "  \
    "\"damping\": 0.01}, \"self_contact\": %s, \"friction\": %g%s}], \"contact\": "            \
    "{\"law\": \"force\", \"damping\": 0.0005, \"friction_speed\": 0.01}}"

enum { LAYERS = 4 };

static void fold(struct sheet *sheet, size_t r) {
    const double edge = 1 / ((double)r - 1), gap = 0.9 * 0.4 * edge;
    const size_t n = sheet->n, columns = r / LAYERS;
    for (size_t i = 0; i < n; i++) {
        const size_t layer = i % r / columns, along = i % r % columns;
        const double wave = sin(0.4 * (double)(i / r) + 2.1 * (double)layer);
        sheet->x[i] = edge * (double)(layer % 2 ? columns - 1 - along : along);
        sheet->x[2 * n + i] = gap * ((double)layer + 0.2 * wave);
        sheet->v[i] = 0.02 * sin(9 * sheet->x[n + i] + (double)layer);
        sheet->v[n + i] = 0.01 * cos(7 * sheet->x[i] + 2 * (double)layer);
    }
}

static void open_folded(struct folded *folded, size_t r, bool meets, double friction,
                        const char *more) {
    struct cs_error error = {0};
    struct crumple *crumple = &folded->crumple;
    uint32_t seed = 7;
    sheet_open(&crumple->sheet, CS_NEED_SOLVE, SHEET, (int)r, (int)r, meets ? "true" : "false",
               friction, more);
    crumple_start(crumple, 0);
    fold(&crumple->sheet, r);
    folded->arena = (struct cs_arena){0};
    const size_t n3 = 3 * crumple->sheet.n;
    folded->x = cs_arena_alloc_array(&folded->arena, n3, sizeof(double), &error);
    folded->y = cs_arena_alloc_array(&folded->arena, n3, sizeof(double), &error);
    UNIT_ASSERT_OK(&error);
    for (size_t i = 0; i < n3; i++)
        folded->x[i] =
            crumple->sheet.system.inv_mass[i % (n3 / 3)] > 0 ? crumple_random(&seed) : 0;
}

static void shut_folded(struct folded *folded) {
    cs_arena_finish(&folded->arena);
    crumple_shut(&folded->crumple);
}

/* a step of 4 ms */
static void set_up(struct folded *folded, bool psd) {
    const double h = 0.004;
    const struct sheet *sheet = &folded->crumple.sheet;
    const bool definite = cs_linear_setup(
        &folded->crumple.linear,
        &(struct cs_matrix){
            .x = sheet->x, .v = sheet->v, .cm = 1, .cd = -h, .ck = -h * h, .psd = psd});
    ck_assert(definite || !psd);
    ck_assert(folded->crumple.linear.stiff);
}

static uint64_t iterations_of(size_t r, bool meets, double friction) {
    struct folded folded;
    open_folded(&folded, r, meets, friction, "");
    set_up(&folded, true);
    ck_assert_int_eq(crumple_solve(&folded.crumple, 1e-6), CS_LINEAR_DONE);
    shut_folded(&folded);
    return folded.crumple.iterations;
}

/* 7 and 11 without contact. With their diagonal blocks alone pairs take 40 and 75. */
TEST(a_fold_takes_at_most_twice_the_iterations) {
    for (size_t r = 32; r <= 64; r *= 2) {
        const uint64_t apart = iterations_of(r, false, 0);
        for (double friction = 0; friction < 0.5; friction += 0.3) {
            const uint64_t met = iterations_of(r, true, friction);
            ck_assert_msg(met <= 2 * apart,
                          "r %zu, friction %g: %llu iterations, %llu without contact", r,
                          friction, (unsigned long long)met, (unsigned long long)apart);
        }
    }
}

/* --- several bodies --- */

#define BODY                                                                                   \
    "{\"cloth\": {\"grid\": [%d, %d], \"size\": [1, 1]}, \"mass\": "                           \
    "{\"areal_density\": 0.2}, \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 0.5, "  \
    "\"damping\": 0.01}, \"self_contact\": true, \"friction\": 0.3}"

/* Sheets of r x r particles, each 0.9 ranges above the last one, with waves. */
static void open_stack(struct crumple *crumple, size_t r, uint32_t n_sheets) {
    char text[16384], body[320];
    snprintf(body, sizeof body, BODY, (int)r, (int)r);
    int at = snprintf(text, sizeof text,
                      "{\"pairs\": {\"among\": \"all\", \"friction\": 0.3}, "
                      "\"contact\": {\"law\": \"force\"}, \"bodies\": [");
    for (uint32_t k = 0; k < n_sheets; k++)
        at += snprintf(text + at, sizeof text - (size_t)at, "%s%s", k ? ", " : "", body);
    snprintf(text + at, sizeof text - (size_t)at, "]}");
    sheet_open(&crumple->sheet, CS_NEED_SOLVE, "%s", text);
    crumple_start(crumple, 0);
    const double edge = 1 / ((double)r - 1), gap = 0.9 * 0.4 * edge;
    const size_t n = crumple->sheet.n;
    for (size_t i = 0; i < n; i++) {
        const size_t layer = i / (r * r), row = i / r % r;
        const double wave = sin(0.4 * (double)row + 2.1 * (double)layer);
        crumple->sheet.x[i] += 0.3 * edge * (double)(layer % 2);
        crumple->sheet.x[2 * n + i] = gap * ((double)layer + 0.2 * wave);
        crumple->sheet.v[i] = 0.02 * sin(9 * crumple->sheet.x[n + i] + (double)layer);
    }
}

static bool set_up_stack_for(struct crumple *crumple, double h) {
    const struct sheet *sheet = &crumple->sheet;
    return cs_linear_setup(
        &crumple->linear,
        &(struct cs_matrix){
            .x = sheet->x, .v = sheet->v, .cm = 1, .cd = -h, .ck = -h * h, .psd = true});
}

static bool set_up_stack(struct crumple *crumple) {
    return set_up_stack_for(crumple, 0.004);
}

/* In a step of 1 ms that is short against springs, stiff contact of two sheets has the levels
 * all the same; one sheet has blocks, and so has contact in a step of 0.1 ms. */
TEST(stiff_contact_has_levels_in_short_steps) {
    for (uint32_t n_sheets = 1; n_sheets <= 2; n_sheets++)
        for (int tenths = 1; tenths <= 10; tenths += 9) {
            struct crumple crumple;
            open_stack(&crumple, 32, n_sheets);
            ck_assert(set_up_stack_for(&crumple, 1e-4 * tenths));
            ck_assert_double_le(crumple.linear.stiffness, CS_LINEAR_STIFF);
            ck_assert_int_eq(crumple.linear.stiff, n_sheets == 2 && tenths == 10);
            ck_assert_int_eq(crumple_solve(&crumple, 1e-6), CS_LINEAR_DONE);
            crumple_shut(&crumple);
        }
}

/* One sheet takes 5 iterations, two take 9 and four 12. With diagonal blocks between bodies two
 * took 49. */
TEST(bodies_take_few_iterations_more_than_one) {
    uint64_t one = 0;
    for (uint32_t n_sheets = 1; n_sheets <= 4; n_sheets *= 2) {
        struct crumple crumple;
        open_stack(&crumple, 32, n_sheets);
        ck_assert(set_up_stack(&crumple) && crumple.linear.stiff);
        ck_assert_int_eq(crumple_solve(&crumple, 1e-6), CS_LINEAR_DONE);
        one = n_sheets == 1 ? crumple.iterations : one;
        ck_assert_msg(crumple.iterations <= one + 3 * (uint64_t)n_sheets,
                      "%u sheets: %llu iterations, one: %llu", n_sheets,
                      (unsigned long long)crumple.iterations, (unsigned long long)one);
        crumple_shut(&crumple);
    }
}

/* z.r' = z'.r and z.r > 0, with a last level that is solved exactly (4 bodies) and one that is
 * smoothed (40), and with the same bits by any number of threads. */
static void check_stack(size_t r, uint32_t n_sheets, bool solved) {
    struct cs_error error = {0};
    double *alone = NULL;
    for (uint32_t threads = 1; threads <= 3; threads++) {
        struct crumple crumple;
        ck_assert_int_eq(cs_pool_start(threads, &error), CS_OK);
        open_stack(&crumple, r, n_sheets);
        ck_assert(set_up_stack(&crumple) && crumple.linear.stiff);
        ck_assert_int_eq(crumple.linear.multigrid.coarsest.n > 0, solved);
        const size_t n3 = 3 * crumple.sheet.n;
        double *z = calloc(n3, sizeof *z), *y = calloc(n3, sizeof *y),
               *b = calloc(n3, sizeof *b);
        uint32_t seed = 3;
        for (size_t i = 0; i < n3; i++)
            b[i] = crumple_random(&seed);
        cs_linear_precondition(&crumple.linear, b, 1, z);
        cs_linear_precondition(&crumple.linear, crumple.b, 1, y);
        const double bz = cs_vector_dot(n3, b, z), yb = cs_vector_dot(n3, y, crumple.b);
        ck_assert(bz > 0 && yb > 0);
        ck_assert_double_le(fabs(cs_vector_dot(n3, b, y) - cs_vector_dot(n3, crumple.b, z)),
                            1e-5 * sqrt(bz * yb));
        if (alone)
            ck_assert_int_eq(memcmp(alone, z, n3 * sizeof *z), 0);
        free(alone);
        alone = z;
        free(y), free(b);
        crumple_shut(&crumple);
        cs_pool_stop();
    }
    free(alone);
}

TEST(a_cycle_of_bodies_is_symmetric_and_positive) {
    check_stack(27, 4, true);
}

TEST(many_bodies_have_no_exact_last_level) {
    check_stack(25, 40, false);
}

/* Ribbons below the size for multigrid in stiff steps: blocks begin, and levels end the solve.
 * A second solve repeats the first to the bit. */
TEST(levels_in_reserve_end_slow_solves) {
    struct crumple crumple;
    open_stack(&crumple, 20, 2);
    ck_assert(set_up_stack(&crumple) && !crumple.linear.stiff);
    ck_assert(!cs_multigrid_is_used(&crumple.sheet.scene));
    const size_t bytes = 3 * crumple.sheet.n * sizeof(double);
    double *first = calloc(1, bytes);
    for (int k = 0; k < 2; k++) {
        memset(crumple.u, 0, bytes);
        ck_assert_int_eq(crumple_solve(&crumple, 1e-6), CS_LINEAR_DONE);
        ck_assert_uint_gt(crumple.iterations, CS_LINEAR_SLOW_ITERATIONS);
        ck_assert_uint_le(crumple.iterations, CS_LINEAR_SLOW_ITERATIONS + 15);
        ck_assert(!crumple.linear.stiff);
        if (k)
            ck_assert_int_eq(memcmp(first, crumple.u, bytes), 0);
        memcpy(first, crumple.u, bytes);
    }
    free(first);
    crumple_shut(&crumple);
}

/* --- the springs themselves --- */

static const struct cs_level *first_level(const struct folded *folded) {
    return folded->crumple.linear.multigrid.hierarchies->levels;
}

static bool is_alive(const struct folded *folded, size_t i) {
    const struct cs_level *level = first_level(folded);
    const size_t r = level->columns;
    return cs_level_is_alive(level, level->begin + i / r * level->pitch + i % r);
}

/* sum of B (x_i - x_j)^2 over the links of a level, of x given cell by cell, in N m */
static double energy_of_links(const struct folded *folded, const struct cs_level *level,
                              const double *x) {
    const size_t n = level->n;
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        const struct cs_extra_springs_slots slots =
            cs_extra_springs_of(level->extra_springs, i / CS_EXTRA_SPRINGS_LANES);
        for (size_t k = 0; k < slots.n; k++) {
            double d[3], block[6], force[3];
            const size_t lane = i % CS_EXTRA_SPRINGS_LANES;
            for (size_t c = 0; c < 3; c++)
                d[c] = x[c * n + i] - x[c * n + slots.cells[k * CS_EXTRA_SPRINGS_LANES + lane]];
            for (size_t c = 0; c < 6; c++)
                block[c] = (double)slots.springs[(6 * k + c) * CS_EXTRA_SPRINGS_LANES + lane];
            cs_sym3_mul(block, d, force);
            sum += d[0] * force[0] + d[1] * force[1] + d[2] * force[2];
        }
    }
    return sum / 2 * folded->crumple.linear.multigrid.scale;
}

/* x of particles to that of the first level's cells, then to the mean of each parent's */
static double *to_cells(const struct folded *folded, const double *x) {
    const struct cs_level *level = first_level(folded);
    const size_t n = folded->crumple.sheet.n, r = level->columns;
    double *cells = calloc(3 * (size_t)level->n, sizeof *cells);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            cells[c * level->n + level->begin + i / r * level->pitch + i % r] = x[c * n + i];
    return cells;
}

/* what pairs make of x: products without the diagonal blocks, and these */
static double energy_of_pairs(struct folded *folded, const double *x) {
    const struct sheet *sheet = &folded->crumple.sheet;
    const struct cs_pairs *pairs = sheet->system.pairs;
    const size_t n = sheet->n;
    double *blocks = calloc(6 * n, sizeof *blocks), sum = 0;
    memset(folded->y, 0, 3 * n * sizeof(double));
    cs_term_pairs.add_matrix_product(pairs->system, x, folded->y);
    cs_term_pairs.add_blocks(pairs->system, NULL, 0, n, blocks);
    for (size_t i = 0; i < n; i++) {
        double block[6], p[3], own[3];
        cs_sym3_read(n, blocks, i, block);
        cs_vec3_read(n, x, i, p);
        cs_sym3_mul(block, p, own);
        for (size_t c = 0; c < 3; c++)
            sum += p[c] * (own[c] + folded->y[c * n + i]);
    }
    free(blocks);
    return sum;
}

/* each layer moves as a whole */
static void move_layers(const struct folded *folded, bool alike, double *x) {
    const size_t n = folded->crumple.sheet.n, r = first_level(folded)->columns;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            x[c * n + i] = alike ? 1 : sin((double)(i % r / (r / LAYERS) + c));
}

static void compare(struct folded *folded, double least, double most) {
    double *cells = to_cells(folded, folded->x);
    const double links = energy_of_links(folded, first_level(folded), cells);
    const double pairs = energy_of_pairs(folded, folded->x);
    ck_assert_double_gt(pairs, 0);
    ck_assert_double_ge(links, least * pairs);
    ck_assert_double_le(links, most * pairs);
    free(cells);
}

/* but for bent gradients, whatever moves; and what moves alike costs nothing */
TEST(links_are_the_pairs) {
    struct folded folded;
    open_folded(&folded, 32, true, 0.3, "");
    set_up(&folded, true);
    compare(&folded, 0.99, 1.01);
    move_layers(&folded, false, folded.x);
    compare(&folded, 0.99, 1.01);
    move_layers(&folded, true, folded.x);
    double *cells = to_cells(&folded, folded.x);
    ck_assert_double_eq(energy_of_links(&folded, first_level(&folded), cells), 0);
    free(cells);
    shut_folded(&folded);
}

/* --- the cycle --- */

static void precondition(struct folded *folded, const double *r, double *z) {
    cs_linear_precondition(&folded->crumple.linear, r, 1, z);
}

/* z.r' = z'.r, and z.r > 0: what conjugate gradients need */
static void assert_symmetric_and_positive(struct folded *folded) {
    const size_t n3 = 3 * folded->crumple.sheet.n;
    const double *b = folded->crumple.b;
    double *z = folded->crumple.u;
    precondition(folded, b, z);
    precondition(folded, folded->x, folded->y);
    const double bz = cs_vector_dot(n3, b, z), xy = cs_vector_dot(n3, folded->x, folded->y);
    ck_assert_double_gt(bz, 0);
    ck_assert_double_gt(xy, 0);
    const double by = cs_vector_dot(n3, b, folded->y), xz = cs_vector_dot(n3, folded->x, z);
    ck_assert_double_le(fabs(by - xz), 1e-5 * sqrt(bz * xy));
}

/* the exact matrix has more in its diagonal than the links, and some of it is negative */
TEST(the_cycle_is_symmetric_and_positive) {
    struct folded folded;
    open_folded(&folded, 33, true, 0.3, ", \"pins\": [\"top\", 200]");
    set_up(&folded, true);
    assert_symmetric_and_positive(&folded);
    set_up(&folded, false);
    assert_symmetric_and_positive(&folded);
    for (size_t i = 0; i < folded.crumple.sheet.n; i++)
        ck_assert(!(folded.crumple.sheet.system.inv_mass[i] > 0) || is_alive(&folded, i));
    shut_folded(&folded);
}

TEST(threads_change_no_bit) {
    struct cs_error error = {0};
    double *alone = NULL;
    for (uint32_t threads = 1; threads <= 3; threads++) {
        struct folded folded;
        cs_pool_start(threads, &error);
        UNIT_ASSERT_OK(&error);
        open_folded(&folded, 48, true, 0.3, "");
        set_up(&folded, true);
        const size_t bytes = 3 * sizeof(double) * folded.crumple.sheet.n;
        alone = alone ? alone : calloc(1, bytes);
        precondition(&folded, folded.x, folded.y);
        if (threads == 1)
            memcpy(alone, folded.y, bytes);
        ck_assert_int_eq(memcmp(alone, folded.y, bytes), 0);
        shut_folded(&folded);
        cs_pool_stop();
    }
    free(alone);
}

/* what was loaded before does not stay */
TEST(a_matrix_without_pairs_in_range_has_no_links) {
    struct folded folded;
    open_folded(&folded, 32, true, 0.3, "");
    set_up(&folded, true);
    ck_assert(first_level(&folded)->extra_springs->is_nonempty);
    for (size_t i = 0, n = folded.crumple.sheet.n; i < n; i++)
        folded.crumple.sheet.x[2 * n + i] *= 100;
    set_up(&folded, true);
    ck_assert(!first_level(&folded)->extra_springs->is_nonempty);
    shut_folded(&folded);
}
