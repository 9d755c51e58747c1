/* Vector kernels: exact values, every tail length, and the one order of sums. */
#include "base/pool.h"
#include "base/vector.h"
#include "unit.h"

#include <math.h>

enum { MOST = 3 * 4096 + 20, LANES = 8, BLOCK = 4096 };

/* lengths round lanes and blocks */
static const size_t lengths[] = {0,   1,  2,  3,  4,  5,    6,    7,    8,    9,
                                 15,  16, 17, 31, 40, 4095, 4096, 4097, 8192, 2 * 4096 + 7,
                                 MOST};
enum { LENGTHS = sizeof lengths / sizeof *lengths };

static const struct cs_vector_kernels *const kernels = &cs_vector_kernels;

/* whole numbers, whose sums are exact in any order */
TEST(sums_of_whole_numbers_are_exact) {
    static double x[MOST], y[MOST];
    for (size_t i = 0; i < MOST; i++) {
        x[i] = (double)(i % 101) - 50;
        y[i] = (double)(i % 97) - 30;
    }
    for (size_t k = 0; k < LENGTHS; k++) {
        int64_t dot = 0, square = 0;
        double largest = 0;
        for (size_t i = 0; i < lengths[k]; i++) {
            dot += (int64_t)(x[i] * y[i]);
            square += (int64_t)(x[i] * y[i] * x[i] * y[i]);
            largest = fmax(largest, fabs(x[i]));
        }
        ck_assert_double_eq(kernels->dot(lengths[k], x, y), (double)dot);
        ck_assert_double_eq(kernels->weighted_sum_of_squares(lengths[k], x, y), (double)square);
        ck_assert_double_eq(kernels->max_norm(lengths[k], x), largest);
    }
}

/* The published order: in blocks of 4096, lane l takes the terms l, l + 8, ...; the lanes are
 * added in pairs of distance 4, then 2, then 1, and the blocks one after the other. */
static double sum_in_order(const double *terms, size_t n) {
    double sum = 0;
    for (size_t start = 0; start < n; start += BLOCK) {
        double lanes[LANES] = {0};
        for (size_t i = start; i < n && i < start + BLOCK; i++)
            lanes[(i - start) % LANES] += terms[i];
        for (size_t half = LANES / 2; half > 0; half /= 2)
            for (size_t l = 0; l < half; l++)
                lanes[l] += lanes[l + half];
        sum += lanes[0];
    }
    return sum;
}

TEST(sums_have_one_order) {
    static double x[MOST], y[MOST], products[MOST], squares[MOST];
    uint64_t seed = 1;
    for (size_t i = 0; i < MOST; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        x[i] = (double)(seed >> 11) * 1e-10;
        y[i] = sin((double)i) * (i % 5 ? 1 : 1e6);
        products[i] = x[i] * y[i];
        squares[i] = products[i] * products[i];
    }
    for (size_t k = 0; k < LENGTHS; k++) {
        ck_assert_double_eq(kernels->dot(lengths[k], x, y), sum_in_order(products, lengths[k]));
        ck_assert_double_eq(kernels->weighted_sum_of_squares(lengths[k], x, y),
                            sum_in_order(squares, lengths[k]));
    }
}

/* z beside, on x, on y, and on both */
TEST(linear_sum_may_write_on_its_input) {
    double x[19], y[19], z[19];
    for (int alias = 0; alias < 4; alias++) {
        for (int i = 0; i < 19; i++)
            x[i] = i, y[i] = 100 - 3 * i;
        double *second = alias == 3 ? x : y;
        double *out = alias == 0 ? z : alias == 1 ? x : second;
        kernels->linear_sum(19, 2, x, -0.5, second, out);
        for (int i = 0; i < 19; i++)
            ck_assert_double_eq(out[i], alias == 3 ? 1.5 * i : 2 * i - 0.5 * (100 - 3 * i));
    }
}

TEST(numbers_that_are_not_finite_show) {
    for (size_t at = 0; at < 20; at++) {
        double x[20], w[20];
        for (size_t i = 0; i < 20; i++)
            x[i] = w[i] = 1;
        x[at] = -HUGE_VAL;
        ck_assert_double_eq(kernels->max_norm(20, x), HUGE_VAL);
        x[at] = (double)NAN;
        ck_assert_double_nan(kernels->max_norm(20, x));
        ck_assert_double_nan(kernels->dot(20, x, w));
        ck_assert_double_nan(kernels->weighted_sum_of_squares(20, x, w));
    }
}

/* longer than the block sums that wait at a time, and not a whole number of blocks */
enum { LONG = 513 * BLOCK + 77 };

static void count_items(void *arg, size_t begin, size_t end) {
    uint8_t *times = arg;
    for (size_t i = begin; i < end; i++)
        times[i]++;
}

TEST(threads_change_no_bit) {
    static const uint32_t threads[] = {1, 2, 3, 7};
    double *x = malloc(4 * LONG * sizeof *x);
    ck_assert_ptr_nonnull(x);
    double *y = x + LONG, *terms = y + LONG, *z = terms + LONG;
    for (size_t i = 0; i < LONG; i++) {
        x[i] = sin((double)i) * (i % 7 ? 1 : 1e5);
        y[i] = cos(1.3 * (double)i);
        terms[i] = x[i] * y[i];
    }
    const double dot = sum_in_order(terms, LONG);
    for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
        struct cs_error error = {0};
        ck_assert(!cs_pool_start(threads[t], &error));
        ck_assert_double_eq(kernels->dot(LONG, x, y), dot);
        kernels->linear_sum(LONG, 3, x, -2, y, z);
        size_t wrong = 0;
        for (size_t i = 0; i < LONG; i++)
            wrong += z[i] != 3 * x[i] - 2 * y[i];
        uint8_t *times = (uint8_t *)memset(z, 0, LONG);
        kernels->parallel_for(LONG, count_items, times);
        for (size_t i = 0; i < LONG; i++)
            wrong += times[i] != 1;
        ck_assert_uint_eq(wrong, 0);
    }
    cs_pool_stop();
    free(x);
}
