/* spring_law.h - the law of one spring: force, and diagonal blocks of its derivative.
 *
 * Notation: d = x_b - x_a with length l and unit vector u, w = v_b - v_a, rest length L,
 * stiffness k, damping c. The force on the first end is
 *
 *   f_a = k (1 - L / l) d + c (w.u) u    axial damping
 *   f_a = k (1 - L / l) d + c w          relative damping
 *
 * and -f_a acts on the second end. All spring kernels use these functions, so that force,
 * derivative and matrix belong to one law. */
#ifndef CS_SPRING_LAW_H
#define CS_SPRING_LAW_H

#include "model/spring/run_pieces.h"

#include <float.h>
#include <math.h>

/* Which damper a kernel has; 0 is none. Each value is a compiled copy of the loop, and a scene
 * without damping never reads v. */
enum damper_form { AXIAL = 1, RELATIVE = 2 };

/* Components of a symmetric block: xx, xy, xz, yy, yz, zz. */
enum { SYM = 6 };

/* f_a of the law above, for the differences d of positions and w of velocities. `how` is a
 * constant of every caller. */
CS_INLINE struct difference force_of(const struct difference d, const struct difference w,
                                     double length, double k, double c, const unsigned how) {
    /* DBL_MIN keeps two particles in one place from dividing by zero */
    const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
    double pull = k * (1 - length * inverse);
    if (how & AXIAL)
        pull += c * ((w.x * d.x + w.y * d.y + w.z * d.z) * inverse * inverse);
    if (how & RELATIVE)
        return (struct difference){pull * d.x + c * w.x, pull * d.y + c * w.y,
                                   pull * d.z + c * w.z};
    return (struct difference){pull * d.x, pull * d.y, pull * d.z};
}

/* Unit vector u of a spring, and L / l. */
struct rotated_damper {
    struct difference u;
    double force_over_length;
};

/* L = 0 gives u alone, which is what damper blocks need. */
CS_INLINE struct rotated_damper turned_of(const struct difference d, double length) {
    const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
    return (struct rotated_damper){{d.x * inverse, d.y * inverse, d.z * inverse},
                                   length * inverse};
}

/* out = a I + b u u^T, for a number a, a number b and a vector u. */
CS_INLINE void set_block(double a, double b, const struct difference u, double *out) {
    out[0] = a + b * u.x * u.x;
    out[1] = b * u.x * u.y;
    out[2] = b * u.x * u.z;
    out[3] = a + b * u.y * u.y;
    out[4] = b * u.y * u.z;
    out[5] = a + b * u.z * u.z;
}

/* Block of df/dx, the same at both ends: df_a/dx_a = -k ((1 - L/l) I + (L/l) u u^T). Along u
 * its eigenvalue is -k; across u it is -k (1 - L/l), which is positive for a compressed spring.
 */
CS_INLINE void stiff_block(const struct rotated_damper spring, double k, double *out) {
    set_block(-(k * (1 - spring.force_over_length)), -(k * spring.force_over_length), spring.u,
              out);
}

#endif
