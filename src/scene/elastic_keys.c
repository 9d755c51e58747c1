/* The rows of a body's membrane and bending, the measured cloths, and their moduli. */
#include "scene/elastic_keys.h"
#include "scene/scene.h"
#include "scene/table_rows.h"

static const struct cs_option membrane_rows[] = {
    REAL(struct cs_membrane_keys, young, "N/m", ABSENT, 1e-6, BIG,
         "Young's modulus times thickness: tension over strain of a strip that is free to "
         "narrow; the same in every direction"),
    REAL(struct cs_membrane_keys, poisson, "", 0.3, -0.99, 0.99,
         "with young: sideways contraction over strain"),
    REAL(struct cs_membrane_keys, warp, "N/m", ABSENT, 1e-6, BIG,
         "instead of young: tension over strain along the warp, at a constant width. The warp "
         "runs along a row, or along the x axis of a mesh"),
    REAL(struct cs_membrane_keys, weft, "N/m", ABSENT, 1e-6, BIG,
         "with warp: likewise across the warp"),
    REAL(struct cs_membrane_keys, shear, "N/m", ABSENT, 1e-6, BIG,
         "with warp: shear force over the change of the angle in rad"),
    REAL(struct cs_membrane_keys, coupling, "N/m", 0, -BIG, BIG,
         "with warp: tension along the warp over strain across it; its square is below warp "
         "times weft"),
};
static const struct cs_table membrane_table = {
    ROWS(membrane_rows), .size = sizeof(struct cs_membrane_keys), .optional = true};

static const struct cs_option bending_rows[] = {
    REAL(struct cs_bending_keys, stiffness, "N m", ABSENT, 1e-15, BIG,
         "moment per width over curvature; the same in every direction"),
    REAL(struct cs_bending_keys, poisson, "", 0.3, -0.99, 0.99,
         "with stiffness: sideways curvature, of the other sign, over curvature"),
    REAL(struct cs_bending_keys, warp, "N m", ABSENT, 1e-15, BIG,
         "instead of stiffness: moment over curvature along the warp, flat across it"),
    REAL(struct cs_bending_keys, weft, "N m", ABSENT, 1e-15, BIG,
         "with warp: likewise across the warp"),
    REAL(struct cs_bending_keys, twist, "N m", ABSENT, 1e-15, BIG,
         "with warp: twisting moment over twice the twist"),
    REAL(struct cs_bending_keys, coupling, "N m", 0, -BIG, BIG,
         "with warp: moment along the warp over curvature across it; its square is below warp "
         "times weft"),
    REAL(struct cs_bending_keys, damping, "s", 0, 0, BIG,
         "of the rate of curvature: moment as from a curvature of damping times that rate"),
};
static const struct cs_table bending_table = {
    ROWS(bending_rows), .size = sizeof(struct cs_bending_keys), .optional = true,
    .shorthand_number = "stiffness"};

/* Names of the cloths below. */
static const char *const cloth_names[] = {"denim",      "pants",   "interlock", "ponte-roma",
                                          "tablecloth", "blanket", "jacket",    NULL};

static const struct cs_option elastic_rows[] = {
    CHOICE(struct cs_elastic, cloth, cloth_names, -1,
           "a measured cloth instead of membrane and bending (Wang et al. 2011)"),
    TABLE(struct cs_elastic, membrane, membrane_table,
          "resistance to strain; young, or warp, weft and shear"),
    TABLE(struct cs_elastic, bending, bending_table,
          "resistance to curvature; stiffness, or warp, weft and twist. A number is the "
          "stiffness"),
    REAL(struct cs_elastic, damping, "s", 0, 0, BIG,
         "of the rate of strain: tension as from a strain of damping times that rate"),
};
const struct cs_table cs_elastic_table = {ROWS(elastic_rows), .size = sizeof(struct cs_elastic),
                                          .optional = true, .shorthand_text = "cloth"};

/* Measurements of Wang, O'Brien, Ramamoorthi 2011, in the order of cloth_names: for small
 * strains the tensions C_11, C_22, C_12, C_33 in N/m over Green's strains E_XX, E_YY, E_XY; and
 * the factors k in N m of their hinges, at small curvature, for folds across the warp, at 45
 * degrees, and across the weft. */
static const struct measured {
    double tension[4], hinge[3];
} measured[] = {
    {{205.352005, 1013.88629, 10.234077, 53.387184},
     {64.196457e-6, 73.384567e-6, 96.951576e-6}},
    {{2016.55456, 2034.97644, 9.170511, 104.759674},
     {125.409805e-6, 107.997696e-6, 125.409805e-6}},
    {{16.593832, 34.477123, -14.695990, 36.860302}, {23.191698e-6, 24.749964e-6, 14.267624e-6}},
    {{31.146198, 44.028667, -12.802702, 31.896357}, {36.348366e-6, 33.013252e-6, 37.157593e-6}},
    {{2002.08618, 2027.48559, 0.345588, 19.189022}, {51.713814e-6, 40.659470e-6, 31.282822e-6}},
    {{151.503906, 244.830673, 106.028160, 30.250183},
     {117.070122e-6, 87.509773e-6, 59.774277e-6}},
    {{43.067627, 171.424835, 54.373299, 14.314700}, {14.293814e-6, 21.951700e-6, 20.345654e-6}},
};

/* E_XY is half the change of the angle. */
static struct cs_moduli measured_membrane(const struct measured *of) {
    return (struct cs_moduli){of->tension[0], of->tension[1], of->tension[2],
                              of->tension[3] / 2};
}

/* A hinge of edge length l between triangles of area a each has the energy k l^2 theta^2/(16
 * a). On a sheet of squares that is folded along its lines theta is curvature times width, and
 * the energy k/8 of the squared curvature per area: the modulus is k/4. At 45 degrees a sheet
 * has (D_11 + D_22)/4 + D_33; the coupling was not measured. */
static struct cs_moduli measured_bending(const struct measured *of) {
    const double warp = of->hinge[0] / 4, diagonal = of->hinge[1] / 4, weft = of->hinge[2] / 4;
    return (struct cs_moduli){warp, weft, 0, diagonal - (warp + weft) / 4};
}

static struct cs_moduli isotropic(double modulus, double poisson) {
    return (struct cs_moduli){modulus, modulus, poisson * modulus, (1 - poisson) / 2 * modulus};
}

struct cs_moduli cs_membrane_moduli(const struct cs_elastic *elastic) {
    const struct cs_membrane_keys *keys = &elastic->membrane;
    if (elastic->present && elastic->cloth >= 0)
        return measured_membrane(measured + elastic->cloth);
    if (!elastic->present || !keys->present)
        return (struct cs_moduli){0};
    if (!isnan(keys->young))
        return isotropic(keys->young / (1 - keys->poisson * keys->poisson), keys->poisson);
    return (struct cs_moduli){keys->warp, keys->weft, keys->coupling, keys->shear};
}

struct cs_moduli cs_bending_moduli(const struct cs_elastic *elastic) {
    const struct cs_bending_keys *keys = &elastic->bending;
    if (elastic->present && elastic->cloth >= 0)
        return measured_bending(measured + elastic->cloth);
    if (!elastic->present || !keys->present)
        return (struct cs_moduli){0};
    if (!isnan(keys->stiffness))
        return isotropic(keys->stiffness, keys->poisson);
    return (struct cs_moduli){keys->warp, keys->weft, keys->coupling, keys->twist};
}

bool cs_elastic_bends(const struct cs_elastic *elastic) {
    return elastic->present && (elastic->cloth >= 0 || elastic->bending.present);
}
