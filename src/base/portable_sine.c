/* Sine by its nested Taylor series, on the first quarter of the turn:
 *
 *   sin y = y (1 - y^2/(2 3) (1 - y^2/(4 5) (1 - ... (1 - y^2/(20 21))))) */
#include "base/portable_sine.h"

#include <math.h>
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

/* r = m 2^e with m in sqrt(1/2)..sqrt(2), and ln m = 2 artanh z, z = (m - 1)/(m + 1), |z| at
 * most 0.172. The first term left out is below 1e-19. frexp is exact. */
double cs_natural_log(double r) {
    int e;
    double m = frexp(r, &e), series = 0;
    if (m < 0.70710678118654752440) {
        m *= 2;
        e--;
    }
    const double z = (m - 1) / (m + 1);
    for (int k = 23; k > 0; k -= 2)
        series = series * (z * z) + 1.0 / k;
    return 0.69314718055994530942 * e + 2 * z * series;
}
