/* The account of energy closes: each term against a closed form or against the motion, and on a
 * tight reference nothing is left to the method. */
#include "fixture.h"

#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "sim/energy_ledger.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TIGHT "dopri5:rtol=1e-12,atol=1e-13"

struct kept {
    struct fixture fixture;
    struct cs_energy_ledger account;
    double start, moving; /* J: all at the start, most in motion */
};

static void run_kept(struct kept *kept, const char *method, const char *scene,
                     uint32_t frames) {
    struct cs_error error = {0};
    fixture_open(&kept->fixture, method, "%s", scene);
    struct cs_session *session = &kept->fixture.session;
    session->settings.run.ledger = &kept->account;
    cs_energy_ledger_open(&kept->account, &session->system, 0, &error);
    ck_assert(!error.status);
    fixture_start(&kept->fixture);
    kept->start = cs_energy_ledger_sum(&kept->account);
    kept->moving = 0;
    for (uint32_t k = 0; k < frames; k++) {
        fixture_frames(&kept->fixture, 1);
        kept->moving = fmax(kept->moving, kept->account.energies[CS_HOLDING_KINETIC]);
    }
}

static void close_kept(struct kept *kept) {
    cs_energy_ledger_close(&kept->account);
    fixture_close(&kept->fixture);
}

#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"size\": [0.5, 0.5], \"bump\": 0.02},"      \
    " \"mass\": {\"particle\": 0.05}, \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\":" \
    " 5, \"damping\": 0.05}, \"pins\": [%s]}], \"time\": {\"fps\": 60}, %s}"

/* what acts, and the entry that must have it */
static const struct {
    const char *pins, *scene;
    enum cs_ledger_work work;
    double closure; /* of the energy in motion that may be left to the method */
} terms[] = {
    {"\"top-left\"", "\"forces\": {}", CS_WORK_DAMPERS, 1e-10},
    {"\"top-left\"", "\"forces\": {\"drag\": 0.02}", CS_WORK_DRAG, 1e-10},
    {"\"top-left\"", "\"forces\": {\"wind\": {\"direction\": [0.2, 0, 1], \"strength\": 2}}",
     CS_WORK_WIND, 1e-10},
    {"",
     "\"events\": [{\"from\": 0.01, \"to\": 0.2, \"impact\": {\"direction\": [1, 0, 1],"
     " \"impulse\": 0.3}}]",
     CS_WORK_PUSH, 1e-10},
    {"\"top-left\"",
     "\"events\": [{\"from\": 0.02, \"to\": 0.2, \"ramp\": {\"key\":"
     " \"bodies[0].springs.stretch\", \"value\": 90}}]",
     CS_WORK_VALUES, 1e-10},
    {"",
     "\"events\": [{\"at\": 0.01, \"grab\": {\"particles\": [0], \"relative\": true,"
     " \"path\": [{\"at\": 0.25, \"point\": [0.1, 0.2, 0.3]}]}}]",
     CS_WORK_PINS, 1e-10},
    {"",
     "\"colliders\": [{\"floor\": {\"height\": -0.3}}], \"contact\": {\"law\": \"force\","
     " \"stiffness\": 400, \"damping\": 0.1}, \"forces\": {\"wind\": {\"direction\":"
     " [1, 0, 0], \"strength\": 1}}",
     CS_WORK_FRICTION, 1e-7},
};

TEST(nothing_is_left_to_a_tight_method) {
    for (size_t k = 0; k < LENGTH(terms); k++) {
        struct kept kept;
        char scene[2048];
        snprintf(scene, sizeof scene, SHEET, terms[k].pins, terms[k].scene);
        run_kept(&kept, TIGHT, scene, 15);
        const double *work = kept.account.work, left = work[CS_WORK_INTEGRATOR];
        ck_assert_msg(fabs(left) <= terms[k].closure * kept.moving,
                      "case %zu: %.3g J of %.3g J are left to the method", k, left,
                      kept.moving);
        ck_assert_msg(fabs(work[terms[k].work]) > 1e-3 * kept.moving,
                      "case %zu: the work is %.3g J", k, work[terms[k].work]);
        close_kept(&kept);
    }
}

/* About the origin, of the state that was stored last. */
static void angular_momentum(const struct cs_energy_ledger *ledger, double sum[3]) {
    const struct cs_system *system = ledger->system;
    memset(sum, 0, 3 * sizeof *sum);
    cs_diagnostics_add_moment(system, system->mass, 1, ledger->state,
                              ledger->state + 3 * (size_t)system->view.n, sum);
}

/* Two sheets without outer forces that meet and rub: what their angular momentum gains is the
 * couple of friction, which acts on surfaces a distance apart. Without friction it stays. */
TEST(friction_between_surfaces_turns_them) {
    for (int k = 0; k < 2; k++) {
        struct kept kept;
        char scene[1024];
        snprintf(
            scene, sizeof scene,
            "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"size\": [0.4, 0.4], "
            "\"start\": \"flat\"}, \"mass\": {\"areal_density\": 0.5}, \"thickness\": 0.02}, "
            "{\"cloth\": {\"grid\": [3, 3], \"size\": [0.2, 0.2], \"start\": \"flat\", "
            "\"velocity\": [0.5, -0.5, 0], \"place\": {\"translate\": [-0.03, 0.05, 0.01]}}, "
            "\"mass\": {\"areal_density\": 0.5}, \"thickness\": 0.02}], \"forces\": "
            "{\"gravity\": [0, 0, 0]}, \"pairs\": {\"among\": \"all\", \"friction\": %g}, "
            "\"contact\": {\"law\": \"force\", \"friction_speed\": 0.05}, \"time\": "
            "{\"fps\": 60}}",
            k ? 0.5 : 0);
        double start[3], end[3], change = 0, rest = 0, size = 0;
        run_kept(&kept, TIGHT, scene, 0);
        angular_momentum(&kept.account, start);
        close_kept(&kept);
        run_kept(&kept, TIGHT, scene, 15);
        angular_momentum(&kept.account, end);
        for (int c = 0; c < 3; c++) {
            change = hypot(change, end[c] - start[c]);
            rest = hypot(rest, end[c] - start[c] - kept.account.couple[c]);
            size = hypot(size, start[c]);
        }
        ck_assert_msg(k ? change > 0.01 * size : change < 1e-9 * size,
                      "friction %d: %.3g of %.3g kg m2/s", k, change, size);
        ck_assert_msg(rest <= 1e-5 * (k ? change : size), "%.3g of %.3g kg m2/s are left", rest,
                      change);
        close_kept(&kept);
    }
}

/* Free fall with drag c from rest: v = g m/c (1 - e), x = g m/c (t - m/c (1 - e)), e = exp(-c
 * t/m); drag has taken m g x - m v^2/2. */
TEST(drag_takes_what_a_fall_lacks) {
    struct kept kept;
    const double m = 0.05, c = 0.1, g = 9.81, t = 0.25, e = exp(-c * t / m);
    const double v = g * m / c * (1 - e), x = g * m / c * (t - m / c * (1 - e));
    run_kept(&kept, TIGHT,
             "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2]}, \"mass\": {\"particle\": 0.05}}],"
             " \"forces\": {\"drag\": 0.1, \"gravity\": [0, -9.81, 0]}, \"time\": {\"fps\":"
             " 60}}",
             15);
    ck_assert_double_eq_tol(kept.account.work[CS_WORK_DRAG], 4 * (m * v * v / 2 - m * g * x),
                            1e-9);
    ck_assert_double_eq_tol(kept.account.energies[CS_HOLDING_KINETIC], 4 * m * v * v / 2, 1e-9);
    close_kept(&kept);
}

/* A floor that absorbs all takes what a fall from h has gained, a velocity loss its share of
 * each step; a strain limit lifts what it pulls in and stops its lengthening, which nearly
 * cancel: put down apart, and together they are the balance. */
TEST(corrections_are_put_down_apart) {
    struct kept kept;
    run_kept(
        &kept, "symplectic-euler:dt=0.00025",
        "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"size\": [0.5, 0.5]}, \"mass\":"
        " {\"particle\": 0.05}, \"springs\": {\"stretch\": 20, \"damping\": 0.05},"
        " \"strain_limit\": 1.05, \"pins\": [\"top-left\"]}, {\"cloth\": {\"grid\": [3, 3],"
        " \"size\": [0.1, 0.1], \"place\": {\"translate\": [2, 0, 0]}}, \"mass\":"
        " {\"particle\": 0.01}, \"springs\": {\"stretch\": 1}}], \"contact\": \"project\", "
        "\"colliders\":"
        " [{\"floor\": {\"height\": -0.7}}], \"forces\": {\"velocity_loss\": 0.0001},"
        " \"time\": {\"fps\": 60}}",
        30);
    const double *work = kept.account.work;
    double sum = kept.start;
    for (int k = 0; k < CS_WORKS; k++)
        sum += work[k];
    ck_assert_double_eq_tol(sum, cs_energy_ledger_sum(&kept.account),
                            1e-12 * (1 + kept.moving));
    ck_assert_double_gt(fabs(work[CS_WORK_LIMIT]), 0);
    ck_assert_msg(work[CS_WORK_LIMIT] < 0.01 * kept.moving, "%g J", work[CS_WORK_LIMIT]);
    ck_assert(work[CS_WORK_LOSS] < 0 && work[CS_WORK_ABSORPTION] < 0);
    ck_assert_msg(fabs(work[CS_WORK_INTEGRATOR]) < 0.05 * kept.moving, "%g of %g J",
                  work[CS_WORK_INTEGRATOR], kept.moving);
    ck_assert_double_eq(work[CS_WORK_EVENTS], 0);
    close_kept(&kept);
}

/* Of methods that lose energy it says how much, and an order more precisely each halving */
TEST(the_rest_is_the_methods_error) {
    double left[2];
    char scene[2048];
    snprintf(scene, sizeof scene, SHEET, "\"top-left\"", "\"forces\": {}");
    for (int k = 0; k < 2; k++) {
        struct kept kept;
        run_kept(&kept, k ? "backward-euler:dt=0.001" : "backward-euler:dt=0.002", scene, 12);
        left[k] = kept.account.work[CS_WORK_INTEGRATOR];
        close_kept(&kept);
    }
    ck_assert_msg(left[0] < 0 && fabs(left[0] / left[1] - 2) < 0.2, "%g and %g J", left[0],
                  left[1]);
}

/* A sheet on a sphere by projection: each step pushes particles out into springs that an
 * implicit step of a frame does not resolve, with up to 17 J. Along a path that followed their
 * accelerations the dampers took a hundred times the energy there is, and the method made as
 * much. */
TEST(dampers_take_no_more_than_there_is) {
    static const char *const methods[] = {"implicit-linearised", "backward-euler", "tr-bdf2"};
    static const char scene[] =
        "{\"bodies\": [{\"cloth\": {\"grid\": [16, 16], \"size\": [1, 1], \"start\": \"flat\","
        " \"place\": {\"translate\": [0, 0.62, 0]}}, \"mass\": {\"total\": 0.3}, \"springs\":"
        " {\"stretch\": 2000, \"shear\": 700, \"bend\": 200, \"damping\": 0.05}}],"
        " \"colliders\": [{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 0.5}, \"friction\": "
        "0.5}],"
        " \"contact\": {\"law\": \"project\"}, \"time\": {\"fps\": 60}}";
    for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
        struct kept kept;
        run_kept(&kept, methods[k], scene, 40);
        const double *work = kept.account.work;
        printf("%s: %g J by dampers, %g J by the method, %g J by projection\n", methods[k],
               work[CS_WORK_DAMPERS], work[CS_WORK_INTEGRATOR], work[CS_WORK_PROJECTION]);
        ck_assert_double_le(work[CS_WORK_INTEGRATOR], 0);
        ck_assert_double_lt(-work[CS_WORK_DAMPERS],
                            0.3 * 9.81 * 0.62 + work[CS_WORK_PROJECTION]);
        close_kept(&kept);
    }
}

/* how often a name stands in a part of the head, which begins and ends with a comma */
static uint32_t times_in(const char *part, const char *end, const char *name) {
    char field[80];
    uint32_t n = 0;
    snprintf(field, sizeof field, ",%s,", name);
    for (; (part = strstr(part, field)) && part < end; part++)
        n++;
    return n;
}

/* the list of forces: what has an energy is among what is held, what does work without one
 * behind the sum, and no column is there twice */
TEST(every_force_has_its_column) {
    struct cs_text head = {0};
    cs_energy_ledger_print_head(&head);
    head.bytes[head.length - 1] = ',';
    const char *all = cs_text_get(&head), *end = all + head.length;
    const char *sum = strstr(all, ",sum,");
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        const struct cs_term *term = cs_terms[k];
        const char *held = term->energy_column, *work = term->work_column;
        char own[80];
        snprintf(own, sizeof own, "%s%s", term->name, term->energy ? "_work" : "");
        ck_assert(term->part_bits & CS_PART_SPRINGS || !term->energy ||
                  times_in(all, sum, held ? held : term->name) == 1);
        ck_assert(!(term->part_bits & CS_PART_WITHOUT_ENERGY) ||
                  times_in(sum, end, work ? work : own) == 1);
    }
    ck_assert_uint_eq(times_in(all, sum, "stretch"), 1);
    ck_assert_uint_eq(times_in(all, sum, "gravity"), 1);
    ck_assert_uint_eq(times_in(sum, end, "dampers"), 1);
    cs_text_finish(&head);
}
