/* Starts within the range of contact: refused with what would do, or moved to balance, where
 * bodies then stay. */
#include "fixture.h"
#include "model/contact/barrier_law.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/force/diagnostics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define G 9.81
#define SHEET(grid, x, y, z)                                                                   \
    "{\"cloth\": {\"grid\": [" grid "], \"size\": [1, 1], \"start\": \"flat\", \"place\": "    \
    "{\"translate\": [" x ", " y ", " z "]}}, \"mass\": {\"total\": 0.2}, \"springs\": "       \
    "{\"stretch\": 100, \"shear\": 30, \"bend\": 1, \"damping\": 0.01}}"
#define START(how)                                                                             \
    "\"contact\": {\"law\": \"force\", \"stiffness\": 100, \"start\": \"" how "\"}"

/* Starts that are too near: what is named, and the energy admitted in J. */
static const struct {
    const char *bodies, *others, *named;
    double admitted, gravity;
} near[] = {
    // laid on the floor
    {SHEET("12, 12", "0", "0", "0"), "\"colliders\": [{\"floor\": {\"height\": 0}}], ",
     "bodies[0] starts within the contact range of colliders[0]: ", 0.2 * G * 0.4 / 11, G},
    // 0.5 mm above a sheet
    {SHEET("12, 12", "0", "0", "0") ", " SHEET("12, 12", "0.01", "0.0005", "0.02"),
     "\"pairs\": \"all\", ",
     "bodies[0] starts within the contact range of bodies[1]: ", 0.4 * G * 0.4 / 11, G},
    // 0.6 mm above the face of a mesh
    {SHEET("12, 12", "0.01", "0.2506", "0.02"),
     "\"colliders\": [{\"mesh\": {\"shape\": \"box\", \"scale\": [1.5, 0.5, 1.5]}}], ",
     "bodies[0] starts within the contact range of colliders[0]: ", 0.2 * G * 0.4 / 11, G},
    // two sheets over a floor, each too near to the next
    {SHEET("8, 8", "0", "0.01", "0") ", " SHEET("8, 8", "0.02", "0.02", "0.03"),
     "\"colliders\": [{\"floor\": {\"height\": 0}, \"thickness\": 0.0571428571}], "
     "\"pairs\": \"all\", ",
     "bodies[0] starts within the contact range of ", 0.4 * G * 0.4 / 7, G},
    // two pairs, of which the second is too near: the first is measured without it
    {SHEET("8, 8", "0", "0", "0") ", " SHEET("8, 8", "0.02", "0.05", "0.03") ", " SHEET(
         "8, 8", "3", "0", "0") ", " SHEET("8, 8", "3.02", "0.0005", "0.03"),
     "\"pairs\": \"all\", ",
     "bodies[2] starts within the contact range of bodies[3]: ", 0.8 * G * 0.4 / 7, G},
    // without gravity 1e-3 k D^2 per particle
    {SHEET("12, 12", "0", "0.005", "0"),
     "\"colliders\": [{\"floor\": {\"height\": 0}, \"thickness\": 0.0363636364}], ",
     "bodies[0] starts within the contact range of colliders[0]: ",
     144 * 1e-3 * 100 * 0.16 / 121, 0},
};
enum { N_NEAR = sizeof near / sizeof *near };

static void open_near(struct cs_session *session, int k, const char *contact,
                      struct cs_error *error) {
    char text[4096];
    snprintf(text, sizeof text,
             "{\"bodies\": [%s], %s%s, \"forces\": {\"gravity\": [0, %g, 0]}}", near[k].bodies,
             near[k].others, contact, -near[k].gravity);
    *session = (struct cs_session){0};
    cs_session_open(session,
                    &(struct cs_session_settings){.scene = "near.json",
                                                  .text = text,
                                                  .integrator = "implicit-linearised:dt=frame"},
                    error);
}

TEST(start_with_more_energy_than_at_rest_is_refused) {
    for (int k = 0; k < N_NEAR; k++) {
        struct cs_session session;
        struct cs_error error = {0};
        open_near(&session, k, START("refuse"), &error);
        ck_assert_int_eq(error.status, CS_ERR_SCENE);
        const char *named = strstr(error.message, near[k].named);
        ck_assert_msg(named != NULL, "%s", error.message);
        // energy, what is admitted, and a move that does
        double stored, admitted, by;
        unsigned body;
        const char *digits = strstr(named, "]: ") ? strstr(named, "]: ") + 3 : "";
        ck_assert_int_eq(sscanf(digits,
                                "%lf J are stored there, at most %lf J at rest; move "
                                "bodies[%u] by %lf m along",
                                &stored, &admitted, &body, &by),
                         4);
        ck_assert(stored > admitted && by > 0);
        ck_assert_double_eq_tol(admitted, near[k].admitted, 0.005 * admitted);
        cs_session_close(&session);
    }
}

/* A range that nobody set is what the start leaves, here 2 and 5 mm of 36: nothing is stored,
 * and the sheet stays on the other surface. */
TEST(open_ranges_shrink_to_the_start) {
    static const struct {
        const char *scene;
        double gap, height;
    } rows[] = {
        {"{\"bodies\": [" SHEET(
             "12, 12", "0.01", "0.252",
             "0.02") "], \"colliders\": "
                     "[{\"mesh\": {\"shape\": \"box\", \"scale\": [1.5, 0.5, 1.5]}}]}",
         0.002, 0.25},
        {"{\"bodies\": [" SHEET(
             "12, 12", "0", "0.005",
             "0") ", {\"cloth\": {\"grid\": "
                  "[8, 8], \"size\": [1.5, 1.5], \"start\": \"flat\"}, \"mass\": {\"total\": "
                  "1}, "
                  "\"pins\": [{\"box\": {\"min\": [-2, -1, -2], \"max\": [2, 1e-3, 2]}}]}], "
                  "\"pairs\": \"all\"}",
         0.005, 0}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct fixture sheet;
        fixture_open(&sheet, "velocity-verlet", "%s", rows[k].scene);
        const double range =
            cs_body_pair_params_of(&sheet.system->pairs->body_pairs, 0, 1)->range;
        // the distance of the law is smooth, and slightly more
        ck_assert_double_eq_tol(range, rows[k].gap, 0.02 * rows[k].gap);
        ck_assert_double_eq(cs_diagnostics_energy(sheet.system, 0, sheet.x, sheet.v).other, 0);
        fixture_start(&sheet);
        fixture_frames(&sheet, 20);
        for (size_t i = 0; i < sheet.n; i++)
            ck_assert_double_gt(sheet.x[sheet.n + i], rows[k].height - 1e-9);
        fixture_close(&sheet);
    }
}

/* Balance: energy below what is admitted, and nothing moves from there on. A flat sheet on a
 * floor has the height at which all particles together carry the weight. */
TEST(move_out_ends_at_balance) {
    for (int k = 0; k < N_NEAR; k++) {
        struct cs_session session;
        struct cs_error error = {0};
        open_near(&session, k, START("move-out"), &error);
        ck_assert_msg(!error.status, "%s", error.message);
        const struct cs_initial_penetration *moved = &session.initial_penetration;
        const size_t n = session.system.view.n;
        ck_assert(moved->n_moves > 0 && moved->shift > 0 && moved->n == 0);
        ck_assert(moved->energy[0] > moved->energy[1]);
        ck_assert(session.run.n_notes > 0 &&
                  strstr(session.run.notes[session.run.n_notes - 1], "moved to balance"));
        if (k == 0) {
            double force = 0;
            for (size_t i = 0; i < n; i++)
                force += cs_barrier_at(session.system.state[n + i], 0.4 / 11, 100).force;
            ck_assert_double_eq_tol(force, 0.2 * G, 1e-5);
        }
        double highest = 0;
        for (size_t i = 0; i < n; i++)
            highest = fmax(highest, session.system.state[n + i]);
        for (int frame = 0; frame < 30 && !error.status; frame++)
            cs_run_frame(&session.run, &error);
        ck_assert_msg(!error.status, "%s", error.message);
        // a throw from W would take it W/(m g), up to D times the masses' ratio; rest takes
        // less
        for (size_t i = 0; i < n && near[k].gravity > 0; i++)
            ck_assert_msg(session.run.x[n + i] <
                              highest + (k == 3 ? 0.12 * 0.4 / 7 : 0.05 * 0.4 / 11),
                          "case %d: %g m", k, session.run.x[n + i] - highest);
        cs_session_close(&session);
    }
}

/* "allow" leaves all as it is, and the shipped scenes' start out of range needs nothing. */
TEST(allowed_start_is_left_as_it_is) {
    for (int k = 0; k < N_NEAR; k++) {
        struct cs_session session;
        struct cs_error error = {0};
        open_near(&session, k, START("allow"), &error);
        ck_assert_msg(!error.status, "%s", error.message);
        ck_assert(session.initial_penetration.n_moves == 0);
        ck_assert_int_eq(memcmp(session.system.start, session.system.state,
                                3 * session.system.view.n * sizeof(double)),
                         0);
        cs_session_close(&session);
    }
}

/* A body that is pinned cannot be moved as a whole: the other one is, or the scene is refused.
 */
TEST(pinned_bodies_stay) {
#define PINNED "\"pins\": [\"top\"], "
    static const char *const bodies[] = {
        "{\"cloth\": {\"grid\": [5, 5], \"start\": \"flat\"}, " PINNED
        "\"mass\": {\"total\": 1}}, {\"cloth\": {\"grid\": [5, 5], \"start\": \"flat\", "
        "\"place\": {\"translate\": [0.02, -0.01, 0.01]}}, \"mass\": {\"total\": 1}}",
        "{\"cloth\": {\"grid\": [5, 5], \"start\": \"flat\"}, " PINNED
        "\"mass\": {\"total\": 1}}, {\"cloth\": {\"grid\": [5, 5], \"start\": \"flat\", "
        "\"place\": {\"translate\": [0.02, -0.01, 0.01]}}, " PINNED
        "\"mass\": {\"total\": 1}}"};
    for (int k = 0; k < 2; k++) {
        struct cs_session session = {0};
        struct cs_error error = {0};
        char text[2048];
        snprintf(text, sizeof text, "{\"bodies\": [%s], \"pairs\": \"all\", %s}", bodies[k],
                 START("move-out"));
        cs_session_open(&session,
                        &(struct cs_session_settings){.scene = "pinned.json", .text = text},
                        &error);
        if (k) {
            ck_assert_int_eq(error.status, CS_ERR_SCENE);
            ck_assert_msg(strstr(error.message, "move them apart by the range of contact") !=
                              NULL,
                          "%s", error.message);
        } else {
            ck_assert_msg(!error.status, "%s", error.message);
            ck_assert_int_eq(
                memcmp(session.system.start, session.system.state, 25 * sizeof(double)), 0);
            ck_assert(session.system.state[50 + 25] < session.system.start[50 + 25]);
        }
        cs_session_close(&session);
    }
}
