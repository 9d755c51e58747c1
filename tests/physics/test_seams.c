/* Seams: stitches as springs between particles and points of triangles. Closed forms, momentum,
 * orders, breaking, contact beside them. */
#include "methods.h"
#include "sim/energy_ledger.h"

#include "base/pool.h"
#include "model/system/seams.h"
#include "session/session.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* two sheets in flight, the second one turned, sewn at an edge, and one corner to a triangle;
 * %s: length of the stitches; %d: fps */
#define SHEETS                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"velocity\": [0.3, 0, 0.2]}, \"mass\":"     \
    " {\"particle\": 0.1}}, {\"cloth\": {\"grid\": [4, 5], \"place\": {\"translate\":"         \
    " [1.02, 0, 0.1], \"rotate\": [0.1, 0, 0, 1]}, \"spin\": [0, 0.3, 0.2]}, \"mass\":"        \
    " {\"particle\": 0.05}}], \"seams\": [{\"body\": 0, \"particles\": [3, 7, 11],"            \
    " \"to\": {\"body\": 1, \"particles\": [0, 4, 8]}, \"stiffness\": 40, \"damping\": 0.1,"   \
    " \"length\": %s}, {\"body\": 0, \"particles\": [\"bottom-right\"], \"to\": {\"body\": 1," \
    " \"particles\": [12, 13, 16], \"weights\": [0.5, 0.2, 0.3]}, \"stiffness\": 30,"          \
    " \"length\": %s}], \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": {\"fps\": %d}}"

enum { VALUES = 6 * 36 };

static void end_state(const char *method, const char *length, double state[VALUES]) {
    struct fixture sheets;
    fixture_open(&sheets, method, SHEETS, length, length, 10);
    fixture_start(&sheets);
    fixture_frames(&sheets, 3);
    memcpy(state, sheets.x, VALUES * sizeof *state);
    fixture_close(&sheets);
}

/* Both kinds of stitches, at the stated order of every method that takes seams. */
TEST(order_is_that_of_the_method) {
    static const char *const lengths[] = {"0", "0.1"};
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "order", .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER, .residual = 1e-12});
    for (size_t l = 0; l < 2; l++) {
        double reference[VALUES], state[VALUES];
        end_state("dopri5:rtol=1e-13", lengths[l], reference);
        for (size_t i = 0; i < methods.n; i++) {
            const struct method_asked *method = methods.list + i;
            const double h =
                method->traits & CS_NOT_GALILEAN ? 2.5e-5 : methods_step(method->order_damped);
            double error[2];
            for (int k = 0; k < 2; k++) {
                char text[120];
                methods_set(text, method->text, "dt", k ? h / 2 : h);
                end_state(text, lengths[l], state);
                error[k] = cs_rms_difference(state, reference, VALUES);
            }
            const double slope = log2(error[0] / error[1]);
            ck_assert_msg(slope > method->order_damped - 0.15 && error[1] < 0.02,
                          "%s, length %s: order %.3f, stated %u (errors %.3g, %.3g)",
                          method->text, lengths[l], slope, method->order_damped, error[0],
                          error[1]);
        }
    }
}

TEST(adaptive_methods_agree) {
    methods_check_agreement(end_state, "0.1", VALUES);
}

/* A force between a particle and a triangle of another body: equal and opposite in sum, and
 * with a length along d, so that angular momentum stays too. */
TEST(momentum_is_kept) {
    static const char *const by[] = {"rk4:dt=2e-3", "implicit-linearised:dt=2e-3,rtol=1e-13",
                                     "backward-euler:dt=2e-3,rtol=1e-12"};
    for (size_t k = 0; k < LENGTH(by); k++) {
        struct fixture sheets;
        double p[2][3], l[2][3];
        fixture_open(&sheets, by[k], SHEETS, "0.1", "0.1", 60);
        fixture_start(&sheets);
        fixture_momentum(&sheets, p[0], l[0]);
        fixture_frames(&sheets, 30);
        fixture_momentum(&sheets, p[1], l[1]);
        for (int c = 0; c < 3; c++) {
            ck_assert_msg(fabs(p[1][c] - p[0][c]) < 1e-10, "%s: %g, not %g", by[k], p[1][c],
                          p[0][c]);
            ck_assert_msg(k > 0 || fabs(l[1][c] - l[0][c]) < 1e-7, "%s: %g, not %g", by[k],
                          l[1][c], l[0][c]);
        }
        fixture_close(&sheets);
    }
}

/* A particle of 0.1 kg on a spring, with one of 0.3 kg sewn to it, moves like one of 0.4 kg:
 * the nearer, the stiffer the stitch. */
TEST(two_particles_are_one) {
    double x[3];
    for (int k = 0; k < 3; k++) {
        char sewn[400] = "", method[40];
        const double stiffness = k == 1 ? 1e3 : 1e5;
        if (k)
            snprintf(
                sewn, sizeof sewn,
                ", {\"cloth\": {\"grid\": [1, 1], \"place\": {\"translate\": [0.5, 0, 0]}},"
                " \"mass\": {\"particle\": 0.3}}], \"seams\": [{\"body\": 1, \"particles\":"
                " [0], \"to\": {\"body\": 0, \"particles\": [1]}, \"stiffness\": %g}",
                stiffness);
        struct fixture pair;
        snprintf(method, sizeof method, "rk4:dt=2e-4");
        fixture_open(
            &pair, method,
            "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": %g},"
            " \"springs\": {\"stretch\": 100}, \"pins\": [0]}%s]}",
            k ? 0.1 : 0.4, sewn);
        fixture_start(&pair);
        fixture_frames(&pair, 30);
        x[k] = pair.x[pair.n + 1];
        fixture_close(&pair);
    }
    ck_assert_double_lt(x[0], -0.3);
    ck_assert_double_lt(fabs(x[1] - x[0]), 2e-2);
    ck_assert_double_lt(fabs(x[2] - x[0]), 0.05 * fabs(x[1] - x[0]));
}

/* Two particles that fly apart at u from each other: the stitch breaks at its length, and takes
 * k l^2 / 2 of the energy m u^2 / 4 with it; a slower pair swings with k / (m / 2). */
TEST(stitches_break_at_their_length) {
    for (int fast = 0; fast < 2; fast++) {
        const double u = fast ? 1.5 : 0.9, k = 100, m = 0.2, most = 0.1;
        struct fixture pair;
        fixture_open(
            &pair, "rk4:dt=1e-5",
            "{\"bodies\": [{\"cloth\": {\"grid\": [1, 1]}, \"mass\": {\"particle\":"
            " 0.1}}, {\"cloth\": {\"grid\": [1, 1], \"velocity\": [%g, 0, 0]}, \"mass\":"
            " {\"particle\": 0.1}}], \"seams\": [{\"body\": 0, \"particles\": [0],"
            " \"to\": {\"body\": 1, \"particles\": [0]}, \"breaking_length\": %g}],"
            " \"forces\": {\"gravity\": [0, 0, 0]}}",
            u, most);
        fixture_start(&pair);
        const double w = sqrt(k / (m / 4));
        // the largest length of what swings is u / w: 0.067 and 0.040 m
        (void)w;
        fixture_frames(&pair, 6);
        const double apart = pair.v[1] - pair.v[0];
        ck_assert_uint_eq(pair.system->seams->n_broken, 0);
        ck_assert_double_eq_tol(apart, u * cos(sqrt(k / 0.05) * 0.1), 1e-8);
        fixture_close(&pair);
    }
}

/* the same by a length and by the force k l of the default stiffness, 100 N/m */
static void check_break(const char *key) {
    struct fixture pair;
    fixture_open(
        &pair, "rk4:dt=1e-5",
        "{\"bodies\": [{\"cloth\": {\"grid\": [1, 1]}, \"mass\": {\"particle\": 0.1}},"
        " {\"cloth\": {\"grid\": [1, 1], \"velocity\": [6, 0, 0]}, \"mass\":"
        " {\"particle\": 0.1}}], \"seams\": [{\"body\": 0, \"particles\": [0], \"to\":"
        " {\"body\": 1, \"particles\": [0]}, %s}], \"forces\": {\"gravity\": [0, 0, 0]}}",
        key);
    char before[CS_HASH_DIGITS], after[CS_HASH_DIGITS];
    fixture_start(&pair);
    fixture_frames(&pair, 6);
    const double apart = pair.v[1] - pair.v[0];
    ck_assert_uint_eq(pair.system->seams->n_broken, 1);
    // m u^2 / 4 less k l^2 / 2; the length was passed within one step, by 5e-5 m
    ck_assert_double_eq_tol(0.025 * apart * apart, 0.025 * 36 - 0.5 * 100 * 0.01, 5e-4);
    ck_assert_double_eq(pair.v[0] + pair.v[1] > 5.999999, true);
    cs_run_hash(&pair.session.run, before);
    pair.system->seams->broken[0] = false;
    pair.system->seams->n_broken = 0;
    cs_run_hash(&pair.session.run, after);
    ck_assert_str_ne(before, after);
    fixture_close(&pair);
}

TEST(stitches_break_at_their_force) {
    check_break("\"breaking_length\": 0.1");
    check_break("\"breaking_force\": 10");
    // the weaker of the two holds
    check_break("\"breaking_length\": 0.2, \"breaking_force\": 10");
}

/* An event opens one seam of two, and takes what it stores: k l^2 / 2 goes to the ledger. */
TEST(events_open_a_seam) {
    struct fixture pair;
    struct cs_energy_ledger ledger = {0};
    struct cs_error error = {0};
    fixture_open(
        &pair, "rk4:dt=1e-4",
        "{\"bodies\": [{\"cloth\": {\"grid\": [1, 2], \"size\": [1, 1]}, \"springs\":"
        " {\"stretch\": 0}, \"mass\": {\"particle\": 0.1}}, {\"cloth\": {\"grid\": [1, 2],"
        " \"size\": [1, 1], \"velocity\": [1, 0, 0]}, \"springs\": {\"stretch\": 0},"
        " \"mass\": {\"particle\": 0.1}}], \"seams\": [{\"body\": 0, \"particles\": [0],"
        " \"to\": {\"body\": 1, \"particles\": [0]}}, {\"body\": 0, \"particles\": [1],"
        " \"to\": {\"body\": 1, \"particles\": [1]}}], \"forces\": {\"gravity\": [0, 0, 0]},"
        " \"events\": [{\"at\": 0.02, \"unsew\": {\"seam\": 1}}]%s}",
        "");
    cs_energy_ledger_open(&ledger, pair.system, 0, &error);
    pair.session.settings.run.ledger = &ledger;
    fixture_start(&pair);
    fixture_frames(&pair, 6);
    // l = u / w sin w t with w^2 = k / (m / 2)
    const double w = sqrt(100 / 0.05), length = sin(w * 0.02) / w;
    ck_assert(!pair.system->seams->broken[0] && pair.system->seams->broken[1]);
    ck_assert_double_eq_tol(ledger.work[CS_WORK_EVENTS], -0.5 * 100 * length * length, 1e-9);
    ck_assert_double_eq_tol(pair.v[3] - pair.v[1], cos(w * 0.02), 1e-8);
    ck_assert_double_eq_tol(pair.v[2] - pair.v[0], cos(w * 0.1), 1e-7);
    cs_energy_ledger_close(&ledger);
    fixture_close(&pair);
}

/* Two sheets sewn edge to edge, and one folded over its seam, rest in contact by force: sewn
 * particles are as far from each other as contact would never let them be. */
TEST(contact_leaves_seams_alone) {
    struct fixture sheets;
    fixture_open(
        &sheets, "rk4:dt=1e-3",
        "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"particle\": 0.1},"
        " \"self_contact\": true},"
        " {\"cloth\": {\"grid\": [6, 6], \"place\": {\"translate\": [1, 0, 0]}},"
        " \"mass\": {\"particle\": 0.1}, \"self_contact\": true}], \"seams\":"
        " [{\"body\": 0, \"particles\": [\"right\"], \"to\": {\"body\": 1,"
        " \"particles\": [\"left\"]}}], \"contact\": {\"law\": \"force\", \"stiffness\":"
        " 100}, \"pairs\": \"all\", \"crossings\": \"count\", \"forces\": {\"gravity\":"
        " [0, 0, 0]}}");
    fixture_start(&sheets);
    fixture_frames(&sheets, 10);
    for (size_t i = 0; i < 3 * sheets.n; i++)
        ck_assert_msg(fabs(sheets.v[i]) < 1e-9, "%zu: %g m/s", i, sheets.v[i]);
    fixture_close(&sheets);
}

/* The bits do not depend on the number of threads. */
TEST(threads_change_nothing) {
    static const char *const by[] = {"rk4:dt=2e-3", "implicit-linearised", "bdf2:dt=5e-3"};
    for (size_t k = 0; k < LENGTH(by); k++) {
        double state[2][6 * (40 * 40 + 40 * 40)];
        for (int several = 0; several < 2; several++) {
            struct cs_error error = {0};
            struct fixture sheets;
            cs_pool_start(several ? 3 : 1, &error);
            fixture_open(&sheets, by[k],
                         "{\"bodies\": [{\"cloth\": {\"grid\": [40, 40], \"velocity\":"
                         " [0, 0, 1]}, \"mass\": {\"total\": 1}, \"pins\": [0]}, {\"cloth\":"
                         " {\"grid\": [40, 40], \"place\": {\"translate\": [1.01, 0, 0]}},"
                         " \"mass\": {\"total\": 1}}], \"seams\": [{\"body\": 0, \"particles\":"
                         " [\"right\"], \"to\": {\"body\": 1, \"particles\": [\"left\"]},"
                         " \"damping\": 0.1, \"breaking_length\": 0.03}]}");
            fixture_start(&sheets);
            fixture_frames(&sheets, 2);
            memcpy(state[several], sheets.x, sizeof state[0]);
            fixture_close(&sheets);
            cs_pool_stop();
        }
        ck_bits(state[0], state[1], LENGTH(state[0]), by[k]);
    }
}
