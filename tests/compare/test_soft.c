/* The rows of soft-bench: growth and rates of rows whose law is known, and what is written. */
#include "../suite.h"
#include "soft/soft.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* three networks whose step takes 2e-9 springs^1.5 s */
static struct cs_soft power_law(void) {
    struct cs_soft soft = {.draw = true, .n = 4};
    static const uint32_t springs[] = {100, 400, 10000};
    for (uint32_t k = 0; k < 3; k++)
        soft.rows[k] = (struct cs_soft_row){
            CS_SOFT_LARGE, 50, springs[k], 8, 2e-9 * springs[k] * sqrt(springs[k]), 0.01, 0};
    /* a body that blew up in its first frame has no time, and is not counted */
    soft.rows[3] = (struct cs_soft_row){
        .series = CS_SOFT_LARGE, .vertices = 50, .springs = 7, .outcome = CS_NOT_FINITE};
    return soft;
}

TEST(growth_is_the_exponent) {
    const struct cs_soft soft = power_law();
    ck_assert_double_eq_tol(cs_soft_growth(&soft, CS_SOFT_LARGE), 1.5, 1e-12);
    ck_assert_double_nan(cs_soft_growth(&soft, CS_SOFT_SMALL));
}

TEST(rates_count_steps_and_pictures) {
    const struct cs_soft soft = power_law();
    const struct cs_soft_row *row = soft.rows + 2; /* 2 ms a step */
    ck_assert_double_eq_tol(cs_soft_rate_one_step(row), 1 / 0.012, 1e-9);
    ck_assert_double_eq_tol(cs_soft_rate(row), 1 / 0.026, 1e-9);
}

TEST(csv_says_what_blew_up) {
    const struct cs_soft soft = power_law();
    struct cs_text out = {0};
    cs_soft_print_csv(&soft, &out);
    const char *last = strstr(cs_text_get(&out), "springs-large,50,7");
    ck_assert_ptr_nonnull(last);
    ck_assert_str_eq(last, "springs-large,50,7,,,,,,,blew up: not finite\n");
    cs_text_finish(&out);
}
