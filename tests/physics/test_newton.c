/* The implicit methods on Newton's iteration: their steps in closed form, what they do where
 * the iteration or the linearisation fails, and steps as long as a frame on the shipped scenes.
 */
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* %g: damping in N s/m; %s: its model; %d: frames a second */
#define PAIR                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1], \"size\": [1, 1]},"                          \
    " \"mass\": {\"particle\": 0.5}, \"springs\": {\"stretch\": 25, \"damping\": %g,"          \
    " \"damping_model\": \"%s\"}}], \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": "          \
    "{\"fps\": %d}}"
#define H       0.05 // s
#define STEPS   20
#define DAMPING 0.6

/* distance beyond rest and its rate */
struct pair {
    double s, w;
};

/* Acceleration of the distance; it is linear. */
static double pull(struct pair y) {
    return -2 / 0.5 * (25 * y.s + DAMPING * y.w);
}

/* (I - g A)^-1 y for y' = A y */
static struct pair solve(double g, struct pair y) {
    const double c = 1 + g * 2 / 0.5 * DAMPING, k = g * 2 / 0.5 * 25;
    const double w = (y.w - k * y.s) / (c + g * k);
    return (struct pair){y.s + g * w, w};
}

static struct pair add(struct pair a, double b, struct pair y) {
    return (struct pair){a.s + b * y.s, a.w + b * y.w};
}

static struct pair slope(struct pair y) {
    return (struct pair){y.w, pull(y)};
}

static struct pair backward_euler(struct pair y, struct pair last) {
    (void)last;
    return solve(H, y);
}

static struct pair midpoint(struct pair y, struct pair last) {
    (void)last;
    return solve(H / 2, add(y, H / 2, slope(y)));
}

/* R(z) = (1 + (1 - 2 g) z) / (1 - g z)^2 with g = 1 - 1/sqrt 2: of tr-bdf2, sdirk2 and ros2 */
static struct pair l_stable(struct pair y, struct pair last) {
    (void)last;
    const double g = 1 - 1 / sqrt(2);
    return solve(g * H, solve(g * H, add(y, (1 - 2 * g) * H, slope(y))));
}

static struct pair bdf2(struct pair y, struct pair last) {
    if (isnan(last.s))
        return l_stable(y, last);
    return solve(2 * H / 3, (struct pair){(4 * y.s - last.s) / 3, (4 * y.w - last.w) / 3});
}

/* the diagonal element of Pade's approximant of exp(h A), N(h A) / N(-h A), of degree s */
static struct pair pade(int s, const double *n, struct pair y) {
    struct pair power = y, top = {0, 0}, column[2] = {{1, 0}, {0, 1}}, bottom[2] = {{0, 0}};
    double scale = 1;
    for (int p = 0; p <= s; p++, scale *= H) {
        top = add(top, n[p] * scale, power);
        power = slope(power);
        for (int k = 0; k < 2; k++) {
            bottom[k] = add(bottom[k], (p % 2 ? -n[p] : n[p]) * scale, column[k]);
            column[k] = slope(column[k]);
        }
    }
    const double det = bottom[0].s * bottom[1].w - bottom[1].s * bottom[0].w;
    return (struct pair){(top.s * bottom[1].w - bottom[1].s * top.w) / det,
                         (bottom[0].s * top.w - top.s * bottom[0].w) / det};
}

static struct pair gauss4(struct pair y, struct pair last) {
    (void)last;
    return pade(2, (const double[]){1, 1.0 / 2, 1.0 / 12}, y);
}

static struct pair gauss6(struct pair y, struct pair last) {
    (void)last;
    return pade(3, (const double[]){1, 1.0 / 2, 1.0 / 10, 1.0 / 120}, y);
}

static struct pair gauss8(struct pair y, struct pair last) {
    (void)last;
    return pade(4, (const double[]){1, 1.0 / 2, 3.0 / 28, 1.0 / 84, 1.0 / 1680}, y);
}

static const struct {
    const char *integrator;
    struct pair (*step)(struct pair y, struct pair last);
} closed[] = {{"backward-euler:rtol=1e-14", backward_euler},
              {"implicit-midpoint:rtol=1e-14", midpoint},
              {"bdf2:rtol=1e-14", bdf2},
              {"bdf2:rtol=1e-14,solve=linear", bdf2},
              {"tr-bdf2:rtol=1e-14", l_stable},
              {"sdirk2:rtol=1e-14", l_stable},
              {"ros2:rtol=1e-14", l_stable},
              {"newmark:rtol=1e-14", midpoint},
              {"gauss:rtol=1e-14", gauss4},
              {"gauss:rtol=1e-14,order=6", gauss6},
              {"gauss:rtol=1e-14,order=8", gauss8}};

/* The distance beyond rest after one second, from 0.1 m. */
static double swing(const char *integrator, const char *model) {
    struct fixture pair;
    fixture_open(&pair, integrator, PAIR, DAMPING, model, 20);
    pair.x[0] -= 0.05;
    pair.x[1] += 0.05;
    fixture_start(&pair);
    fixture_frames(&pair, STEPS);
    const double found = pair.x[1] - pair.x[0] - 1;
    fixture_close(&pair);
    return found;
}

/* Along the spring all is linear, and a step is a rational function of h A. Average
 * acceleration is the trapezoidal rule there, which is the midpoint rule of a linear equation.
 */
TEST(steps_have_their_closed_form) {
    static const char *const models[] = {"relative", "axial"};
    for (size_t i = 0; i < sizeof closed / sizeof *closed; i++) {
        struct pair y = {0.1, 0}, last = {(double)NAN, 0};
        for (int k = 0; k < STEPS; k++) {
            const struct pair next = closed[i].step(y, last);
            last = y;
            y = next;
        }
        for (size_t m = 0; m < 2; m++) {
            const double found = swing(closed[i].integrator, models[m]);
            ck_assert_msg(fabs(found - y.s) < 1e-13, "%s, %s: %.17g, expected %.17g",
                          closed[i].integrator, models[m], found, y.s);
        }
    }
}

/* Generalised-alpha damps the fastest mode by rho_inf a step, average acceleration not at all:
 * a stiff pair far beyond its resolution, after 20 steps. */
TEST(newmark_keeps_rho_inf_of_the_fastest_mode) {
    static const double shares[] = {0.5, 0.8, 1};
    for (size_t i = 0; i < 3; i++) {
        char integrator[96];
        snprintf(integrator, sizeof integrator,
                 "newmark:rtol=1e-13,variant=generalised-alpha,rho_inf=%g", shares[i]);
        struct fixture pair;
        struct cs_error error = {0};
        double size[2];
        fixture_open(&pair, integrator,
                     "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": "
                     "0.5}, \"springs\": {\"stretch\": 25}}], \"forces\": {\"gravity\": "
                     "[0, 0, 0]}, \"time\": {\"fps\": 0.1}}");
        pair.x[1] += 1e-5; // small, or a step would turn the spring inside out
        fixture_start(&pair);
        for (int k = 0; k < 2; k++) {
            for (int frame = 0; frame < 10; frame++)
                ck_assert_int_eq(cs_run_frame(&pair.session.run, &error), CS_OK);
            size[k] = fabs(pair.v[1] - pair.v[0]);
        }
        fixture_close(&pair);
        // a double root -rho_inf: n-th powers times a straight line in n
        const double found = pow(size[1] / size[0], 0.1);
        ck_assert_msg(found > 0.85 * shares[i] && found < 1.2 * shares[i],
                      "rho_inf %g: a step keeps %g", shares[i], found);
    }
}

/* One iteration is not enough for a whirling chain: the step is halved twelve times, each
 * counted, and then the run fails with the residual. */
TEST(failure_is_told) {
    static const char *const methods[] = {
        "backward-euler", "implicit-midpoint", "bdf2",           "tr-bdf2",
        "sdirk2",         "newmark",           "energy-momentum"};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        char integrator[96];
        struct fixture chain;
        snprintf(integrator, sizeof integrator, "%s:rtol=1e-14,iterations=1", methods[i]);
        fixture_open(
            &chain, integrator,
            "{\"bodies\": [{\"cloth\": {\"grid\": [4, 1]}, \"mass\": {\"particle\": 0.5},"
            " \"springs\": {\"stretch\": 25}, \"pins\": [\"left\"]}], \"time\": {\"fps\": 1}}");
        cs_perturb_smooth(chain.system, 0.1, 20);
        fixture_start(&chain);
        const char *reason = fixture_reason(&chain);
        ck_assert_msg(strstr(reason, "Newton's iteration fails") &&
                          strstr(reason, "after 16 halvings: the residual is"),
                      "%s: %s", methods[i], reason);
        ck_assert_uint_eq(chain.session.run.counts.method.rejected, 17);
        ck_assert_uint_eq(chain.session.run.counts.steps, 0);
        fixture_close(&chain);
    }
}

/* Without a refused step the deepest contact is named: of a plate at heights of 9 to 1 mm over
 * a floor with a range of 10 mm. */
TEST(failure_in_contact_names_the_deepest) {
    struct fixture plate;
    fixture_open(
        &plate, "newmark:rtol=1e-14,iterations=1",
        "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"size\": [0.2, 0.2], \"start\": "
        "\"flat\"}, \"mass\": {\"particle\": 0.01}, \"springs\": {\"stretch\": 50}}], "
        "\"colliders\": [{\"floor\": {\"height\": 0}, \"thickness\": 0.01}], "
        "\"contact\": {\"law\": \"force\", \"start\": \"allow\", \"stiffness\": 100}}");
    for (size_t i = 0; i < plate.n; i++)
        plate.x[plate.n + i] = 0.009 - 0.001 * (double)i;
    fixture_start(&plate);
    const char *reason = fixture_reason(&plate);
    ck_assert_msg(strstr(reason, "Newton's iteration fails") &&
                      strstr(reason, "; there particle 8 (body 0, column 2, row 2) comes to "
                                     "colliders[0], 0.001 m apart: contact takes up 0.83"),
                  "%s", reason);
    fixture_close(&plate);
}

/* A pair that turns by three radians a frame: linear methods halve the step and lose some
 * energy, instead of throwing the pair apart. */
TEST(rotation_halves_linear_steps) {
    static const char *const methods[] = {"ros2", "bdf2:solve=linear"};
    for (size_t i = 0; i < 2; i++) {
        struct fixture pair;
        fixture_open(&pair, methods[i], PAIR, 0.0, "axial", 1);
        pair.v[2] = -1.5, pair.v[3] = 1.5;
        fixture_start(&pair);
        const double before = fixture_energy(&pair);
        fixture_frames(&pair, 3);
        const double kept = fixture_energy(&pair) / before;
        ck_assert_msg(kept > 0.5 && kept < 1.01, "%s: %g of the energy", methods[i], kept);
        ck_assert_uint_gt(pair.session.run.counts.method.rejected, 0);
        ck_assert_uint_gt(pair.session.run.counts.steps, 3);
        fixture_close(&pair);
    }
}

/* Runs 60 frames of a shipped scene with one step a frame; the energy in the end. */
static double frame_steps(const char *scene, const char *integrator, const char *grid) {
    const struct cs_override coarse = {"bodies[0].cloth.grid", grid};
    const struct cs_session_settings settings = {
        .scene = scene, .overrides = &coarse, .n_overrides = 1, .integrator = integrator};
    struct cs_error error = {0};
    struct fixture cloth = {0};
    cs_session_open_system(&cloth.session, &settings, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    cs_method_step_by_frames(&cloth.session.method);
    fixture_start(&cloth);
    cloth.system = &cloth.session.system;
    cloth.n = cloth.system->view.n;
    cloth.x = cloth.system->state;
    cloth.v = cloth.x + 3 * cloth.n;
    fixture_frames(&cloth, 60);
    const double energy = fixture_energy(&cloth);
    fixture_close(&cloth);
    return energy;
}

/* Without a failure and without energy from nowhere: the hanging and the falling sheet end
 * below what they had at the start (0 J and 2.3 J), the flag within what wind can give. ros2
 * alone makes some energy while hanging: its fast turns are chaos at such a step, and it ends
 * between -0.04 and 0.15 J for widths of the sheet that differ by 0.5 %. What it may reach is
 * ten times the 0.08 J that gravity has given by then. Left out are methods that gain energy a
 * hundredfold: implicit-midpoint and newmark, whose fast modes are not damped and feed on
 * contact and wind at such steps (on finer grids while hanging, too), and tr-bdf2 in contact,
 * whose first stage is half explicit. On these grids they pass with dt = 4 ms. */
TEST(a_step_may_be_a_frame) {
    static const char *const methods[] = {"backward-euler",
                                          "bdf2",
                                          "sdirk2",
                                          "ros2",
                                          "newmark:variant=generalised-alpha,rho_inf=0",
                                          "tr-bdf2",
                                          "implicit-midpoint",
                                          "newmark"};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        const double hang = frame_steps(SCENES "/hang.json", methods[i], "[16, 16]");
        const double most = strcmp(methods[i], "ros2") ? 0 : 0.8;
        ck_assert_msg(hang < most, "%s, hang: %g J", methods[i], hang);
        if (i < 5) {
            const double fall = frame_steps(SCENES "/sphere_fall.json", methods[i], "[16, 16]");
            ck_assert_msg(fall < 2.3, "%s, sphere_fall: %g J", methods[i], fall);
        }
        if (i < 6) {
            const double flag = frame_steps(SCENES "/flag_wind.json", methods[i], "[18, 12]");
            ck_assert_msg(flag < 0.5, "%s, flag_wind: %g J", methods[i], flag);
        }
    }
}

/* The preconditioner as a call: symmetric, positive, near the inverse; with blocks (8 x 8) and
 * with multigrid (30 x 30, a stiff step). */
TEST(preconditioner_is_offered) {
    enum { MOST = 3 * 30 * 30 };
    static double a[MOST], b[MOST], za[MOST], zb[MOST], back[MOST];
    for (int k = 0; k < 2; k++) {
        const int side = k ? 30 : 8;
        const double h = k ? 1 / 60.0 : 1e-4;
        struct fixture cloth;
        fixture_open(
            &cloth, "backward-euler",
            "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d]}, \"mass\": {\"total\": 0.3}, "
            "\"springs\": {\"stretch\": 5000}, \"pins\": [\"top-left\"]}]}",
            side, side);
        fixture_start(&cloth);
        const struct cs_host *host = cs_run_calls(&cloth.session.run);
        ck_assert_int_eq(
            host->solve_setup(host->ctx, 0, cloth.x, cloth.v, 1, -h, -h * h, CS_SOLVE_PSD),
            CS_STEP_OK);
        const size_t n3 = 3 * cloth.n;
        double ab = 0, ba = 0, aa = 0, bb = 0, left = 0, whole = 0;
        for (size_t i = 0; i < n3; i++) {
            const bool free = cloth.system->inv_mass[i % cloth.n] > 0;
            a[i] = free ? (double)(i * 7919 % 1009) / 1009 - 0.5 : 0;
            b[i] = free ? (double)(i * 104729 % 997) / 997 - 0.5 : 0;
        }
        host->precondition(host->ctx, a, za);
        host->precondition(host->ctx, b, zb);
        host->matrix_product(host->ctx, zb, back);
        for (size_t i = 0; i < n3; i++) {
            ab += a[i] * zb[i], ba += b[i] * za[i], aa += a[i] * za[i], bb += b[i] * zb[i];
            left += (b[i] - back[i]) * (b[i] - back[i]), whole += b[i] * b[i];
            ck_assert(cloth.system->inv_mass[i % cloth.n] > 0 || zb[i] == 0);
        }
        ck_assert_msg(aa > 0 && bb > 0 && fabs(ab - ba) < 1e-5 * sqrt(aa * bb),
                      "side %d: %.9g and %.9g, norms %.9g and %.9g", side, ab, ba, aa, bb);
        ck_assert_msg(left < (k ? 1 : 1e-2) * whole, "side %d: %.3g of the residual left", side,
                      sqrt(left / whole));
        fixture_close(&cloth);
    }
}

/* Particles of 1e-9 kg at springs of 100 N/m: periods below 1e-5 s, and dampers that outweigh
 * inertia. The run goes on, and no energy is made. */
TEST(tiny_masses_are_stepped) {
    static const char *const methods[] = {"backward-euler", "newmark"};
    for (size_t i = 0; i < 2; i++) {
        struct fixture sheet;
        fixture_open(
            &sheet, methods[i],
            "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"size\": [0.5, 0.5], \"start\": "
            "\"flat\", \"bump\": 0.02}, \"mass\": {\"particle\": 1e-9}, \"springs\": "
            "{\"stretch\": 100, \"shear\": 30, \"bend\": 3, \"damping\": 0.01}, \"pins\": "
            "[\"top-left\", \"top-right\"]}]}");
        fixture_start(&sheet);
        const double before = fixture_energy(&sheet);
        fixture_frames(&sheet, 3);
        const double after = fixture_energy(&sheet);
        ck_assert_msg(after < before, "%s: from %g to %g J", methods[i], before, after);
        fixture_close(&sheet);
    }
}
