/* Sums whose bits reveal how they were computed; run when the build is configured and at each
 * start of the program. Flags and their names differ between compilers; results do not. */
#ifdef CS_ARITHMETIC_ALONE
const char *cs_ieee_check(void);
#else
#include "cli/ieee_check.h"
#endif

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* volatile: nothing is computed by the compiler */
static volatile double one = 1, small = 0x1p-30, tiny = 0x1p-1022, large = 1e308, odd = 49,
                       whole = 1e16;

/* Fused multiply-add: (1 + e)(1 - e) - 1 with e = 2^-30 is 0 in doubles, and -e^2 = -2^-60 if
 * product and sum are rounded once. */
static bool is_fused(void) {
    const double a = one + small, b = one - small, c = -one;
    return a * b + c != 0;
}

/* 49 (1/49) is not 1 in doubles, but 49/49 is. */
static bool multiplies_by_reciprocals(void) {
    const double divisor = odd;
    double values[8];
    bool wrong = odd / 49.0 != 1;
    for (size_t k = 0; k < 8; k++)
        values[k] = odd * (double)(k + 1);
    for (size_t k = 0; k < 8; k++)
        wrong |= values[k] / divisor != (double)(k + 1);
    return wrong;
}

/* Sums must run from left to right. 1e16 + 1 is 1e16, because the spacing of doubles there is
 * 2. The array is 1e16, 1, -1e16, 1, four times: each 1e16 absorbs the sum before it and the 1
 * after it, so only the last 1 remains. */
static bool changes_order(void) {
    const double a = whole, b = one;
    double values[16], sum = 0;
    for (size_t k = 0; k < 16; k++)
        values[k] = k % 4 == 0 ? whole : k % 4 == 2 ? -whole : one;
    for (size_t k = 0; k < 16; k++)
        sum += values[k];
    return a + b - a != 0 || sum != 1;
}

/* Half of the smallest normal number is subnormal and must not become 0. */
static bool flushes_to_zero(void) {
    const double half = tiny / 2;
    return half == 0 || half + half != tiny;
}

/* -0 + 0 is +0, and its reciprocal +inf; -(1 - 1) is -0. */
static bool loses_signs_of_zero(void) {
    const double negative = (one - one) * -one, sum = negative + 0.0, negated = -(one - one);
    return one / sum < 0 || one / negated > 0;
}

/* 1e309 must overflow; with the wider range of x87 registers it does not. */
static bool is_wider(void) {
    const double product = large * 10, narrowed = product / 10;
    return narrowed == large;
}

/* inf - inf must be recognised as a NaN. */
static bool takes_nan_for_a_number(void) {
    const double nan = large * 10 - large * 10;
    return nan == nan || !isnan(nan);
}

/* 1 with far less than its spacing added or taken away is 1 in the mode "to nearest" only. */
static bool rounds_otherwise(void) {
    const double little = small * small / 64;
    return one + little != one || one - little != one;
}

const char *cs_ieee_check(void) {
    if (rounds_otherwise())
        return "sums are not rounded to nearest (another rounding mode is set)";
    if (is_fused())
        return "products and sums are fused (-ffp-contract=off is missing)";
    if (multiplies_by_reciprocals())
        return "divisions are replaced by products with reciprocals (-freciprocal-math)";
    if (changes_order())
        return "sums are reordered (-fassociative-math)";
    if (flushes_to_zero())
        return "numbers below 2^-1022 are flushed to 0 (linked with -ffast-math)";
    if (loses_signs_of_zero())
        return "signs of zero are lost (-fno-signed-zeros)";
    if (is_wider())
        return "doubles are computed with a wider range (x87: use -msse2 -mfpmath=sse)";
    if (takes_nan_for_a_number())
        return "NaN is not recognised (-ffinite-math-only)";
    return NULL;
}

#ifdef CS_ARITHMETIC_ALONE
#include <stdio.h>
int main(void) {
    const char *fault = cs_ieee_check();
    if (fault)
        puts(fault);
    return fault != NULL;
}
#endif
