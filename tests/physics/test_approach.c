/* The energy with which bodies approach, the stiffness of contact that follows from it, and
 * what is told where it is too small. */
#include "fixture.h"
#include "model/contact/approach.h"
#include "model/contact/barrier_law.h"
#include "session/session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define G 9.81

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
