/* Starts within the range of contact: refused with what would do, or moved to balance, where
 * bodies then stay. */
#include "fixture.h"
#include "model/contact/approach.h"
#include "model/contact/barrier_law.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/force/diagnostics.h"
#include "study/contact_capacity.h"

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

/* The energy of approach in closed form, and the stiffness that follows from it. */
#define DROPPED(x, y)                                                                          \
    "{\"cloth\": {\"grid\": [3, 3], \"size\": [0.2, 0.2], \"start\": \"flat\", \"place\": "    \
    "{\"translate\": [" x ", " y ", 0]}%s}, \"mass\": {\"particle\": 0.002}, \"springs\": "    \
    "{\"stretch\": 30}}"
static const struct {
    const char *about, *format, *more;
    uint32_t a, b;
    double squared; /* m2/s2, of the speed */
} meetings[] = {
    {"a drop", "{\"bodies\": [" DROPPED("0", "0.5") "], %s}",
     "\"colliders\": [{\"floor\": {\"height\": 0.1}}]", 0, 1, 2 * G * 0.4},
    {"a drop onto a slope of 3 in 4, from the nearest corner",
     "{\"bodies\": [" DROPPED("0", "0.5") "], %s}",
     "\"colliders\": [{\"plane\": {\"point\": [0, 0, 0], \"normal\": [0.6, 0.8, 0]}}]", 0, 1,
     2 * G *(0.5 - 0.075)},
    {"a drop beside a ball", "{\"bodies\": [" DROPPED("0.5", "0.5") "], %s}",
     "\"colliders\": [{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 0.3}}]", 0, 1, 0},
    {"a drop onto a ball", "{\"bodies\": [" DROPPED("0.35", "0.5") "], %s}",
     "\"colliders\": [{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 0.3}}]", 0, 1,
     2 * G * 0.2},
    {"a mesh below", "{\"bodies\": [" DROPPED("0", "0.5") "], %s}",
     "\"colliders\": [{\"mesh\": {\"shape\": \"box\", \"scale\": [1, 0.4, 1]}}]", 0, 1,
     2 * G * 0.3},
    {"a ceiling", "{\"bodies\": [" DROPPED("0", "0.5") "], %s}",
     "\"colliders\": [{\"plane\": {\"point\": [0, 1, 0], \"normal\": [0, -1, 0]}}]", 0, 1, 0},
    {"itself, where it may be stopped", "{\"bodies\": [" DROPPED("0", "0.5") "], %s}",
     "\"colliders\": [{\"floor\": {\"height\": 0.1}}, {\"floor\": {\"height\": -1}}]", 0, 0,
     2 * G * 0.4},
    {"two thrown at each other",
     "{\"bodies\": [" DROPPED("0", "0") ", " DROPPED("0", "1") "], %s}",
     "\"forces\": {\"gravity\": [0, 0, 0]}", 0, 1, 25},
    {"one that falls onto another",
     "{\"bodies\": [" DROPPED("0", "0") ", " DROPPED("0", "1") "], %s}", "\"about\": \"\"", 0,
     1, 25 + 2 * G},
    {"a floor that rises",
     "{\"bodies\": [" DROPPED("0", "0.5") "], %s, \"forces\": {\"gravity\": [0, 0, 0]}}",
     "\"colliders\": [{\"floor\": {\"height\": 0.1}}], \"events\": [{\"from\": 1, \"to\": 1.5, "
     "\"move\": {\"collider\": 0, \"path\": [{\"at\": 1.1, \"point\": [0, 0.2, 0]}, {\"at\": "
     "1.5, \"point\": [0, 0.3, 0]}]}}]",
     0, 1, 4},
    {"a body that is pulled smoothly",
     "{\"bodies\": [" DROPPED("0", "0.5") "], %s, \"forces\": {\"gravity\": [0, 0, 0]}}",
     "\"colliders\": [{\"floor\": {\"height\": 0.1}}], \"events\": [{\"from\": 0, \"to\": 1, "
     "\"grab\": {\"path\": [{\"at\": 0.5, \"point\": [0, 1, 0]}], \"relative\": true, "
     "\"motion\": \"smooth\"}}]",
     0, 1, 9},
    {"a ball that turns",
     "{\"bodies\": [" DROPPED("0", "0.5") "], %s, \"forces\": {\"gravity\": [0, 0, 0]}}",
     "\"colliders\": [{\"sphere\": {\"radius\": 0.1, \"centre\": [0, 0, 0]}}], \"events\": "
     "[{\"from\": 0, \"to\": 1, \"move\": {\"collider\": 0, \"spin\": [0, 0, 20]}}]",
     0, 1, 400 * 0.03},
};

TEST(energy_of_approach_is_that_of_closed_forms) {
    for (size_t k = 0; k < sizeof meetings / sizeof *meetings; k++)
        for (int given = 0; given < 2; given++) {
            struct fixture cloth;
            char format[1024], text[2048];
            const bool thrown = meetings[k].squared >= 25;
            // the format holds %s once or twice for what a body may have besides
            snprintf(format, sizeof format, "%s", meetings[k].format);
            if (strstr(format, "}, {\"cloth\"") && thrown)
                snprintf(text, sizeof text, format, ", \"velocity\": [0, 3, 0]",
                         ", \"velocity\": [0, -1, 3]", meetings[k].more);
            else
                snprintf(text, sizeof text, format, "", meetings[k].more);
            ck_assert(text[strlen(text) - 1] == '}');
            text[strlen(text) - 1] = '\0';
            fixture_open(&cloth, "velocity-verlet", "%s, \"pairs\": \"all\", %s}", text,
                         given ? "\"contact\": {\"law\": \"force\", \"stiffness\": 7}"
                               : "\"contact\": \"force\"");
            const double energy =
                cs_approach_energy(cloth.system, meetings[k].a, meetings[k].b);
            ck_assert_msg(fabs(energy - 0.001 * meetings[k].squared) <
                              1e-12 + 1e-9 * fabs(energy),
                          "%s: %g m2/s2, expected %g", meetings[k].about, energy / 0.001,
                          meetings[k].squared);
            struct cs_contact_capacity capacity;
            ck_assert(cs_contact_capacity_find(cloth.system, &capacity));
            const double needed = 80 * capacity.comes / (capacity.range * capacity.range);
            ck_assert_double_eq_tol(capacity.k, given ? 7 : fmax(30, needed),
                                    1e-9 * capacity.k);
            ck_assert_double_eq(capacity.holds,
                                cs_barrier_capacity(capacity.range, capacity.k));
            fixture_close(&cloth);
        }
}

/* A default holds 50 times what comes; a stiffness that does not is warned of, with one that
 * would do, and that one does. */
TEST(stiffness_that_is_too_small_is_told) {
    const char *const scene =
        "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"start\": \"flat\", \"place\": "
        "{\"translate\": [0, 2, 0]}}, \"mass\": {\"total\": 1}}], \"colliders\": [{\"floor\": "
        "{\"height\": 0}, \"thickness\": 0.004}], \"contact\": {\"law\": \"force\"%s}}";
    char more[64] = "";
    for (int k = 0; k < 3; k++) {
        struct fixture cloth;
        struct cs_text warning = {0};
        fixture_open(&cloth, "velocity-verlet", scene, more);
        cs_contact_capacity_warn(cloth.system, &warning);
        const char *digits = strstr(cs_text_get(&warning), "expected at least ");
        ck_assert_msg((k == 1) == (digits != NULL), "%s", cs_text_get(&warning));
        if (k == 0)
            snprintf(more, sizeof more, ", \"stiffness\": 50");
        else if (digits)
            // three digits are printed
            snprintf(more, sizeof more, ", \"stiffness\": %g",
                     1.01 * strtod(digits + strlen("expected at least "), NULL));
        cs_text_finish(&warning);
        fixture_close(&cloth);
    }
}

/* A sheet thrown at 10 m/s, at what is too soft by 1e4 times. */
#define THROWN                                                                                 \
    "{\"cloth\": {\"grid\": [6, 6], \"size\": [0.1, 0.1], \"start\": \"flat\", \"place\": "    \
    "{\"translate\": [0.003, 0.05, 0.007]}, \"velocity\": [0, -10, 0]}, \"mass\": "            \
    "{\"total\": "                                                                             \
    "0.02}, \"springs\": {\"stretch\": 100, \"shear\": 30}}"
#define SOFT()                                                                                 \
    "\"forces\": {\"gravity\": [0, 0, 0]}, \"contact\": {\"law\": \"force\", \"stiffness\": "  \
    "%s}}"

/* The message of a method that gives up names the place, both energies and the stiffness that
 * holds; with that one the same run goes on. */
TEST(jam_is_told_with_what_would_hold) {
    static const struct {
        const char *method, *scene, *there;
    } rows[] = {
        {"velocity-verlet",
         "{\"bodies\": [" THROWN
         "], \"colliders\": [{\"mesh\": {\"shape\": \"box\", \"scale\": "
         "[1, 0.06, 1]}, \"thickness\": 0.002}], " SOFT(),
         " at vertex "},
        {"implicit-linearised",
         "{\"bodies\": [" THROWN
         ", {\"cloth\": {\"grid\": [7, 7], \"size\": [0.12, 0.12], \"start\": \"flat\"}, "
         "\"mass\": {\"total\": 0.03}, \"springs\": {\"stretch\": 100, \"shear\": 30}, "
         "\"thickness\": 0.002}], \"pairs\": \"all\", " SOFT(),
         " at particle "},
        {"newmark",
         "{\"bodies\": [" THROWN
         "], \"colliders\": [{\"mesh\": {\"shape\": \"box\", \"scale\": "
         "[1, 0.06, 1]}, \"thickness\": 0.002}], " SOFT(),
         " at vertex "},
        {"dopri5",
         "{\"bodies\": [" THROWN
         "], \"colliders\": [{\"mesh\": {\"shape\": \"box\", \"scale\": "
         "[1, 0.06, 1]}, \"thickness\": 0.002}], " SOFT(),
         " at vertex "},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        char k[32] = "0.5";
        for (int again = 0; again < 2; again++) {
            struct fixture cloth;
            struct cs_error error = {0};
            fixture_open(&cloth, rows[r].method, rows[r].scene, k);
            fixture_start(&cloth);
            const struct cs_run *run = &cloth.session.run;
            for (int frame = 0; frame < 3 && run->outcome == CS_RUNNING; frame++)
                ck_assert_msg(!cs_run_frame(&cloth.session.run, &error), "%s", error.message);
            if (again) {
                ck_assert_msg(run->outcome == CS_RUNNING, "k %s: %s", k, run->reason);
            } else {
                double apart, holds, comes, factor, needed;
                ck_assert_int_eq(run->outcome, CS_GAVE_UP);
                const char *there = strstr(run->reason, "; there ");
                ck_assert_msg(there && strstr(there, rows[r].there), "%s", run->reason);
                const char *digits = strstr(there, " m apart");
                ck_assert(digits != NULL);
                while (digits > there && digits[-1] != ' ')
                    digits--;
                ck_assert_msg(
                    sscanf(
                        digits,
                        "%lf m apart: contact takes up %lf J there and %lf J come; %lf times "
                        "the stiffness would hold (contact.stiffness %lf N/m)",
                        &apart, &holds, &comes, &factor, &needed) == 5,
                    "%s", run->reason);
                // of a particle of 0.02 kg / 36, or of a contact point, which may be heavier
                ck_assert(apart >= 0 && apart < 0.001 && holds < comes);
                ck_assert_double_eq_tol(comes, 0.5 * 0.02 / 36 * 100, 0.3 * comes);
                ck_assert_double_eq_tol(factor, 50 * comes / holds, 0.02 * factor);
                ck_assert_double_eq_tol(needed, factor * 0.5, 0.02 * needed);
                snprintf(k, sizeof k, "%g", needed);
            }
            fixture_close(&cloth);
        }
    }
}
