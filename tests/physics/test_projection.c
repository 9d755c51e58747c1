/* Contact by projection: what friction holds stays where it is, and no commit makes energy,
 * with any method. With the argument "all" the ball has more particles and is dropped at more
 * steps and tolerances. */
#include "methods.h"

#include "model/force/terms.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MU     0.9
#define DEGREE (M_PI / 180)

/* a sheet that lies on a slope, as soft as explicit methods want it at 1/60 s */
#define ON_SLOPE(more)                                                                         \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"start\": \"flat\", \"size\": [0.3, 0.3],"  \
    " \"place\": {\"rotate\": [0, 0, %.17g, %.17g]}}, \"mass\": {\"total\": 1},"               \
    " \"springs\": {\"stretch\": 10, \"shear\": 5, \"bend\": 1, \"damping\": 0.01}}],"         \
    " \"contact\": \"project\", \"colliders\": [{\"plane\": {\"normal\": [%.17g, %.17g, 0]}, " \
    "\"friction\": %g}]" more "}"
#define SLOPE ON_SLOPE("")
#define LOOSENED                                                                               \
    ON_SLOPE(", \"time\": {\"fps\": 120}, \"events\": [{\"from\": 0, \"to\": 1, \"ramp\": "    \
             "{\"key\": \"colliders[0].friction\", \"value\": 0.1}}]")

static void open_slope(struct fixture *sheet, const char *method, double degrees) {
    const double a = degrees * DEGREE;
    fixture_open(sheet, method, SLOPE, -sin(a / 2), cos(a / 2), sin(a), cos(a), MU);
    fixture_start(sheet);
}

/* the furthest that a particle is from where it was at the start */
static double drift(const struct fixture *sheet) {
    double largest = 0;
    for (size_t k = 0; k < 3 * sheet->n; k++)
        largest = fmax(largest, fabs(sheet->x[k] - sheet->system->start[k]));
    return largest;
}

/* tan 20 degrees = 0.36 is below mu: nothing moves by more than 1e-6 m in 10 s */
TEST(block_below_the_angle_of_friction_stays) {
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "slope", .dt = 1 / 60.0});
    for (size_t k = 0; k < methods.n; k++) {
        struct fixture sheet;
        const char *method = methods.list[k].text;
        open_slope(&sheet, method, 20);
        fixture_frames(&sheet, 600);
        ck_assert_msg(drift(&sheet) <= 1e-6, "%s: %.3g m", method, drift(&sheet));
        // held from the start on, it never falls behind the slope
        ck_assert_uint_eq(sheet.session.run.counts.projected_particles, 0);
        fixture_close(&sheet);
    }
}

/* tan 50 degrees is above it: g (sin - mu cos) t^2 / 2, to the first order in the step */
TEST(block_above_it_slides) {
    const double a = 50 * DEGREE, t = 0.5, g = 9.81 * (sin(a) - MU * cos(a));
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "slide", .dt = 1 / 480.0});
    for (size_t k = 0; k < methods.n; k++) {
        struct fixture sheet;
        const char *method = methods.list[k].text;
        open_slope(&sheet, method, 50);
        fixture_frames(&sheet, 30);
        for (size_t i = 0; i < sheet.n; i++) {
            const double way =
                (sheet.x[i] - sheet.system->start[i]) * cos(a) -
                (sheet.x[sheet.n + i] - sheet.system->start[sheet.n + i]) * sin(a);
            ck_assert_msg(fabs(way - g * t * t / 2) <= 2 * g * t / 480, "%s: %.6f m", method,
                          way);
        }
        fixture_close(&sheet);
    }
}

/* A box of springs that lies on the same slope with its lowest 25 vertices, 7.5 cm deep: its
 * own weight takes it together by 0.3 mm. */
#define BOX                                                                                    \
    "{\"bodies\": [{\"mesh\": {\"shape\": \"box\", \"detail\": 4, \"scale\": [0.3, 0.15, "     \
    "0.3], \"place\": {\"rotate\": [0, 0, %.17g, %.17g], \"translate\": [%.17g, %.17g, 0]}}, " \
    "\"network\": {\"placement\": \"opposed-normals\", \"springs\": 5, \"surface\": 4, "       \
    "\"seed\": 7}, \"mass\": {\"total\": 1}, \"springs\": {\"stretch\": 400, \"bend\": 0, "    \
    "\"damping\": 0.2}, \"pins\": [%s]}], \"contact\": \"project\", \"colliders\": "           \
    "[{\"plane\": {\"normal\": [%.17g, "                                                       \
    "%.17g, 0]}, \"friction\": %g}]}"

static void open_pinned_box(struct fixture *box, const char *method, const char *pins) {
    const double a = 20 * DEGREE, x = sin(a), y = cos(a);
    fixture_open(box, method, BOX, -sin(a / 2), cos(a / 2), 0.075 * x, 0.075 * y, pins, x, y,
                 MU);
    fixture_start(box);
}

static void open_box(struct fixture *box, const char *method) {
    open_pinned_box(box, method, "");
}

/* vertex i lay on the slope */
static bool lay(const struct fixture *box, size_t i) {
    const double a = 20 * DEGREE, *start = box->system->start;
    return start[i] * sin(a) + start[box->n + i] * cos(a) < 1e-9;
}

/* the furthest that a vertex of those that lay on the slope is from where it was */
static double slip(const struct fixture *box, const double *before) {
    double largest = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < box->n; i++)
            if (lay(box, i))
                largest = fmax(largest, fabs(box->x[c * box->n + i] - before[c * box->n + i]));
    return largest;
}

/* What rests on the vertices that friction holds may swing: they stay at a sixtieth of a
 * second, with iterations that have settled. */
TEST(box_below_the_angle_of_friction_stays) {
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "box", .with = CS_IMPLICIT, .without = CS_ADAPTIVE, .dt = 1 / 60.0});
    for (size_t k = 0; k < methods.n; k++) {
        struct fixture box;
        const char *method = methods.list[k].text;
        open_box(&box, method);
        fixture_frames(&box, suite_all ? 600 : 120);
        const double way = slip(&box, box.system->start);
        ck_assert_msg(way <= 1e-6, "%s: %.3g m", method, way);
        fixture_close(&box);
    }
}

/* The loads on the vertices of the box, were they all held: largest T / (mu N). */
static double steepest_load(void) {
    const double a = 20 * DEGREE, normal[3] = {sin(a), cos(a), 0};
    struct fixture box;
    char pins[400] = "";
    double f[3 * 512], steepest = 0;
    open_box(&box, "rk4:dt=1e-3");
    for (size_t i = 0; i < box.n; i++)
        if (lay(&box, i))
            snprintf(pins + strlen(pins), sizeof pins - strlen(pins), "%s%zu", *pins ? "," : "",
                     i);
    fixture_close(&box);
    open_pinned_box(&box, "rk4:dt=1e-3", pins);
    ck_assert_uint_le(box.n, 512);
    fixture_frames(&box, 30);
    box.system->n_pinned = 0; // whose forces are left out else
    cs_terms_force(box.system,
                   &(struct cs_eval){.t = 0.5, .x = box.x, .v = box.v, .parts = CS_PART_ALL},
                   f);
    for (size_t i = 0; i < box.n; i++) {
        double inward = 0, across = 0;
        for (size_t c = 0; c < 3; c++)
            inward -= f[c * box.n + i] * normal[c];
        for (size_t c = 0; c < 3; c++) {
            const double t = f[c * box.n + i] + inward * normal[c];
            across += t * t;
        }
        if (lay(&box, i) && inward > 0)
            steepest = fmax(steepest, sqrt(across) / (MU * inward));
    }
    fixture_close(&box);
    return steepest;
}

/* Held vertices of the box have loads outside the cone of friction, also when it has come to
 * rest: by Coulomb's law some must slip until the springs around them give way. With shorter
 * steps the slip converges to 6.9e-5 m, and all families agree on it. */
TEST(first_slip_of_a_box_is_that_of_the_law) {
    static const char *const methods[] = {"rk4:dt=5e-4", "velocity-verlet:dt=5e-4",
                                          "dopri5:rtol=1e-6", "cvode-bdf:rtol=1e-6"};
    ck_assert_double_gt(steepest_load(), 1.1);
    for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
        struct fixture box;
        open_box(&box, methods[k]);
        fixture_frames(&box, 10);
        const double way = slip(&box, box.system->start);
        ck_assert_msg(fabs(way - 6.9e-5) < 0.06 * 6.9e-5, "%s: %.3g m", methods[k], way);
        fixture_close(&box);
    }
}

TEST(box_does_not_creep) {
    double before[3 * 512];
    const struct methods methods = methods_find(&(struct methods_query){.with = CS_ADAPTIVE});
    for (size_t k = 0; k < methods.n; k++) {
        struct fixture box;
        const char *method = methods.list[k].text;
        if (!suite_takes(k + 1, methods.n > 1 ? 2 : 1)) // four seconds each
            continue;
        open_box(&box, method);
        ck_assert_uint_le(box.n, 512);
        fixture_frames(&box, suite_all ? 300 : 180);
        memcpy(before, box.x, 3 * box.n * sizeof *before);
        fixture_frames(&box, suite_all ? 300 : 60);
        ck_assert_msg(slip(&box, before) <= 4e-6, "%s: %.3g m", method, slip(&box, before));
        fixture_close(&box);
    }
}

/* Friction falls from 0.9 to 0.1 in a second. Until it is tan 20 degrees, at t0, nothing moves;
 * then the speed grows as g cos a 0.8 (t - t0)^2 / 2. */
TEST(block_slides_when_friction_lets_go) {
    const struct methods methods = methods_find(&(struct methods_query){.test = "let go"});
    const double a = 20 * DEGREE, t0 = (MU - tan(a)) / 0.8;
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture sheet;
        fixture_open(&sheet, method, LOOSENED, -sin(a / 2), cos(a / 2), sin(a), cos(a), MU);
        fixture_start(&sheet);
        fixture_frames(&sheet, 80);
        ck_assert_msg(drift(&sheet) == 0, "%s: %.3g m", method, drift(&sheet));
        fixture_frames(&sheet, 40);
        const double speed = 9.81 * cos(a) * 0.8 * (1 - t0) * (1 - t0) / 2;
        for (size_t i = 0; i < sheet.n; i++) {
            const double v = sheet.v[i] * cos(a) - sheet.v[sheet.n + i] * sin(a);
            ck_assert_msg(fabs(v - speed) <= 0.05 * speed, "%s: %.6f m/s, expected %.6f",
                          method, v, speed);
        }
        fixture_close(&sheet);
    }
}

/* A ball of 1 kg and 0.3 m, whose centre is 0.6 m above the floor: 5.886 J of gravity. */
#define BALL                                                                                   \
    "{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": %d, \"scale\": [0.6, 0.6, "  \
    "0.6], \"place\": {\"translate\": [0, 0.6, 0]}}, \"network\": {\"placement\": "            \
    "\"opposed-normals\", \"springs\": 5, \"surface\": 4, \"seed\": 7}, \"mass\": {\"total\":" \
    " 1}, \"springs\": {\"stretch\": 400, \"bend\": 0, \"damping\": %g}}],"                    \
    " \"contact\": \"project\", \"colliders\": [{\"floor\": {\"height\": 0}, \"absorption\": " \
    "%g, \"friction\": 0.2}],"                                                                 \
    " \"time\": {\"fps\": %d}}"

static int detail(void) {
    return suite_all ? 5 : 3;
}

/* these add energy: their steps are as long as the damping allows */
static bool is_forward(const char *method) {
    return methods_is(method, "explicit-euler") || methods_is(method, "averaged-euler");
}

static double damping_of(const char *method) {
    return is_forward(method) && !suite_all ? 0.2 : 0.02;
}

static struct fixture_log drop(const char *method, double absorption, int fps, double seconds) {
    struct fixture ball;
    struct fixture_log log;
    fixture_open(&ball, method, BALL, detail(), damping_of(method), absorption, fps);
    fixture_start_logged(&ball, &log);
    fixture_frames(&ball, (uint32_t)(seconds * fps));
    fixture_close(&ball);
    return log;
}

/* The longest step in s that a method takes of its own accord on the ball, by the bounds of its
 * springs; the two of first order that add energy want h omega^2 / 2 below the damping of every
 * mode, which is d / k times omega^2 / 2. */
static double limit_of(const struct method_asked *method) {
    struct fixture ball;
    fixture_open(&ball, method->text, BALL, detail(), damping_of(method->text), 1.0, 60);
    const double omega = ball.system->view.omega, delta = ball.system->view.delta;
    fixture_close(&ball);
    if (is_forward(method->text))
        return 0.1 * damping_of(method->text) / 400;
    return method->traits & CS_IMPLICIT ? HUGE_VAL : 1 / (omega + delta);
}

static void check_drop(const char *method, double absorption, int fps) {
    const struct fixture_log log = drop(method, absorption, fps, 0.8);
    ck_assert_msg(log.largest <= 1.01 * 5.886, "%s, absorption %g, %d frames a second: %.4g J",
                  method, absorption, fps, log.largest);
    // it may be flattened to half its height, but not sink in
    ck_assert_msg(log.lowest_gravity >= 0.15 * 9.81,
                  "%s, absorption %g, %d frames a second: %.4g m", method, absorption, fps,
                  log.lowest_gravity / 9.81);
}

TEST(ball_gets_no_energy_from_the_floor) {
    static const double absorptions[] = {1, -0.6};
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "drop", .without = CS_ADAPTIVE});
    for (size_t a = 0; a < 2; a++)
        for (size_t k = 0; k < methods.n; k++)
            for (int rate = 240; rate <= (suite_all ? 960 : 240); rate *= 4) {
                char method[120];
                const double limit = limit_of(methods.list + k), h = fmin(1.0 / rate, limit);
                if (!suite_takes(a + k, 2) || (suite_all && limit < 1.0 / rate && rate < 960))
                    continue; // or the same as with the next
                methods_set(method, methods.list[k].text, "dt", h);
                check_drop(method, absorptions[a], 60);
            }
}

TEST(ball_gets_none_at_a_sixtieth) {
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "long drop", .with = CS_IMPLICIT, .without = CS_ADAPTIVE, .dt = 1 / 60.0});
    for (size_t k = 0; k < methods.n; k++)
        check_drop(methods.list[k].text, 1, 60);
}

TEST(ball_gets_none_at_a_tolerance) {
    static const double tolerances[] = {1e-3, 1e-5};
    for (int r = 0; r < (suite_all ? 2 : 1); r++) {
        const struct methods methods = methods_find(&(struct methods_query){
            .with = CS_ADAPTIVE, .rtol = tolerances[r], .always = "esdirk"});
        for (size_t k = 0; k < methods.n; k++)
            for (int fps = 60; fps >= 5; fps /= 12)
                check_drop(methods.list[k].text, 1, fps);
    }
}

/* m behind the surface of the collider `kind` at t: a ball of 0.3 m, a box of 0.6 x 0.3 x 0.6 m
 * with edges of 0.02 m, a capsule of 0.15 m along x, a ball over a floor, a floor that rises at
 * 0.5 m/s */
static double depth_in(char kind, double t, const double p[3]) {
    const double x = p[0], y = p[1], z = p[2];
    if (kind == 'c')
        return 0.15 - sqrt(y * y + z * z);
    if (kind == 'b') {
        const double a = fabs(x) - 0.28, b = fabs(y) - 0.13, c = fabs(z) - 0.28;
        const double out = sqrt(pow(fmax(a, 0), 2) + pow(fmax(b, 0), 2) + pow(fmax(c, 0), 2));
        return 0.02 - out - fmin(fmax(a, fmax(b, c)), 0);
    }
    if (kind == 'm')
        return fmin(0.5 * t, 0.25) - y;
    return fmax(0.3 - sqrt(x * x + y * y + z * z), kind == 'f' ? -0.2 - y : -1);
}

/* Largest depth in m of a sheet after each of so many frames. */
static double find_deepest(struct fixture *sheet, char kind, int frames) {
    double deepest = 0;
    for (int frame = 0; frame < frames; frame++) {
        fixture_frames(sheet, 1);
        for (size_t i = 0; i < sheet->n; i++) {
            const double p[3] = {sheet->x[i], sheet->x[sheet->n + i],
                                 sheet->x[2 * sheet->n + i]};
            deepest = fmax(deepest, depth_in(kind, sheet->session.run.t, p));
        }
    }
    return deepest;
}

/* A sheet of 1 m falls on a collider in steps of a frame. What the limit of energy puts off may
 * be no deeper than 0.1 % of that: steps are cut, and come to be whole again. Whole steps alone
 * left 7 to 36 mm. No energy comes from it, and what it stores is little: a version that
 * applied all of a push froze sheets at a strain of 20 %. */
TEST(sheet_stays_out_in_long_steps) {
    static const struct {
        char kind;
        double top;
        const char *collider;
    } cases[] = {
        {'s', 0.3, "{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 0.3}}"},
        {'b', 0.15,
         "{\"box\": {\"centre\": [0, 0, 0], \"size\": [0.6, 0.3, 0.6], \"radius\": 0.02}}"},
        {'c', 0.15,
         "{\"capsule\": {\"from\": [-1, 0, 0], \"to\": [1, 0, 0], \"radius\": 0.15}}"},
        {'f', 0.3,
         "{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 0.3}, \"friction\": 0.3},"
         "{\"floor\": {\"height\": -0.2}, \"friction\": 0.3}"},
        {'m', 0, "{\"floor\": {\"height\": 0}, \"friction\": 0.3}"},
    };
    static const char *const more[] = {"xpbd:dt=frame", "vbd:dt=frame", NULL};
    const struct methods methods = methods_find(&(struct methods_query){.more = more,
                                                                        .test = "drape",
                                                                        .with = CS_IMPLICIT,
                                                                        .without = CS_ADAPTIVE,
                                                                        .dt = 1 / 60.0});
    static const char rises[] =
        ", \"events\": [{\"from\": 0, \"to\": 0.5, \"move\": {\"collider\": 0, \"path\": ["
        "{\"at\": 0.5, \"point\": [0, 0.25, 0]}]}}]";
    uint64_t cuts = 0;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
        for (size_t k = 0; k < methods.n; k++) {
            struct fixture sheet;
            struct fixture_log log;
            fixture_open(&sheet, methods.list[k].text,
                         "{\"bodies\": [{\"cloth\": {\"grid\": [8, 8], \"start\": \"flat\","
                         " \"place\": {\"translate\": [0, %.17g, 0]}},"
                         " \"mass\": {\"total\": 0.2}}], \"contact\": \"project\","
                         " \"colliders\": [%s]%s}",
                         cases[c].top + 0.06, cases[c].collider,
                         cases[c].kind == 'm' ? rises : "");
            fixture_start_logged(&sheet, &log);
            const double deepest = find_deepest(&sheet, cases[c].kind, 60);
            const struct cs_counts *counts = &sheet.session.run.counts;
            cuts += counts->subdivided_steps;
            ck_assert_msg(deepest <= 1e-3, "%s, %c: %.3g m", methods.list[k].text,
                          cases[c].kind, deepest);
            ck_assert_msg(cases[c].kind == 'm' || log.largest <= log.first * (1 + 1e-9),
                          "%s, %c: %.9g J of %.9g", methods.list[k].text, cases[c].kind,
                          log.largest, log.first);
            ck_assert_msg(counts->steps < 240, "%s, %c: %llu steps", methods.list[k].text,
                          cases[c].kind, (unsigned long long)counts->steps);
            fixture_close(&sheet);
        }
    ck_assert_uint_gt(cuts, 50);
}
