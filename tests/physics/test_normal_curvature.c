/* Bending by the curvature along the normal: sheets curved at rest, and damping. */
#include "fixture.h"
#include "model/elastic/normal_stencil.h"
#include "model/force/terms.h"
#include "scene/elastic_keys.h"
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

/* --- every state --- */

static double distance(const double *p, size_t n, uint32_t i, uint32_t j) {
    double squares = 0;
    for (size_t c = 0; c < 3; c++)
        squares += (p[c * n + i] - p[c * n + j]) * (p[c * n + i] - p[c * n + j]);
    return sqrt(squares);
}

static double rest_of_end(const struct cs_bending_stencil *of, const double *rest, size_t n,
                          int k) {
    return distance(rest, n, of->at[of->ends[2 * k]], of->at[of->ends[2 * k + 1]]);
}

/* lambda of docs/notes/singular-states.md: the largest growth of a distance within a stencil.
 */
static double growth_of(const struct cs_bending_stencil *of, const double *rest,
                        const double *x, size_t n) {
    double found = 0;
    for (uint32_t j = 1; j < of->n; j++)
        if (of->at[j] != of->at[0])
            found = fmax(found, distance(x, n, of->at[0], of->at[j]) /
                                    distance(rest, n, of->at[0], of->at[j]));
    for (int k = 0; k < 2; k++)
        found = fmax(found, rest_of_end(of, x, n, k) / rest_of_end(of, rest, n, k));
    return found;
}

/* The sum of G_a^2 there, in 1/m4 m2: of a body that is curved at rest with L0/10 for L0, and
 * the unit normal for n. */
static double squares_of(const struct cs_bending_stencil *of, const double *rest, size_t n) {
    const double d = rest_of_end(of, rest, n, 0), e = rest_of_end(of, rest, n, 1);
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        double weights = 0, arms = 0;
        for (uint32_t j = 0; j < of->n; j++) {
            weights += of->weights[a][j] * of->weights[a][j];
            arms += fabs(of->weights[a][j]) * distance(rest, n, of->at[0], of->at[j]);
        }
        const double least = of->is_curved ? 0.0995 * of->product : of->product;
        const double normal = of->is_curved ? 1.005 : d * e / of->product;
        const double G = normal * sqrt(weights) + sqrt(2) * (d + e) * arms / least;
        sum += G * G;
    }
    return sum;
}

/* The bound there on |df/dv| in N s/m, for tau = 0.5 s. */
static double theory_bound(const struct fixture *sheet, const double *rest) {
    const struct cs_bending *bending = sheet->system->bendings->bodies;
    const struct cs_moduli D = {2, 2, 0, 1};
    double *sums = calloc(sheet->n, sizeof *sums), found = 0;
    for (uint32_t s = 0; s < bending->n; s++) {
        struct cs_bending_stencil of;
        cs_bending_stencil_at(bending, &D, s, &of);
        if (of.n == 0)
            continue;
        const struct cs_moduli *A = &of.moduli;
        const double norm = fmax(A->shear, fmax(A->warp, A->weft) + fabs(A->coupling));
        const double grown = growth_of(&of, rest, sheet->x, sheet->n);
        const double growth = of.is_curved ? fmax(grown, 1) : grown;
        const double rate =
            0.5 * norm * growth * growth * growth * growth * squares_of(&of, rest, sheet->n);
        for (uint32_t j = 0; j < of.n; j++)
            sums[of.at[j]] += rate;
    }
    for (size_t i = 0; i < sheet->n; i++)
        found = fmax(found, sums[i]);
    free(sums);
    return found;
}

/* |df/dv| by power iteration on the force, which is linear in v. */
static double damping_of(const struct fixture *sheet) {
    const size_t n = sheet->n;
    double *v = calloc(6 * n, sizeof *v), *f = v + 3 * n, norm = 0;
    for (size_t i = 0; i < 3 * n; i++)
        v[i] = sin(0.7 * (double)i);
    for (int k = 0; k < 30; k++) {
        double squares = 0, power = 0;
        find_force(sheet, CS_PART_ELASTIC_DAMPING, v, f);
        for (size_t i = 0; i < 3 * n; i++) {
            squares += f[i] * f[i];
            power += f[i] * v[i];
        }
        ck_assert_msg(power <= 0, "damping gives %g W", power);
        norm = sqrt(squares);
        for (size_t i = 0; i < 3 * n && norm > 0 && k < 29; i++)
            v[i] = f[i] / norm;
    }
    free(v);
    return norm;
}

/* Moves all x by a walk: 0 to a line, 1 to a point, 2 a fold at the middle column, 3 a fold at
 * every column, each by a share of the way. */
static void walk_to(const struct fixture *sheet, const double *from, int walk, double share) {
    const size_t n = sheet->n;
    for (size_t i = 0; i < n; i++) {
        const double across = from[i] - from[0], column = across * 8;
        const double folded = fabs(column - 2 * floor(column / 2 + 0.5)) / 8;
        const double to[] = {0, 0, across > 0.5 ? 1 - across : across, folded};
        sheet->x[i] = from[i] + share * (to[walk] - across);
        for (size_t c = 1; c < 3; c++)
            sheet->x[c * n + i] =
                from[c * n + i] + (walk == 1 ? share * (from[c * n] - from[c * n + i]) : 0);
    }
}

/* In no state is the damping above the bound of theory, where it stands still or not; and a
 * sheet folded without stretch is damped at most as a flat one. */
TEST(damping_is_bounded_in_every_state) {
    for (int number = 0; number < 7; number++)
        for (int walk = 0; walk < 4; walk++) {
            struct fixture sheet;
            double widest = 0;
            open_sheet(&sheet, number < 4 ? number - 1 : number - 4, 8, number >= 4);
            const size_t bytes = 3 * sheet.n * sizeof(double);
            double *rest = malloc(2 * bytes), *from = rest + 3 * sheet.n;
            memcpy(rest, sheet.x, bytes);
            const double flat = damping_of(&sheet);
            if (walk < 2) {
                fixture_start(&sheet);
                cs_perturb_smooth(sheet.system, 0.1, 3);
            }
            memcpy(from, sheet.x, bytes);
            for (int step = 0; step <= 12; step++) {
                walk_to(&sheet, from, walk, step < 12 ? 1 - ldexp(1, -2 * step) : 1);
                const double found = damping_of(&sheet), most = theory_bound(&sheet, rest);
                ck_assert_msg(found <= most, "sheet %d, walk %d, step %d: %g above %g", number,
                              walk, step, found, most);
                widest = fmax(widest, found);
            }
            ck_assert_msg(walk < 2 || number > 0 || widest < 1.01 * flat,
                          "walk %d: %g, flat %g", walk, widest, flat);
            free(rest);
            fixture_close(&sheet);
        }
}

/* A small sheet that is hung up by one corner folds while it falls: total energy never grows,
 * by methods of five kinds at their own steps. */
TEST(sheet_hung_by_a_corner_ends_with_every_method) {
    static const char *const methods[] = {"rk4", "velocity-verlet", "symplectic-euler",
                                          "tr-bdf2", "dop853"};
    for (size_t m = 0; m < LENGTH(methods); m++) {
        struct fixture sheet;
        fixture_open(
            &sheet, methods[m],
            "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"size\": [0.4, 0.4], \"start\": "
            "\"flat\", \"bump\": 0.01}, \"mass\": {\"areal_density\": 0.2}, \"elastic\": "
            "{\"membrane\": {\"young\": 100, \"poisson\": 0.3}, \"bending\": {\"stiffness\": "
            "1e-4, \"poisson\": 0.3, \"damping\": 1e-3}, \"damping\": 1e-3}, \"pins\": "
            "[\"top-left\"]}], \"time\": {\"fps\": 60}}");
        fixture_start(&sheet);
        double last = fixture_energy(&sheet);
        for (int second = 0; second < 3; second++) {
            fixture_frames(&sheet, 60);
            const double now = fixture_energy(&sheet);
            ck_assert_msg(now < last, "%s: %g J after %g J", methods[m], now, last);
            last = now;
        }
        fixture_close(&sheet);
    }
}
