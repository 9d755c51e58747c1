/* Contact of bodies with themselves and with each other: its order, energy and momentum, and
 * that no list of pairs is ever seen in the bits. */
#include "methods.h"

#include "base/pool.h"
#include "model/contact/ccd/accd.h"
#include "model/contact/ccd/crossings.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/force/terms.h"
#include "model/plan.h"
#include "scene/file/scene_read.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* a sheet over a sheet, turned, or a strip to be bent into a U; %s: mass and springs' damping
 */
#define SPRINGS                                                                                \
    "\"mass\": {\"particle\": 0.1}, \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": "  \
    "5, \"damping\": 0}"
#define CONTACT                                                                                \
    "\"contact\": {\"law\": \"force\", \"stiffness\": 40, \"damping\": %g, "                   \
    "\"friction_speed\": 0.5}, \"time\": {\"fps\": 10}"
#define SHEETS                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"start\": \"flat\"}, \"thickness\": 0.1, "  \
    "\"pins\": [\"top\", \"bottom\"], " SPRINGS "}, {\"cloth\": {\"grid\": [3, 4], \"start\":" \
    " \"flat\", \"size\": [0.6, 0.7], \"place\": {\"translate\": [0.03, 0.12, 0.05], "         \
    "\"rotate\": [0.03, 0.2, 0, 1]}}, \"thickness\": 0.1, " SPRINGS "}], \"pairs\": "          \
    "{\"among\": \"all\", \"friction\": %g}, " CONTACT "}"
#define STRIP                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 3], \"size\": [2, 0.5]}, \"thickness\": 0.1, "   \
    "\"self_contact\": true, \"friction\": %g, " SPRINGS "}], \"forces\": {\"gravity\": "      \
    "[0, 0, 0]}, " CONTACT "}"

/* the strip in the shape of a U whose arms close */
static void bend(struct fixture *strip) {
    static const double turn[9][2] = {{0.9, 0.1},  {0.65, 0.1},  {0.4, 0.1},
                                      {0.15, 0.1}, {0, 0},       {0.15, -0.1},
                                      {0.4, -0.1}, {0.65, -0.1}, {0.9, -0.1}};
    const size_t n = strip->n;
    for (size_t i = 0; i < n; i++) {
        const double bump = 0.02 * sin(1.3 * (double)i);
        strip->x[i] = turn[i % 9][0] + bump;
        strip->x[2 * n + i] = turn[i % 9][1] + 0.5 * bump;
        strip->v[2 * n + i] = -1.5 * turn[i % 9][1];
    }
}

enum scene { ON_BODY, ON_ITSELF };

static void open(struct fixture *cloth, enum scene scene, const char *integrator,
                 double friction, double damping) {
    if (scene == ON_BODY)
        fixture_open(cloth, integrator, SHEETS, friction, damping);
    else
        fixture_open(cloth, integrator, STRIP, friction, damping);
    if (scene == ON_ITSELF)
        bend(cloth);
    fixture_start(cloth);
}

enum { VALUES = 6 * 28 };

static size_t end_state(enum scene scene, const char *name, double h, uint32_t frames,
                        double *state) {
    struct fixture cloth;
    char integrator[120];
    methods_set(integrator, name, "dt", h);
    open(&cloth, scene, integrator, 0, 0);
    fixture_frames(&cloth, frames);
    const size_t n = 6 * cloth.n;
    memcpy(state, cloth.x, n * sizeof *state);
    fixture_close(&cloth);
    return n;
}

TEST(orders_hold_in_contact) {
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "pairs",
                                .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                .residual = 1e-12});
    for (int scene = ON_BODY; scene <= ON_ITSELF; scene++) {
        double reference[VALUES], state[VALUES], error[2];
        const size_t n = end_state(scene, "rk4", 2.5e-4, 3, reference);
        for (size_t m = 0; m < methods.n; m++) {
            const struct method_asked *method = methods.list + m;
            const double h = fmin(methods_step(method->order), 2e-3);
            for (int k = 0; k < 2; k++) {
                end_state(scene, method->text, h / (1 + k), 3, state);
                error[k] = cs_rms_difference(state, reference, n);
            }
            const double order = log2(error[0] / error[1]);
            ck_assert_msg(fabs(order - method->order) < 0.2,
                          "scene %d, %s: order %.3f (errors %.3g, %.3g)", scene, method->text,
                          order, error[0], error[1]);
        }
    }
}

/* what rk4 loses of the energy over a run, which falls by 2^4 or so with each halving of the
 * step, in the mean of three: losses of one step change their sign where edges turn */
TEST(energy_is_kept) {
    for (int scene = ON_BODY; scene <= ON_ITSELF; scene++) {
        double lost[2];
        for (int k = 0; k < 2; k++) {
            struct fixture cloth;
            open(&cloth, scene, k ? "rk4:dt=1.25e-4" : "rk4:dt=1e-3", 0, 0);
            const double before = fixture_energy(&cloth);
            fixture_frames(&cloth, 4);
            lost[k] = fabs(fixture_energy(&cloth) - before);
            fixture_close(&cloth);
        }
        ck_assert_msg(lost[0] < 5e-5 && lost[1] < lost[0] / 3000, "scene %d: lost %.3g, %.3g J",
                      scene, lost[0], lost[1]);
    }
}

/* free in space: momentum whatever acts, angular momentum but for friction */
TEST(momentum_is_kept) {
    for (int rub = 0; rub < 2; rub++) {
        struct fixture strip;
        double p[2][3] = {{0}}, l[2][3] = {{0}};
        open(&strip, ON_ITSELF, "symplectic-euler:dt=1e-3", rub ? 0.5 : 0, 0.01);
        fixture_momentum(&strip, p[0], l[0]);
        fixture_frames(&strip, 6);
        fixture_momentum(&strip, p[1], l[1]);
        for (int c = 0; c < 3; c++) {
            ck_assert_double_eq_tol(p[0][c], p[1][c], 1e-12);
            ck_assert(rub || fabs(l[0][c] - l[1][c]) < 1e-10);
        }
        fixture_close(&strip);
    }
}

/* --- lists --- */

static const char crumple[] =
    "{\"bodies\": [{\"cloth\": {\"grid\": [25, 12], \"size\": [2.4, 1.1]}, \"self_contact\": "
    "true, \"friction\": 0.2, \"mass\": {\"particle\": 0.01}, \"springs\": {\"stretch\": 40, "
    "\"shear\": 15, \"bend\": 1, \"damping\": 0.02}}, {\"mesh\": {\"shape\": \"sphere\", "
    "\"detail\": 4, \"scale\": [0.6, 0.6, 0.6], \"place\": {\"translate\": [0, 0, 0.36]}, "
    "\"velocity\": [0, 0, -4]}, \"mass\": {\"total\": 2}, \"springs\": {\"stretch\": 400, "
    "\"damping\": 0.1}}], \"pairs\": \"all\", \"contact\": {\"law\": \"force\"}, \"forces\": "
    "{\"gravity\": [0, 0, 0]}}";

enum { FRAMES = 4 };

/* How a crumple is run: lists are kept for `trust` times the moves that they are made for. */
struct how {
    uint32_t threads;
    double margin, trust, fps;
};

/* a ball is thrown at a sheet, which wraps round it */
static size_t end_of_crumple(const char *method, struct how how, double state[6 * 600]) {
    struct fixture cloth;
    struct cs_error error = {0};
    cs_pool_start(how.threads, &error);
    fixture_open(&cloth, method, "%s", crumple);
    cloth.session.scene->time.fps = how.fps;
    struct cs_candidates *search = &cloth.system->pairs->candidates;
    search->margin *= how.margin;
    search->is_built = false;
    fixture_start(&cloth);
    for (uint32_t frame = 0; frame < (uint32_t)(how.fps * FRAMES / 60); frame++) {
        fixture_frames(&cloth, 1);
        search->margin_now = how.trust > 1 ? how.trust * search->margin : search->margin_now;
    }
    ck_assert_uint_gt(cloth.system->pairs->current_contacts->n, 40);
    ck_assert_uint_gt(search->n_builds, 3);
    const size_t n = 6 * cloth.n;
    ck_assert_uint_le(n, 6 * 600);
    memcpy(state, cloth.x, n * sizeof *state);
    fixture_close(&cloth);
    cs_pool_stop();
    return n;
}

TEST(lists_are_not_seen_in_the_bits) {
    static const struct how runs[] = {
        {1, 0.5, 1, 60}, {1, 2, 1, 60}, {2, 1, 1, 60}, {3, 0.7, 1, 60}, {8, 1, 1, 60}};
    static const char *const methods[] = {"velocity-verlet:dt=5e-4",
                                          "implicit-linearised:dt=0.004"};
    for (size_t m = 0; m < LENGTH(methods); m++) {
        static double one[6 * 600], other[6 * 600];
        const size_t n = end_of_crumple(methods[m], (struct how){1, 1, 1, 60}, one);
        for (size_t r = 0; r < LENGTH(runs); r++) {
            end_of_crumple(methods[m], runs[r], other);
            ck_assert_msg(!memcmp(one, other, n * sizeof *one), "%s: %u threads, margin %g",
                          methods[m], runs[r].threads, runs[r].margin);
        }
    }
}

/* what the test before would find: lists that are kept too long */
TEST(lists_kept_too_long_are_seen) {
    static double right[6 * 600], wrong[6 * 600];
    static const char method[] = "velocity-verlet:dt=5e-4";
    const size_t n = end_of_crumple(method, (struct how){1, 1, 1, 960}, right);
    end_of_crumple(method, (struct how){1, 1, 1.5, 960}, wrong);
    ck_assert(memcmp(right, wrong, n * sizeof *right));
}

/* moves of all particles at random, up to so many ranges a component, from where they are */
static void shake(const struct fixture *cloth, double ranges, uint64_t *seed, double *x) {
    const double range = cloth->system->pairs->body_pairs.range_min;
    for (size_t i = 0; i < 3 * cloth->n; i++) {
        *seed = *seed * 6364136223846793005u + 1442695040888963407u;
        x[i] = cloth->x[i] + ranges * range * ((double)(*seed >> 11) / 4503599627370496.0 - 1);
    }
}

/* Share of a move by the list, which must be that by a search of all primitives. */
static double share_of(const struct fixture *cloth, const double *x) {
    struct cs_pairs *pairs = cloth->system->pairs;
    const double share = cs_crossings_safe_fraction(cloth->system, 0, cloth->x, 0, x);
    cloth->system->pairs = NULL;
    ck_assert_double_eq(cs_crossings_safe_fraction(cloth->system, 0, cloth->x, 0, x), share);
    cloth->system->pairs = pairs;
    return share;
}

/* the list has the same share of a move as a search of all primitives, long moves too */
TEST(list_limits_as_the_search_does) {
    struct fixture cloth;
    static double x[3 * 600];
    uint64_t seed = 1;
    uint32_t listed = 0, cut = 0;
    fixture_open(&cloth, "velocity-verlet:dt=5e-4", "%s", crumple);
    fixture_start(&cloth);
    fixture_frames(&cloth, FRAMES);
    for (uint32_t k = 0; k < 60; k++) {
        shake(&cloth, 0.05 * (1 + k), &seed, x);
        listed += cs_crossings_list_suffices(cloth.system, cloth.x, x);
        cut += share_of(&cloth, x) < 1;
    }
    ck_assert_uint_gt(listed, 20);
    ck_assert_uint_lt(listed, 60);
    ck_assert_uint_gt(cut, 20);
    ck_assert_uint_lt(cut, 60);
    fixture_close(&cloth);
}

static void ask_elsewhere(struct cs_pairs *pairs, const struct cs_matrix *matrix,
                          const double *x) {
    static double sums[1200];
    const struct cs_eval at = {.x = x, .v = matrix->v, .parts = CS_PART_ALL};
    struct cs_matrix other = *matrix;
    other.x = x;
    cs_term_pairs.prepare(pairs->system, &at);
    cs_term_pairs.energy(pairs->system, &at);
    cs_term_pairs.prepare_matrix(pairs->system, &other, false);
    cs_term_pairs.add_state_bound(pairs->system, &at,
                                  &(struct cs_gershgorin){sums, sums + pairs->system->view.n});
    other.psd = false;
    cs_term_pairs.prepare_matrix(pairs->system, &other, false);
}

/* the kept matrix is that of its state, whatever is asked at others, and what is asked twice is
 * the same to the bit */
TEST(questions_do_not_disturb_each_other) {
    struct fixture cloth;
    static double x[3 * 600], y[4][3 * 600], f[4][3 * 600];
    uint64_t seed = 4;
    fixture_open(&cloth, "velocity-verlet:dt=5e-4", "%s", crumple);
    fixture_start(&cloth);
    fixture_frames(&cloth, FRAMES / 2);
    struct cs_pairs *pairs = cloth.system->pairs;
    const struct cs_block block = {.end = (uint32_t)cloth.n};
    const struct cs_eval at = {
        .x = cloth.x, .v = cloth.v, .parts = CS_PART_ALL, .block = &block};
    struct cs_matrix matrix = {
        .x = cloth.x, .v = cloth.v, .cm = 1, .cd = -0.01, .ck = -1e-4, .psd = true};
    for (int k = 0; k < 4; k++) {
        matrix.psd = k < 2;
        if (k % 2 == 0)
            cs_term_pairs.prepare_matrix(pairs->system, &matrix, true);
        cs_term_pairs.add_matrix_product(pairs->system, cloth.v, y[k]);
        cs_term_pairs.prepare(pairs->system, &at);
        cs_term_pairs.add_force(pairs->system, &at, f[k]);
        shake(&cloth, 0.1 * k, &seed, x);
        ask_elsewhere(pairs, &matrix, x);
        cs_term_pairs.prepare(pairs->system, &at);
        ask_elsewhere(pairs, &matrix, x);
    }
    for (int k = 1; k < 4; k++)
        ck_assert(!memcmp(f[0], f[k], sizeof f[0]));
    ck_assert(!memcmp(y[0], y[1], sizeof y[0]) && !memcmp(y[2], y[3], sizeof y[0]));
    ck_assert(memcmp(y[0], y[2], sizeof y[0]));
    fixture_close(&cloth);
}

/* a cloth whose layers have no room for its thickness is told so */
TEST(too_thick_is_refused) {
    struct cs_error error = {0};
    struct cs_scene scene;
    struct cs_system system;
    struct cs_plan plan;
    static const char text[] =
        "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5]}, \"mass\": {\"total\": 1}, "
        "\"self_contact\": true, \"thickness\": 0.2}], \"contact\": \"force\"}";
    cs_scene_read_text(&scene, "scene.json", text, strlen(text), NULL, 0, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    cs_plan_make(&plan, &scene, 0, false);
    ck_assert_int_eq(cs_system_build(&system, &scene, &plan, &error), CS_ERR_SCENE);
    ck_assert_msg(
        strstr(error.message, "bodies[0].self_contact: layers are only 0.177 m apart"), "%s",
        error.message);
    cs_scene_finish(&scene);
}
