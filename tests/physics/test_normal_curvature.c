/* Bending by the curvature along the normal: sheets curved at rest, and damping. */
#include "fixture.h"
#include "model/elastic/bending_forces.h"
#include "model/elastic/bending_sums.h"
#include "model/force/terms.h"
#include "sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RADIUS = 1 };

/* A sheet of side 1, on a cylinder of radius 1 if it is rolled; pattern -1: a grid. */
static void open_sheet(struct fixture *sheet, int pattern, int cells, bool rolled) {
    sheet_write_rolled(pattern < 0 ? SHEET_BACK : (enum sheet_pattern)pattern, cells + 1,
                       cells + 1, 1, 1, 0, rolled ? RADIUS : 0);
    fixture_open(
        sheet, "backward-euler",
        "{\"bodies\": [{%s, \"elastic\": {\"membrane\": {\"young\": 1}, "
        "\"bending\": {\"stiffness\": 2, \"poisson\": 0, \"damping\": 0.5}}, \"mass\": "
        "{\"areal_density\": 1}}], \"forces\": {\"gravity\": [0, 0, 0]}}",
        pattern < 0 ? "\"cloth\": {\"grid\": [9, 9], \"size\": [1, 1]}"
                    : "\"mesh\": {\"file\": \"sheet.obj\"}");
}

/* The force of bending of the chosen parts; f (3,n). */
static void find_force(const struct fixture *sheet, uint32_t parts, const double *v,
                       double *f) {
    const struct cs_block all = {.begin = 0, .end = (uint32_t)sheet->n};
    struct cs_eval at = {.x = sheet->x, .v = v, .parts = parts};
    memset(f, 0, 3 * sheet->n * sizeof *f);
    cs_bendings_prepare(sheet->system, &at);
    at.block = &all;
    cs_bendings_add(sheet->system, &at, f);
}

static double largest(const double *f, size_t n) {
    double found = 0;
    for (size_t i = 0; i < n; i++)
        found = fmax(found, fabs(f[i]));
    return found;
}

/* No force in the shape at rest, on any mesh. */
TEST(rolled_sheets_rest_in_their_shape) {
    for (int pattern = SHEET_BACK; pattern <= SHEET_IRREGULAR; pattern++) {
        struct fixture sheet;
        open_sheet(&sheet, pattern, 8, true);
        double *f = calloc(3 * sheet.n, sizeof *f);
        find_force(&sheet, CS_PART_ELASTIC, sheet.v, f);
        ck_assert_double_lt(largest(f, 3 * sheet.n), 1e-12);
        ck_assert_double_lt(cs_bendings_energy(sheet.system, sheet.x), 1e-24);
        free(f);
        fixture_close(&sheet);
    }
}

/* Energy of the sheet unrolled onto the plane, over that of theory, D/(2 R^2) per area. */
static double unrolled(int pattern, int cells) {
    struct fixture sheet, flat;
    open_sheet(&flat, pattern, cells, false);
    double *x = malloc(3 * flat.n * sizeof *x);
    memcpy(x, flat.x, 3 * flat.n * sizeof *x);
    fixture_close(&flat);
    open_sheet(&sheet, pattern, cells, true);
    const double energy = cs_bendings_energy(sheet.system, x);
    free(x);
    fixture_close(&sheet);
    return energy / (2.0 / 2 / (RADIUS * RADIUS));
}

/* A triangle at a rim lacks a hinge, so its curvature is half or none of that across the rim:
 * the error is of first order in the cells. */
TEST(unrolling_takes_the_energy_of_theory) {
    for (int pattern = SHEET_BACK; pattern <= SHEET_FORTH; pattern++) {
        const double coarse = unrolled(pattern, 16) - 1, fine = unrolled(pattern, 64) - 1;
        ck_assert_msg(fabs(fine) < 0.02, "pattern %d: %g at 64 cells", pattern, fine);
        ck_assert_double_eq_tol(log2(coarse / fine) / 2, 1, 0.1);
    }
    ck_assert_double_eq_tol(unrolled(SHEET_IRREGULAR, 64), 1, 0.05);
}

/* Opens a crumpled sheet: number 0 a grid, then flat meshes, then rolled ones. */
static void open_crumpled(struct fixture *sheet, int number) {
    open_sheet(sheet, number < 4 ? number - 1 : number - 4, 8, number >= 4);
    fixture_start(sheet);
    cs_perturb_smooth(sheet->system, 0.1, 3);
}

/* A moving sheet feels no damping unless it deforms. */
TEST(damping_leaves_rigid_motion_alone) {
    for (int number = 0; number < 7; number++) {
        struct fixture sheet;
        open_crumpled(&sheet, number);
        const size_t n = sheet.n;
        double *v = calloc(6 * n, sizeof *v), *f = v + 3 * n;
        const double spin[3] = {0.7, -1.1, 0.4};
        for (size_t i = 0; i < n; i++)
            for (size_t c = 0; c < 3; c++) {
                const size_t d = (c + 1) % 3, e = (c + 2) % 3;
                v[c * n + i] = 1 + spin[d] * sheet.x[e * n + i] - spin[e] * sheet.x[d * n + i];
            }
        find_force(&sheet, CS_PART_ELASTIC_DAMPING, v, f);
        const double rigid = largest(f, 3 * n);
        for (size_t i = 0; i < n; i++)
            v[2 * n + i] += sin(5 * sheet.x[i]);
        find_force(&sheet, CS_PART_ELASTIC_DAMPING, v, f);
        ck_assert_msg(rigid < 1e-11 * largest(f, 3 * n), "sheet %d: %g of %g", number, rigid,
                      largest(f, 3 * n));
        free(v);
        fixture_close(&sheet);
    }
}

/* Forces and moments of all particles add up to 0, and damping takes energy. */
TEST(forces_along_normals_have_no_resultant) {
    for (int number = 0; number < 7; number++) {
        struct fixture sheet;
        open_crumpled(&sheet, number);
        const size_t n = sheet.n;
        double *f = calloc(3 * n, sizeof *f), power = 0;
        for (size_t i = 0; i < 3 * n; i++)
            sheet.v[i] = sin(0.7 * (double)i);
        find_force(&sheet, CS_PART_ELASTIC_DAMPING, sheet.v, f);
        for (size_t i = 0; i < 3 * n; i++)
            power += f[i] * sheet.v[i];
        ck_assert_double_lt(power, 0);
        find_force(&sheet, CS_PART_ELASTIC | CS_PART_ELASTIC_DAMPING, sheet.v, f);
        const double most = largest(f, 3 * n);
        for (size_t c = 0; c < 3; c++) {
            const size_t d = (c + 1) % 3, e = (c + 2) % 3;
            double force = 0, moment = 0;
            for (size_t i = 0; i < n; i++) {
                force += f[c * n + i];
                moment += sheet.x[d * n + i] * f[e * n + i] - sheet.x[e * n + i] * f[d * n + i];
            }
            ck_assert_msg(fabs(force) < 1e-12 * most && fabs(moment) < 1e-12 * most,
                          "sheet %d: %g, %g of %g", number, force, moment, most);
        }
        free(f);
        fixture_close(&sheet);
    }
}

/* Across a flat sheet the damping is tau times the stiffness: a mode of frequency omega decays
 * with tau omega^2/2. */
TEST(damping_of_a_flat_sheet_is_proportional_to_stiffness) {
    for (int number = 0; number < 4; number++) {
        struct fixture sheet;
        open_sheet(&sheet, number - 1, 8, false);
        const size_t n = sheet.n;
        double *u = calloc(9 * n, sizeof *u), *stiff = u + 3 * n, *damped = u + 6 * n;
        for (size_t i = 0; i < n; i++)
            u[2 * n + i] = sin(3 * sheet.x[i]) * cos(2 * sheet.x[n + i]);
        const struct cs_eval at = {
            .x = sheet.x, .v = sheet.v, .dx = u, .parts = CS_PART_LINEARISED};
        find_force(&sheet, CS_PART_ELASTIC_DAMPING, u, damped);
        sheet.system->n_terms = 1;
        sheet.system->terms[0] = &cs_term_bending;
        cs_terms_jvp(sheet.system, &at, stiff);
        for (size_t i = 0; i < 3 * n; i++)
            ck_assert_double_eq_tol(damped[i], 0.5 * stiff[i], 1e-9);
        free(u);
        fixture_close(&sheet);
    }
}
