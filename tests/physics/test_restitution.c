/* Restitution of contact by force: a sheet that is thrown at an obstacle comes back with the
 * energy that it had, whatever its speed, and wherever in a step it meets the obstacle. */
#include "methods.h"

#include <math.h>
#include <stdio.h>

/* Without gravity, damping and friction the energy of springs, contact and motion is constant.
 * All particles of the flat sheet meet the obstacle at one time, so that the springs hardly
 * move: the change of energy is that of contact. */
#define THROWN                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d], \"size\": [%g, %g], \"start\": \"flat\", " \
    "\"place\": {\"translate\": [0, %.15g, 0]}, \"velocity\": [0, %g, 0]}, \"mass\": "         \
    "{\"areal_density\": 0.2}, \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 0.5, "  \
    "\"damping\": 0}}], \"contact\": \"force\", \"forces\": {\"gravity\": [0, 0, 0]}, "        \
    "\"colliders\": [{%s, \"thickness\": %g}]}"

/* An obstacle with the top at y = 0, and the sheet that is thrown at it. */
struct target {
    const char *obstacle;
    double range; /* m */
    int side;     /* particles */
};

/* a range that is short against speed times step */
static const struct target plane = {"\"floor\": {\"height\": 0}", 0.002, 8};
static const struct target small = {"\"floor\": {\"height\": 0}", 0.002, 4};
/* Pairs of surfaces. A speed that takes them through each other is a crossing and no bounce: a
 * longer range. */
static const struct target mesh = {
    "\"mesh\": {\"shape\": \"box\", \"place\": {\"translate\": [0, -0.5, 0]}}", 0.01, 4};

/* What a method keeps at its default step, where that is not 0.9 to 1.05 of the energy; `pairs`
 * is the least where surfaces meet in pairs. */
static const struct bounds {
    const char *method;
    double least, most, pairs;
    const char *reason;
} own_bounds[] = {
    {"avbd", 0.35, 1, 0.05, "dissipates as backward-euler"},
    {"backward-euler", 0.35, 1, 0.05, "dissipates: a step that is long against range/speed"},
    {"implicit-linearised", 0.97, 1.01, 0, "pairs: as backward-euler, without its iteration"},
    {"symplectic-euler", 0.9, 1.06, 0.9, "its energy swings by the first order of h"},
    {"vbd", 0.35, 1, 0.05, "dissipates as backward-euler"},
    {"xpbd", 0.35, 1, 0.05, "dissipates as backward-euler"},
};

static struct bounds bounds_of(const char *method) {
    for (size_t k = 0; k < LENGTH(own_bounds); k++)
        if (methods_is(method, own_bounds[k].method))
            return own_bounds[k];
    return (struct bounds){.least = 0.9, .most = 1.05, .pairs = 0.9};
}

/* Energy after the bounce, as a fraction of that before. The sheet comes into the range of the
 * obstacle `phase` frames after the start. */
static double kept(const char *method, const struct target *target, double speed,
                   double phase) {
    const double size = 0.1 * (target->side - 1);
    struct fixture sheet;
    fixture_open(&sheet, method, THROWN, target->side, target->side, size, size,
                 target->range + speed * phase / 60, -speed, target->obstacle, target->range);
    fixture_start(&sheet);
    const double start = fixture_energy(&sheet);
    fixture_frames(&sheet, 5);
    const double end = fixture_energy(&sheet);
    double up = 0;
    for (size_t i = 0; i < sheet.n; i++)
        up += sheet.v[sheet.n + i];
    ck_assert_msg(up > 0, "%s, %g m/s: it does not come back", method, speed);
    fixture_close(&sheet);
    return end / start;
}

static void check(const char *method, const struct target *target, double speed, double phase) {
    const struct bounds bounds = bounds_of(method);
    const double share = kept(method, target, speed, phase);
    const double least = target == &mesh ? bounds.pairs : bounds.least;
    ck_assert_msg(share >= least && share <= bounds.most,
                  "%s, %s, %g m/s, phase %g: %.4f of the energy kept, expected %g to %g",
                  method, target->obstacle, speed, phase, share, least, bounds.most);
}

/* Methods with stages or a Newton iteration once passed into contact and out of it within one
 * step that nothing refused, both its ends being outside: rk4 made 1700 times the energy at
 * 5 m/s, gauss 12.8 times; newmark kept 0.06. */
TEST(thrown_sheets_come_back_with_their_energy) {
    static const double speeds[] = {1, 2, 5, 7, 10, 15, 20}, phases[] = {1.37, 1.66, 1.95};
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "bounce", .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN});
    for (size_t m = 0; m < methods.n; m++)
        for (size_t s = 0; s < LENGTH(speeds); s++)
            for (size_t p = 0; p < LENGTH(phases); p++)
                if (suite_takes(m + LENGTH(phases) * s + p, 4))
                    check(methods.list[m].text, &plane, speeds[s], phases[p]);
}

/* A long step that ends just inside of contact: the force there, over the whole step or half of
 * it, once threw single sheets back with up to four times their energy, which the long steps
 * afterwards then lost. Of 40 phases ros2 kept 0.42 at the least, velocity-verlet 0.68, rk4
 * 0.75, composition 0.8. */
TEST(impacts_keep_their_energy_at_every_phase) {
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "bounce", .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER | CS_NOT_GALILEAN});
    for (size_t m = 0; m < methods.n; m++)
        for (int k = 1; k <= 40; k++)
            if (suite_takes(m + k, 8))
                check(methods.list[m].text, &small, 10, 1 + fmod(0.6180339887498949 * k, 1));
}

/* A state deep in contact may be off by less than the tolerance: with nothing but error control
 * one throw in 30 of these came back with up to 8000 times its energy. */
TEST(error_control_is_not_all_that_bdf_has_in_contact) {
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "bounce", .with = CS_ADAPTIVE | CS_IMPLICIT | CS_MULTISTEP, .rtol = 1e-3});
    for (size_t m = 0; m < methods.n; m++)
        for (int k = 1; k <= 100; k++) {
            if (!suite_takes(m + k, 8))
                continue;
            const char *method = methods.list[m].text;
            const double share = kept(method, &small, 1, 1 + fmod(0.6180339887498949 * k, 1));
            ck_assert_msg(share > 0.85 && share < 1.1, "%s, throw %d: %.4f of the energy kept",
                          method, k, share);
        }
}

/* Explicit methods would take thousands of steps. */
TEST(meshes_throw_sheets_back) {
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "bounce", .with = CS_IMPLICIT, .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN});
    for (size_t m = 0; m < methods.n; m++)
        check(methods.list[m].text, &mesh, 2, 1.37);
}

/* A sheet that starts where the range of a stiff floor begins falls by micrometres. What a step
 * may miss was once a fraction of what such contact can hold: the sheet was thrown
 * to twice its height by implicit-linearised at a step a frame, and each refused or shortened
 * step of position-verlet threw it. rkc2 is off by its tolerance. */
TEST(sheets_on_stiff_floors_stay_there) {
    static const char *const more[] = {"implicit-linearised:dt=frame", "newmark:dt=frame",
                                       NULL};
    static const double stiffnesses[] = {2e4, 2e6};
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "bounce", .without = CS_EXPLICIT_OUTER, .more = more});
    for (size_t m = 0; m < methods.n; m++)
        for (size_t k = 0; k < LENGTH(stiffnesses); k++) {
            struct fixture sheet;
            struct fixture_log log;
            fixture_open(&sheet, methods.list[m].text,
                         "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"size\": [0.5, 0.5], "
                         "\"start\": \"flat\", \"place\": {\"translate\": [0, 0.002, 0]}}, "
                         "\"mass\": {\"areal_density\": 0.2}}], \"contact\": {\"law\": "
                         "\"force\", \"stiffness\": %g}, \"colliders\": [{\"floor\": "
                         "{\"height\": 0}, \"thickness\": 0.002}]}",
                         stiffnesses[k]);
            fixture_start_logged(&sheet, &log);
            fixture_frames(&sheet, 20);
            ck_assert_msg(log.largest < 1.05 * log.first,
                          "%s, %g N/m: energy %g of the start's", methods.list[m].text,
                          stiffnesses[k], log.largest / log.first);
            fixture_close(&sheet);
        }
}

/* xpbd once lost the count of steps that were refused, and the length of parts, between
 * advances. */
TEST(refused_steps_are_counted) {
    const struct methods methods = methods_find(&(struct methods_query){
        .with = CS_IMPLICIT, .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER | CS_NOT_GALILEAN});
    for (size_t m = 0; m < methods.n; m++) {
        const char *method = methods.list[m].text;
        struct fixture sheet;
        // a sheet at rest that accelerates into contact: the motion without forces is admitted
        fixture_open(&sheet, method,
                     "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"size\": [0.3, 0.3], "
                     "\"start\": \"flat\", \"place\": {\"translate\": [0, 0.003, 0]}}, "
                     "\"mass\": {\"areal_density\": 0.2}}], \"contact\": \"force\", "
                     "\"forces\": {\"gravity\": [0, -300, 0]}, \"colliders\": [{\"floor\": "
                     "{\"height\": 0}, \"thickness\": 0.002}]}");
        fixture_start(&sheet);
        fixture_frames(&sheet, 3);
        ck_assert_msg(sheet.session.run.counts.method.rejected > 0, "%s", method);
        fixture_close(&sheet);
    }
}

/* A particle alone, which no points between particles accompany, before other shapes. */
#define PARTICLE                                                                               \
    "{\"bodies\": [{\"cloth\": {\"grid\": [1, 1], \"place\": {\"translate\": [0.1, %.17g, "    \
    "0]}, "                                                                                    \
    "\"velocity\": [%g, %g, 0]}, \"mass\": {\"particle\": 0.01}}], \"contact\": {\"law\": "    \
    "\"force\", \"stiffness\": 200}, \"forces\": {\"gravity\": [0, 0, 0]}, \"colliders\": "    \
    "[{%s, "                                                                                   \
    "\"thickness\": 0.004}]}"
static const char *const shapes[] = {
    "\"sphere\": {\"centre\": [0, -1, 0], \"radius\": 1}",
    "\"box\": {\"centre\": [0, -0.5, 0], \"size\": [1, 1, 1], \"radius\": 0.1}",
    "\"capsule\": {\"from\": [-1, -0.5, 0], \"to\": [1, -0.5, 0], \"radius\": 0.5}"};

static double particle_keeps(const char *method, const char *shape, double along,
                             double speed) {
    struct fixture one;
    fixture_open(&one, method, PARTICLE, 0.004 + 1.37 * speed / 60, along, -speed, shape);
    fixture_start(&one);
    const double start = fixture_energy(&one);
    fixture_frames(&one, 5);
    const double end = fixture_energy(&one);
    ck_assert_msg(one.v[one.n] > 0, "%s, %s, %g m/s: it does not come back", method, shape,
                  speed);
    fixture_close(&one);
    return end / start;
}

/* Particles in impact are stepped alone: at every step, speed and phase. With one linear
 * model for a step such throws kept 0.18 to 0.44. */
TEST(linearised_steps_keep_the_energy_of_impacts) {
    static const double speeds[] = {0.5, 1, 2, 3, 5, 7, 10, 15, 20};
    static const double steps[] = {1 / 60., 8e-3, 4e-3, 2e-3, 1e-3};
    for (size_t k = 0; k < LENGTH(speeds) * LENGTH(steps); k++) {
        char method[64];
        snprintf(method, sizeof method, "implicit-linearised:dt=%.17g",
                 steps[k % LENGTH(steps)]);
        for (double phase = 1.05; phase < 2; phase += 0.22)
            check(method, &plane, speeds[k / LENGTH(steps)], phase);
        for (size_t o = 0; o < LENGTH(shapes); o++) {
            const double share =
                particle_keeps(method, shapes[o], 1, speeds[k / LENGTH(steps)]);
            ck_assert_msg(share > 0.97 && share < 1.02, "%s, %s, %g m/s: %.4f", method,
                          shapes[o], speeds[k / LENGTH(steps)], share);
        }
    }
}

/* In the smoothed band between two faces of a box the gradient of the distance is shorter than
 * 1: with 1 for its length the same throws kept 0.974 to 1.005. */
TEST(edges_of_boxes_keep_the_energy_of_impacts) {
    static const char *const methods[] = {"implicit-linearised", "implicit-linearised:dt=0.004",
                                          "implicit-linearised:dt=0.001"};
    static const char *const edge =
        "\"box\": {\"centre\": [0, -0.5, 0], \"size\": [0.4, 1, 1], \"radius\": 0.1}";
    static const double speeds[] = {1, 2, 5, 10, 20};
    for (size_t k = 0; k < LENGTH(speeds) * LENGTH(methods); k++) {
        const char *method = methods[k % LENGTH(methods)];
        const double speed = speeds[k / LENGTH(methods)];
        const double share = particle_keeps(method, edge, 0.3, speed);
        ck_assert_msg(share > 0.985 && share < 1.012, "%s, %g m/s: %.4f", method, speed, share);
    }
}

/* Mean velocity after an oblique throw at a floor with friction: along x and y. */
static void throw_obliquely(const char *method, double friction, double phase, double mean[2]) {
    struct fixture sheet;
    fixture_open(&sheet, method,
                 "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"size\": [0.5, 0.5], "
                 "\"start\": \"flat\", \"place\": {\"translate\": [0, %.15g, 0]}, "
                 "\"velocity\": [3, -2, 0]}, \"mass\": {\"areal_density\": 0.2}, \"springs\": "
                 "{\"stretch\": 60}}], \"contact\": \"force\", \"colliders\": [{\"floor\": "
                 "{\"height\": 0}, \"thickness\": 0.002, \"friction\": %g}], \"forces\": "
                 "{\"gravity\": [0, 0, 0]}}",
                 0.002 + 2 * phase / 60, friction);
    fixture_start(&sheet);
    fixture_frames(&sheet, 4);
    mean[0] = mean[1] = 0;
    for (size_t i = 0; i < sheet.n; i++) {
        mean[0] += sheet.v[i] / (double)sheet.n;
        mean[1] += sheet.v[sheet.n + i] / (double)sheet.n;
    }
    fixture_close(&sheet);
}

/* The impulse of friction is mu times that of the impact, J = 2 m u, until the sheet sticks:
 * 3 - 4 mu along the floor. */
TEST(impacts_lose_what_friction_takes) {
    static const double frictions[] = {0, 0.1, 0.3, 0.6, 1};
    // the last ones do not resolve friction (CS_FRICTION_IMPACT_RATIO)
    enum { RESOLVED = 4 };
    static const char *const methods[] = {"implicit-linearised",
                                          "implicit-linearised:dt=0.004",
                                          "implicit-linearised:dt=0.001",
                                          "dopri5",
                                          "velocity-verlet",
                                          "symplectic-euler",
                                          "rk4"};
    for (size_t m = 0; m < LENGTH(methods); m++)
        for (size_t f = 0; f < LENGTH(frictions); f++)
            for (double phase = 1.1; phase < 2; phase += 0.4) {
                double mean[2];
                throw_obliquely(methods[m], frictions[f], phase, mean);
                const double expected = fmax(0, 3 - 4 * frictions[f]);
                ck_assert_msg(fabs(mean[0] - expected) < 0.03 * 3,
                              "%s, friction %g: %.4f m/s along, expected %g", methods[m],
                              frictions[f], mean[0], expected);
                // symplectic-euler comes up at 2.10 m/s where friction is resolved too
                ck_assert_msg(fabs(mean[1] - 2) < (m < RESOLVED ? 0.03 : 0.11),
                              "%s, friction %g: %.4f m/s up", methods[m], frictions[f],
                              mean[1]);
            }
}

/* A sheet of 5 x 5, or one particle, that comes down on a floor, and maybe another from below,
 * with contact.restitution. */
#define GIVEN                                                                                  \
    "{\"bodies\": [%s], \"contact\": {\"law\": \"force\", \"restitution\": %g%s}, "            \
    "\"forces\": "                                                                             \
    "{\"gravity\": [0, 0, 0]}, \"pairs\": \"all\", \"colliders\": [{%s, \"thickness\": "       \
    "0.002}]}"
#define GIVEN_SHEET                                                                            \
    "{\"cloth\": {\"grid\": [%d, %d], \"size\": [0.4, 0.4], \"start\": \"flat\", \"place\": "  \
    "{\"translate\": [%g, %.15g, 0]}, \"velocity\": [0, %g, 0]}, \"mass\": "                   \
    "{\"areal_density\": "                                                                     \
    "%g}, \"thickness\": 0.002}"
/* a box of triangles with its top at y = 0 */
#define BOX                                                                                    \
    "\"mesh\": {\"shape\": \"box\", \"detail\": 4, \"scale\": [1, 0.2, 1], "                   \
    "\"place\": {\"translate\": [0, -0.1, 0]}}"
struct given {
    int side;            /* particles of a sheet's edge */
    bool clash;          /* two sheets far above the floor */
    double speed;        /* m/s of each */
    const char *further; /* keys of contact */
    double heavier;      /* the sheet from below, in times; 0: as heavy */
    bool mesh;           /* the floor is the top of a box of triangles */
};

/* Velocity apart after the impact over that together before. */
static double comes_back(const char *method, const struct given *given, double restitution) {
    const double way = given->speed * 1.37 / 60,
                 height = given->clash ? 0.001 + way : way + 0.002;
    char bodies[800];
    struct fixture sheets;
    int used = snprintf(bodies, sizeof bodies, GIVEN_SHEET, given->side, given->side, 0.0,
                        height, -given->speed, 0.2);
    const double density = given->heavier > 0 ? 0.2 * given->heavier : 0.2;
    if (given->clash)
        snprintf(bodies + used, sizeof bodies - (size_t)used, ", " GIVEN_SHEET, given->side,
                 given->side, 0.013, -height, given->speed, density);
    fixture_open(&sheets, method, GIVEN, bodies, restitution, given->further,
                 given->clash  ? "\"floor\": {\"height\": -100}"
                 : given->mesh ? BOX
                               : "\"floor\": {}");
    fixture_start(&sheets);
    fixture_frames(&sheets, 6);
    const size_t upper = (size_t)(given->side * given->side);
    double up = 0, down = 0;
    for (size_t i = 0; i < upper; i++)
        up += sheets.v[sheets.n + i] / (double)upper;
    for (size_t i = upper; i < sheets.n; i++)
        down -= sheets.v[sheets.n + i] / (double)upper;
    fixture_close(&sheets);
    return (up + down) / (given->clash ? 2 * given->speed : given->speed);
}

/* The loss is the only law of one particle: its closed form against the motion. */
TEST(restitution_of_one_particle_is_exact) {
    static const double restitutions[] = {0, 0.1, 0.3, 0.5, 0.8, 0.95, 1};
    static const struct given throws[] = {{1, false, 0.3, ", \"stiffness\": 100", 0, false},
                                          {1, false, 3, ", \"stiffness\": 1e3", 0, false},
                                          {1, false, 20, ", \"stiffness\": 1e7", 0, false}};
    for (size_t e = 0; e < LENGTH(restitutions); e++)
        for (size_t k = 0; k < LENGTH(throws); k++)
            ck_assert_double_eq_tol(comes_back("dopri5:rtol=1e-7", throws + k, restitutions[e]),
                                    restitutions[e], restitutions[e] > 0 ? 0.003 : 0.03);
}

/* Methods of order 1 lose most of an impact in steps of their own choice, but not where the
 * restitution is given. */
TEST(restitution_is_that_of_the_key) {
    static const char *const more[] = {"implicit-linearised:dt=frame",
                                       "backward-euler:dt=frame", "newmark:dt=frame", NULL};
    static const struct given impacts[] = {{5, false, 1, "", 0, false},
                                           {5, false, 10, ", \"stiffness\": 1e5", 0, false},
                                           {5, true, 2, "", 0, false},
                                           {5, true, 7, ", \"stiffness\": 1e6", 0, false}};
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "bounce", .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN, .more = more});
    for (size_t m = 0; m < methods.n; m++)
        for (size_t k = 0; k < LENGTH(impacts); k++)
            for (double e = 0.5; e <= 1; e += 0.5) {
                const double found = comes_back(methods.list[m].text, impacts + k, e);
                ck_assert_msg(fabs(found - e) < 0.1, "%s, impact %zu: %.4f, expected %g",
                              methods.list[m].text, k, found, e);
            }
}

/* Sheets of 4 and 100 times the mass, and colliders of triangles. */
TEST(restitution_depends_neither_on_masses_nor_on_triangles) {
    static const char *const methods[] = {"dopri5", "implicit-linearised:dt=frame",
                                          "backward-euler:dt=frame"};
    static const struct given impacts[] = {
        {5, true, 2, "", 4, false}, {5, true, 2, "", 100, false}, {5, false, 2, "", 0, true}};
    for (size_t m = 0; m < LENGTH(methods); m++)
        for (size_t k = 0; k < LENGTH(impacts); k++)
            for (double e = 0.5; e <= 1; e += 0.5)
                ck_assert_double_eq_tol(comes_back(methods[m], impacts + k, e), e, 0.1);
}
