/* Membranes against closed forms: moduli that depend neither on the mesh nor on the direction,
 * motion in a moving frame, the bound on their frequency, the order of the methods. */
#include "base/pool.h"
#include "methods.h"
#include "model/elastic/membrane_forces.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define YOUNG   1200.0
#define POISSON 0.3
#define ELASTIC "\"elastic\": {\"membrane\": {\"young\": 1200, \"poisson\": 0.3}}"
#define REST    "\"mass\": {\"areal_density\": 0.2}}], \"forces\": {\"gravity\": [0, 0, 0]}}"

/* A sheet of 1 m as a grid, or as a mesh of a pattern. */
static void open_sheet(struct fixture *sheet, int cells, int pattern) {
    if (pattern < 0) {
        fixture_open(
            sheet, "rk4",
            "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d], \"size\": [1, 1]}, " ELASTIC
            ", " REST,
            cells + 1, cells + 1);
        return;
    }
    sheet_write((enum sheet_pattern)pattern, cells + 1, cells + 1, 1, 1, 0);
    fixture_open(sheet, "rk4",
                 "{\"bodies\": [{\"mesh\": {\"file\": \"sheet.obj\"}, " ELASTIC ", " REST);
}

/* F with the principal Green strains e and -POISSON e, along `angle` and across it. */
static void stretch(double angle, double e, double F[2][2]) {
    const double c = cos(angle), s = sin(angle);
    const double along = sqrt(1 + 2 * e), across = sqrt(1 - 2 * POISSON * e);
    F[0][0] = along * c * c + across * s * s;
    F[1][1] = along * s * s + across * c * c;
    F[0][1] = F[1][0] = (along - across) * c * s;
}

/* x = F x, then turned about an axis out of the plane, and shifted. */
static void deform(struct fixture *sheet, double F[2][2]) {
    const size_t n = sheet->n;
    for (size_t i = 0; i < n; i++) {
        const double X = sheet->x[i], Y = sheet->x[n + i];
        const double u = F[0][0] * X + F[0][1] * Y, w = F[1][0] * X + F[1][1] * Y;
        sheet->x[i] = u;
        sheet->x[n + i] = 0.6 * w + 0.1;
        sheet->x[2 * n + i] = 0.8 * w;
    }
}

/* Tells whether particle i is at the sheet's rim at rest. */
static bool is_rim(const struct fixture *sheet, size_t i, const double *start) {
    const size_t n = sheet->n;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (size_t c = 0; c < 2; c++)
        for (size_t k = 0; k < n; k++) {
            low[c] = fmin(low[c], start[c * n + k]);
            high[c] = fmax(high[c], start[c * n + k]);
        }
    return start[i] < low[0] + 1e-9 || start[i] > high[0] - 1e-9 ||
           start[n + i] < low[1] + 1e-9 || start[n + i] > high[1] - 1e-9;
}

/* A strip that is free to narrow has the energy A/2 Y e^2 for Green's strain e: Young's modulus
 * and Poisson's ratio at once. Inside an even strain no particle feels a force. */
static void check_moduli(int cells, int pattern, double angle) {
    struct fixture sheet;
    double F[2][2], worst = 0, tension = 0;
    const double e = 0.05, exact = 0.5 * YOUNG * e * e;
    open_sheet(&sheet, cells, pattern);
    const size_t n = sheet.n;
    double *start = malloc(3 * n * sizeof *start), *f = calloc(3 * n, sizeof *f);
    memcpy(start, sheet.x, 3 * n * sizeof *start);
    stretch(angle, e, F);
    deform(&sheet, F);
    const struct cs_energy energy = cs_diagnostics_energy(sheet.system, 0, sheet.x, sheet.v);
    ck_assert_msg(fabs(energy.elastic / exact - 1) < 1e-10,
                  "%d cells, pattern %d, angle %g: energy %.13g, exact %.13g", cells, pattern,
                  angle, energy.elastic, exact);
    cs_diagnostics_force(sheet.system, 0, sheet.x, sheet.v, CS_PART_ALL, f);
    for (size_t i = 0; i < n; i++) {
        const double size = fabs(f[i]) + fabs(f[n + i]) + fabs(f[2 * n + i]);
        if (cells > 16 || is_rim(&sheet, i, start))
            tension = fmax(tension, size);
        else
            worst = fmax(worst, size);
    }
    ck_assert_msg(worst < 1e-10 * tension, "%d cells, pattern %d: %g N inside, %g N at rims",
                  cells, pattern, worst, tension);
    free(start);
    free(f);
    fixture_close(&sheet);
}

TEST(moduli_do_not_depend_on_mesh_or_direction) {
    static const int cells[] = {8, 16, 128};
    for (int pattern = -1; pattern <= SHEET_IRREGULAR; pattern++)
        for (size_t k = 0; k < LENGTH(cells); k++)
            for (int angle = 0; angle <= 90; angle += 45)
                check_moduli(cells[k], pattern, angle * M_PI / 180);
}

/* At 0 degrees the force on the strip's end is the tension (1 + u') Y e times its width, and
 * none acts on its sides. */
TEST(tension_pulls_at_the_ends_alone) {
    for (int pattern = -1; pattern <= SHEET_IRREGULAR; pattern++) {
        struct fixture sheet;
        double F[2][2], f[3 * 81], end = 0, side = 0;
        const double e = 0.05;
        open_sheet(&sheet, 8, pattern);
        double start[3 * 81];
        memcpy(start, sheet.x, sizeof start);
        stretch(0, e, F);
        deform(&sheet, F);
        cs_diagnostics_force(sheet.system, 0, sheet.x, sheet.v, CS_PART_ALL, f);
        const double low = fmin(start[0], start[8]);
        for (size_t i = 0; i < 81; i++) {
            end += start[i] < low + 1e-9 ? f[i] : 0;
            side = fmax(side, fabs(f[81 + i]) + fabs(f[162 + i]));
        }
        ck_assert_double_eq_tol(end, sqrt(1 + 2 * e) * YOUNG * e, 1e-9);
        ck_assert_double_lt(side, 1e-10);
        fixture_close(&sheet);
    }
}

/* Warp and weft have their own moduli, along and across. */
TEST(orthotropic_moduli_are_those_given) {
    static const struct {
        double strain[3], energy; /* XX, YY, twice XY; J/m2 */
    } cases[] = {{{0.04, 0, 0}, 0.5 * 5000 * 0.04 * 0.04},
                 {{0, 0.03, 0}, 0.5 * 3000 * 0.03 * 0.03},
                 {{0, 0, 0.1}, 0.5 * 60 * 0.1 * 0.1},
                 {{0.04, 0.03, 0},
                  0.5 * (5000 * 0.04 * 0.04 + 3000 * 0.03 * 0.03 + 2 * 400 * 0.04 * 0.03)}};
    for (int mesh = 0; mesh < 2; mesh++)
        for (size_t k = 0; k < LENGTH(cases); k++) {
            struct fixture sheet;
            sheet_write(SHEET_IRREGULAR, 9, 9, 1, 1, 0);
            fixture_open(&sheet, "rk4",
                         "{\"bodies\": [{%s, \"elastic\": {\"membrane\": {\"warp\": 5000, "
                         "\"weft\": 3000, \"shear\": 60, \"coupling\": 400}}, " REST,
                         mesh ? "\"mesh\": {\"file\": \"sheet.obj\"}"
                              : "\"cloth\": {\"grid\": [9, 9], \"size\": [1, 1]}");
            /* F upper triangular with F^T F = I + 2 E */
            const double a = sqrt(1 + 2 * cases[k].strain[0]), b = cases[k].strain[2] / a;
            double F[2][2] = {{a, b}, {0, sqrt(1 + 2 * cases[k].strain[1] - b * b)}};
            deform(&sheet, F);
            const struct cs_energy found =
                cs_diagnostics_energy(sheet.system, 0, sheet.x, sheet.v);
            ck_assert_double_eq_tol(found.elastic, cases[k].energy, 1e-10);
            fixture_close(&sheet);
        }
}

/* A rigid velocity changes no force, damped or not: damping is on the rate of strain. */
TEST(rigid_motion_is_not_damped) {
    for (int mesh = 0; mesh < 2; mesh++) {
        struct fixture sheet;
        double f[3 * 81], moving[3 * 81], largest = 0;
        sheet_write(SHEET_IRREGULAR, 9, 9, 1, 1, 0);
        fixture_open(&sheet, "rk4",
                     "{\"bodies\": [{%s, \"elastic\": {\"membrane\": {\"young\": 1200}, "
                     "\"bending\": 0.01, \"damping\": 0.01}, " REST,
                     mesh ? "\"mesh\": {\"file\": \"sheet.obj\"}"
                          : "\"cloth\": {\"grid\": [9, 9], \"size\": [1, 1]}");
        cs_perturb_smooth(sheet.system, 0.05, 0);
        cs_diagnostics_force(sheet.system, 0, sheet.x, sheet.v, CS_PART_ALL, f);
        for (size_t i = 0; i < 81; i++) {
            sheet.v[i] = 0.3 - sheet.x[81 + i];
            sheet.v[81 + i] = sheet.x[i] - 0.5 * sheet.x[162 + i];
            sheet.v[162 + i] = 0.5 * sheet.x[81 + i];
        }
        cs_diagnostics_force(sheet.system, 0, sheet.x, sheet.v, CS_PART_ALL, moving);
        for (size_t k = 0; k < 3 * 81; k++)
            largest = fmax(largest, fabs(f[k]));
        for (size_t k = 0; k < 3 * 81; k++)
            ck_assert_double_lt(fabs(moving[k] - f[k]), 1e-15 * largest);
        fixture_close(&sheet);
    }
}

/* Largest eigenvalue of -M^-1 df/dx by power iteration, in 1/s2. */
static double largest_square(const struct fixture *sheet) {
    const size_t n3 = 3 * sheet->n;
    double *p = malloc(n3 * sizeof *p), *df = malloc(n3 * sizeof *df), value = 0;
    uint64_t seed = 3;
    for (size_t k = 0; k < n3; k++)
        p[k] = sheet_random(&seed);
    for (int k = 0; k < 400; k++) {
        const struct cs_eval at = {
            .x = sheet->x, .v = sheet->v, .dx = p, .parts = CS_PART_LINEARISED};
        double norm = 0;
        cs_terms_jvp(sheet->system, &at, df);
        for (size_t i = 0; i < n3; i++) {
            df[i] *= sheet->system->inv_mass[i % sheet->n];
            norm += df[i] * df[i];
        }
        value = sqrt(norm);
        for (size_t i = 0; i < n3; i++)
            p[i] = df[i] / value;
    }
    free(p);
    free(df);
    return value;
}

/* Ratio of the bound to the frequency: 1 at best. */
static double check_bound(double young, double bending, bool mesh, double stretched) {
    struct fixture sheet;
    double *work, omega, delta;
    sheet_write(SHEET_IRREGULAR, 33, 33, 1, 1, 0);
    fixture_open(&sheet, "rk4",
                 "{\"bodies\": [{%s, \"elastic\": {\"membrane\": {\"young\": %g}, \"bending\": "
                 "%g}, " REST,
                 mesh ? "\"mesh\": {\"file\": \"sheet.obj\"}"
                      : "\"cloth\": {\"grid\": [33, 33], \"size\": [1, 1]}",
                 young, bending);
    for (size_t k = 0; k < 3 * sheet.n; k++)
        sheet.x[k] *= stretched;
    work = malloc(2 * sheet.n * sizeof *work);
    const struct cs_eval at = {.x = sheet.x, .v = sheet.v, .parts = CS_PART_ALL};
    cs_spectral_bounds_at(sheet.system, &at, work, &omega, &delta);
    const double ratio = omega / sqrt(largest_square(&sheet));
    free(work);
    fixture_close(&sheet);
    return ratio;
}

TEST(bounds_are_above_and_near_the_frequency) {
    static const double stretched[] = {1, 1.3};
    for (int mesh = 0; mesh < 2; mesh++)
        for (int bends = 0; bends < 2; bends++)
            for (size_t k = 0; k < LENGTH(stretched); k++) {
                const double ratio =
                    check_bound(bends ? 1e-3 : 1000, bends ? 1e-2 : 1e-9, mesh, stretched[k]);
                ck_assert_msg(ratio > 0.999 && ratio < (mesh ? 1.45 : 1.25),
                              "%s, %s, stretched %g: bound %.3f of the frequency",
                              mesh ? "mesh" : "grid", bends ? "bending" : "membrane",
                              stretched[k], ratio);
            }
}

/* hung at two corners, stirred, slow enough to be smooth over a step */
#define HUNG                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"particle\": 0.1}, "            \
    "\"elastic\": "                                                                            \
    "{\"membrane\": {\"young\": 40, \"poisson\": 0.3}, \"bending\": 0.3, \"damping\": %g}, "   \
    "\"pins\": [\"top-left\", \"top-right\"]}], \"time\": {\"fps\": 10}}"

static uint32_t end_state(const char *integrator, double damping, double state[96]) {
    struct fixture cloth;
    fixture_open(&cloth, integrator, HUNG, damping);
    cs_perturb_smooth(cloth.system, 0.01, 0.2);
    fixture_start(&cloth);
    fixture_frames(&cloth, 3);
    memcpy(state, cloth.x, 96 * sizeof *state);
    const struct cs_integrator *method = cloth.session.method.integrator;
    const uint32_t order = damping == 0 ? method->order : method->order_damped;
    fixture_close(&cloth);
    return order;
}

/* Slope of the error from h to h/2, against a step far finer. */
static void check_order(const struct method_asked *method, double damping) {
    double reference[96], state[96], error[2];
    const double h = method->traits & CS_NOT_GALILEAN ? 2.5e-5 : methods_step(method->order);
    end_state("dopri5:rtol=1e-13", damping, reference);
    uint32_t order = 0;
    for (int k = 0; k < 2; k++) {
        char integrator[120];
        methods_set(integrator, method->text, "dt", k ? h / 2 : h);
        order = end_state(integrator, damping, state);
        error[k] = cs_rms_difference(state, reference, 48);
    }
    const double slope = log2(error[0] / error[1]);
    ck_assert_msg(fabs(slope - order) < 0.2, "%s, damping %g: order %.3f, stated %u",
                  method->text, damping, slope, order);
}

TEST(methods_have_their_order) {
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "membrane", .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER, .residual = 1e-12});
    for (size_t i = 0; i < methods.n; i++)
        for (int damped = 0; damped < 2; damped++)
            check_order(methods.list + i, damped ? 0.01 : 0);
}

/* end of a run of methods with error control, for methods_check_agreement */
static void end_of(const char *method, const char *value, double *state) {
    (void)value;
    end_state(method, 0.01, state);
}

TEST(methods_with_error_control_agree) {
    methods_check_agreement(end_of, "", 96);
}

/* Iterations per solve to 1e-6 of a sheet of 1 m that hangs by two corners, in steps of 1/60 s.
 */
static double iterations_of(int cells, bool mesh) {
    struct fixture sheet;
    char shape[80] = "\"mesh\": {\"file\": \"sheet.obj\"}";
    sheet_write(SHEET_IRREGULAR, cells + 1, cells + 1, 1, 1, 0);
    if (!mesh)
        snprintf(shape, sizeof shape, "\"cloth\": {\"grid\": [%d, %d], \"size\": [1, 1]}",
                 cells + 1, cells + 1);
    fixture_open(
        &sheet, "implicit-linearised:rtol=1e-6",
        "{\"bodies\": [{%s, \"pins\": [0, %d], \"elastic\": {\"membrane\": {\"young\": "
        "1000}, \"bending\": 1e-6}, \"mass\": {\"areal_density\": 0.2}}]}",
        shape, cells);
    fixture_start(&sheet);
    fixture_frames(&sheet, 4);
    const struct cs_counts *counts = &sheet.session.run.counts;
    const double found = (double)counts->solve_iterations / (double)counts->solves;
    fixture_close(&sheet);
    return found;
}

TEST(iterations_hardly_grow_with_the_mesh) {
    for (int mesh = 0; mesh < 2; mesh++) {
        const double coarse = iterations_of(32, mesh), fine = iterations_of(128, mesh);
        ck_assert_msg(fine < 45 && fine < 1.5 * coarse,
                      "%s: %.1f iterations at 32 cells, %.1f at 128", mesh ? "mesh" : "grid",
                      coarse, fine);
    }
}

/* An even stretch of 10 % along the rows, which narrows the sheet by Poisson's ratio. */
TEST(strain_is_the_principal_one) {
    for (int pattern = -1; pattern <= SHEET_IRREGULAR; pattern++) {
        struct fixture sheet;
        double F[2][2], strain[81];
        open_sheet(&sheet, 8, pattern);
        stretch(M_PI / 5, (1.1 * 1.1 - 1) / 2, F);
        deform(&sheet, F);
        ck_assert_double_eq_tol(cs_diagnostics_strain(sheet.system, sheet.x), 0.1, 1e-12);
        cs_diagnostics_particle_strain(sheet.system, sheet.x, strain);
        for (int i = 0; i < 81; i++)
            ck_assert_double_eq_tol(strain[i], 0.1, 1e-12);
        fixture_close(&sheet);
    }
}

/* The same stretch is one of tension along a line: the stress is Young's modulus times Green's
 * strain, and the other principal stress is 0. */
TEST(stress_is_the_principal_one) {
    for (int pattern = -1; pattern <= SHEET_IRREGULAR; pattern++) {
        struct fixture sheet;
        double F[2][2], stress[81];
        open_sheet(&sheet, 8, pattern);
        stretch(M_PI / 5, (1.1 * 1.1 - 1) / 2, F);
        deform(&sheet, F);
        cs_membranes_particle_stress(sheet.system, sheet.x, stress);
        for (int i = 0; i < 81; i++)
            ck_assert_double_eq_tol(stress[i], 1200 * (1.1 * 1.1 - 1) / 2, 1e-9);
        fixture_close(&sheet);
    }
}

/* a grid and a mesh, each in several blocks of particles, after two frames */
static double *end_with(uint32_t threads, size_t *n) {
    struct fixture sheets;
    struct cs_error error = {0};
    cs_pool_start(threads, &error);
    sheet_write(SHEET_IRREGULAR, 31, 37, 1, 1, 0);
    fixture_open(
        &sheets, "implicit-linearised",
        "{\"bodies\": [{\"cloth\": {\"grid\": [33, 40], \"size\": [1, 1]}, \"pins\": "
        "[\"top\"], \"mass\": {\"areal_density\": 0.2}, \"elastic\": {\"membrane\": "
        "{\"young\": 900}, \"bending\": 1e-4, \"damping\": 1e-3}}, {\"mesh\": {\"file\": "
        "\"sheet.obj\"}, \"pins\": [5], \"mass\": {\"areal_density\": 0.2}, "
        "\"elastic\": {\"membrane\": {\"warp\": 900, \"weft\": 500, \"shear\": 20}, "
        "\"bending\": 1e-4, \"damping\": 1e-3}}]}");
    cs_perturb_smooth(sheets.system, 0.02, 0.5);
    fixture_start(&sheets);
    fixture_frames(&sheets, 2);
    *n = 6 * sheets.n;
    double *state = malloc(*n * sizeof *state);
    memcpy(state, sheets.x, *n * sizeof *state);
    fixture_close(&sheets);
    cs_pool_stop();
    return state;
}

TEST(threads_do_not_change_the_bits) {
    size_t n;
    double *one = end_with(1, &n), *five = end_with(5, &n), *two = end_with(2, &n);
    ck_bits(one, five, n, "five threads");
    ck_bits(one, two, n, "two threads");
    free(one);
    free(two);
    free(five);
}
