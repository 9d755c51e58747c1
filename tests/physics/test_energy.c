/* Energy: what the dampers, drag and wind do is what the cloth loses or gains. */
#include "body_pair_fixture.h"
#include "fixture.h"

#include "model/contact/rebound.h"
#include "model/force/terms.h"
#include "sim/energy_ledger.h"

#include <math.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"particle\": 0.1},"             \
    " \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": %g,"             \
    " \"damping_model\": \"%s\"}, \"pins\": [\"top-left\", \"top-right\"]}],"                  \
    " \"forces\": {\"drag\": %g%s}, \"time\": {\"fps\": %d}}"
#define WIND                                                                                   \
    ", \"wind\": {\"direction\": [0, 0, 1], \"strength\": 0.3, \"strength_unit\": \"N\"}"

enum { N = 36 };

/* Power in W of the forces that have no potential. */
static double power(const struct fixture *cloth) {
    double f[3 * N], sum = 0;
    if (cloth->system->normals)
        cs_normals_update(cloth->system, cloth->x);
    cs_terms_force(cloth->system,
                   &(struct cs_eval){.x = cloth->x,
                                     .v = cloth->v,
                                     .parts = CS_PART_DAMPING | CS_PART_DRAG | CS_PART_WIND},
                   f);
    for (size_t i = 0; i < 3 * N; i++)
        sum += f[i] * cloth->v[i];
    return sum;
}

/* Steps of one frame for half a second: the change of energy less the work done, by the
 * trapezium rule over the steps; *work is the sum of its sizes. */
static double imbalance(const char *integrator, double damping, const char *model, double drag,
                        const char *wind, int fps, double *work) {
    struct fixture cloth;
    fixture_open(&cloth, integrator, SCENE, damping, model, drag, wind, fps);
    cs_perturb_smooth(cloth.system, 0.01, 0.5);
    fixture_start(&cloth);
    const double before = fixture_energy(&cloth);
    double done = 0, last = power(&cloth);
    *work = 0;
    for (int k = 0; k < fps / 2; k++) {
        fixture_frames(&cloth, 1);
        const double next = power(&cloth);
        done += (last + next) / 2 / fps;
        *work += fabs(last + next) / 2 / fps;
        last = next;
    }
    const double left = fixture_energy(&cloth) - before - done;
    fixture_close(&cloth);
    return left;
}

/* Second order: the balance closes four times better at half the step. */
TEST(balance_closes_with_the_step) {
    static const struct {
        double damping;
        const char *model;
        double drag;
        const char *wind;
    } rows[] = {{0.05, "axial", 0, ""},
                {0.05, "relative", 0, ""},
                {0, "axial", 0.1, ""},
                {0, "axial", 0, WIND},
                {0.05, "axial", 0.1, WIND}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double left[2], work;
        for (int k = 0; k < 2; k++)
            left[k] = fabs(imbalance("velocity-verlet", rows[i].damping, rows[i].model,
                                     rows[i].drag, rows[i].wind, 1000 << k, &work));
        ck_assert_msg(work > 0.01, "row %zu: only %.3g J of work", i, work);
        ck_assert_msg(left[1] < 1e-3 * work && left[1] < left[0] / 3.5,
                      "row %zu: %.3g J and, at half the step, %.3g J of %.3g J are missing", i,
                      left[0], left[1], work);
    }
}

/* Without damping the energy stays: symplectic methods keep it near, explicit Euler gains and
 * implicit Euler loses it. */
TEST(undamped_energy_goes_the_methods_way) {
    double work;
    const double verlet = imbalance("velocity-verlet", 0, "axial", 0, "", 500, &work);
    const double symplectic = imbalance("symplectic-euler", 0, "axial", 0, "", 500, &work);
    const double gained = imbalance("explicit-euler", 0, "axial", 0, "", 500, &work);
    const double lost = imbalance("implicit-linearised", 0, "axial", 0, "", 500, &work);
    ck_assert_double_lt(fabs(verlet), 1e-3);
    ck_assert_double_lt(fabs(symplectic), 0.05);
    ck_assert_double_gt(gained, 0.1);
    ck_assert_double_lt(lost, -0.1);
}

/* The largest rise of the energy that a method has made on a scene of the folder, over the most
 * energy in motion and springs that there was. HUGE_VAL: it blew up. */
static double made(const char *scene, const char *method, uint32_t frames) {
    const struct meeting of = {scene, method, {{NULL, NULL}}, frames};
    struct cs_session session;
    struct cs_energy_ledger ledger;
    struct cs_error error = {0};
    double lowest = 0, rise = 0, most = 0;
    meeting_open_system(&session, &of);
    session.settings.run.ledger = &ledger;
    ck_assert_int_eq(cs_energy_ledger_open(&ledger, &session.system, 0, &error), CS_OK);
    ck_assert_int_eq(cs_session_begin(&session, NULL, &error), CS_OK);
    for (uint32_t frame = 0; frame < frames && session.run.outcome == CS_RUNNING; frame++) {
        const double *at = ledger.energies;
        cs_run_frame(&session.run, &error);
        const double integrator = ledger.work[CS_WORK_INTEGRATOR];
        lowest = fmin(lowest, integrator);
        rise = fmax(rise, integrator - lowest);
        most = fmax(most, at[CS_HOLDING_KINETIC] + at[CS_HOLDING_STRETCH] +
                              at[CS_HOLDING_SHEAR] + at[CS_HOLDING_BEND]);
    }
    const bool ended = session.run.outcome == CS_RUNNING;
    cs_session_close(&session);
    cs_energy_ledger_close(&ledger);
    return ended ? rise / most : HUGE_VAL;
}

/* The lines of `clothsim integrators`: what damps makes no energy at its default step; xpbd
 * with chosen substeps makes a fifth of what there is at most; and the two with
 * CS_MAKES_ENERGY make half of all there is, or more, at one step per frame. */
TEST(methods_make_the_energy_that_they_claim) {
    static const struct {
        const char *scene;
        bool stiff; /* springs are stiff for a step of a frame */
    } scenes[] = {{"hang", true},           {"hang_by_one", false},
                  {"flag_wind", true},      {"drum", false},
                  {"push", false},          {"explosion", false},
                  {"grab_release", true},   {"swing", false},
                  {"free_fall", false},     {"extreme/long_step", false},
                  {"extreme/folded", false}};
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        const char *scene = scenes[k].scene;
        const double linearised = made(scene, "implicit-linearised", 20);
        ck_assert_msg(linearised <= 1e-3, "%s by implicit-linearised: %.3g", scene, linearised);
        const double chosen = made(scene, "xpbd:substeps=0,iterations=1", 20);
        ck_assert_msg(chosen <= 0.2, "%s by xpbd, chosen: %.3g", scene, chosen);
        if (!scenes[k].stiff)
            continue;
        ck_assert_double_gt(made(scene, "xpbd:dt=frame", 20), 0.5);
        ck_assert_double_gt(made(scene, "implicit-block:dt=frame", 20), 0.5);
    }
}

/* A sheet bounces on a floor in each step, so that its particles step alone, and another one is
 * blown along: the account has the work on the second, by the power at the ends of steps. */
TEST(work_counts_beside_impacts) {
    enum { STEPS = 20 };
    struct fixture sheets;
    struct cs_error error = {0};
    struct cs_energy_ledger ledger = {0};
    fixture_open(
        &sheets, "implicit-linearised:dt=frame",
        "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"size\": [0.3, 0.3], \"start\": "
        "\"flat\", \"place\": {\"translate\": [0, 0.012, 0]}}, \"mass\": {\"total\": 1}}, "
        "{\"cloth\": {\"grid\": [2, 2], \"place\": {\"translate\": [0, 9, 0]}}, \"mass\": "
        "{\"total\": 0.4}}], \"colliders\": [{\"floor\": {}, \"thickness\": 0.01}], "
        "\"contact\": {\"law\": \"force\", \"stiffness\": 100000, \"restitution\": 1}, "
        "\"forces\": {\"wind\": {\"direction\": [0, 0, 1], \"strength\": 2, "
        "\"strength_unit\": \"N\"}}}");
    cs_energy_ledger_open(&ledger, sheets.system, 0, &error);
    ck_assert_int_eq(error.status, CS_OK);
    sheets.session.settings.run.ledger = &ledger;
    fixture_start(&sheets);
    uint32_t impacts = 0;
    for (int frame = 0; frame < STEPS; frame++) {
        fixture_frames(&sheets, 1);
        impacts += sheets.system->rebounds->any;
    }
    ck_assert_uint_gt(impacts, STEPS / 4);
    // v grows evenly: the rule, by an end of each step, is off by at most one step's part
    const double work = ledger.work[CS_WORK_WIND];
    ck_assert_double_gt(work, 1);
    ck_assert_double_eq_tol(sheets.session.run.energy_input.given[CS_SOURCE_FORCES] / work, 1,
                            1.0 / STEPS);
    cs_energy_ledger_close(&ledger);
    fixture_close(&sheets);
}
