/* The colour bar: ticks at round values, maps that every reader can tell apart, and the value
 * that the colours of a frame end at. */
#include "unit.h"

#include "draw/glyph.h"
#include "draw/srgb.h"
#include "model/force/diagnostics.h"
#include "scene/picture_keys.h"

#include <math.h>

static uint32_t state = 1;
static double uniform(void) {
    state = state * 1664525u + 1013904223u;
    return (double)(state >> 8) / (1 << 24);
}

/* 1, 2 or 5 times a power of ten */
static bool is_round(double step) {
    const double mantissa = step / pow(10, floor(log10(step) + 1e-9));
    return fabs(mantissa - 1) < 1e-9 || fabs(mantissa - 2) < 1e-9 || fabs(mantissa - 5) < 1e-9;
}

/* Of any range: within it, a round step apart, multiples of it, at most one more than asked for
 * and at least two of five; 0 is one where values have both signs. */
TEST(ticks_are_round) {
    for (int trial = 0; trial < 20000; trial++) {
        const double scale = pow(10, 30 * uniform() - 15);
        const double from = scale * (2 * uniform() - 1);
        const double range[2] = {from, from + scale * (0.01 + uniform())};
        const int steps = trial % 2 ? 5 : 3;
        double ticks[CS_COLOUR_BAR_TICKS];
        const uint32_t n = cs_colour_bar_ticks(range, steps, ticks);
        bool zero = false;
        ck_assert(n <= (uint32_t)steps + 1 && n >= (steps == 5 ? 2 : 1));
        for (uint32_t i = 0; i < n; i++) {
            const double within = 1e-5 * (range[1] - range[0]);
            ck_assert(ticks[i] >= range[0] - within && ticks[i] <= range[1] + within);
            zero = zero || ticks[i] == 0;
            if (i == 0)
                continue;
            const double step = ticks[i] - ticks[i - 1];
            const double multiple = ticks[i] / (ticks[1] - ticks[0]);
            ck_assert(is_round(step));
            ck_assert_double_eq_tol(multiple, round(multiple), 1e-6);
        }
        ck_assert(zero || range[0] > 0 || range[1] < 0);
    }
}

TEST(ends_that_are_round_have_ticks) {
    static const double tenths[2] = {-0.3, 0.2}, none[2] = {4, 4};
    double ticks[CS_COLOUR_BAR_TICKS];
    ck_assert_uint_eq(cs_colour_bar_ticks(tenths, 5, ticks), 6);
    ck_assert_double_eq_tol(ticks[0], -0.3, 1e-15);
    ck_assert(ticks[3] == 0 && !signbit(ticks[3]));
    ck_assert_double_eq_tol(ticks[5], 0.2, 1e-15);
    ck_assert_uint_eq(cs_colour_bar_ticks(none, 5, ticks), 1);
    ck_assert_double_eq(ticks[0], 4);
    ck_assert_uint_eq(cs_colour_bar_ticks((const double[2]){0, (double)NAN}, 5, ticks), 1);
    ck_assert_uint_eq(cs_colour_bar_ticks((const double[2]){-HUGE_VAL, HUGE_VAL}, 5, ticks), 1);
}

/* What a reader without the cones for green sees (Vienot, Brettel and Mollon 1999, linear RGB),
 * in the colours of CIELAB (CIE 15, white D65). */
static void lab_without_green(const float rgb[3], double lab[3]) {
    static const double seen[3][3] = {
        {0.29275, 0.70725, 0}, {0.29275, 0.70725, 0}, {-0.02234, 0.02234, 1}};
    static const double to_xyz[3][3] = {
        {0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};
    static const double white[3] = {0.9505, 1, 1.089};
    double dim[3], f[3];
    for (int i = 0; i < 3; i++)
        dim[i] = seen[i][0] * (double)rgb[0] + seen[i][1] * (double)rgb[1] +
                 seen[i][2] * (double)rgb[2];
    for (int i = 0; i < 3; i++) {
        const double xyz =
            to_xyz[i][0] * dim[0] + to_xyz[i][1] * dim[1] + to_xyz[i][2] * dim[2];
        const double t = xyz / white[i];
        f[i] = t > 0.008856 ? cbrt(t) : 7.787 * t + 16.0 / 116;
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

/* Neighbours differ by at least 10 (Delta E of 1976); lightness tells how far a value is from
 * the lowest, or from 0 in the middle of a map that has a sign. */
TEST(colours_are_told_apart_without_green) {
    static const int32_t looks[] = {CS_LOOK_FORCE, CS_LOOK_STRAIN};
    for (int k = 0; k < 2; k++) {
        float stops[6][4];
        double lab[6][3];
        cs_colour_stops(looks[k], false, stops);
        for (int i = 0; i < 6; i++)
            lab_without_green(stops[i], lab[i]);
        for (int i = 1; i < 6; i++) {
            double square = 0;
            for (int c = 0; c < 3; c++)
                square += (lab[i][c] - lab[i - 1][c]) * (lab[i][c] - lab[i - 1][c]);
            ck_assert_double_ge(sqrt(square), 10);
            const double rise = lab[i][0] - lab[i - 1][0];
            const int half = looks[k] == CS_LOOK_FORCE ? 1 : i < 3 ? 1 : i > 3 ? -1 : 0;
            ck_assert(half == 0 || half * rise > 5);
        }
        // both sides of 0 are as far from it
        ck_assert(looks[k] == CS_LOOK_FORCE || fabs(lab[2][0] - lab[3][0]) < 6);
    }
}

static int by_size(const void *a, const void *b) {
    const double x = fabs(*(const double *)a), y = fabs(*(const double *)b);
    return (x > y) - (x < y);
}

/* against sorting, of both signs and many sizes */
TEST(a_hundredth_is_beyond_the_range) {
    enum { MOST = 1234 };
    double values[MOST], sorted[MOST];
    for (uint32_t n = 1; n <= MOST; n = n * 5 / 4 + 1) {
        for (uint32_t i = 0; i < n; i++)
            sorted[i] = values[i] = (uniform() - 0.5) * pow(10, 12 * uniform() - 6);
        qsort(sorted, n, sizeof *sorted, by_size);
        const double expected = fabs(sorted[n - 1 - (n - 1) / 100]);
        ck_assert_double_eq_tol(cs_diagnostics_magnitude(values, n), expected, 1e-7 * expected);
    }
}

TEST(values_that_are_no_numbers_are_passed_over) {
    const double values[] = {(double)NAN, 2, -HUGE_VAL, -3, 1, HUGE_VAL, 1e300};
    ck_assert_double_eq(cs_diagnostics_magnitude(values, 7), 3);
    ck_assert_double_eq(cs_diagnostics_magnitude(values, 1), 0);
    ck_assert_double_eq(cs_diagnostics_magnitude(values, 0), 0);
}
