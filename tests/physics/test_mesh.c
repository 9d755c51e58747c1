/* Bodies of triangles: forces, energy, derivatives and the solver's matrix against sums over
 * the springs one by one and against differences; pins, masses, wind and strain limit. */
#include "fixture.h"

#include "mesh/trimesh.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/post_step/contact_projection.h"
#include "model/solver/linear.h"

#include <math.h>
#include <string.h>

/* a network inside a sphere (92 particles, more than one piece of springs) beside a cloth, so
 * that the mesh does not start at particle 0 */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 2]}, \"mass\": {\"total\": 1}},"                 \
    " {\"mesh\": {\"shape\": \"sphere\", \"detail\": 3, \"scale\": [1, 2, 0.5],"               \
    "   \"place\": {\"translate\": [0.1, 2, 0], \"rotate\": [0.1, 0.2, 0.3, 0.9]}},"           \
    "  \"network\": {\"springs\": 5, \"surface\": 2.5}, \"mass\": {\"areal_density\": 0.4},"   \
    "  \"springs\": {\"stretch\": 200, \"bend\": 25, \"damping\": 0.7,"                        \
    "    \"damping_model\": \"%s\", \"stiffness_unit\": \"%s\"}, \"pins\": [3, 50]}],"         \
    " \"forces\": {\"drag\": 0.3, \"drag_unit\": \"Pa s/m\","                                  \
    "   \"wind\": {\"direction\": [0.3, 0.2, 1], \"strength\": 4}}}"

enum { N = 98, VALUES = 3 * N };
#define STEP 1e-6

static void open(struct fixture *body, bool axial) {
    fixture_open(body, "implicit-linearised", SCENE, axial ? "axial" : "relative",
                 axial ? "N" : "N/m");
    ck_assert_uint_eq(body->n, N);
    cs_perturb_smooth(body->system, 0.03, 2);
}

static void force(const struct fixture *body, const double *x, const double *v, uint32_t parts,
                  double f[VALUES]) {
    cs_normals_update(body->system, x);
    cs_terms_force(body->system, &(struct cs_eval){.x = x, .v = v, .parts = parts}, f);
}

static double vector(const double *p, uint32_t a, uint32_t b, double d[3]) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        d[c] = p[c * N + b] - p[c * N + a];
        squared += d[c] * d[c];
    }
    return sqrt(squared);
}

/* one spring after the other, with ends and law from the geometry and the scene */
static double add_springs(const struct fixture *body, const uint32_t *ends, uint32_t count,
                          double stiffness, bool axial, double f[VALUES]) {
    const uint32_t first = body->system->bodies[1].first;
    double energy = 0;
    for (uint32_t s = 0; s < count; s++) {
        const uint32_t a = first + ends[2 * (size_t)s], b = first + ends[2 * (size_t)s + 1];
        double d[3], w[3];
        const double rest = vector(body->system->start, a, b, d);
        const double length = vector(body->x, a, b, d);
        vector(body->v, a, b, w);
        const double k = axial ? stiffness / rest : stiffness;
        const double closing = (w[0] * d[0] + w[1] * d[1] + w[2] * d[2]) / length;
        energy += 0.5 * k * (length - rest) * (length - rest);
        for (size_t c = 0; c < 3; c++) {
            const double pull = k * (length - rest) * d[c] / length +
                                0.7 * (axial ? closing * d[c] / length : w[c]);
            f[c * N + a] += pull;
            f[c * N + b] -= pull;
        }
    }
    return energy;
}

TEST(springs_are_those_of_the_geometry) {
    for (int axial = 0; axial < 2; axial++) {
        struct fixture body;
        double found[VALUES], expected[VALUES] = {0}, energy = 0;
        open(&body, axial);
        const struct cs_trimesh *mesh = body.system->bodies[1].mesh;
        ck_assert_uint_gt(mesh->n_network_springs, 300);
        energy += add_springs(&body, mesh->edges, mesh->n_edges, 500, axial, expected);
        energy += add_springs(&body, mesh->network_springs, mesh->n_network_springs, 200, axial,
                              expected);
        energy += add_springs(&body, mesh->hinges, mesh->n_hinges, 25, axial, expected);
        force(&body, body.x, body.v, CS_PART_SPRINGS | CS_PART_DAMPING, found);
        for (size_t i = 0; i < VALUES; i++)
            if (i % N >= 6)
                ck_assert_double_eq_tol(
                    found[i], body.system->inv_mass[i % N] > 0 ? expected[i] : 0, 1e-9);
        /* the cloth's share of the energy is what is left when the mesh lies at rest */
        const double with =
            cs_springs_energy(&body.system->springs, N, body.x, CS_PART_SPRINGS);
        double x[VALUES];
        memcpy(x, body.x, sizeof x);
        for (size_t i = 0; i < VALUES; i++)
            x[i] = i % N >= 6 ? body.system->start[i] : x[i];
        const double without = cs_springs_energy(&body.system->springs, N, x, CS_PART_SPRINGS);
        ck_assert_double_eq_tol(with - without, energy, 1e-9 * energy);
        fixture_close(&body);
    }
}

/* (f(x + e dx, v + e dv) - f(x - e dx, v - e dv)) / 2 e */
static void difference(const struct fixture *body, uint32_t parts, const double *dx,
                       const double *dv, double slope[VALUES]) {
    double x[VALUES], v[VALUES], forward[VALUES];
    for (int sign = 1; sign >= -1; sign -= 2) {
        for (size_t i = 0; i < VALUES; i++) {
            x[i] = body->x[i] + sign * STEP * dx[i];
            v[i] = body->v[i] + sign * STEP * dv[i];
        }
        force(body, x, v, parts, sign > 0 ? forward : slope);
    }
    for (size_t i = 0; i < VALUES; i++)
        slope[i] = (forward[i] - slope[i]) / (2 * STEP);
}

/* directions that move one particle each, and some that move all */
static void check_part(const struct fixture *body, uint32_t part, double least) {
    double size = 0, error = 0;
    for (size_t column = 0; column < VALUES + 4; column++) {
        double dx[VALUES] = {0}, dv[VALUES] = {0}, slope[VALUES], df[VALUES];
        for (size_t i = 0; i < VALUES; i++) {
            const bool moves = column < VALUES ? i == column : true;
            if (!moves || body->system->inv_mass[i % N] <= 0)
                continue;
            dx[i] = column < VALUES ? 1 : sin((double)(i + column));
            dv[i] = column < VALUES ? 0 : cos(1.3 * (double)(i + column));
        }
        difference(body, part, dx, dv, slope);
        cs_normals_update(body->system, body->x);
        cs_terms_jvp(
            body->system,
            &(struct cs_eval){.x = body->x, .v = body->v, .parts = part, .dx = dx, .dv = dv},
            df);
        for (size_t i = 0; i < VALUES; i++) {
            size = fmax(size, fabs(slope[i]));
            error = fmax(error, fabs(slope[i] - df[i]));
        }
    }
    ck_assert_msg(size >= least, "part %u: the largest derivative is only %g", part, size);
    ck_assert_msg(error <= 1e-7 * size + 1e-9, "part %u: off by %g of %g", part, error, size);
}

TEST(jvp_is_the_derivative) {
    for (int axial = 0; axial < 2; axial++) {
        struct fixture body;
        open(&body, axial);
        check_part(&body, CS_PART_STRETCH, 100);
        check_part(&body, CS_PART_SHEAR, 30);
        check_part(&body, CS_PART_BEND, 10);
        check_part(&body, CS_PART_DAMPING, 0.5);
        check_part(&body, CS_PART_WIND, 0.01);
        check_part(&body, CS_PART_ALL, 100);
        fixture_close(&body);
    }
}

TEST(solver_matrix_and_diagonal_are_those_of_jvp) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const double cm = 1, cd = -0.02, ck = -4e-4;
    for (int axial = 0; axial < 2; axial++) {
        struct fixture body;
        struct cs_arena arena = {0};
        struct cs_error error = {0};
        struct cs_linear linear;
        double p[VALUES], found[VALUES], dk[VALUES], dd[VALUES], kxx[6 * N], dvv[6 * N];
        open(&body, axial);
        memset(body.v, 0, VALUES * sizeof *body.v);
        ck_assert_int_eq(cs_linear_init(&linear, body.system, &arena, &error), CS_OK);
        cs_linear_setup(&linear, &(struct cs_matrix){
                                     .x = body.x, .cm = cm, .cd = cd, .ck = ck, .psd = false});
        for (size_t i = 0; i < VALUES; i++)
            p[i] = body.system->inv_mass[i % N] > 0 ? sin(0.9 * (double)i) : 0;
        cs_linear_mul(&linear, p, found);
        cs_terms_jvp(
            body.system,
            &(struct cs_eval){.x = body.x, .v = body.v, .parts = CS_PART_LINEARISED, .dx = p},
            dk);
        cs_terms_jvp(
            body.system,
            &(struct cs_eval){.x = body.x, .v = body.v, .parts = CS_PART_LINEARISED, .dv = p},
            dd);
        for (size_t i = 0; i < VALUES; i++)
            ck_assert_double_eq_tol(
                found[i], cm * body.system->mass[i % N] * p[i] + cd * dd[i] + ck * dk[i],
                1e-11);
        cs_terms_diagonal(
            body.system, &(struct cs_eval){.x = body.x, .parts = CS_PART_LINEARISED}, kxx, dvv);
        for (size_t i = 0; i < N; i++)
            for (int e = 0; e < 6 && body.system->inv_mass[i] > 0; e++) {
                double unit[VALUES] = {0};
                unit[column[e] * N + i] = 1;
                cs_terms_jvp(
                    body.system,
                    &(struct cs_eval){
                        .x = body.x, .v = body.v, .parts = CS_PART_LINEARISED, .dx = unit},
                    dk);
                ck_assert_double_eq_tol(kxx[e * N + i], dk[row[e] * N + i], 1e-8);
            }
        cs_arena_finish(&arena);
        fixture_close(&body);
    }
}

/* Wind on a closed body: normals look outwards, and the still body has the area of its mesh. */
TEST(normals_and_masses_fit_the_body) {
    struct fixture ball;
    double area = 0, mass = 0;
    fixture_open(&ball, "implicit-linearised",
                 "{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": 12,"
                 " \"velocity\": [1, 2, 3]}, \"mass\": {\"areal_density\": 2}, \"pins\": [0]}],"
                 " \"forces\": {\"wind\": {\"direction\": [0, 0, 1], \"strength\": 1}}}");
    const size_t n = ball.n;
    cs_normals_update(ball.system, ball.x);
    for (size_t i = 0; i < n; i++) {
        const double *normal = ball.system->normals;
        double along = 0;
        for (size_t c = 0; c < 3; c++)
            along += normal[c * n + i] * ball.x[c * n + i] / 0.5;
        ck_assert_double_ge(along, 0.999);
        area += ball.system->area[i];
        mass += ball.system->mass[i];
    }
    ck_assert_double_eq_tol(area, 3.1416, 0.02);
    ck_assert_double_eq_tol(mass, 2 * area, 1e-12);
    ck_assert_double_eq(ball.v[0], 0);
    ck_assert_double_eq(ball.v[1], 1);
    ck_assert_double_eq(ball.v[2 * n + 1], 3);
    fixture_close(&ball);
}

TEST(strain_is_limited) {
    struct fixture ball;
    fixture_open(
        &ball, "implicit-linearised",
        "{\"bodies\": [{\"mesh\": {\"shape\": \"torus\", \"detail\": 6},"
        " \"mass\": {\"total\": 1}, \"springs\": {\"bend\": 0}, \"strain_limit\": 1.05,"
        " \"strain_limit_sweeps\": 2000}]}");
    for (size_t i = 0; i < ball.n; i++)
        ball.x[ball.n + i] *= 1.2;
    ck_assert_double_gt(cs_diagnostics_strain(ball.system, ball.x), 0.15);
    ck_assert(cs_strain_limit_apply(&ball.session.run.strain_limit, ball.system, 0.01, ball.x,
                                    ball.v) > 0);
    double strain[1000];
    ck_assert_uint_lt(ball.n, 1000);
    cs_diagnostics_particle_strain(ball.system, ball.x, strain);
    for (size_t i = 0; i < ball.n; i++)
        ck_assert_double_le(strain[i], 0.0501);
    fixture_close(&ball);
}

/* A body that is thrown and turns keeps both momenta, and its energy within the method's error.
 */
TEST(free_body_keeps_its_momentum) {
    struct fixture body;
    double p[3], l[3], p0[3], l0[3];
    fixture_open(&body, "velocity-verlet",
                 "{\"bodies\": [{\"mesh\": {\"shape\": \"limbs\", \"detail\": 9,"
                 "  \"velocity\": [1, 2, 3]}, \"network\": {}, \"mass\": {\"degree\": 0.001},"
                 "  \"springs\": {\"stretch\": 30, \"bend\": 1}}],"
                 " \"forces\": {\"gravity\": [0, 0, 0]}}");
    for (size_t i = 0; i < body.n; i++)
        body.v[i] += 4 * body.x[body.n + i]; /* a shear: it turns, and is pulled */
    const double energy = fixture_energy(&body);
    fixture_momentum(&body, p0, l0);
    fixture_start(&body);
    fixture_frames(&body, 10);
    body.x = body.session.run.x, body.v = body.session.run.v;
    fixture_momentum(&body, p, l);
    for (int c = 0; c < 3; c++) {
        ck_assert_double_eq_tol(p[c], p0[c], 1e-10);
        ck_assert_double_eq_tol(l[c], l0[c], 1e-9);
    }
    ck_assert_double_eq_tol(fixture_energy(&body), energy, 0.02 * energy);
    fixture_close(&body);
}
