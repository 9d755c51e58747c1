/* Friction in methods that are linear in a step: a block creeps, slides and is carried as
 * implicit Euler itself has it, at steps far longer than friction takes to turn. */
#include "fixture.h"

#include "model/contact/friction_chord.h"

#include <math.h>
#include <stdio.h>

#define G  9.81
#define MU 0.3

/* Four particles of 25 g on a plate, in a field that is inclined by %g, %g m/s2; then friction
 * speed, events. */
#define BLOCK                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"size\": [0.1, 0.1], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [-0.23, %.17g, 0.11]}}, \"mass\": {\"total\": 0.1},"          \
    " \"springs\": {\"stretch\": 1000, \"shear\": 500, \"bend\": 0, \"damping\": 1},"          \
    " \"thickness\": 0.02}], \"colliders\": [{%s, \"thickness\": 0.02, \"friction\": 0.3}],"   \
    " \"contact\": {\"law\": \"force\", \"stiffness\": 1000, \"damping\": 0.001,"              \
    " \"friction_speed\": %g}, \"forces\": {\"gravity\": [%.17g, %.17g, 0]}, \"events\": "     \
    "[%s]}"

static const char *const plates[] = {
    "\"floor\": {}",
    "\"mesh\": {\"shape\": \"box\", \"detail\": 3, \"scale\": [2, 2, 2], \"place\": "
    "{\"translate\": [0, -1, 0]}}"};

static void open(struct fixture *block, const char *method, size_t plate, double tangent,
                 double ev, const char *events) {
    const double cosine = 1 / sqrt(1 + tangent * tangent);
    const double d = cs_barrier_loaded_distance(0.02, 1000, 0.025 * G * cosine);
    fixture_open(block, method, BLOCK, d, plates[plate], ev, G * tangent * cosine, -G * cosine,
                 events);
    fixture_start(block);
}

static double mean(const struct fixture *block, const double *of) {
    double sum = 0;
    for (size_t i = 0; i < block->n; i++)
        sum += of[i];
    return sum / (double)block->n;
}

/* A block at rest in height: of a mesh the distance follows from more than one feature. */
static double rest_height(size_t plate, double tangent, double ev) {
    struct fixture block;
    open(&block, "implicit-linearised:dt=0.004", plate, tangent, ev, "");
    fixture_frames(&block, 60);
    const double height = mean(&block, block.x + block.n);
    fixture_close(&block);
    return height;
}

static const char *const methods[] = {"implicit-linearised", "implicit-linearised:dt=0.004",
                                      "implicit-linearised:hessian=exact"};

/* Below the angle of friction: ev tan a / sqrt(mu^2 - tan^2 a), whatever h mu N/(m ev) is. */
TEST(blocks_creep_by_the_formula) {
    static const double evs[] = {1e-3, 1e-4, 5e-6};
    for (size_t p = 0; p < LENGTH(plates); p++)
        for (size_t e = 0; e < LENGTH(evs); e++)
            for (size_t m = 0; m < LENGTH(methods); m++)
                for (double tangent = 0.1; tangent < 0.25; tangent += 0.1) {
                    struct fixture block;
                    open(&block, methods[m], p, tangent, evs[e], "");
                    fixture_frames(&block, 60);
                    const double begin = mean(&block, block.x);
                    fixture_frames(&block, 30);
                    const double creep = (mean(&block, block.x) - begin) / 0.5,
                                 expected =
                                     evs[e] * tangent / sqrt(MU * MU - tangent * tangent);
                    ck_assert_msg(fabs(creep / expected - 1) < 0.01,
                                  "%s, plate %zu, ev %g, slope %.1f: %.6g of the formula",
                                  methods[m], p, evs[e], tangent, creep / expected);
                    fixture_close(&block);
                }
}

/* Ways of a block that slides from rest, after 15, 30 and 60 frames. */
static void slide(const char *method, size_t plate, double ev, double height, double way[3]) {
    const double tangent = 0.45, cosine = 1 / sqrt(1 + tangent * tangent);
    struct fixture block;
    fixture_open(&block, method, BLOCK, height, plates[plate], ev, G * tangent * cosine,
                 -G * cosine, "");
    fixture_start(&block);
    const double begin = mean(&block, block.x);
    for (uint32_t k = 0; k < 3; k++) {
        fixture_frames(&block, k ? 15 * k : 15);
        way[k] = mean(&block, block.x) - begin;
    }
    fixture_close(&block);
}

/* Above the angle of friction, from rest: as far as backward Euler at the same step, which is
 * 1 + h/t of the exact way. */
TEST(blocks_slide_from_rest_like_implicit_euler) {
    static const double evs[] = {1e-3, 1e-5};
    for (size_t p = 0; p < LENGTH(plates); p++)
        for (size_t e = 0; e < LENGTH(evs); e++) {
            const double height = rest_height(p, 0.45, evs[e]);
            double newton[3], linear[3];
            slide("backward-euler", p, evs[e], height, newton);
            slide("implicit-linearised", p, evs[e], height, linear);
            for (uint32_t k = 0; k < 3; k++) {
                const double t = k == 0 ? 0.25 : k == 1 ? 0.5 : 1;
                const double exact = G * (0.45 - MU) / sqrt(1 + 0.45 * 0.45) * t * t / 2;
                ck_assert_msg(fabs(linear[k] / newton[k] - 1) < 0.01,
                              "plate %zu, ev %g, %g s: %.6g of backward Euler's way", p, evs[e],
                              t, linear[k] / newton[k]);
                ck_assert_msg(fabs(linear[k] / exact - 1 - 1 / (60 * t)) < 0.01,
                              "plate %zu, ev %g, %g s: %.6g of the exact way", p, evs[e], t,
                              linear[k] / exact);
            }
        }
}

/* A conveyor: it drags by mu g until the block has its speed, at which the block stays. The
 * same from the conveyor: a block that is thrown, slides, and rests. */
TEST(conveyors_carry_to_their_speed) {
    static const double evs[] = {1e-3, 1e-5};
    for (size_t p = 0; p < LENGTH(plates); p++)
        for (size_t e = 0; e < LENGTH(evs); e++)
            for (size_t m = 0; m < LENGTH(methods); m++) {
                struct fixture block;
                fixture_open(&block, methods[m], BLOCK, rest_height(p, 0, evs[e]), plates[p],
                             evs[e], 0., -G,
                             "{\"at\": 0, \"move\": {\"collider\": 0, \"path\": [{\"at\": 2, "
                             "\"point\": [1, 0, 0]}]}}");
                fixture_start(&block);
                fixture_frames(&block, 6);
                const double early = mean(&block, block.v);
                ck_assert_msg(fabs(early / (MU * G * 0.1) - 1) < 0.01,
                              "%s, plate %zu, ev %g: %.6g m/s after 0.1 s", methods[m], p,
                              evs[e], early);
                for (uint32_t frame = 6; frame < 30; frame++) {
                    fixture_frames(&block, 1);
                    const double v = mean(&block, block.v);
                    ck_assert_msg(v < 0.5 + evs[e] && (frame < 12 || v > 0.5 - evs[e]),
                                  "%s, plate %zu, ev %g: %.9g m/s in frame %u", methods[m], p,
                                  evs[e], v, frame);
                }
                fixture_close(&block);
            }
}

/* A sheet that slides at 2 m/s and lands from a height, at a speed downwards. */
#define LANDING                                                                                \
    "{\"bodies\": [{\"cloth\": {\"grid\": [8, 8], \"size\": [0.3, 0.3], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [0, %g, 0]}, \"velocity\": [2, %g, 0]}, \"mass\": "           \
    "{\"areal_density\": 0.2}}], \"colliders\": [{\"floor\": {}, \"friction\": 0.4}], "        \
    "\"contact\": {\"law\": \"force\", \"start\": \"move-out\"}}"

/* While a sheet slides, friction takes mu times what contact gives upwards: by momentum v - mu
 * (g t + w - w0) is left of v, whatever bounces. With the load at the begin of each step it was
 * off by up to -0.15 m/s in steps of a frame, and by 0.065 m/s where it does not bounce. */
TEST(landings_take_coulombs_impulse) {
    static const double starts[][2] = {{0.0165, 0}, {0.05, 0}, {0.0172, -0.5}};
    static const double steps[] = {1 / 60., 1 / 240., 1e-3};
    const double mu = 0.4;
    for (size_t k = 0; k < LENGTH(starts) * LENGTH(steps); k++) {
        const double h = steps[k % LENGTH(steps)], *start = starts[k / LENGTH(steps)];
        char method[64];
        struct fixture sheet;
        double p[3], l[3], mass = 0, left = 2;
        snprintf(method, sizeof method, "implicit-linearised:dt=%.17g", h);
        fixture_open(&sheet, method, LANDING, start[0], start[1]);
        fixture_start(&sheet);
        for (size_t i = 0; i < sheet.n; i++)
            mass += sheet.system->mass[i];
        const double begin = mean(&sheet, sheet.x);
        for (int frame = 1; frame <= 60; frame++) {
            fixture_frames(&sheet, 1);
            fixture_momentum(&sheet, p, l);
            const double expected = 2 - mu * (G * frame / 60 + p[1] / mass - start[1]);
            left = p[0] / mass;
            ck_assert_msg(left < 0.2 || fabs(left - expected) < (h > 0.01 ? 0.035 : 0.006),
                          "%s from %g m: %.4f m/s in frame %d, expected %.4f", method, start[0],
                          left, frame, expected);
        }
        ck_assert(fabs(left) < 0.01);
        // implicit Euler goes with the speed of a step's end
        const double way = mean(&sheet, sheet.x) - begin;
        ck_assert_msg(k >= LENGTH(steps) || fabs(way + h - 2 / (mu * G)) < 0.002,
                      "%s: %.4f m, expected %.4f", method, way, 2 / (mu * G) - h);
        fixture_close(&sheet);
    }
}

/* A sheet on a fine mesh: its particles have several contacts each, which share one load. */
TEST(sheets_creep_on_fine_meshes) {
    static const char *const sheet =
        "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"size\": [0.3, 0.3], \"start\": "
        "\"flat\", \"place\": {\"translate\": [0, 0.0155, 0.013], \"rotate\": [0, 0.15, 0, "
        "1]}}, \"mass\": {\"areal_density\": 0.3}, \"thickness\": 0.02, \"springs\": "
        "{\"stretch\": 60, \"shear\": 20, \"bend\": 1, \"damping\": 0.02}}], \"colliders\": "
        "[{\"mesh\": {\"shape\": \"box\", \"detail\": 12, \"scale\": [0.8, 0.1, 0.8], "
        "\"place\": {\"translate\": [0, -0.05, 0]}}, \"friction\": 0.3, \"thickness\": 0.02}],"
        " \"contact\": {\"law\": \"force\", \"damping\": 0.001, \"friction_speed\": %g}, "
        "\"forces\": {\"gravity\": [%.17g, %.17g, 0]}}";
    static const double evs[] = {1e-3, 1e-5};
    const double tangent = 0.1, cosine = 1 / sqrt(1 + tangent * tangent);
    for (size_t e = 0; e < LENGTH(evs); e++) {
        struct fixture cloth;
        fixture_open(&cloth, "implicit-linearised", sheet, evs[e], G * tangent * cosine,
                     -G * cosine);
        fixture_start(&cloth);
        fixture_frames(&cloth, 30);
        const double begin = mean(&cloth, cloth.x);
        fixture_frames(&cloth, 30);
        const double creep = (mean(&cloth, cloth.x) - begin) / 0.5;
        const double expected = evs[e] * tangent / sqrt(MU * MU - tangent * tangent);
        // bumps of the mesh hold back a little, as with rk4
        ck_assert_msg(fabs(creep / expected - 1) < 0.05, "ev %g: %.6g of the formula", evs[e],
                      creep / expected);
        fixture_close(&cloth);
    }
}

/* u + a u/s(u) = length to rounding, from no friction to a limit of 1e12 ev, far from the limit
 * length = a and at it. */
TEST(friction_chord_finds_the_speed_at_the_end) {
    static const double parts[] = {1e-9, 0.01, 0.5, 0.9, 0.999, 1, 1.001, 1.1, 2, 100, 1e9};
    const double ev = 1e-3;
    for (double a = 1e-6 * ev; a < 2e12 * ev; a *= 3)
        for (size_t k = 0; k < LENGTH(parts); k++) {
            const double length = parts[k] * a, u = cs_friction_chord_speed(a, ev, length);
            const double s = sqrt(u * u + ev * ev), slope = 1 + a * ev * ev / (s * s * s);
            const double error = (u + a * u / s - length) / slope;
            // what rounding of the sum makes of u, beside its own
            const double rounding = 4e-16 * (length / slope + u);
            ck_assert_msg(u >= 0 && fabs(error) <= 1e-12 * u + rounding,
                          "a %g, length %g: %g off %g", a, length, error, u);
        }
    ck_assert_double_eq(cs_friction_chord_speed(0, ev, 0.3), 0.3);
    ck_assert_double_eq(cs_friction_chord_speed(5, ev, 0), 0);
}

/* The slope that leads the contact alone to where implicit Euler has it: m (V' - V) = h (F +
 * f(V) + D (V' - V)), for forces along the sliding and across. */
TEST(friction_chord_is_exact_for_one_contact) {
    const double ev = 1e-4, mu = 0.4, load = 0.05, h = 1 / 60.0, m = 0.01;
    static const double speeds[] = {0, 1e-5, 1e-3, 0.02, 0.5};
    static const double forces[] = {-0.3, -0.021, -0.01, 0, 0.01, 0.019, 0.0201, 0.5};
    for (size_t i = 0; i < LENGTH(speeds); i++)
        for (size_t k = 0; k < LENGTH(forces); k++) {
            const double v = speeds[i], now = mu * load * v / sqrt(v * v + ev * ev);
            const struct cs_sliding_contact contacts = {.n = {0, 1, 0},
                                                        .v = {0.6 * v, 0.2, 0.8 * v},
                                                        .force = load,
                                                        .end_force = load,
                                                        .friction = mu,
                                                        .friction_speed = ev};
            const double net = forces[k] - now;
            const struct cs_contact_pull pull = {
                .h = h, .inverse = 1 / m, .motion = {0.6 * net / m, 3, 0.8 * net / m}};
            double b[6] = {0};
            cs_friction_chord_add(&pull, &contacts, b);
            // along the sliding
            const double slope = 0.36 * b[0] + 2 * 0.48 * b[2] + 0.64 * b[5];
            const double end = v + h * net / (m + slope);
            const double residual =
                m * (end - v) - h * (forces[k] - mu * load * end / sqrt(end * end + ev * ev));
            ck_assert_msg(fabs(residual) < 1e-10 * m, "v %g, F %g: %g", v, forces[k], residual);
            ck_assert_double_eq_tol(b[1], 0, 1e-15);
            ck_assert_double_eq_tol(b[3], 0, 1e-15);
            ck_assert(slope >= 0 && b[0] + b[5] >= slope * (1 - 1e-12));
        }
}
