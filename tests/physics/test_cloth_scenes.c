/* Shipped scenes of elastic sheets against closed forms, and measured cloths in the tests of
 * the textile trade. */
#include "fixture.h"
#include "mesh/trimesh.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "scene/body_keys.h"
#include "sheet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Runs a shipped scene; cloth: of its first body, or NULL. */
static void run_scene(struct fixture *fixture, const char *name, const char *cloth,
                      double density, uint32_t frames) {
    char path[300], weight[40];
    struct cs_error error = {0};
    *fixture = (struct fixture){0};
    snprintf(path, sizeof path, SCENES "/%s.json", name);
    snprintf(weight, sizeof weight, "%g", density);
    const struct cs_override overrides[] = {{"bodies[0].elastic.cloth", cloth},
                                            {"bodies[0].mass.areal_density", weight}};
    const struct cs_session_settings settings = {
        .scene = path, .overrides = overrides, .n_overrides = cloth ? 2 : 0};
    cs_session_open_system(&fixture->session, &settings, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    cs_method_step_by_frames(&fixture->session.method);
    fixture->system = &fixture->session.system;
    fixture->n = fixture->system->view.n;
    fixture->x = fixture->system->state;
    fixture->v = fixture->x + 3 * fixture->n;
    fixture_start(fixture);
    fixture_frames(fixture, frames);
    double fastest = 0;
    for (size_t k = 0; k < 3 * fixture->n; k++)
        fastest = fmax(fastest, fabs(fixture->v[k]));
    ck_assert_msg(fastest < 1e-3, "%s still moves at %g m/s", name, fastest);
}

/* --- the elastica between two hinges --- */

/* Complete elliptic integrals K and E of modulus k, by arithmetic and geometric means. */
static void elliptic(double k, double *K, double *E) {
    double a = 1, b = sqrt(1 - k * k), sum = k * k / 2, power = 1;
    for (int i = 0; i < 20; i++) {
        const double mean = (a + b) / 2, c = (a - b) / 2;
        b = sqrt(a * b);
        a = mean;
        sum += power * c * c;
        power *= 2;
    }
    *K = M_PI / (2 * a);
    *E = *K * (1 - sum);
}

/* Height over length of an inextensible strip whose hinged ends are `span` of its length apart:
 * span = 2 E/K - 1, height = k/K (Love 1927). */
static double arch_height(double span) {
    double low = 0, high = 0.9999, K = 1, E;
    for (int i = 0; i < 60; i++) {
        const double k = (low + high) / 2;
        elliptic(k, &K, &E);
        *(2 * E / K - 1 > span ? &low : &high) = k;
    }
    return low / K;
}

TEST(buckled_sheet_is_the_elastica) {
    struct fixture arch;
    double height = 0;
    const double exact = arch_height(0.7);
    ck_assert_double_eq_tol(exact, 0.314313, 1e-6);
    run_scene(&arch, "arch", NULL, 0, 150);
    for (size_t i = 0; i < arch.n; i++)
        height = fmax(height, arch.x[arch.n + i] / 0.4);
    ck_assert_msg(fabs(height / exact - 1) < 2e-3, "height %.6f, exact %.6f", height, exact);
    fixture_close(&arch);
}

/* --- a cylinder under load along its axis --- */

/* With D = k^2 Y for the root k a cylinder buckles at a load of 2 sqrt(D Y)/R = 2 k Y/R per
 * width, in waves of wavenumber 1/sqrt(k R) (Timoshenko, Gere 1961, sec. 11.1); here three half
 * waves fill the length. */
#define RADIUS 0.1
#define ROOT   1e-3
#define YOUNG  1000.0
#define THEORY (2 * ROOT * YOUNG / RADIUS)
enum { ALONG = 18 }; // cells; 36 change the load by 3e-4

/* A cylinder of so many cells around z, at rest. */
static void open_cylinder(struct fixture *cylinder, int cells) {
    const double length = 3 * M_PI * sqrt(ROOT * RADIUS);
    FILE *file = fopen("cylinder.obj", "w");
    ck_assert(file);
    for (int i = 0; i <= ALONG; i++)
        for (int j = 0; j < cells; j++)
            fprintf(file, "v %.17g %.17g %.17g\n", RADIUS * cos(2 * M_PI * j / cells),
                    RADIUS * sin(2 * M_PI * j / cells), length * i / ALONG);
    for (int i = 0; i < ALONG; i++)
        for (int j = 0; j < cells; j++) {
            const int a = i * cells + j + 1, b = i * cells + (j + 1) % cells + 1;
            fprintf(file, "f %d %d %d\nf %d %d %d\n", a, b, a + cells, b, b + cells, a + cells);
        }
    fclose(file);
    fixture_open(cylinder, "rk4",
                 "{\"bodies\": [{\"mesh\": {\"file\": \"cylinder.obj\"}, \"mass\": "
                 "{\"areal_density\": 0.2}, \"elastic\": {\"membrane\": {\"young\": %g, "
                 "\"poisson\": 0}, \"bending\": {\"stiffness\": %g, \"poisson\": 0}}}]}",
                 YOUNG, ROOT * ROOT * YOUNG);
}

/* Compresses it by a Green's strain of -load/Y. */
static void compress_cylinder(const struct fixture *cylinder, const double *rest, double load) {
    for (size_t i = 0; i < cylinder->n; i++)
        cylinder->x[2 * cylinder->n + i] =
            rest[2 * cylinder->n + i] * sqrt(1 - 2 * load / YOUNG);
}

/* The second variation of the energy along the mode of theory, which is 0 at both ends. */
static double variation_of(const struct fixture *cylinder, const double *rest, double load) {
    const size_t n = cylinder->n;
    double *p = calloc(6 * n, sizeof *p), *df = p + 3 * n, found = 0;
    compress_cylinder(cylinder, rest, load);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 2; c++)
            p[c * n + i] =
                rest[c * n + i] / RADIUS * sin(rest[2 * n + i] / sqrt(ROOT * RADIUS));
    const struct cs_eval at = {
        .x = cylinder->x, .v = cylinder->v, .dx = p, .parts = CS_PART_ELASTIC};
    cs_terms_jvp(cylinder->system, &at, df);
    for (size_t k = 0; k < 3 * n; k++)
        found -= p[k] * df[k];
    free(p);
    return found;
}

/* The load at which it buckles along the mode of theory, over that of theory. */
static double buckling_load(int cells) {
    struct fixture cylinder;
    double load[2] = {0.5, 1.5}, found[2];
    open_cylinder(&cylinder, cells);
    double *rest = malloc(3 * cylinder.n * sizeof *rest);
    memcpy(rest, cylinder.x, 3 * cylinder.n * sizeof *rest);
    for (int k = 0; k < 2; k++)
        found[k] = variation_of(&cylinder, rest, load[k] * THEORY);
    // nearly linear in the load: the rule of the secant needs three or four steps
    for (int k = 0; k < 12 && fabs(load[1] - load[0]) > 1e-9; k++) {
        const double next = load[1] - found[1] * (load[1] - load[0]) / (found[1] - found[0]);
        load[0] = load[1];
        found[0] = found[1];
        load[1] = next;
        found[1] = variation_of(&cylinder, rest, next * THEORY);
    }
    ck_assert_double_le(fabs(load[1] - load[0]), 1e-9);
    free(rest);
    fixture_close(&cylinder);
    return load[1];
}

/* A triangle on a cylinder sees shear where the slope along the axis changes its radius: the
 * load is too high by the square of the angle of a cell over 8, here 1.5 % and 0.4 %. */
TEST(cylinder_buckles_at_the_load_of_theory) {
    const double coarse = buckling_load(128) - 1, fine = buckling_load(256) - 1;
    ck_assert_msg(coarse < 0.016 && fine < 0.0045, "%g at 128, %g at 256 cells", coarse, fine);
    ck_assert_msg(fabs(log2(coarse / fine) - 2) < 0.2, "%g at 128, %g at 256 cells", coarse,
                  fine);
}

/* --- tension at an angle to the warp --- */

/* 1/Y = c^4/Y_1 + s^4/Y_2 + c^2 s^2 (1/G - 2 p/Y_1) of an orthotropic sheet, with the moduli of
 * strips along warp and weft and p Poisson's ratio under tension along the warp. */
static double young_at(double angle, const double C[4]) {
    const double c = cos(angle) * cos(angle), s = 1 - c, det = C[0] * C[1] - C[2] * C[2];
    const double Y1 = det / C[1], Y2 = det / C[0], p = C[2] / C[1];
    return 1 / (c * c / Y1 + s * s / Y2 + c * s * (1 / C[3] - 2 * p / Y1));
}

/* A sheet of 1 m strained so that the only stress is `stress` along `angle` stores stress^2/2Y.
 */
TEST(tension_at_angles_has_the_modulus_of_theory) {
    static const double C[4] = {205.352, 1013.89, 10.234, 26.694}, stress = 2;
    for (int degrees = 0; degrees <= 90; degrees += 45) {
        struct fixture sheet;
        const double angle = degrees * M_PI / 180, c = cos(angle), s = sin(angle);
        const double det = C[0] * C[1] - C[2] * C[2];
        const double S[3] = {stress * c * c, stress * s * s, stress * c * s};
        const double EX = (C[1] * S[0] - C[2] * S[1]) / det,
                     EY = (C[0] * S[1] - C[2] * S[0]) / det, shear = S[2] / C[3];
        // F upper triangular with F^T F = I + 2 E
        const double a = sqrt(1 + 2 * EX), b = shear / a, d = sqrt(1 + 2 * EY - b * b);
        fixture_open(&sheet, "rk4",
                     "{\"bodies\": [{\"cloth\": {\"grid\": [9, 12], \"size\": [1, 1]}, "
                     "\"elastic\": {\"membrane\": {\"warp\": %g, \"weft\": %g, \"coupling\": "
                     "%g, \"shear\": %g}}, \"mass\": {\"areal_density\": 0.3}}]}",
                     C[0], C[1], C[2], C[3]);
        for (size_t i = 0; i < sheet.n; i++) {
            const double X = sheet.x[i], Y = sheet.x[sheet.n + i];
            sheet.x[i] = a * X + b * Y;
            sheet.x[sheet.n + i] = d * Y;
        }
        const struct cs_energy found = cs_diagnostics_energy(sheet.system, 0, sheet.x, sheet.v);
        const double modulus = stress * stress / (2 * found.elastic);
        ck_assert_double_eq_tol(modulus / young_at(angle, C), 1, 1e-10);
        fixture_close(&sheet);
    }
}

/* --- the drape coefficient (ISO 9073-9) --- */

enum { PIXELS = 600 };
#define HALF 0.16 /* m, half the width of the shadow's picture */

/* Twice the area of a triangle of points in the xz plane, with its sign. */
static double turn(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static void shade(double p[3][2], bool *shadow) {
    size_t low[2], high[2];
    for (int c = 0; c < 2; c++) {
        const double least = fmin(p[0][c], fmin(p[1][c], p[2][c]));
        const double most = fmax(p[0][c], fmax(p[1][c], p[2][c]));
        low[c] = (size_t)((least + HALF) * PIXELS / (2 * HALF));
        high[c] = (size_t)((most + HALF) * PIXELS / (2 * HALF)) + 1;
    }
    for (size_t i = low[0]; i < high[0]; i++)
        for (size_t k = low[1]; k < high[1]; k++) {
            const double at[2] = {((double)i + 0.5) * 2 * HALF / PIXELS - HALF,
                                  ((double)k + 0.5) * 2 * HALF / PIXELS - HALF};
            const double t[3] = {turn(p[0], p[1], at), turn(p[1], p[2], at),
                                 turn(p[2], p[0], at)};
            shadow[i * PIXELS + k] |=
                (t[0] >= 0 && t[1] >= 0 && t[2] >= 0) || (t[0] <= 0 && t[1] <= 0 && t[2] <= 0);
        }
}

/* The fraction of the ring beyond the disc of 0.09 m that is in the sheet's shadow. */
static double drape_coefficient(const char *cloth, double density) {
    struct fixture sheet;
    bool *shadow = calloc(PIXELS * PIXELS, sizeof *shadow);
    size_t dark = 0;
    run_scene(&sheet, "cusick", cloth, density, 180);
    const struct cs_trimesh *mesh = cs_scene_bodies(sheet.session.scene)->geometry;
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        double p[3][2];
        for (size_t k = 0; k < 3; k++)
            for (size_t c = 0; c < 2; c++)
                p[k][c] = sheet.x[2 * c * sheet.n + mesh->triangles[3 * (size_t)t + k]];
        shade(p, shadow);
    }
    for (size_t k = 0; k < PIXELS * PIXELS; k++)
        dark += shadow[k];
    free(shadow);
    fixture_close(&sheet);
    const double disc = M_PI * 0.09 * 0.09, sheet_area = M_PI * 0.15 * 0.15;
    const double pixel = 2 * HALF / PIXELS;
    return ((double)dark * pixel * pixel - disc) / (sheet_area - disc);
}

/* Those of docs/theory.md, in the order of the bending lengths. */
TEST(measured_cloths_drape_by_their_bending_length) {
    static const struct {
        const char *cloth;
        double density, coefficient;
    } cloths[] = {
        {"interlock", 0.187, 0.379}, {"denim", 0.324, 0.576}, {"pants", 0.220, 0.796}};
    for (size_t k = 0; k < LENGTH(cloths); k++) {
        if (!suite_takes(k, LENGTH(cloths)))
            continue;
        const double found = drape_coefficient(cloths[k].cloth, cloths[k].density);
        ck_assert_msg(fabs(found - cloths[k].coefficient) < 0.02, "%s: %.3f", cloths[k].cloth,
                      found);
    }
}
