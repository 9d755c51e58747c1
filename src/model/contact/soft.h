/* soft.h - the positive part of a number, made smooth. */
#ifndef CS_CONTACT_SOFT_H
#define CS_CONTACT_SOFT_H

#include <clothsim/clones.h>

/* The positive part of t made smooth over -e..e: 0 below, t above, else
 * 2e z^4 (z^2 - 3z + 5/2) with z = (t + e)/2e; three continuous derivatives. out: value, first
 * and second derivative. e may be 0. */
CS_INLINE void cs_soft_part(double t, double e, double out[3]) {
    if (t >= e || t <= -e) {
        out[0] = t >= e ? t : 0;
        out[1] = t >= e;
        out[2] = 0;
        return;
    }
    const double z = (t + e) / (2 * e), left = 1 - z;
    out[0] = 2 * e * (z * z) * (z * z) * (z * z - 3 * z + 2.5);
    out[1] = z * z * z * (10 - 15 * z + 6 * z * z);
    out[2] = 15 / e * (z * z) * (left * left);
}

#endif
