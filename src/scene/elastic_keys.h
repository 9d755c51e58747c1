/* elastic_keys.h - keys of a body that resists strain and bending as a continuous sheet: its
 * constants belong to the cloth, not to the mesh. */
#ifndef CS_ELASTIC_KEYS_H
#define CS_ELASTIC_KEYS_H

#include <clothsim/option.h>

/* Tension per strain in the plane, in N/m: young and poisson, or the four others. */
struct cs_membrane_keys {
    bool present;
    double young, poisson;    /* isotropic; NAN: not given */
    double warp, weft, shear; /* orthotropic; NAN: not given */
    double coupling;          /* of warp and weft */
};

/* Moment per curvature, in N m: stiffness and poisson, or the four others. */
struct cs_bending_keys {
    bool present;
    double stiffness, poisson; /* isotropic; NAN: not given */
    double warp, weft, twist;  /* orthotropic; NAN: not given */
    double coupling;           /* of warp and weft */
    double damping;            /* s: moment per rate of curvature over moment per curvature */
};

/* Law of force of a body instead of springs: a cloth of the library, or constants. */
struct cs_elastic {
    bool present;
    int32_t cloth; /* of the library; -1: none */
    struct cs_membrane_keys membrane;
    struct cs_bending_keys bending;
    double damping; /* s: stress per rate of strain over stress per strain */
};

struct cs_scene;
/* The elastic keys of body b of a scene. */
const struct cs_elastic *cs_scene_elastic(const struct cs_scene *scene, uint32_t b);

/* A symmetric matrix of moduli over the strains (XX, YY, XY), or the curvatures (XX, YY, 2 XY):
 * entries 11, 22, 12, 33; the others are 0. X is the direction of the warp. */
struct cs_moduli {
    double warp, weft, coupling, shear;
};
/* out = D s of strains or curvatures s, or of one component of each. */
static inline void cs_moduli_multiply(const struct cs_moduli *D, const double s[3],
                                      double out[3]) {
    out[0] = D->warp * s[0] + D->coupling * s[1];
    out[1] = D->coupling * s[0] + D->weft * s[1];
    out[2] = D->shear * s[2];
}

/* Moduli of a membrane in N/m; the XY strain is the change of the angle in rad. For Young's
 * modulus Y and Poisson's ratio p: Y/(1 - p^2) (1, 1, p, (1 - p)/2). All 0 without one. */
struct cs_moduli cs_membrane_moduli(const struct cs_elastic *elastic);
/* Moduli of bending in N m; likewise, with the stiffness D: D (1, 1, p, (1 - p)/2). */
struct cs_moduli cs_bending_moduli(const struct cs_elastic *elastic);
/* Returns true if the body resists bending. */
bool cs_elastic_bends(const struct cs_elastic *elastic);

#endif
