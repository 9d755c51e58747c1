/* Every scene in which surfaces meet, in full length, by methods of all families: no frame has
 * an edge through a triangle. Prints the rows of the table in docs/results/contact-scenes.md as
 * it goes: scene, method, frames, crossings, processor time.
 *
 * test_contact_methods METHOD [SCENE ...]: of one method, "all" for every one.
 * test_contact_methods hard [METHOD [SCENE ...]]: the scenes of scenes/hard, all at its
 * default; half ...: with half as many particles a side. Without arguments: some of those,
 * coarse. */
#include "body_pair_fixture.h"
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* the first with steps of one length, short where contact is stiff: on scenes that leave these
 * long enough alone, unless others are asked for */
static const char *const methods[] = {
    "velocity-verlet",  "dopri5:rtol=1e-3",    "implicit-linearised:dt=0.004",
    "newmark:dt=0.004", "cvode-bdf:rtol=1e-3", "xpbd:dt=0.004"};
enum { SHORT_STEPS = 0 };

/* as they stand, but for two that would take long */
enum { MILD = 5 };
static const struct meeting scenes[] = {
    {.scene = "self_compare", .frames = 60, .overrides = {MEETING_LIMIT}},
    {.scene = "ribbon", .frames = 240},
    {.scene = "trampoline", .frames = 60},
    {.scene = "curtain_ball",
     .frames = 150,
     .overrides = {MEETING_GRID(28, 32), MEETING_CURTAIN}},
    {.scene = "fold", .frames = 60},
    {.scene = "needles", .frames = 125},
    {.scene = "bear_drape", .frames = 60},
    {.scene = "walking_bear", .frames = 90},
    {.scene = "layers", .frames = 60},
    {.scene = "bear_heap", .frames = 120},
    {.scene = "winding", .frames = 240, .overrides = {MEETING_GRID(15, 15)}},
    {.scene = "funnel", .frames = 180}, // coarser ones jam: the tip comes to lie on an edge
    {.scene = "reef_knot", .frames = 120},
};

/* Those in which contact is fast, thin or sharp, at 40 x 40, by methods at their defaults. */
static const char *const hard_methods[] = {"implicit-linearised:dt=frame",
                                           "backward-euler:dt=frame", "newmark:dt=frame",
                                           "velocity-verlet", "cvode-bdf"};
#define HARD_GRID MEETING_GRID(40, 40)
static const struct meeting hard[] = {
    {.scene = "hard/star", .frames = 120, .overrides = {HARD_GRID}},
    {.scene = "hard/needles", .frames = 120, .overrides = {HARD_GRID}},
    {.scene = "hard/ring", .frames = 120},
    {.scene = "hard/clash", .frames = 60, .overrides = {HARD_GRID, MEETING_GRID_OF(1, 40, 40)}},
    {.scene = "hard/crash", .frames = 60, .overrides = {HARD_GRID, MEETING_GRID_OF(1, 40, 40)}},
    {.scene = "hard/bullet", .frames = 60, .overrides = {HARD_GRID}},
    {.scene = "hard/roller", .frames = 180, .overrides = {HARD_GRID}},
    {.scene = "hard/tube", .frames = 120},
    {.scene = "hard/pull", .frames = 90, .overrides = {HARD_GRID}},
    // no number of the program was chosen by these
    {.scene = "hard/corner", .frames = 60, .overrides = {HARD_GRID}},
    {.scene = "hard/wires", .frames = 60, .overrides = {HARD_GRID}},
    {.scene = "hard/press", .frames = 40, .overrides = {HARD_GRID}},
    {.scene = "hard/whip", .frames = 40, .overrides = {HARD_GRID}},
    {.scene = "hard/stack",
     .frames = 60,
     .overrides = {HARD_GRID, MEETING_GRID_OF(1, 40, 40), MEETING_GRID_OF(2, 40, 40),
                   MEETING_GRID_OF(3, 40, 40), MEETING_GRID_OF(4, 40, 40),
                   MEETING_GRID_OF(5, 40, 40), MEETING_GRID_OF(6, 40, 40),
                   MEETING_GRID_OF(7, 40, 40), MEETING_GRID_OF(8, 40, 40),
                   MEETING_GRID_OF(9, 40, 40)}},
    {.scene = "hard/hammock", .frames = 60, .overrides = {HARD_GRID}},
    {.scene = "hard/knife", .frames = 40, .overrides = {HARD_GRID}},
    {.scene = "hard/links", .frames = 60},
    {.scene = "hard/spin", .frames = 40, .overrides = {HARD_GRID}},
    {.scene = "hard/net", .frames = 40, .overrides = {HARD_GRID}},
};
static const struct meeting hard_and_coarse[] = {
    {"hard/star", "implicit-linearised", {MEETING_GRID(12, 12)}, 40},
    {"hard/clash",
     "implicit-linearised",
     {MEETING_GRID(10, 10), MEETING_GRID_OF(1, 10, 10)},
     20},
    {"hard/bullet", "implicit-linearised", {MEETING_GRID(10, 10)}, 12},
    // friction in this impact wants steps of 1e-9 s, which are not taken
    {"hard/clash", "velocity-verlet", {MEETING_GRID(10, 10), MEETING_GRID_OF(1, 10, 10)}, 3},
    {"hard/clash", "rk4", {MEETING_GRID(10, 10), MEETING_GRID_OF(1, 10, 10)}, 3},
};

static double processor_seconds(void) {
    struct rusage used;
    getrusage(RUSAGE_SELF, &used);
    return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
           1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/* What became of one scene by one method. */
struct course {
    uint32_t frames; /* that were done */
    uint64_t most;   /* crossings in one of them */
    struct cs_error error;
};

static void follow(struct cs_session *session, uint32_t frames, struct course *course) {
    while (course->frames < frames && !course->error.status) {
        cs_run_frame(&session->run, &course->error);
        if (session->run.outcome != CS_RUNNING)
            cs_fail(&course->error, CS_ERR_MODULE, "%s",
                    session->run.reason ? session->run.reason
                                        : cs_outcome_text(session->run.outcome));
        if (course->error.status)
            return;
        const uint64_t n = meeting_crossings(session);
        course->most = n > course->most ? n : course->most;
        course->frames++;
    }
}

/* Returns true if nothing crossed, and all frames were done. */
static bool run(const struct meeting *params) {
    struct cs_session session;
    struct course course = {0};
    const double before = processor_seconds();
    meeting_open_system(&session, params);
    ck_assert(!cs_session_begin(&session, NULL, &course.error));
    follow(&session, params->frames, &course);
    printf("| %s | %s | %u | %llu | %.1f | %s |\n", params->scene, params->method,
           course.frames, (unsigned long long)course.most, processor_seconds() - before,
           course.error.status ? course.error.message : "");
    fflush(stdout);
    cs_session_close(&session);
    return !course.error.status && !course.most;
}

/* Whether `args`, a method and scenes, ask for a name; they ask for all where they end. */
static bool is_asked_method(char **args, const char *method) {
    return !*args || !strcmp(*args, "all") || !strncmp(*args, method, strlen(*args));
}

static bool is_asked_scene(char **args, const char *scene) {
    bool asked = !*args || !args[1];
    for (char **name = args + (*args != NULL); *name; name++)
        asked = asked || !strcmp(*name, scene);
    return asked;
}

static void halve_grids(struct meeting *params) {
    for (int k = 0; k < MEETING_OVERRIDES && params->overrides[k].path; k++)
        if (!strcmp(params->overrides[k].value, "[40,40]"))
            params->overrides[k].value = "[20,20]";
}

/* Runs a method through a scene; counts. */
static void try(const struct meeting *scene, const char *method, uint32_t count[2]) {
    struct meeting params = *scene;
    params.method = method;
    count[0]++;
    count[1] += !run(&params);
}

TEST(nothing_goes_through) {
    uint32_t count[2] = {0};
    const bool is_half = *suite_args && !strcmp(*suite_args, "half");
    const bool is_hard = is_half || (*suite_args && !strcmp(*suite_args, "hard"));
    char **args = suite_args + is_hard;
    for (size_t s = 0; !is_hard && *args && s < LENGTH(scenes); s++)
        for (size_t m = 0; m < LENGTH(methods); m++)
            if (is_asked_method(args, methods[m]) && is_asked_scene(args, scenes[s].scene) &&
                (args[1] || m != SHORT_STEPS || s < MILD))
                try(scenes + s, methods[m], count);
    for (size_t s = 0; is_hard && s < LENGTH(hard); s++)
        for (size_t m = 0; m < LENGTH(hard_methods); m++)
            if (is_asked_method(args, hard_methods[m]) &&
                is_asked_scene(args, hard[s].scene + strlen("hard/"))) {
                struct meeting scene = hard[s];
                if (is_half)
                    halve_grids(&scene);
                try(&scene, hard_methods[m], count);
            }
    for (size_t s = 0; !is_hard && !*args && s < LENGTH(hard_and_coarse); s++)
        try(hard_and_coarse + s, hard_and_coarse[s].method, count);
    ck_assert_uint_gt(count[0], 0);
    ck_assert_msg(!count[1], "%u of %u runs failed, see their rows", count[1], count[0]);
}
