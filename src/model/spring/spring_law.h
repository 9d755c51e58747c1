/* spring_law.h - what one spring does: its force, and the blocks of its derivative. */
#ifndef CS_SPRING_LAW_H
#define CS_SPRING_LAW_H

#include "model/spring/run_pieces.h"

#include <float.h>
#include <math.h>

/* Copies of the loops over springs, so that a scene without damping never reads v. */
enum damper_form { AXIAL = 1, RELATIVE = 2 };

/* symmetric blocks: xx, xy, xz, yy, yz, zz */
enum { SYM = 6 };

/* Of one spring, on its first end: d and w are the differences of places and speeds. */
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

/* a spring's unit direction and ratio of its rest length to its length */
struct rotated_damper {
    struct difference u;
    double force_over_length;
};

CS_INLINE struct rotated_damper turned_of(const struct difference d, double length) {
    const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
    return (struct rotated_damper){{d.x * inverse, d.y * inverse, d.z * inverse},
                                   length * inverse};
}

/* a I + b u u^T */
CS_INLINE void set_block(double a, double b, const struct difference u, double *out) {
    out[0] = a + b * u.x * u.x;
    out[1] = b * u.x * u.y;
    out[2] = b * u.x * u.z;
    out[3] = a + b * u.y * u.y;
    out[4] = b * u.y * u.z;
    out[5] = a + b * u.z * u.z;
}

/* of df/dx */
CS_INLINE void stiff_block(const struct rotated_damper spring, double k, double *out) {
    set_block(-(k * (1 - spring.force_over_length)), -(k * spring.force_over_length), spring.u,
              out);
}

#endif
