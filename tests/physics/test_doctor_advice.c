/* Prescribed motions that go wrong are found before the first step, and the figures that
 * messages advise do. */
#include "doctor.h"

#include <stdlib.h>
#include <string.h>

#define JUMP                                                                                   \
    "{\"from\": 0.2, \"to\": 0.8, \"grab\": {\"particles\": [\"bottom-left\"], \"path\": [{"   \
    "\"at\": 0.22, \"point\": [0, 0.01, 0]}]}}"
#define GOES "events[0]: colliders[0] goes at "
/* the upper edge carried by a collider, and a second one */
#define CARRIED(one, other, events)                                                            \
    BODY("", ", \"pins\": [{\"box\": {\"min\": [-1, 0.2, -1], \"max\": [1, 1, 1]}, \"to\": "   \
             "{\"collider\": 0}}]")                                                            \
    ", \"colliders\": [{" one "}, {" other "}], \"contact\": \"force\", \"events\": [" events  \
    "]"
#define HIP    "\"sphere\": {\"centre\": [0, 0.6, 0], \"radius\": 0.1}"
#define PEG    "\"sphere\": {\"centre\": [0, 0.25, 0.2], \"radius\": 0.05}"
#define GROUND "\"floor\": {\"height\": -1}"
#define TURN   "{\"from\": 0, \"to\": 3, \"move\": {\"collider\": 0, \"spin\": [0, 1, 0]}}"
#define LEG                                                                                    \
    "{\"from\": 0, \"to\": 2, \"move\": {\"collider\": 1, " SHIFTS                             \
    "[{\"at\": 2, \"point\": [0, 0, -1.2]}]}}"
#define DOWN                                                                                   \
    "{\"from\": 0, \"to\": 2, \"move\": {\"collider\": 0, " SHIFTS                             \
    "[{\"at\": 2, \"point\": [0, -1.6, 0]}]}}"
#define SEWN                                                                                   \
    BODY("", "")                                                                               \
    ", \"colliders\": [{" HIP "}, {" GROUND "}], \"contact\": \"project\", "                   \
    "\"seams\": [{\"body\": 0, \"particles\": [\"top\"], \"to\": {\"collider\": 0}, "          \
    "\"closing_time\": 0.2}], \"events\": ["
#define FIVE JUMP ", " JUMP ", " JUMP ", " JUMP ", " JUMP
#define TEN  FIVE ", " FIVE

/* Prescribed motions that go wrong: the same columns. */
static const struct trap trajectories[] = {
    // pins
    {BODY("", ", \"pins\": [{\"box\": {\"min\": [5, 5, 5], \"max\": [6, 6, 6]}}]"),
     "bodies[0].pins[0] holds no particle", "bodies[0].pins", "[\"top\"]", true},
    {BODY("", ", \"pins\": [\"top\", {\"box\": {\"min\": [1, 1, 1], \"max\": [2, 2, 2]}}]"),
     "bodies[0].pins[1] holds no particle", "bodies[0].pins", "[\"top\"]", true},
    // seams over gaps
    {"\"bodies\": [" SHEET("") ", " SHEET(
         ", \"place\": {\"translate\": [0, -3, 0]}") "], \"seams\": [{\"body\": 0, "
                                                     "\"particles\": [\"top\"], \"to\": "
                                                     "{\"body\": 1, "
                                                     "\"particles\": [\"top\"]}}]",
     "a seam between bodies[0] and bodies[1] is ", "seams[0].length", "3", true},
    // colliders that are led through what pins hold: a ball, a bar, a box, a floor, on a
    // second leg, by positions, smoothly
    {MOVE(TOP, BALL, "\"from\": 0, \"to\": 2", SHIFTS "[{\"at\": 2, \"point\": [0, 0, -1.2]}]"),
     GOES, "events[0].move.path[0].point", "[0, 0, -0.4]", true},
    {MOVE(TOP, BAR, "\"from\": 0, \"to\": 2", SHIFTS "[{\"at\": 2, \"point\": [0, 0, -0.8]}]"),
     GOES, "events[0].move.path[0].point", "[0, 0, -0.3]", true},
    {MOVE(TOP, "\"box\": {\"centre\": [0, 0.25, 0.6], \"size\": [0.4, 0.2, 0.2]}",
          "\"from\": 0, \"to\": 2", SHIFTS "[{\"at\": 2, \"point\": [0, 0, -1.2]}]"),
     GOES, "events[0].move.path[0].point", "[0, 1, -1.2]", true},
    {MOVE(TOP, "\"floor\": {\"height\": -1}", "\"from\": 0, \"to\": 2",
          SHIFTS "[{\"at\": 2, \"point\": [0, 1.5, 0]}]"),
     GOES, "events[0].move.path[0].point", "[0, 0.2, 0]", true},
    {MOVE(TOP, BALL, "\"from\": 0, \"to\": 4",
          SHIFTS "[{\"at\": 2, \"point\": [2, 0, 0]}, {\"at\": 4, \"point\": [-2, 0, -1.2]}]"),
     GOES, "events[0].move.path[1].point", "[2, 0, -1.2]", true},
    {MOVE(TOP, BALL, "\"from\": 0, \"to\": 2",
          "\"relative\": false, \"path\": [{\"at\": 2, \"point\": [0, 0.25, -0.6]}]"),
     GOES, "events[0].move.path[0].point", "[0, 0.25, 0.2]", true},
    {MOVE(TOP, BALL, "\"from\": 0, \"to\": 2",
          "\"motion\": \"smooth\", " SHIFTS "[{\"at\": 2, \"point\": [0, 0, -1.2]}]"),
     GOES, "events[0].move.path[0].point", "[0, 0.5, -0.2]", true},
    // what another collider carries: a leg through a skirt's waist, one that turns into a peg,
    // one that is led into the ground; what a seam holds, and a grab
    {CARRIED(HIP, BALL, TURN ", " LEG), "events[1]: colliders[1] goes at ",
     "events[1].move.path[0].point", "[0, 0, -0.2]", true},
    {CARRIED(HIP, PEG, TURN), "of bodies[0], which colliders[0] holds", "events[0].to", "0.5",
     true},
    {CARRIED(HIP, GROUND, DOWN), "events[0]: colliders[1] goes at ",
     "events[0].move.path[0].point", "[0, -1, 0]", true},
    {SEWN DOWN "]", "events[0]: colliders[1] goes at ", "events[0].move.path[0].point",
     "[0, -1, 0]", true},
    {BODY("", TOP) ", \"colliders\": [{" GROUND "}], \"contact\": \"force\", \"events\": "
                   "[{\"at\": 0, \"grab\": {\"particles\": [\"top\"], " SHIFTS
                   "[{\"at\": 2, \"point\": [0, -1.4, 0]}]}}]",
     "which events[0] holds", "events[0].grab.path[0].point", "[0, -0.2, 0]", true},
    // colliders that jump
    {MOVE(TOP, BALL, "\"from\": 0, \"to\": 1",
          "\"relative\": true, \"path\": [{\"at\": 0.01, \"point\": [4, 0, 0]}]"),
     "events[0].move.path[0] is reached at ", "events[0].move.path[0].at", "0.5", false},
    {MOVE(TOP, BALL, "\"from\": 0, \"to\": 1", SHIFTS "[{\"at\": 0.01, \"point\": [0, 7, 0]}]"),
     "events[0].move.path[0] is reached at ", "events[0].move.path[0].at", "1", false},
    // grabs that jump, for good or for a while
    {GRAB(TOP, "\"at\": 0",
          "\"particles\": [\"bottom-left\"], \"path\": [{\"at\": 0.05, \"point\": [0, 0.1, "
          "0]}]"),
     "events[0].grab.path[0] is 0.43 m from where its particle starts",
     "events[0].grab.relative", "true", false},
    {GRAB(TOP, "\"from\": 0.2, \"to\": 0.8",
          "\"particles\": [\"bottom\"], \"path\": [{\"at\": 0.21, \"point\": [0, 0, 0]}]"),
     "from where its particle starts", "events[0].grab.relative", "true", false},
    {GRAB(TOP, "\"from\": 0.2, \"to\": 0.8",
          "\"particles\": [\"bottom\"], " SHIFTS "[{\"at\": 0.201, \"point\": [0, 0, 0.2]}]"),
     "events[0].grab.path[0] is reached at ", "events[0].grab.path[0].at", "0.6", false},
    // grabs that take what pins hold, and let it fall
    {GRAB(TOP, "\"from\": 0, \"to\": 0.5",
          "\"particles\": [\"top-left\"], " SHIFTS "[{\"at\": 0.5, \"point\": [0, 0, 0.1]}]"),
     "events[0].grab takes particles that pins hold", "events[0].grab.particles",
     "[\"bottom-left\"]", false},
    {SEWN "{\"from\": 0.5, \"to\": 1, \"pin\": {\"particles\": [\"top\"]}}]",
     "events[0].pin takes particles that seams[0] sews to a collider: it undoes the seam",
     "events[0].pin.particles", "[\"bottom\"]", false},
    {BODY("", TOP) ", \"events\": [{\"from\": 0, \"to\": 1, \"pin\": {}}]",
     "events[0].pin takes particles that pins hold", "events[0].pin.particles", "[\"bottom\"]",
     false},
    // one stitch twice
    {"\"bodies\": [" SHEET("") ", " SHEET(
         ", \"place\": {\"translate\": [0, 0, 0.5]}") "], \"seams\": [{\"body\": 0, "
                                                      "\"particles\": [\"bottom\"], \"to\": "
                                                      "{\"body\": 1, \"particles\": "
                                                      "[\"top\"]}}, {\"body\": 1, "
                                                      "\"particles\": [0], \"to\": {\"body\": "
                                                      "0, \"particles\": [56]}}]",
     "seams[1] joins particles that seams[0] joins: their stitches add up, to 200 N/m",
     "seams[1].particles", "[9]", false},
    // grabs that draw further than the sheet goes: along, on a second leg, by positions
    {GRAB(LEFT, "\"from\": 0, \"to\": 2",
          "\"particles\": [\"right\"], " SHIFTS "[{\"at\": 2, \"point\": [3, 0, 0]}]"),
     "events[0].grab draws particle 7", "events[0].grab.path[0].point", "[0.1, 0, 0]", true},
    {GRAB(LEFT, "\"from\": 0, \"to\": 4",
          "\"particles\": [\"right\"], " SHIFTS
          "[{\"at\": 2, \"point\": [0, 0, 0.1]}, {\"at\": 4, \"point\": [0, 0, 2]}]"),
     "until 4 s to ", "events[0].grab.path[1].point", "[0, 0, 0.2]", true},
    {GRAB(LEFT, "\"from\": 0, \"to\": 2",
          "\"particles\": [\"top-right\"], \"path\": [{\"at\": 2, \"point\": [2, 0.25, 0]}]"),
     "events[0].grab draws particle 7", "events[0].grab.path[0].point", "[0.3, 0.25, 0]", true},
    // releases of what nothing holds: never, not yet, not there
    {BODY("", "") ", \"events\": [{\"at\": 0.5, \"release\": {}}]",
     "events[0].release lets go what nothing holds at 0.5 s", "bodies[0].pins", "[\"top\"]",
     false},
    {BODY("", TOP) ", \"events\": [{\"at\": 0.5, \"release\": {\"particles\": [\"bottom\"]}}]",
     "events[0].release lets go what nothing holds", "events[0].release.particles", "[\"top\"]",
     false},
    {BODY("", "") ", \"events\": [{\"at\": 0.5, \"release\": {}}, {\"at\": 1, \"pin\": {}}]",
     "events[0].release lets go what nothing holds", "events[1].at", "0.2", false},
    // ten with one fault are one line
    {BODY("", ", \"pins\": [\"top\"]") ", \"events\": [" TEN "]",
     "events[0].grab.path[0] is 0.361 m from where its particle starts, reached at 18 m/s: "
     "points "
     "are positions, and with \"relative\": true shifts; the same holds for 9 more\n",
     "events", "[]", false},
};

TEST(traps_of_trajectories_are_found_and_cured) {
    spring_traps(trajectories, LENGTH(trajectories));
}

/* Round bodies whose boxes overlap at a corner do not. */
TEST(boxes_that_overlap_are_no_bodies_that_do) {
    struct cs_scene_findings found;
    check("{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\"}, \"mass\": {\"total\": 1}}, "
          "{\"mesh\": "
          "{\"shape\": \"sphere\", \"place\": {\"translate\": [0.8, 0.8, 0]}}, \"mass\": "
          "{\"total\": 1}}]}",
          NULL, 0, &found);
    ck_assert_msg(!strstr(cs_text_get(&found.warnings), "overlap at the start") &&
                      strstr(cs_text_get(&found.warnings), "could collide"),
                  "%s", cs_text_get(&found.warnings));
    cs_scene_findings_finish(&found);
}

#define APART "they stay apart with path[0].point "
/* The figures that messages advise, as they print them: with one of them in its place nothing
 * of the kind is found any more, and the run goes on and stays bounded by what it began with.
 */
static const struct {
    const char *scene, *finding, *before; /* the text before the figure */
    double base;                          /* the value is base times the figure; < 0: over it */
    const char *path, *format;            /* NULL: the point as it stands */
} advice[] = {
    {GRAB(TOP, "\"from\": 0.2, \"to\": 0.8",
          "\"particles\": [\"bottom\"], " SHIFTS "[{\"at\": 0.201, \"point\": [0, 0, 0.2]}]"),
     "events[0].grab.path[0] is reached", "expected at = ", 1, "events[0].grab.path[0].at",
     "%g"},
    {MOVE(TOP, BALL, "\"from\": 0, \"to\": 1",
          "\"relative\": true, \"path\": [{\"at\": 0.01, \"point\": [4, 0, 0]}]"),
     "events[0].move.path[0] is reached", "expected at = ", 1, "events[0].move.path[0].at",
     "%g"},
    {BODY("", TOP ", \"springs\": {\"stretch\": 2, \"bend\": 0, \"shear\": 0}"),
     "its weight stretches", ": springs.stretch ", 1, "bodies[0].springs.stretch", "%g"},
    {BODY("", TOP) ", \"forces\": {\"wind\": {\"direction\": [0, 0, 1], \"strength\": 5000}}",
     "the wind at the start stretches", ": a wind ", -5000, "forces.wind.strength", "%g"},
    {BODY(FLAT ", \"stretch\": [9, 9]",
          ", \"springs\": {\"stretch\": 500, \"shear\": 0, \"bend\": 0}"),
     "springs store ", "; springs ", -500, "bodies[0].springs.stretch", "%g"},
    {BODY("", ", \"pins\": [\"top-left\", \"top-right\"]"), "bodies[0] lies in a plane",
     "cloth.bump ", 1, "bodies[0].cloth.bump", "%g"},
    {BODY(HIGH,
          "") ", \"contact\": \"project\", \"colliders\": [{\"sphere\": {\"centre\": [0, 0, "
              "0], \"radius\": 0.03}}]",
     "particles are ", "with cells below ", 0.99 * 7, "bodies[0].cloth.size", "[%1$g, %1$g]"},
    {BODY(HIGH, "") FLOOR ", \"contact\": {\"law\": \"force\", \"stiffness\": 1}",
     "contact.stiffness: at ", "expected at least ", 1, "contact.stiffness", "%g"},
    {BODY(HIGH, "") FLOOR ", \"contact\": {\"law\": \"force\", \"stiffness\": 1}",
     "contact.stiffness: at ", "or no value for ", 1, "contact.stiffness", "%g"},
    {BODY(HIGH, "") ", \"colliders\": [{\"floor\": {\"height\": 0}, \"thickness\": 0.001}], "
                    "\"contact\": \"force\"",
     "may meet at ", "a thickness of ", 1, "colliders[0].thickness", "%g"},
    {MOVE(TOP, BALL, "\"from\": 0, \"to\": 2",
          "\"motion\": \"smooth\", " SHIFTS "[{\"at\": 2, \"point\": [0, 0, -1.2]}]"),
     GOES, APART, 1, "events[0].move.path[0].point", NULL},
    {MOVE(TOP, BALL, "\"from\": 0, \"to\": 2",
          "\"relative\": false, \"path\": [{\"at\": 2, \"point\": [0, 0.25, -0.6]}]"),
     GOES, APART, 1, "events[0].move.path[0].point", NULL},
    {CARRIED(HIP, BALL, TURN ", " LEG), "events[1]: colliders[1] goes at ", APART, 1,
     "events[1].move.path[0].point", NULL},
    {CARRIED(HIP, PEG, TURN), "events[0]: colliders[1] goes at ",
     "they stay apart with \"to\": ", 1, "events[0].to", "%g"},
    {CARRIED(HIP, GROUND, DOWN), "events[0]: colliders[1] goes at ", APART, 1,
     "events[0].move.path[0].point", NULL},
};

/* Runs a scene with an override for some frames, in which it must not blow up. */
static void run_with(const char *text, const struct cs_override *override, int frames) {
    struct cs_session session;
    struct cs_error error = {0};
    cs_session_open(&session,
                    &(struct cs_session_settings){.scene = "cured.json",
                                                  .text = text,
                                                  .integrator = "implicit-linearised:dt=frame",
                                                  .overrides = override,
                                                  .n_overrides = 1},
                    &error);
    for (int frame = 0; frame < frames && !error.status; frame++)
        cs_run_frame(&session.run, &error);
    ck_assert_msg(!error.status && session.run.outcome == CS_RUNNING, "%s=%s: %s",
                  override->path, override->value, error.message);
    cs_session_close(&session);
}

TEST(figures_that_are_advised_do) {
    for (size_t k = 0; k < LENGTH(advice); k++) {
        char text[4096], value[64];
        struct cs_scene_findings found;
        snprintf(text, sizeof text, "{%s}", advice[k].scene);
        check(text, NULL, 0, &found);
        const char *all = strstr(cs_text_get(&found.warnings), advice[k].finding)
                              ? cs_text_get(&found.warnings)
                              : cs_text_get(&found.hints);
        const char *line = strstr(all, advice[k].finding);
        ck_assert_msg(line != NULL, "%s: %s", advice[k].finding, all);
        const char *figure = strstr(line, advice[k].before);
        ck_assert_msg(figure != NULL, "%s: %s", advice[k].before, line);
        figure += strlen(advice[k].before);
        if (advice[k].format) {
            const double read = strtod(figure, NULL), base = advice[k].base;
            ck_assert_double_gt(read, 0);
            snprintf(value, sizeof value, advice[k].format,
                     base > 0 ? base * read : -base / read);
        } else
            snprintf(value, sizeof value, "[%.*s]", (int)strcspn(figure + 1, "]"), figure + 1);
        cs_scene_findings_finish(&found);
        const struct cs_override cure = {advice[k].path, value};
        check(text, &cure, 1, &found);
        ck_assert_msg(!strstr(cs_text_get(&found.warnings), advice[k].finding) &&
                          !strstr(cs_text_get(&found.hints), advice[k].finding),
                      "%s=%s: %s%s", cure.path, value, cs_text_get(&found.warnings),
                      cs_text_get(&found.hints));
        cs_scene_findings_finish(&found);
        run_with(text, &cure, advice[k].format ? 30 : 120);
    }
}
