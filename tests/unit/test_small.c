/* The symmetric 3x3 blocks of small.h. */
#include "unit.h"

#include <clothsim/small.h>
#include <string.h>

/* xx, xy, xz, yy, yz, zz: definite, indefinite, and both far from 1 */
static const double regular[][6] = {{4, 1, -2, 5, 0.5, 3},
                                    {0, 1, 0, 0, 0, -2},
                                    {4e-200, 1e-200, -2e-200, 5e-200, 0.5e-200, 3e-200},
                                    {4e99, 1e99, -2e99, 5e99, 0.5e99, 3e99}};

TEST(inverse_times_the_block_is_one) {
    for (size_t k = 0; k < sizeof regular / sizeof *regular; k++) {
        double inverse[6], any[6];
        ck_assert(cs_sym3_invert(regular[k], inverse));
        ck_assert(cs_sym3_is_regular(cs_sym3_invert_any(regular[k], any)));
        ck_assert_mem_eq(any, inverse, sizeof any);
        for (int c = 0; c < 3; c++) {
            const double unit[3] = {c == 0, c == 1, c == 2};
            double there[3], back[3];
            cs_sym3_mul(regular[k], unit, there);
            cs_sym3_mul(inverse, there, back);
            for (int d = 0; d < 3; d++)
                ck_assert_double_eq_tol(back[d], unit[d], 1e-15);
        }
    }
}

TEST(scaled_determinant_is_of_the_block_over_its_largest_entry) {
    double inverse[6];
    const double block[6] = {2, 0, 0, -4, 0, 1};
    ck_assert_double_eq(cs_sym3_invert_any(block, inverse), 0.5 * -1 * 0.25);
}

TEST(block_without_inverse_is_said_and_nothing_written) {
    const double nan = (double)NAN, inf = (double)INFINITY;
    const double singular[][6] = {{0, 0, 0, 0, 0, 0},     {1, 2, 3, 4, 6, 9},
                                  {1, 0, 0, 1e-31, 0, 1}, {1, 0, 0, 1, 0, nan},
                                  {1, nan, 0, 1, 0, 1},   {inf, 0, 0, 1, 0, 1},
                                  {1, 0, 0, -inf, 0, 1}};
    for (size_t k = 0; k < sizeof singular / sizeof *singular; k++) {
        double inverse[6] = {7, 7, 7, 7, 7, 7}, any[6];
        ck_assert(!cs_sym3_invert(singular[k], inverse));
        ck_assert(!cs_sym3_is_regular(cs_sym3_invert_any(singular[k], any)));
        for (int c = 0; c < 6; c++)
            ck_assert_double_eq(inverse[c], 7);
    }
}

TEST(block_may_be_inverted_in_place) {
    double block[6], inverse[6];
    memcpy(block, regular[0], sizeof block);
    cs_sym3_invert(regular[0], inverse);
    cs_sym3_invert_any(block, block);
    ck_assert_mem_eq(block, inverse, sizeof block);
}
