/* The derivatives of cloth, by the parts that methods choose (stretch, shear, bend, damping,
 * drag, wind) and with both kinds of dampers and units. Forces of the list: test_contract.c.
 *
 * Central differences with a step of 1e-6 on a cloth that is pulled, sheared and stirred, so
 * that no spring is at rest length, where a wrong transverse term would go unseen. Truncation
 * is near 1e-11 and rounding near 1e-9 of the largest entry; the bounds leave a factor of 100.
 */
#include "fixture.h"

#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/solver/linear.h"

#include <math.h>
#include <string.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 4]}, \"mass\": {\"areal_density\": 0.4},"        \
    " \"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": 25, \"damping\": 0.7,"          \
    " \"damping_model\": \"%s\"}, \"pins\": [\"top-left\", 7]}],"                              \
    " \"forces\": {\"drag\": 0.3, \"drag_unit\": \"%s\","                                      \
    " \"wind\": {\"direction\": [0.3, 0.2, 1], \"strength\": 4, \"strength_unit\": \"%s\"}}}"

enum { N = 20, VALUES = 3 * N };
#define STEP 1e-6

static void open(struct fixture *cloth, bool axial) {
    fixture_open(cloth, "implicit-linearised", SCENE, axial ? "axial" : "relative",
                 axial ? "N s/m" : "Pa s/m", axial ? "Pa" : "N");
    ck_assert_uint_eq(cloth->n, N);
    cs_perturb_smooth(cloth->system, 0.06, 2);
}

static void force(const struct fixture *cloth, const double *x, const double *v, uint32_t parts,
                  double f[VALUES]) {
    cs_normals_update(cloth->system, x);
    cs_terms_force(cloth->system, &(struct cs_eval){.x = x, .v = v, .parts = parts}, f);
}

/* (f(x + e dx, v + e dv) - f(x - e dx, v - e dv)) / 2 e */
static void difference(const struct fixture *cloth, uint32_t parts, const double *dx,
                       const double *dv, double slope[VALUES]) {
    double x[VALUES], v[VALUES], forward[VALUES];
    for (int sign = 1; sign >= -1; sign -= 2) {
        for (size_t i = 0; i < VALUES; i++) {
            x[i] = cloth->x[i] + sign * STEP * dx[i];
            v[i] = cloth->v[i] + sign * STEP * dv[i];
        }
        force(cloth, x, v, parts, sign > 0 ? forward : slope);
    }
    for (size_t i = 0; i < VALUES; i++)
        slope[i] = (forward[i] - slope[i]) / (2 * STEP);
}

static double largest(const double *a, size_t n) {
    double found = 0;
    for (size_t i = 0; i < n; i++)
        found = fmax(found, fabs(a[i]));
    return found;
}

/* All columns of df/dx and df/dv of one part. */
static void check_part(const struct fixture *cloth, uint32_t part, const char *name,
                       double least) {
    double dx[VALUES] = {0}, dv[VALUES] = {0}, slope[VALUES], df[VALUES], off[VALUES];
    double size = 0, error = 0;
    for (size_t column = 0; column < 2 * VALUES; column++) {
        double *moved = column < VALUES ? dx + column : dv + (column - VALUES);
        // a pinned particle does not move
        if (cloth->system->inv_mass[column % N] <= 0)
            continue;
        *moved = 1;
        difference(cloth, part, dx, dv, slope);
        cs_normals_update(cloth->system, cloth->x);
        cs_terms_jvp(cloth->system,
                     &(struct cs_eval){.x = cloth->x,
                                       .v = cloth->v,
                                       .parts = part,
                                       .dx = column < VALUES ? dx : NULL,
                                       .dv = column < VALUES ? NULL : dv},
                     df);
        for (size_t i = 0; i < VALUES; i++)
            off[i] = df[i] - slope[i];
        size = fmax(size, largest(slope, VALUES));
        error = fmax(error, largest(off, VALUES));
        *moved = 0;
    }
    ck_assert_msg(size >= least, "%s: the largest derivative is only %g", name, size);
    ck_assert_msg(error <= 1e-7 * size + 1e-9, "%s: off by %g of %g", name, error, size);
}

TEST(jvp_is_the_derivative_of_each_force) {
    static const struct {
        uint32_t part;
        const char *name;
        double least; /* so that a part that is not there cannot pass */
    } parts[] = {{CS_PART_STRETCH, "stretch", 100}, {CS_PART_SHEAR, "shear", 30},
                 {CS_PART_BEND, "bend", 10},        {CS_PART_DAMPING, "damping", 0.5},
                 {CS_PART_GRAVITY, "gravity", 0},   {CS_PART_DRAG, "drag", 0.01},
                 {CS_PART_WIND, "wind", 0.01},      {CS_PART_ALL, "all", 100}};
    for (int axial = 0; axial < 2; axial++) {
        struct fixture cloth;
        open(&cloth, axial);
        for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
            check_part(&cloth, parts[k].part, parts[k].name, parts[k].least);
        fixture_close(&cloth);
    }
}

/* Both directions at once are the sum of each alone. */
TEST(jvp_is_linear) {
    struct fixture cloth;
    double dx[VALUES], dv[VALUES], both[VALUES], one[VALUES], other[VALUES];
    open(&cloth, true);
    for (size_t i = 0; i < VALUES; i++)
        dx[i] = sin(0.7 * (double)i), dv[i] = cos(1.1 * (double)i);
    cs_normals_update(cloth.system, cloth.x);
    cs_terms_jvp(
        cloth.system,
        &(struct cs_eval){.x = cloth.x, .v = cloth.v, .parts = CS_PART_ALL, .dx = dx, .dv = dv},
        both);
    cs_terms_jvp(cloth.system,
                 &(struct cs_eval){.x = cloth.x, .v = cloth.v, .parts = CS_PART_ALL, .dx = dx},
                 one);
    cs_terms_jvp(cloth.system,
                 &(struct cs_eval){.x = cloth.x, .v = cloth.v, .parts = CS_PART_ALL, .dv = dv},
                 other);
    for (size_t i = 0; i < VALUES; i++)
        ck_assert_double_eq_tol(both[i], one[i] + other[i], 1e-11);
    fixture_close(&cloth);
}

/* The blocks and the solver's matrix leave out the position derivative of axial damping: at
 * equal velocities it is 0, and both must agree with jvp. */
static void open_at_rest(struct fixture *cloth, bool axial) {
    open(cloth, axial);
    memset(cloth->v, 0, VALUES * sizeof *cloth->v);
}

TEST(diagonal_is_that_of_jvp) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    for (int axial = 0; axial < 2; axial++) {
        struct fixture cloth;
        double kxx[6 * N], dvv[6 * N], unit[VALUES] = {0}, df[VALUES];
        open_at_rest(&cloth, axial);
        cs_terms_diagonal(cloth.system,
                          &(struct cs_eval){.x = cloth.x, .parts = CS_PART_LINEARISED}, kxx,
                          dvv);
        for (size_t i = 0; i < N; i++)
            for (int e = 0; e < 6 && cloth.system->inv_mass[i] > 0; e++) {
                unit[column[e] * N + i] = 1;
                cs_terms_jvp(
                    cloth.system,
                    &(struct cs_eval){
                        .x = cloth.x, .v = cloth.v, .parts = CS_PART_LINEARISED, .dx = unit},
                    df);
                ck_assert_double_eq_tol(kxx[e * N + i], df[row[e] * N + i], 1e-10);
                cs_terms_jvp(
                    cloth.system,
                    &(struct cs_eval){
                        .x = cloth.x, .v = cloth.v, .parts = CS_PART_LINEARISED, .dv = unit},
                    df);
                ck_assert_double_eq_tol(dvv[e * N + i], df[row[e] * N + i], 1e-12);
                unit[column[e] * N + i] = 0;
            }
        fixture_close(&cloth);
    }
}

TEST(solver_matrix_is_that_of_jvp) {
    const double cm = 1, cd = -0.02, ck = -4e-4;
    for (int axial = 0; axial < 2; axial++) {
        struct fixture cloth;
        struct cs_arena arena = {0};
        struct cs_error error = {0};
        struct cs_linear linear;
        double p[VALUES], found[VALUES], dk[VALUES], dd[VALUES];
        open_at_rest(&cloth, axial);
        ck_assert_int_eq(cs_linear_init(&linear, cloth.system, &arena, &error), CS_OK);
        cs_linear_setup(&linear, &(struct cs_matrix){
                                     .x = cloth.x, .cm = cm, .cd = cd, .ck = ck, .psd = false});
        for (size_t i = 0; i < VALUES; i++)
            p[i] = cloth.system->inv_mass[i % N] > 0 ? sin(0.9 * (double)i) : 0;
        cs_linear_mul(&linear, p, found);
        cs_terms_jvp(
            cloth.system,
            &(struct cs_eval){.x = cloth.x, .v = cloth.v, .parts = CS_PART_LINEARISED, .dx = p},
            dk);
        cs_terms_jvp(
            cloth.system,
            &(struct cs_eval){.x = cloth.x, .v = cloth.v, .parts = CS_PART_LINEARISED, .dv = p},
            dd);
        for (size_t i = 0; i < VALUES; i++) {
            const double expected =
                cm * cloth.system->mass[i % N] * p[i] + cd * dd[i] + ck * dk[i];
            ck_assert_double_eq_tol(found[i], expected, 1e-13);
        }
        cs_arena_finish(&arena);
        fixture_close(&cloth);
    }
}

/* The force of springs and gravity is the downward slope of the energy. */
TEST(force_is_the_slope_of_the_energy) {
    struct fixture cloth;
    double f[VALUES];
    open(&cloth, true);
    force(&cloth, cloth.x, cloth.v, CS_PART_SPRINGS | CS_PART_GRAVITY, f);
    for (size_t i = 0; i < VALUES; i++) {
        if (cloth.system->inv_mass[i % N] <= 0)
            continue;
        const double place = cloth.x[i];
        cloth.x[i] = place + STEP;
        const double above = fixture_energy(&cloth);
        cloth.x[i] = place - STEP;
        const double below = fixture_energy(&cloth);
        cloth.x[i] = place;
        ck_assert_double_eq_tol(f[i], (below - above) / (2 * STEP), 1e-7);
    }
    fixture_close(&cloth);
}
