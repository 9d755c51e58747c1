/* The scenes in which bodies meet: nothing goes through anything in any frame, with methods of
 * all families, and what a scene is about converges with the step. Small ones by default; "all"
 * for the rest. */
#include "body_pair_fixture.h"
#include "fixture.h"

#include "model/force/diagnostics.h"
#include "model/force/terms.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- nothing goes through anything --- */

/* one of the small ones, or of the rest */
struct kept {
    struct meeting meeting;
    bool slow;
};

static const struct kept kept_apart[] = {
    {{"needles", "velocity-verlet", {MEETING_GRID(5, 5)}, 9}, false},
    {{"needles", "dopri5:rtol=1e-3", {MEETING_GRID(7, 7)}, 11}, false},
    {{"needles", "implicit-linearised:dt=0.008", {MEETING_GRID(7, 7)}, 16}, false},
    {{"needles", "newmark:dt=0.008", {MEETING_GRID(5, 5)}, 9}, false},
    {{"needles", "cvode-bdf:rtol=1e-3", {MEETING_GRID(7, 7)}, 11}, false},
    {{"needles", "xpbd:dt=0.004", {MEETING_GRID(7, 7)}, 11}, false},
    {{"bear_drape", NULL, {MEETING_GRID(9, 9)}, 15}, false},
    {{"walking_bear", NULL, {MEETING_GRID(9, 9)}, 30}, false},
    {{"walking_bear", "velocity-verlet", {MEETING_GRID(9, 9)}, 30}, false},
    {{"walking_bear", "newmark:dt=0.004", {MEETING_GRID(9, 9)}, 30}, false},
    {{"carried_bear", NULL, {MEETING_GRID(13, 13)}, 60}, false},
    {{"reef_knot", "implicit-linearised:dt=0.008", {{NULL, NULL}}, 12}, false},
    {{"needles", NULL, {{NULL, NULL}}, 125}, true},
    {{"needles", "velocity-verlet", {MEETING_GRID(13, 13)}, 90}, true},
    {{"needles", "bdf2:dt=0.004", {MEETING_GRID(13, 13)}, 90}, true},
    {{"bear_drape", NULL, {MEETING_GRID(25, 25)}, 60}, true},
    {{"bear_drape", "cvode-bdf:rtol=1e-3", {MEETING_GRID(13, 13)}, 40}, true},
    {{"walking_bear", NULL, {{NULL, NULL}}, 150}, true},
    {{"winding", NULL, {MEETING_GRID(21, 21)}, 200}, true},
    {{"bear_heap", NULL, {{NULL, NULL}}, 120}, true},
    {{"reef_knot", NULL, {{NULL, NULL}}, 105}, true},
    {{"ribbon", NULL, {MEETING_LIMIT}, 240}, true},
    {{"twister", NULL, {{NULL, NULL}}, 156}, true},
    {{"fold", NULL, {MEETING_LIMIT}, 60}, true},
    {{"trampoline", NULL, {MEETING_LIMIT}, 60}, true},
    {{"layers", NULL, {MEETING_LIMIT}, 60}, true},
};

static void check_apart(const struct meeting *of) {
    struct cs_session session;
    meeting_open(&session, of);
    for (uint32_t frame = 0; frame < of->frames; frame++) {
        meeting_frame(&session, of);
        const uint64_t n = meeting_crossings(&session);
        ck_assert_msg(!n, "%s by %s, frame %u: %llu crossings", of->scene, of->method,
                      frame + 1, (unsigned long long)n);
    }
    cs_session_close(&session);
}

TEST(nothing_goes_through) {
    for (size_t k = 0; k < LENGTH(kept_apart); k++)
        if (suite_all == kept_apart[k].slow)
            check_apart(&kept_apart[k].meeting);
}

/* --- what scenes are about --- */

/* A sheet that is pulled off needles is not torn by them: found is a strain of 0.2. */
TEST(needles_do_not_tear) {
    const struct meeting of = {"needles", NULL, {MEETING_GRID(13, 13)}, suite_all ? 125 : 1};
    struct cs_session session;
    meeting_open(&session, &of);
    for (uint32_t frame = 0; frame < of.frames; frame++) {
        meeting_frame(&session, &of);
        const double strain = cs_diagnostics_strain(&session.system, session.run.x);
        ck_assert_msg(strain < 0.4, "frame %u: %.3g", frame + 1, strain);
    }
    cs_session_close(&session);
}

enum { RIBBON = 363, HELD = 6, FRAMES_OF_MEAN = 6 };

/* N, of the held ends of a ribbon along the pull */
static double pull_of(const struct cs_session *session, uint32_t ribbon) {
    static const uint32_t held[HELD] = {0, 1, 2, 360, 361, 362};
    const struct cs_run *run = &session->run;
    const size_t n = session->system.view.n;
    // held ones have no force otherwise
    struct cs_system loose = session->system;
    double *f = calloc(3 * n, sizeof *f), sum = 0;
    loose.n_pinned = 0;
    ck_assert_ptr_nonnull(f);
    cs_terms_force(
        &loose, &(struct cs_eval){.t = run->t, .x = run->x, .v = run->v, .parts = CS_PART_ALL},
        f);
    for (size_t k = 0; k < HELD; k++)
        sum += f[RIBBON * ribbon + held[k]];
    free(f);
    return sum;
}

/* N, mean of both ribbons over the last tenth of a second; *odds: how much more the first
 * pulls, which is what accelerates the knot */
static double tie(const char *method, uint32_t frames, double *odds) {
    const struct meeting of = {"reef_knot", method, {{NULL, NULL}}, frames};
    struct cs_session session;
    double pull[2] = {0};
    meeting_open(&session, &of);
    for (uint32_t frame = 0; frame < frames; frame++) {
        meeting_frame(&session, &of);
        for (uint32_t k = 0; k < 2 && frame + FRAMES_OF_MEAN >= frames; k++)
            pull[k] += pull_of(&session, k) / FRAMES_OF_MEAN;
    }
    cs_session_close(&session);
    *odds = pull[0] + pull[1];
    return (pull[0] - pull[1]) / 2;
}

/* A knot that was pulled tight for 1.5 s and is held pulls back with 0.19 N, thirty times what
 * it took to draw the loose one together, whatever the step and by Newton's iteration too. The
 * small case is at the start, where ribbons are drawn along. */
TEST(knot_is_tight) {
    static const char *const quick[] = {"implicit-linearised:dt=0.004",
                                        "implicit-linearised:dt=0.002"};
    static const char *const slow[] = {
        "implicit-linearised:dt=0.001", "implicit-linearised:dt=0.002",
        "implicit-linearised:dt=0.004", "backward-euler:dt=0.004,iterations=100"};
    double odds;
    const uint32_t frames = suite_all ? 105 : 8;
    const double first = tie(suite_all ? slow[0] : quick[0], frames, &odds);
    ck_assert_msg(first > (suite_all ? 0.1 : 0.001), "%.4g N", first);
    for (int k = 1; k < (suite_all ? 4 : 2); k++) {
        const double pull = tie(suite_all ? slow[k] : quick[k], frames, &odds);
        ck_assert_msg(fabs(pull - first) < (suite_all ? 0.02 : 0.05) * first, "%.4g, %.4g N",
                      first, pull);
        ck_assert_msg(fabs(odds) < 1e-3 * pull, "%.4g of %.4g N", odds, pull);
    }
}

/* kg m/s along each axis, of the particles [begin, end) */
static void momentum_of(const struct cs_session *session, uint32_t begin, uint32_t end,
                        double p[3]) {
    const struct cs_system *system = &session->system;
    for (size_t c = 0; c < 3; c++) {
        p[c] = 0;
        for (size_t i = begin; i < end; i++)
            p[c] += system->mass[i] * session->run.v[c * system->view.n + i];
    }
}

/* A bear of springs that is thrown at a loose sheet, at 2 and 10 m/s: the sheet takes up what
 * the bear loses, and nothing crosses. */
TEST(sheet_takes_up_what_a_body_loses) {
    static const char *const velocities[] = {"[0.3,-2,0]", "[0.5,-10,0]"};
    static const char *const all[] = {"implicit-linearised:rtol=1e-10", "velocity-verlet",
                                      "newmark:rtol=1e-10"};
    for (size_t k = 0; k < LENGTH(all) * LENGTH(velocities); k++) {
        const struct meeting of = {"carried_bear",
                                   all[k / 2],
                                   {MEETING_GRID(13, 13),
                                    {"events", "[]"},
                                    {"bodies[0].pins", "[]"},
                                    {"forces.gravity", "[0,0,0]"},
                                    {"bodies[1].mesh.velocity", velocities[k % 2]},
                                    {"bodies[1].mesh.place.translate", "[0.05,0.3,0]"}},
                                   15};
        double start[3], bear[3], sheet[3];
        struct cs_session session;
        if (!suite_takes(k, 3)) // both velocities, of two methods
            continue;
        meeting_open(&session, &of);
        const uint32_t first = session.system.bodies[1].first, n = session.system.view.n;
        momentum_of(&session, 0, n, start);
        for (uint32_t frame = 0; frame < of.frames; frame++) {
            meeting_frame(&session, &of);
            ck_assert_uint_eq(meeting_crossings(&session), 0);
        }
        momentum_of(&session, first, n, bear);
        momentum_of(&session, 0, first, sheet);
        ck_assert_msg(sheet[1] < 0.2 * start[1], "%s: %.3g of %.3g kg m/s", of.method, sheet[1],
                      start[1]);
        for (int c = 0; c < 3; c++)
            ck_assert_msg(fabs(bear[c] + sheet[c] - start[c]) < 1e-6 * fabs(start[1]),
                          "%s: %.9g, not %.9g kg m/s", of.method, bear[c] + sheet[c], start[c]);
        cs_session_close(&session);
    }
}

/* rad, by which the middle of the sheet has been turned about y */
static double turn_of(const struct cs_session *session) {
    const struct cs_body_range *sheet = session->system.bodies;
    const size_t n = session->system.view.n, columns = sheet->columns;
    const size_t middle = columns * (sheet->rows / 2) + columns / 2;
    const double *x = session->run.x;
    return atan2(x[2 * n + middle - 1] - x[2 * n + middle + 1], x[middle + 1] - x[middle - 1]);
}

/* rad, over all frames */
static double wind_up(const struct meeting *of) {
    struct cs_session session;
    double turned = 0, before = 0;
    meeting_open(&session, of);
    for (uint32_t frame = 0; frame < of->frames; frame++) {
        meeting_frame(&session, of);
        const double now = turn_of(&session);
        turned += remainder(now - before, 2 * acos(-1));
        before = now;
    }
    cs_session_close(&session);
    return turned;
}

/* The ball takes the sheet along, by an angle that the step does not decide: in three seconds
 * by more than a whole turn. The small case begins to. */
TEST(ball_winds_up_the_sheet) {
    static const char *const methods[] = {"implicit-linearised:dt=0.004",
                                          "implicit-linearised:dt=0.002",
                                          "implicit-linearised:dt=0.001"};
    const int n = suite_all ? 3 : 2;
    double turn[3];
    for (int k = 0; k < n; k++) {
        const struct meeting whole = {"winding", methods[k], {MEETING_GRID(7, 7)}, 240};
        const struct meeting part = {
            "winding", methods[k], {MEETING_GRID(7, 7), {"events[0].from", "0.2"}}, 18};
        turn[k] = wind_up(suite_all ? &whole : &part);
    }
    ck_assert_msg(turn[0] > (suite_all ? 6.3 : 0.02), "turned by %.3g", turn[0]);
    for (int k = 1; k < n; k++)
        ck_assert_msg(fabs(turn[k] - turn[k - 1]) < (suite_all ? 0.02 : 0.08) * turn[k],
                      "%.5g, %.5g", turn[k - 1], turn[k]);
}

/* --- a funnel --- */

/* The tetrahedron pushes all three sheets through, none through another. The small case begins
 * to. */
TEST(sheets_go_through_the_funnel) {
    const struct meeting of = {"funnel", NULL, {{NULL, NULL}}, suite_all ? 180 : 1};
    struct cs_session session;
    double highest = -HUGE_VAL;
    meeting_open(&session, &of);
    for (uint32_t frame = 0; frame < of.frames; frame++) {
        meeting_frame(&session, &of);
        ck_assert_uint_eq(meeting_crossings(&session), 0);
    }
    const size_t n = session.system.view.n;
    for (size_t i = 0; i < n; i++)
        highest = fmax(highest, session.run.x[n + i]);
    // its end is at -0.3 m
    ck_assert_msg(!suite_all || highest < -0.3, "%g m", highest);
    cs_session_close(&session);
}

/* --- curtain and ball --- */

/* A ball of triangles that goes into a curtain, and stays where the curtain hangs down over it
 * (after Bridson et al. 2002); columns and rows, friction. */
#define CURTAIN                                                                                \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%u, %u], \"size\": [0.8, 0.8], \"place\": "         \
    "{\"translate\": [0, 0, 0]}}, \"mass\": {\"areal_density\": 0.25}, \"springs\": "          \
    "{\"stretch\": 150, \"shear\": 50, \"bend\": 1, \"damping\": 0.02}, \"pins\": [\"top\"], " \
    "\"thickness\": 0.02}], \"colliders\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": "   \
    "4, "                                                                                      \
    "\"scale\": [0.4, 0.4, 0.4], \"place\": {\"translate\": [0.03, -0.1, -0.3]}}, "            \
    "\"friction\": %g, \"thickness\": 0.02}], \"contact\": {\"law\": \"force\", "              \
    "\"damping\": 0.001, \"friction_speed\": 0.05}, \"events\": [{\"from\": 0, \"to\": 0.8, "  \
    "\"move\": {\"collider\": 0, \"path\": [{\"at\": 0.8, \"point\": [0, 0, 0.6]}]}}], "       \
    "\"crossings\": \"limit\"}"

/* z in m of the ball's centre in the end */
#define BALL_END 0.3

/* Runs it, and gives the mean of the curtain's particles along the ball's way, in m, and which
 * share of them is in front of where the ball ends. */
static double provenance(const char *method, uint32_t grid, double mu, uint32_t frames,
                         double *front) {
    struct fixture cloth;
    double mean = 0;
    *front = 0;
    fixture_open(&cloth, method, CURTAIN, grid, grid, mu);
    fixture_start(&cloth);
    for (uint32_t frame = 0; frame < frames; frame++) {
        fixture_frames(&cloth, 1);
        ck_assert_uint_eq(meeting_crossings(&cloth.session), 0);
    }
    for (size_t i = 0; i < cloth.n; i++) {
        mean += cloth.x[2 * cloth.n + i] / (double)cloth.n;
        *front += (cloth.x[2 * cloth.n + i] > BALL_END) / (double)cloth.n;
    }
    fixture_close(&cloth);
    return mean;
}

/* After two seconds 0.4 of the curtain is in front of the ball, at any step where friction
 * holds it there; without friction it slips by and by. */
TEST(ball_goes_into_the_curtain) {
    static const char *const steps[] = {"implicit-linearised:dt=0.004",
                                        "implicit-linearised:dt=0.002",
                                        "implicit-linearised:dt=0.001"};
    const uint32_t grid = suite_all ? 17 : 7, frames = suite_all ? 120 : 24;
    for (int rub = suite_all ? 0 : 1; rub < 2; rub++) {
        const double mu = rub ? 0.6 : 0, most = !suite_all ? 0.01 : rub ? 0.002 : 0.03;
        double share[2];
        const double coarse = provenance(steps[suite_all], grid, mu, frames, share);
        const double fine = provenance(steps[1 + suite_all], grid, mu, frames, share + 1);
        ck_assert_msg(fabs(coarse - fine) < most, "rub %d: %.4g, %.4g m", rub, coarse, fine);
        ck_assert_msg(fabs(share[0] - share[1]) < 2 * most, "rub %d: %.4g, %.4g in front", rub,
                      share[0], share[1]);
        ck_assert_msg(!suite_all || fabs(share[1] - 0.4) < 0.1, "rub %d: %.4g in front", rub,
                      share[1]);
    }
}
