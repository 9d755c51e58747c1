/* Bending against closed forms: curvatures of quadratic surfaces, frequencies of plates and
 * strips, a strip under its own weight. */
#include "fixture.h"
#include "model/elastic/bendings.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/solver/linear.h"
#include "scene/elastic_keys.h"
#include "sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- curvatures --- */

/* H: x_XX, x_YY, x_XY of a surface */
static const double surfaces[][3] = {{1, 0, 0},        {0, 1, 0}, {0.5, 0.5, 0.5},
                                     {0.5, 0.5, -0.5}, {0, 0, 1}, {1, -1, 0}};

static void open_sheet(struct fixture *sheet, int pattern, int cells, const char *bending) {
    sheet_write(pattern < 0 ? SHEET_BACK : (enum sheet_pattern)pattern, cells + 1, cells + 1, 1,
                1, 0);
    fixture_open(
        sheet, "backward-euler",
        "{\"bodies\": [{%s, \"elastic\": {\"membrane\": {\"young\": 1}, \"bending\": "
        "%s}, \"mass\": {\"areal_density\": 1}}], \"forces\": {\"gravity\": [0, 0, 0]}}",
        pattern < 0 ? "\"cloth\": {\"grid\": [9, 9], \"size\": [1, 1]}"
                    : "\"mesh\": {\"file\": \"sheet.obj\"}",
        bending);
}

/* Checks the curvature that a stencil finds on the quadratic surface of H. */
static void check_stencil(const struct fixture *sheet, const struct cs_bending_stencil *stencil,
                          const double H[3], const double *z) {
    const double exact[3] = {H[0], H[1], 2 * H[2]};
    const struct cs_moduli *D = &stencil->moduli;
    const bool has[3] = {D->warp > 0, D->weft > 0, D->shear > 0};
    (void)sheet;
    for (int a = 0; a < 3; a++) {
        double k = 0, weights = 0;
        for (uint32_t j = 0; j < stencil->n; j++) {
            k += stencil->weights[a][j] * z[stencil->at[j]];
            weights += fabs(stencil->weights[a][j]);
        }
        if (has[a] && weights > 0)
            ck_assert_msg(fabs(k - exact[a]) < 1e-9, "curvature %d is %.12g, not %g", a, k,
                          exact[a]);
    }
}

/* Every stencil inside finds the curvatures of a quadratic exactly, on any mesh. */
TEST(curvatures_of_quadratics_are_exact) {
    for (int pattern = -1; pattern <= SHEET_IRREGULAR; pattern++)
        for (size_t h = 0; h < LENGTH(surfaces); h++) {
            struct fixture sheet;
            uint32_t checked = 0;
            open_sheet(&sheet, pattern, 8, "1");
            const size_t n = sheet.n;
            const struct cs_bending *bending = sheet.system->bendings->bodies;
            const struct cs_moduli moduli = {1, 1, 0, 0.5};
            double z[81];
            for (size_t i = 0; i < n; i++) {
                const double X = sheet.x[i], Y = -sheet.x[n + i] * (pattern < 0 ? 1 : -1);
                z[i] = surfaces[h][0] * X * X / 2 + surfaces[h][1] * Y * Y / 2 +
                       surfaces[h][2] * X * Y;
            }
            for (uint32_t s = 0; s < bending->n; s++) {
                struct cs_bending_stencil stencil;
                bool inside = true;
                cs_bending_stencil_at(bending, &moduli, s, &stencil);
                // a mesh has no quadratic at rims: there a point stands twice
                for (uint32_t j = 1; j < stencil.n; j++)
                    inside &= pattern < 0 || stencil.at[j] != stencil.at[0];
                if (inside && stencil.n) {
                    check_stencil(&sheet, &stencil, surfaces[h], z);
                    checked++;
                }
            }
            ck_assert_uint_gt(checked, 60);
            fixture_close(&sheet);
        }
}

/* --- frequencies --- */

/* A simply supported square plate of side 1, D = rho = 1: omega = 2 pi^2. Its first mode is a
 * product of sines on a grid too: the force on it is -rho omega_h^2 times the displacement. */
static double plate_error(int cells) {
    struct fixture plate;
    fixture_open(&plate, "rk4",
                 "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d], \"size\": [1, 1]}, \"pins\": "
                 "[\"edges\"], \"elastic\": {\"membrane\": {\"young\": 1e-6}, \"bending\": 1}, "
                 "\"mass\": {\"areal_density\": 1}}], \"forces\": {\"gravity\": [0, 0, 0]}}",
                 cells + 1, cells + 1);
    const size_t n = plate.n;
    double *u = calloc(6 * n, sizeof *u), *f = u + 3 * n, square = 0;
    for (size_t i = 0; i < n; i++)
        u[2 * n + i] = cos(M_PI * plate.x[i]) * cos(M_PI * plate.x[n + i]);
    const struct cs_eval at = {
        .x = plate.x, .v = plate.v, .dx = u, .parts = CS_PART_LINEARISED};
    cs_terms_jvp(plate.system, &at, f);
    for (size_t i = 0; i < n; i++) {
        if (plate.system->inv_mass[i] <= 0)
            continue;
        const double own = -f[2 * n + i] * plate.system->inv_mass[i] / u[2 * n + i];
        square = square > 0 ? square : own;
        ck_assert_double_eq_tol(own, square, 1e-6 * square);
    }
    free(u);
    fixture_close(&plate);
    return sqrt(square) / (2 * M_PI * M_PI) - 1;
}

TEST(plate_has_the_frequency_of_theory) {
    const double coarse = plate_error(16), fine = plate_error(64);
    ck_assert_msg(fabs(coarse) < 0.0035 && fabs(fine) < 0.0003, "%g at 16, %g at 64 cells",
                  coarse, fine);
    ck_assert_double_eq_tol(log2(coarse / fine) / 2, 2, 0.2);
}

/* The lowest frequency across a sheet in the xz plane by inverse iteration, in 1/s. */
static double lowest(const struct fixture *sheet) {
    const size_t n = sheet->n;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_linear linear;
    double *u = calloc(9 * n, sizeof *u), *b = u + 3 * n, *f = b + 3 * n, square = 0;
    const struct cs_matrix matrix = {
        .x = sheet->x, .v = sheet->v, .cm = 1e-9, .ck = -1, .psd = true};
    ck_assert_int_eq(cs_linear_init(&linear, sheet->system, &arena, &error), CS_OK);
    cs_linear_setup(&linear, &matrix);
    for (size_t i = 0; i < n; i++)
        u[n + i] = sheet->system->inv_mass[i] > 0;
    for (int k = 0; k < 6; k++) {
        uint64_t iterations;
        double residual, mass = 0, energy = 0;
        for (size_t i = 0; i < n; i++)
            b[n + i] = sheet->system->mass[i] * u[n + i];
        memset(u, 0, 3 * n * sizeof *u);
        ck_assert_int_eq(cs_linear_solve(&linear, b, 1e-9, u, &iterations, &residual),
                         CS_LINEAR_DONE);
        const struct cs_eval at = {
            .x = sheet->x, .v = sheet->v, .dx = u, .parts = CS_PART_LINEARISED};
        cs_terms_jvp(sheet->system, &at, f);
        for (size_t i = 0; i < n; i++) {
            mass += sheet->system->mass[i] * u[n + i] * u[n + i];
            energy -= f[n + i] * u[n + i];
        }
        square = energy / mass;
        for (size_t i = 0; i < n; i++)
            u[n + i] /= sqrt(mass);
    }
    free(u);
    cs_arena_finish(&arena);
    return sqrt(square);
}

/* Opens a strip along x of free length `length` whose first two columns are held: they clamp it
 * half a cell in. body: more keys of the body. */
static void open_strip(struct fixture *strip, int cells, int pattern, double length,
                       const char *body, double gravity) {
    const int across = cells >= 16 ? cells / 8 : 1;
    const double h = length / (cells - 0.5), width = cells * h;
    char shape[160];
    sheet_write(pattern < 0 ? SHEET_BACK : (enum sheet_pattern)pattern, cells + 1, across + 1,
                width, length / 8, 2);
    if (pattern < 0)
        snprintf(
            shape, sizeof shape,
            "\"cloth\": {\"grid\": [%d, %d], \"size\": [%.17g, %.17g], \"start\": \"flat\"}",
            cells + 1, across + 1, width, length / 8);
    else // laid flat, and moved to where a grid is
        snprintf(
            shape, sizeof shape,
            "\"mesh\": {\"file\": \"sheet.obj\", \"place\": {\"matrix\": [1, 0, 0, 0, 0, 1, "
            "0, -1, 0], \"translate\": [%.17g, 0, 0]}}",
            -width / 2);
    fixture_open(strip, "backward-euler:rtol=1e-10",
                 "{\"bodies\": [{%s, \"pins\": [{\"box\": {\"min\": [-9, -9, -9], \"max\": "
                 "[%.17g, 9, 9]}}], %s}], \"forces\": {\"gravity\": [0, %.17g, 0]}, \"time\": "
                 "{\"fps\": 0.1}}",
                 shape, -width / 2 + 1.1 * h, body, -gravity);
}

/* A strip with D = rho = 1 and no Poisson effect: error of its first frequency 3.516015, the
 * square of the first root of 1 + cos b cosh b = 0. */
static double strip_error(int cells, int pattern) {
    struct fixture strip;
    open_strip(
        &strip, cells, pattern, 1,
        "\"mass\": {\"areal_density\": 1}, \"elastic\": {\"membrane\": {\"young\": 1e-3},"
        " \"bending\": {\"stiffness\": 1, \"poisson\": 0}}",
        0);
    const double error = lowest(&strip) / 3.516015 - 1;
    fixture_close(&strip);
    return error;
}

TEST(strip_has_the_frequency_of_theory) {
    const double coarse = strip_error(16, -1), fine = strip_error(64, -1);
    ck_assert_msg(fabs(coarse) < 0.0035 && fabs(fine) < 0.0003, "%g at 16, %g at 64 cells",
                  coarse, fine);
    ck_assert_double_eq_tol(log2(coarse / fine) / 2, 2, 0.2);
}

/* Meshes come near, and irregular ones do not converge to 0. */
TEST(strips_of_triangles_are_near) {
    for (int pattern = SHEET_BACK; pattern <= SHEET_IRREGULAR; pattern++)
        for (int cells = 8; cells <= 32; cells *= 2) {
            const double error = strip_error(cells, pattern);
            ck_assert_msg(fabs(error) < 0.05, "%d cells, pattern %d: %g", cells, pattern,
                          error);
        }
}

/* --- a strip under its own weight --- */

/* Drop of the tip over the length of an inextensible strip that leaves its clamp horizontally:
 * D theta'' = -rho g (L - s) cos theta, with q = rho g L^3/D (Love 1927). Shooting
 * by bisection for the curvature at the clamp, with the midpoint rule. */
static double elastica(double q) {
    enum { STEPS = 20000 };
    double low = 0, high = q, drop = 0;
    for (int k = 0; k < 60; k++) {
        const double ds = 1.0 / STEPS;
        double theta = 0, curvature = 0.5 * (low + high);
        drop = 0;
        for (int i = 0; i < STEPS; i++) {
            const double s = i * ds, middle = theta + ds / 2 * curvature;
            const double half = curvature - ds / 2 * q * (1 - s) * cos(theta);
            drop += ds * sin(middle);
            curvature -= ds * q * (1 - s - ds / 2) * cos(middle);
            theta += ds * half;
        }
        *(curvature > 0 ? &high : &low) = 0.5 * (low + high);
    }
    return drop;
}

/* The drop of a strip of 0.1 m at rest over its length, for q = 10. */
static double strip_drop(int cells, int pattern) {
    struct fixture strip;
    double drop = 0, fastest = 0;
    uint32_t ends = 0;
    open_strip(
        &strip, cells, pattern, 0.1,
        "\"mass\": {\"areal_density\": 0.2}, \"elastic\": {\"membrane\": {\"young\": 100,"
        " \"poisson\": 0}, \"bending\": {\"stiffness\": 1e-4, \"poisson\": 0}}",
        5);
    const size_t n = strip.n;
    double end = -HUGE_VAL;
    for (size_t i = 0; i < n; i++)
        end = fmax(end, strip.x[i]);
    bool *is_end = calloc(n, sizeof *is_end);
    for (size_t i = 0; i < n; i++)
        is_end[i] = strip.x[i] > end - 1e-9;
    fixture_start(&strip);
    fixture_frames(&strip, 40);
    for (size_t i = 0; i < n; i++) {
        fastest = fmax(fastest, fabs(strip.v[n + i]));
        drop -= is_end[i] ? strip.x[n + i] : 0;
        ends += is_end[i];
    }
    ck_assert_msg(fastest < 1e-7, "it still moves at %g m/s", fastest);
    free(is_end);
    fixture_close(&strip);
    return drop / ends / 0.1;
}

TEST(strip_hangs_as_the_elastica) {
    const double exact = elastica(10);
    ck_assert_double_eq_tol(exact, 0.70020, 1e-5);
    const double coarse = strip_drop(8, -1) / exact - 1, fine = strip_drop(32, -1) / exact - 1;
    ck_assert_msg(fabs(coarse) < 0.005 && fabs(fine) < 0.001, "%g at 8, %g at 32 cells", coarse,
                  fine);
}

TEST(strips_of_triangles_hang_near_the_elastica) {
    const double exact = elastica(10);
    for (int pattern = SHEET_BACK; pattern <= SHEET_IRREGULAR; pattern++) {
        const double error = strip_drop(16, pattern) / exact - 1;
        ck_assert_msg(fabs(error) < 0.02, "pattern %d: %g", pattern, error);
    }
}

/* --- a strip between two bars --- */

/* Sag of an inextensible strip of length 1 over a span: 2 a sinh(span/(2 a)) = 1 for its
 * parameter a, by bisection. */
static double catenary(double span) {
    double low = 1e-3, high = 5;
    for (int k = 0; k < 60; k++) {
        const double u = 0.5 * (low + high);
        *(sinh(u) / u < 1 / span ? &low : &high) = u;
    }
    return span / (2 * low) * (cosh(low) - 1);
}

/* Without stiffness against bending a strip hangs as a catenary. Its weight of 0.3 N stretches
 * it by 1e-4, which is 3e-4 of the sag. */
TEST(strip_hangs_as_a_catenary) {
    const double span = 0.8, exact = catenary(span);
    struct fixture strip;
    double lowest_y = 0;
    ck_assert_double_eq_tol(exact, 0.265438, 1e-6);
    fixture_open(
        &strip, "backward-euler:rtol=1e-9",
        "{\"bodies\": [{\"cloth\": {\"grid\": [33, 2], \"size\": [1, 0.1], \"start\": "
        "\"flat\", \"stretch\": [%g, 1]}, \"pins\": [\"left\", \"right\"], \"mass\": "
        "{\"areal_density\": 0.3}, \"elastic\": {\"membrane\": {\"young\": 3e4, \"poisson\": "
        "0}}}], \"time\": {\"fps\": 1}}",
        span);
    const size_t n = strip.n;
    // hung up as a parabola, so that nothing buckles
    for (size_t i = 0; i < n; i++) {
        const double s = 2 * strip.x[i] / span;
        strip.x[n + i] -= exact * (1 - s * s);
    }
    fixture_start(&strip);
    fixture_frames(&strip, 40);
    for (size_t i = 0; i < n; i++)
        lowest_y = fmin(lowest_y, strip.x[n + i]);
    ck_assert_msg(fabs(-lowest_y / exact - 1) < 2e-3, "sag %.6g instead of %.6g", -lowest_y,
                  exact);
    fixture_close(&strip);
}
