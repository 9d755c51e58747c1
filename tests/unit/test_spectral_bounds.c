/* The bounds of frequency and damping: exact for a pair, never below the truth for a sheet. */
#include "model/force/terms.h"
#include "sheet.h"

/* two free particles: w^2 = 2 k / m, and half the rate of relative damping is d / m */
TEST(pair_has_its_own_frequency) {
    struct sheet pair;
    sheet_open(&pair, 0,
               "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": 0.5},"
               " \"springs\": {\"stretch\": 25, \"damping\": 0.6}}],"
               " \"forces\": {\"drag\": 0.2}}");
    ck_assert_double_eq_tol(pair.system.view.omega, 10, 1e-14);
    ck_assert_double_eq_tol(pair.system.view.delta, (0.6 + 0.1) / 0.5, 1e-14);
    sheet_close(&pair);
}

TEST(nothing_swings_without_springs) {
    struct sheet sheet;
    sheet_open(&sheet, 0,
               "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3]}, \"mass\": {\"total\": 1},"
               " \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}}]}");
    ck_assert_double_eq(sheet.system.view.omega, 0);
    ck_assert_double_eq(sheet.system.view.delta, 0);
    sheet_close(&sheet);
}

/* a pinned particle does not count, however many springs it has */
TEST(pins_do_not_swing) {
    struct sheet chain;
    sheet_open(&chain, 0,
               "{\"bodies\": [{\"cloth\": {\"grid\": [3, 1]}, \"mass\": {\"particle\": 0.5},"
               " \"springs\": {\"stretch\": 25, \"bend\": 0}, \"pins\": [1]}]}");
    ck_assert_double_eq_tol(chain.system.view.omega, 10, 1e-14);
    sheet_close(&chain);
}

/* drag by area, on masses that are not */
TEST(drag_by_area_counts) {
    struct sheet sheet;
    sheet_open(
        &sheet, 0,
        "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"size\": [2, 2]}, \"mass\": "
        "{\"particle\": 0.1}, \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}}],"
        " \"forces\": {\"drag\": 0.4, \"drag_unit\": \"Pa s/m\"}}");
    ck_assert_double_eq_tol(sheet.system.view.delta, 0.5 * 0.4 * 1 / 0.1, 1e-14);
    sheet_close(&sheet);
}

/* largest eigenvalue of -D df with D the inverse masses, by 300 power iterations */
static double largest_of(const struct sheet *sheet, bool velocity) {
    enum { N = 36 };
    double p[3 * N], df[3 * N], value = 0;
    for (size_t i = 0; i < 3 * N; i++)
        p[i] = sin(1.3 * (double)i + (double)(i % 5));
    for (int k = 0; k < 300; k++) {
        double norm = 0;
        cs_terms_jvp(&sheet->system,
                     &(struct cs_eval){.x = sheet->x,
                                       .v = sheet->v,
                                       .parts = CS_PART_LINEARISED,
                                       .dx = velocity ? NULL : p,
                                       .dv = velocity ? p : NULL},
                     df);
        for (size_t i = 0; i < 3 * N; i++) {
            df[i] *= -sheet->system.inv_mass[i % N];
            norm += df[i] * df[i];
        }
        value = sqrt(norm);
        for (size_t i = 0; i < 3 * N; i++)
            p[i] = df[i] / value;
    }
    return value;
}

/* at rest the bound is above the truth, by less than a factor of 1.7 in frequency */
TEST(sheet_stays_below_its_bounds) {
    static const char *const models[] = {"relative", "axial"};
    for (size_t m = 0; m < 2; m++) {
        struct sheet sheet;
        sheet_open(&sheet, 0,
                   "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"areal_density\":"
                   " 0.3}, \"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": 25,"
                   " \"damping\": 0.4, \"damping_model\": \"%s\"}, \"pins\": [0]}],"
                   " \"forces\": {\"drag\": 0.1}}",
                   models[m]);
        const double omega = sqrt(largest_of(&sheet, false));
        const double delta = largest_of(&sheet, true) / 2;
        ck_assert_double_lt(omega, sheet.system.view.omega);
        ck_assert_double_lt(delta, sheet.system.view.delta);
        ck_assert_double_gt(omega, 0.6 * sheet.system.view.omega);
        ck_assert_double_gt(delta, 0.3 * sheet.system.view.delta);
        sheet_close(&sheet);
    }
}
