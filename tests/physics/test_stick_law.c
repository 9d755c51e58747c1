/* Friction that sticks (contact.friction_law "stick") as a force: its derivatives against
 * differences, its matrix, its bounds and its energy; and what scenes without it do not pay. */
#include "fixture.h"

#include "model/contact/bristle_law.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/solver/linear.h"
#include "sim/energy_ledger.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A sheet that wraps a ball, a rod and a box, with contact samples on all of them; %g: three
 * coefficients of friction. */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 4]}, \"mass\": {\"areal_density\": 0.4}, "       \
    "\"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": 25}, \"pins\": [\"top-left\", "  \
    "7]}], \"colliders\": [{\"sphere\": {\"centre\": [0.1, 0.05, -0.06], \"radius\": 0.02}, "  \
    "\"thickness\": 0.3, \"friction\": %g}, {\"capsule\": {\"from\": [-0.5, 0, 0.1], \"to\": " \
    "[0.2, 0.1, 0.1], \"radius\": 0.02}, \"thickness\": 0.3, \"friction\": %g}, {\"box\": "    \
    "{\"centre\": [0.3, 0.3, -0.25], \"size\": [0.4, 0.4, 0.4], \"radius\": 0.05}, "           \
    "\"thickness\": 0.3, \"friction\": %g}], \"contact\": {\"law\": \"force\", "               \
    "\"start\": \"allow\", \"friction_law\": \"stick\", \"stiffness\": 50}, \"events\": "      \
    "[{\"from\": 0, \"to\": 1, "                                                               \
    "\"move\": {\"collider\": 2, \"spin\": [1, 2, 3], \"path\": [{\"at\": 1, \"point\": [1, "  \
    "0, 0]}]}}]}"

enum { N = 20, VALUES = 3 * N };
#define STEP 1e-6
#define AT   0.01 /* s: the box has turned by then */

/* Bristles are stretched by the state that is moved after the start. Friction of 1000 holds
 * everywhere, that of 0.05 slips. */
static void open_wrapped(struct fixture *sheet, double friction) {
    fixture_open(sheet, "implicit-linearised", SCENE, friction, friction, friction);
    ck_assert_uint_eq(sheet->n, N);
    fixture_start(sheet);
    ck_assert_ptr_nonnull(sheet->system->friction_anchors->samples);
    cs_perturb_smooth(sheet->system, 0.03, 1);
}

static void force(const struct fixture *sheet, const double *x, const double *v, double *f) {
    const struct cs_eval at = {.t = AT, .x = x, .v = v, .parts = CS_PART_DISSIPATIVE};
    cs_terms_force(sheet->system, &at, f);
}

/* f(x + e dx, v + e dv) - f(x - e dx, v - e dv) over 2 e */
static void difference(const struct fixture *sheet, size_t column, double slope[VALUES]) {
    double below[VALUES];
    double *value = column < VALUES ? sheet->x + column : sheet->v + (column - VALUES);
    const double kept = *value;
    *value = kept + STEP;
    force(sheet, sheet->x, sheet->v, slope);
    *value = kept - STEP;
    force(sheet, sheet->x, sheet->v, below);
    *value = kept;
    for (size_t i = 0; i < VALUES; i++)
        slope[i] = (slope[i] - below[i]) / (2 * STEP);
}

static double largest(const double *a) {
    double most = 0;
    for (size_t i = 0; i < VALUES; i++)
        most = fmax(most, fabs(a[i]));
    return most;
}

TEST(products_are_the_derivative) {
    for (int k = 0; k < 2; k++) {
        struct fixture sheet;
        double unit[VALUES] = {0}, slope[VALUES], df[VALUES], size = 0, error = 0;
        open_wrapped(&sheet, k ? 0.05 : 1000);
        for (size_t column = 0; column < 2 * VALUES; column++) {
            struct cs_eval at = {
                .t = AT, .x = sheet.x, .v = sheet.v, .parts = CS_PART_DISSIPATIVE};
            if (sheet.system->inv_mass[column % N] <= 0)
                continue;
            difference(&sheet, column, slope);
            unit[column % VALUES] = 1;
            *(column < VALUES ? &at.dx : &at.dv) = unit;
            cs_terms_jvp(sheet.system, &at, df);
            unit[column % VALUES] = 0;
            size = fmax(size, largest(slope));
            for (size_t i = 0; i < VALUES; i++)
                error = fmax(error, fabs(df[i] - slope[i]));
        }
        ck_assert_double_gt(size, 0.1);
        ck_assert_msg(error <= 1e-7 * size, "%s: off by %g of %g", k ? "slip" : "rest", error,
                      size);
        fixture_close(&sheet);
    }
}

/* y = (cm M + cd df/dv + ck df/dx) p - M p */
static void multiply(const struct fixture *sheet, struct cs_matrix matrix, const double *p,
                     double *y) {
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_linear linear;
    matrix.t = AT, matrix.x = sheet->x, matrix.v = sheet->v, matrix.cm = 1;
    ck_assert_int_eq(cs_linear_init(&linear, sheet->system, &arena, &error), CS_OK);
    cs_linear_setup(&linear, &matrix);
    cs_linear_mul(&linear, p, y);
    for (size_t i = 0; i < VALUES; i++)
        y[i] =
            sheet->system->inv_mass[i % N] > 0 ? y[i] - sheet->system->mass[i % N] * p[i] : 0;
    cs_arena_finish(&arena);
}

static double dot(const double *a, const double *b) {
    double sum = 0;
    for (size_t i = 0; i < VALUES; i++)
        sum += a[i] * b[i];
    return sum;
}

static void wave(const struct fixture *sheet, double k, double *p) {
    for (size_t i = 0; i < VALUES; i++)
        p[i] = sheet->system->inv_mass[i % N] > 0 ? sin(k * (double)i) : 0;
}

/* The matrix is symmetric and not negative, the one with the bound is above it, and the one
 * with friction by its chord is none of that less, whatever forces act. */
TEST(matrix_is_symmetric_and_positive) {
    const struct cs_matrix clamped = {.cd = -0.02, .ck = -4e-4, .psd = true},
                           bound = {.cd = -0.02, .ck = -4e-4, .psd = true, .bound = true};
    for (int k = 0; k < 2; k++)
        for (int wave_number = 1; wave_number < 9; wave_number++) {
            struct fixture sheet;
            double p[VALUES], q[VALUES], ap[VALUES], aq[VALUES], bp[VALUES], all[VALUES];
            const struct cs_chord_forces forces = {.all = all, .contact = all};
            struct cs_matrix chord = clamped;
            chord.chord = &forces;
            open_wrapped(&sheet, k ? 0.05 : 1000);
            wave(&sheet, 0.7 * wave_number, p);
            wave(&sheet, 1.9 * wave_number, q);
            multiply(&sheet, clamped, p, ap);
            multiply(&sheet, clamped, q, aq);
            multiply(&sheet, bound, p, bp);
            ck_assert_double_eq_tol(dot(q, ap), dot(p, aq), 1e-12);
            ck_assert_double_gt(dot(p, ap), 0);
            ck_assert_double_ge(dot(p, bp), dot(p, ap) * (1 - 1e-12));
            wave(&sheet, 3.1 * wave_number, all);
            multiply(&sheet, chord, p, ap);
            multiply(&sheet, chord, q, aq);
            ck_assert_double_eq_tol(dot(q, ap), dot(p, aq), 1e-12);
            ck_assert_double_ge(dot(p, ap), 0);
            fixture_close(&sheet);
        }
}

/* Four particles at rest on a floor, their bristles stretched along it: flat, so that nothing
 * is left out of the matrix. */
#define FLAT                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"size\": [0.1, 0.1], \"start\": \"flat\", " \
    "\"place\": {\"translate\": [0, 0.009, 0]}}, \"mass\": {\"total\": 0.1}, \"springs\": "    \
    "{\"stretch\": 0, \"shear\": 0, \"bend\": 0}}], \"colliders\": [{\"floor\": {}, "          \
    "\"thickness\": 0.02, \"friction\": %g}], \"contact\": {\"law\": \"force\", "              \
    "\"start\": \"allow\", \"friction_law\": \"%s\", \"stiffness\": %g%s}"

/* k_t = k, and c_t = 2 sqrt(k m): the block, the bounds and the force. */
TEST(bristle_is_critically_damped) {
    struct fixture plate;
    double f[12], kxx[24], dvv[24], work[8], omega, delta;
    const double k = 80, c = 2 * sqrt(k * 0.025);
    fixture_open(&plate, "implicit-linearised", FLAT, 1.0, "stick", k, "}");
    fixture_start(&plate);
    for (int i = 0; i < 4; i++)
        plate.x[i] += 1e-4, plate.v[8 + i] = 2e-3;
    const struct cs_eval at = {.x = plate.x, .v = plate.v, .parts = CS_PART_DISSIPATIVE};
    cs_terms_force(plate.system, &at, f);
    cs_terms_diagonal(plate.system, &at, kxx, dvv);
    for (int i = 0; i < 4; i++) {
        ck_assert_double_eq_tol(f[i], -k * 1e-4, 1e-15);
        ck_assert_double_eq_tol(f[8 + i], -c * 2e-3, 1e-15);
        ck_assert_double_eq_tol(kxx[i], -k, 1e-12);
        ck_assert_double_eq_tol(kxx[20 + i], -k, 1e-12);
        ck_assert_double_eq_tol(dvv[i], -c, 1e-12);
        ck_assert_double_eq_tol(dvv[12 + i], 0, 1e-12);
    }
    const struct cs_eval all = {.x = plate.x, .v = plate.v, .parts = CS_PART_ALL};
    cs_spectral_bounds_at(plate.system, &all, work, &omega, &delta);
    ck_assert_double_ge(omega, sqrt(k / 0.025));
    ck_assert_double_ge(delta, c / (2 * 0.025));
    fixture_close(&plate);
}

/* Smooth friction of a plate at rest counts in full for a method that resolves it, and for the
 * step of an explicit one up to 64 times the frequency of the contact, beside its damper; where
 * nothing has weight, as in an impact, up to 24 times. */
TEST(friction_limits_explicit_steps_so_far) {
    static const struct {
        double ev, tau, gravity, ratio;
    } of[] = {
        {1e-2, 0, -9.81, 64}, {1e-4, 0, -9.81, 64}, {1e-4, 2e-3, -9.81, 64}, {1e-4, 0, 0, 24}};
    for (size_t k = 0; k < LENGTH(of); k++) {
        struct fixture plate;
        char more[120];
        double work[8], w, all, step;
        snprintf(more, sizeof more,
                 ", \"friction_speed\": %g, \"damping\": %g}, \"forces\": {\"gravity\": [0, "
                 "%g, 0]}",
                 of[k].ev, of[k].tau, of[k].gravity);
        fixture_open(&plate, "velocity-verlet", FLAT, 0.3, "smooth", 80.0, more);
        fixture_start(&plate);
        const struct cs_eval at = {.x = plate.x, .v = plate.v, .parts = CS_PART_ALL};
        cs_spectral_bounds_rate(plate.system, &at, false, work, &w, &all);
        cs_spectral_bounds_rate(plate.system, &at, true, work, &w, &step);
        const struct cs_barrier barrier = cs_barrier_at(0.009, 0.02, 80);
        const double damper = of[k].tau * barrier.stiffness / (2 * 0.025);
        const double friction = 0.3 * barrier.force / of[k].ev / (2 * 0.025);
        ck_assert_double_eq_tol(w, sqrt(barrier.stiffness / 0.025), 1e-9 * w);
        ck_assert_double_eq_tol(all, damper + friction, 1e-9 * all);
        const double most = of[k].ratio / 2 * w;
        ck_assert_double_eq_tol(step, damper + fmin(friction, most), 1e-9 * step);
        ck_assert(k == 0 ? friction < most : friction > most);
        fixture_close(&plate);
    }
}

/* Above the limit the force is mu N, against the trial; a step then leaves the spring at the
 * limit, and a point out of range takes its anchor along. */
TEST(anchor_follows_a_point_that_slips) {
    struct fixture plate;
    double f[12], again[12], normal[12];
    fixture_open(&plate, "rk4", FLAT, 0.3, "stick", 80.0, "}");
    fixture_start(&plate);
    for (int i = 0; i < 4; i++)
        plate.x[i] += 0.01, plate.v[i] = 0.5;
    struct cs_eval at = {.x = plate.x, .v = plate.v, .parts = CS_PART_POTENTIAL};
    cs_terms_force(plate.system, &at, normal);
    at.parts = CS_PART_DISSIPATIVE;
    cs_terms_force(plate.system, &at, f);
    cs_friction_anchors_commit(plate.system, 0, plate.x, plate.v);
    cs_terms_force(plate.system, &at, again);
    for (int i = 0; i < 4; i++) {
        ck_assert_double_eq_tol(f[i], -0.3 * normal[4 + i], 1e-14);
        ck_assert_double_eq_tol(again[i], f[i], 1e-14);
        ck_assert_double_eq_tol(plate.x[i] - plate.system->friction_anchors->values[i],
                                0.3 * normal[4 + i] / 80, 1e-14);
        plate.x[4 + i] = 0.03;
    }
    cs_friction_anchors_commit(plate.system, 0, plate.x, plate.v);
    ck_bits(plate.x, plate.system->friction_anchors->values, 12, "anchors out of range");
    fixture_close(&plate);
}

/* A push that friction resists stores F^2/(2 k) a particle in springs, which the ledger books
 * as work against friction, and gives back when it ends. */
TEST(ledger_closes) {
    struct cs_energy_ledger ledger;
    struct cs_error error = {0};
    struct fixture plate;
    fixture_open(&plate, "dopri5:rtol=1e-10,atol=1e-12", FLAT, 0.8, "stick", 80.0,
                 "}, \"events\": [{\"from\": 0, \"to\": 1, \"impact\": {\"direction\": [1, 0, "
                 "0], \"impulse\": 0.2}}]");
    plate.session.settings.run.ledger = &ledger;
    cs_energy_ledger_open(&ledger, plate.system, 0, &error);
    ck_assert(!error.status);
    const double start = cs_energy_ledger_sum(&ledger);
    fixture_start(&plate);
    fixture_frames(&plate, 30);
    double work = 0;
    for (int k = 0; k < CS_WORKS; k++)
        work += ledger.work[k];
    ck_assert_double_eq_tol(cs_energy_ledger_sum(&ledger) - start, work, 1e-12);
    ck_assert_double_eq_tol(ledger.work[CS_WORK_FRICTION], -4 * 0.05 * 0.05 / 80, 1e-9);
    ck_assert_double_le(fabs(ledger.work[CS_WORK_INTEGRATOR]), 1e-8);
    fixture_frames(&plate, 60);
    ck_assert_double_eq_tol(ledger.work[CS_WORK_FRICTION], -4 * 0.05 * 0.05 / 80, 1e-9);
    cs_energy_ledger_close(&ledger);
    fixture_close(&plate);
}

TEST(smooth_scenes_have_no_anchors) {
    static const char *const laws[] = {"smooth", "stick"};
    for (size_t k = 0; k < LENGTH(laws); k++) {
        struct fixture plate;
        fixture_open(&plate, "rk4", FLAT, 0.3, laws[k], 80.0, "}");
        fixture_start(&plate);
        const struct cs_plan_row *row =
            plate.session.run.plan.rows + CS_FEATURE_FRICTION_ANCHORS;
        ck_assert(!plate.system->friction_anchors == !k && row->built == !!k);
        ck_assert((row->bytes > 0) == !!k);
        ck_assert_str_eq(row->reason, k ? "contact.friction_law is stick"
                                        : "contact.friction_law is smooth");
        ck_assert(!cs_run_calls(&plate.session.run)->may_overstep);
        fixture_close(&plate);
        // where nothing can ever slide there is no anchor
        fixture_open(&plate, "rk4", FLAT, 0.0, laws[k], 80.0, "}");
        ck_assert_ptr_null(plate.system->friction_anchors);
        fixture_close(&plate);
    }
}
