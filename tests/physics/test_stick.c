/* Friction that sticks (contact.friction_law "stick") in motion: rest below the angle of
 * friction is exact, sliding above it has Coulomb's acceleration, and obstacles carry what lies
 * on them. test_stick_law.c has the derivatives. */
#include "methods.h"

#include "base/pool.h"
#include "model/contact/barrier_law.h"
#include "model/contact/bristle_law.h"
#include "sim/run_state.h"

#include <math.h>
#include <string.h>

#define G 9.81
/* anchors follow at each step, so methods with error control get a tolerance */
#define RTOL 1e-6

static double furthest(const double *a, const double *b, size_t n) {
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

/* Nothing moves from 1 s to 3 s, below 1e-9 mm; where a tolerance lets the rest tremble, the
 * anchors at least do not move by a bit. */
TEST(rest_is_exact) {
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "exact rest", .without = CS_EXPLICIT_OUTER});
    ck_assert_uint_ge(methods.n_by_trait, 9);
    for (size_t m = 0; m < methods.n; m++) {
        const struct method_asked *method = methods.list + m;
        struct fixture block;
        double x[12], anchors[12];
        fixture_open_slope(&block, method->text, "\"friction_law\": \"stick\"", 0.2, "");
        fixture_frames(&block, 60);
        memcpy(x, block.x, sizeof x);
        ck_assert_uint_eq(block.system->friction_anchors->n_values, 12);
        memcpy(anchors, block.system->friction_anchors->values, sizeof anchors);
        fixture_frames(&block, 120);
        const double moved = furthest(x, block.x, 12);
        ck_assert_msg(moved <= (method->traits & CS_ADAPTIVE ? 2e-6 : 1e-12),
                      "%s moved by %.3g m", method->text, moved);
        ck_bits(anchors, block.system->friction_anchors->values, 12, method->text);
        fixture_close(&block);
    }
}

TEST(sliding_is_coulombs) {
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "slide",
                                             .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                             .rtol = RTOL,
                                             .residual = 1e-10});
    for (size_t m = 0; m < methods.n; m++)
        for (double tangent = 0.4; tangent < 0.55; tangent += 0.1) {
            struct fixture block;
            fixture_open_slope(&block, methods.list[m].text, "\"friction_law\": \"stick\"",
                               tangent, "");
            fixture_frames(&block, 15);
            const double before = fixture_sliding(&block, tangent);
            fixture_frames(&block, 15);
            const double found = (fixture_sliding(&block, tangent) - before) / 0.25;
            const double expected = G * cos(atan(tangent)) * (tangent - 0.3);
            ck_assert_msg(fabs(found - expected) < 1e-6, "%s: slope %.1f, off by %.3g m/s2",
                          methods.list[m].text, tangent, found - expected);
            fixture_close(&block);
        }
}

/* A plate that bobs on a floor and slides; gravity across turns it. */
#define PLATE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"size\": [0.1, 0.1], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [0, 0.009, 0]}, \"velocity\": [%g, 0, 0]}, \"mass\": "        \
    "{\"total\": 0.1}, \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}}], "           \
    "\"colliders\": [{\"floor\": {}, \"thickness\": 0.02, \"friction\": 0.3}], \"forces\": "   \
    "{\"gravity\": [0, -9.81, %g]}, \"contact\": {\"law\": \"force\", \"start\": \"allow\", "  \
    "\"friction_law\": "                                                                       \
    "\"stick\", \"stiffness\": 100}, \"time\": {\"fps\": 10}}"

enum { VALUES = 24 };

static void end_state(const char *method, double h, const double of[2], double state[VALUES]) {
    struct fixture plate;
    char text[120];
    methods_set(text, method, "dt", h);
    fixture_open(&plate, text, PLATE, of[0], of[1]);
    fixture_start(&plate);
    fixture_frames(&plate, 3);
    memcpy(state, plate.x, VALUES * sizeof *state);
    fixture_close(&plate);
}

/* slope between two steps */
static double order_of(const char *method, double h, const double of[2]) {
    double reference[VALUES], state[VALUES], error[2];
    end_state("rk4", 2e-5, of, reference);
    for (int k = 0; k < 2; k++) {
        end_state(method, h / (1 + k), of, state);
        error[k] = cs_rms_difference(state, reference, VALUES);
    }
    return log2(error[0] / error[1]);
}

TEST(order_is_full_where_sliding_is_straight_and_1_where_it_turns) {
    static const double straight[2] = {2, 0}, turning[2] = {1, -5};
    const double full = order_of("rk4", 1e-3, straight), one = order_of("rk4", 1e-3, turning);
    const double second = order_of("velocity-verlet", 1e-3, straight);
    ck_assert_msg(fabs(full - 4) < 0.1, "rk4: order %.3f straight on", full);
    ck_assert_msg(fabs(second - 2) < 0.1, "velocity-verlet: order %.3f straight on", second);
    ck_assert_msg(one > 0.8 && one < 1.4, "rk4: order %.3f in a bend", one);
}

/* At mu g until it has the belt's speed; from then on it moves as the belt does. */
TEST(belts_carry) {
    static const char belt[] = "{\"from\": 0, \"to\": 1, \"move\": {\"collider\": 0, "
                               "\"path\": [{\"at\": 1, \"point\": [0.5, 0, 0]}]}}";
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "let rest",
                                             .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                             .rtol = RTOL,
                                             .residual = 1e-10});
    for (size_t m = 0; m < methods.n; m++) {
        const char *name = methods.list[m].text;
        struct fixture block;
        fixture_open_slope(&block, name, "\"friction_law\": \"stick\"", 0, belt);
        fixture_frames(&block, 6);
        const double early = fixture_sliding(&block, 0);
        ck_assert_msg(fabs(early - 0.3 * G * 0.1) < 0.06 * 0.3 * G, "%s: %g m/s", name, early);
        fixture_frames(&block, 24);
        const double before = block.x[0];
        fixture_frames(&block, 24);
        ck_assert_msg(fabs(block.x[0] - before - 0.2) < 1e-8, "%s: carried %.12g of 0.2 m",
                      name, block.x[0] - before);
        fixture_close(&block);
    }
}

/* m, the way of a block that starts on a slope at a speed across it, in steps of a frame */
static void path_of(const char *method, double tangent, double across, double way[3]) {
    struct fixture block;
    fixture_open_slope(&block, method, "\"friction_law\": \"stick\"", tangent, "");
    const double x[3] = {block.x[0], block.x[4], block.x[8]};
    for (size_t i = 0; i < 4; i++)
        block.v[8 + i] = across;
    fixture_frames(&block, 60);
    for (size_t c = 0; c < 3; c++)
        way[c] = block.x[4 * c] - x[c];
    fixture_close(&block);
}

/* The chord takes a linear step to where implicit Euler ends: from rest, in a bend, and into
 * rest. */
TEST(linear_steps_end_as_implicit_euler) {
    static const double cases[][2] = {{0.5, 0}, {0.5, 0.5}, {0.2, 0.5}, {0, 0.5}};
    for (size_t k = 0; k < LENGTH(cases); k++) {
        double linear[3], full[3];
        path_of("implicit-linearised:rtol=1e-10", cases[k][0], cases[k][1], linear);
        path_of("backward-euler:rtol=1e-10", cases[k][0], cases[k][1], full);
        const double apart = furthest(linear, full, 3);
        ck_assert_msg(apart < 1e-7, "slope %g, %g m/s: %.3g m apart", cases[k][0], cases[k][1],
                      apart);
    }
}

/* A sheet at rest on a box or a ball that begin to turn at 2 rad/s: with contact samples on its
 * edges. %s: the collider and its first event. */
#define TURNS                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d], \"size\": [0.12, 0.12], \"start\": "       \
    "\"flat\", \"place\": {\"translate\": [%g, 0.0085, 0]}}, \"mass\": {\"areal_density\": "   \
    "0.5}, \"springs\": {\"stretch\": 60, \"shear\": 30, \"bend\": 0, \"damping\": 0.05}}], "  \
    "\"colliders\": [{%s, \"thickness\": 0.02, \"friction\": 0.8}], \"contact\": {\"law\": "   \
    "\"force\", \"start\": \"allow\", \"friction_law\": \"stick\", \"stiffness\": 100, "       \
    "\"damping\": 0.01}, "                                                                     \
    "\"events\": [{\"from\": %g, \"to\": 3, \"move\": {\"collider\": 0, \"spin\": [0, 2, "     \
    "0]}}]}"
#define BOX  "\"box\": {\"centre\": [0, -0.1, 0], \"size\": [1, 0.2, 1], \"radius\": 0.02}"
#define BALL "\"sphere\": {\"centre\": [0, -0.1, 0], \"radius\": 0.1}"

/* Largest distance in m of a state from another one turned by an angle about y. */
static double turned_from(const double *before, const double *after, size_t n, double angle) {
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        const double x = before[i], y = before[n + i], z = before[2 * n + i];
        const double to[3] = {x * cos(angle) + z * sin(angle), y,
                              z * cos(angle) - x * sin(angle)};
        for (size_t c = 0; c < 3; c++)
            most = fmax(most, fabs(after[c * n + i] - to[c]));
    }
    return most;
}

TEST(turning_obstacles_carry) {
    static const char *const methods[] = {"rk4", "velocity-verlet", "gauss",
                                          "backward-euler:dt=0.002", "dopri5:rtol=1e-6"};
    static const struct {
        const char *collider;
        double at, most;
    } shapes[] = {{BOX, 0.3, 1e-4}, {BALL, 0, 1e-4}};
    for (size_t k = 0; k < 2 * LENGTH(methods); k++) {
        const char *method = methods[k / 2], *collider = shapes[k % 2].collider;
        struct fixture sheet;
        double before[27];
        fixture_open(&sheet, method, TURNS, 3, 3, shapes[k % 2].at, collider, 0.2);
        fixture_start(&sheet);
        ck_assert_ptr_nonnull(sheet.system->friction_anchors);
        fixture_frames(&sheet, 60);
        memcpy(before, sheet.x, sizeof before);
        fixture_frames(&sheet, 30);
        const double off = turned_from(before, sheet.x, sheet.n, 1);
        ck_assert_msg(off < shapes[k % 2].most, "%s on %.6s: off by %.3g m", method, collider,
                      off);
        fixture_close(&sheet);
    }
}

/* the whole state, as the hash has it */
static void hash_after(const char *method, uint32_t frames, uint32_t threads,
                       char digits[CS_HASH_DIGITS]) {
    struct cs_error error = {0};
    struct fixture sheet;
    cs_pool_start(threads, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    fixture_open(&sheet, method, TURNS, 40, 14, 0.0, BALL, 0.01);
    fixture_start(&sheet);
    ck_assert(threads == 1 || sheet.system->springs.n_blocks > 1);
    fixture_frames(&sheet, frames);
    cs_run_hash(&sheet.session.run, digits);
    fixture_close(&sheet);
    cs_pool_stop();
}

TEST(threads_do_not_count) {
    static const struct {
        const char *method;
        uint32_t frames;
    } of[] = {{"velocity-verlet", 1}, {"implicit-linearised", 6}};
    for (size_t m = 0; m < LENGTH(of); m++) {
        char one[CS_HASH_DIGITS], more[CS_HASH_DIGITS];
        hash_after(of[m].method, of[m].frames, 1, one);
        for (uint32_t threads = 2; threads <= 8; threads += threads == 3 ? 5 : 1) {
            hash_after(of[m].method, of[m].frames, threads, more);
            ck_assert_msg(!strcmp(one, more), "%s: %u threads", of[m].method, threads);
        }
    }
}

/* Two states with the same x and v and other anchors are not the same. */
TEST(resumed_run_has_the_same_hash) {
    static const char *const methods[] = {"rk4", "dopri5", "bdf2", "implicit-linearised"};
    for (size_t m = 0; m < LENGTH(methods); m++) {
        struct fixture whole, resumed;
        struct cs_error error = {0};
        struct cs_serialiser serialiser = {0};
        char a[CS_HASH_DIGITS], b[CS_HASH_DIGITS];
        fixture_open(&whole, methods[m], TURNS, 3, 3, 0.0, BALL, 0.2);
        fixture_start(&whole);
        fixture_frames(&whole, 14);
        cs_run_save(&whole.session.run, &serialiser, &error);
        fixture_frames(&whole, 4);
        fixture_open(&resumed, methods[m], TURNS, 3, 3, 0.0, BALL, 0.2);
        fixture_start(&resumed);
        serialiser.is_reading = true;
        cs_run_load(&resumed.session.run, &serialiser, &error);
        ck_assert_msg(!error.status && cs_serialiser_is_done(&serialiser), "%s", error.message);
        fixture_frames(&resumed, 4);
        cs_run_hash(&whole.session.run, a);
        cs_run_hash(&resumed.session.run, b);
        ck_assert_msg(!strcmp(a, b), "%s goes on elsewhere", methods[m]);
        resumed.system->friction_anchors->values[0] += 1e-9;
        cs_run_hash(&resumed.session.run, b);
        ck_assert_str_ne(a, b);
        cs_serialiser_finish(&serialiser);
        fixture_close(&resumed);
        fixture_close(&whole);
    }
}
