/* soft.h - a smoothed positive part of a number, S in shape_core.c. */
#ifndef CS_CONTACT_SOFT_H
#define CS_CONTACT_SOFT_H

#include <clothsim/clones.h>

/* The positive part of t smoothed over -e..e: 0 below, t above, else
 *   S(t) = 2e z^4 (z^2 - 3z + 5/2),   z = (t + e) / 2e
 * S' = z^3 (10 - 15 z + 6 z^2) is the quintic that rises from 0 to 1 with zero first and second
 * derivatives at both ends, hence three continuous derivatives of S. S'' = 15/e z^2 (1 - z)^2.
 * out: S, S', S''. e may be 0. */
CS_INLINE void cs_smooth_positive(double t, double e, double out[3]) {
    // chosen last, not branched to: loops over many vectorise
    const double z = (t + e) / (2 * e), left = 1 - z;
    const double value = 2 * e * (z * z) * (z * z) * (z * z - 3 * z + 2.5);
    const double slope = z * z * z * (10 - 15 * z + 6 * z * z);
    const double turn = 15 / e * (z * z) * (left * left);
    const double inner[3] = {value, slope, turn}, above[3] = {t, 1, 0};
    for (int k = 0; k < 3; k++) {
        const double below = t <= -e ? 0 : inner[k];
        out[k] = t >= e ? above[k] : below;
    }
}

#endif
