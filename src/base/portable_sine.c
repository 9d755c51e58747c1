/* Sine by its nested Taylor series, on the first quarter of the turn:
 *
 *   sin y = y (1 - y^2/(2 3) (1 - y^2/(4 5) (1 - ... (1 - y^2/(20 21))))) */
#include "base/portable_sine.h"

#include <stdint.h>

/* The first term left out, y^23 / 23!, is 1.3e-18 at y = pi/2. */
double cs_quarter_sine(double r) {
    const double y = 1.57079632679489661923 * r;
    double series = 1;
    for (int k = 20; k > 0; k -= 2)
        series = 1 - series * (y * y) / (k * (k + 1));
    return y * series;
}

/* Reduces the angle to quarter k and rest r: sin is s(r), s(1-r), -s(r), -s(1-r) in turn, with
 * s(r) = sin(r pi/2), and cos is one quarter ahead. */
void cs_sine_cosine(double angle, double *sine, double *cosine) {
    const double quarters = angle / 1.57079632679489661923;
    const uint64_t whole = (uint64_t)quarters;
    const double rest = quarters - (double)whole;
    const double rising = cs_quarter_sine(rest), falling = cs_quarter_sine(1 - rest);
    const double around[4] = {rising, falling, -rising, -falling};
    *sine = around[whole % 4];
    *cosine = around[(whole + 1) % 4];
}
