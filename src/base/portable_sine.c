/* Sine and cosine by the sine's nested series, from the first quarter of the turn. */
#include "base/portable_sine.h"

#include <stdint.h>

double cs_quarter_sine(double r) {
    const double y = 1.57079632679489661923 * r;
    double series = 1;
    for (int k = 20; k > 0; k -= 2)
        series = 1 - series * (y * y) / (k * (k + 1));
    return y * series;
}

void cs_sine_cosine(double angle, double *sine, double *cosine) {
    const double quarters = angle / 1.57079632679489661923;
    const uint64_t whole = (uint64_t)quarters;
    const double rest = quarters - (double)whole;
    const double rising = cs_quarter_sine(rest), falling = cs_quarter_sine(1 - rest);
    const double around[4] = {rising, falling, -rising, -falling};
    *sine = around[whole % 4];
    *cosine = around[(whole + 1) % 4];
}
