/* Every scene in which surfaces meet, in full length, by methods of all families: no frame has
 * an edge through a triangle. Prints the rows of the table in docs/contact.md as it goes:
 * scene, method, frames, crossings, processor time.
 *
 * test_contact_methods [METHOD [SCENE ...]]: of one method, "all" for every one. */
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
    {.scene = "layers", .frames = 60},
    {.scene = "bear_heap", .frames = 120},
    {.scene = "winding", .frames = 240, .overrides = {MEETING_GRID(15, 15)}},
    {.scene = "funnel", .frames = 180}, // coarser ones jam: the tip comes to lie on an edge
    {.scene = "reef_knot", .frames = 120},
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
            cs_fail(&course->error, CS_ERR_MODULE, "%s", cs_outcome_text(session->run.outcome));
        if (course->error.status)
            return;
        const uint64_t n = meeting_crossings(session);
        course->most = n > course->most ? n : course->most;
        course->frames++;
    }
}

/* true: all frames were done and nothing crossed */
static bool run(const struct meeting *params) {
    struct cs_session session;
    struct course course = {0};
    const double before = processor_seconds();
    meeting_open(&session, params);
    follow(&session, params->frames, &course);
    printf("| %s | %s | %u | %llu | %.1f | %s |\n", params->scene, params->method,
           course.frames, (unsigned long long)course.most, processor_seconds() - before,
           course.error.status ? course.error.message : "");
    fflush(stdout);
    cs_session_close(&session);
    return !course.error.status && !course.most;
}

static bool is_asked(size_t scene, size_t method) {
    const char *asked_method = *suite_args ? *suite_args : "all";
    char **asked_scenes = suite_args + (*suite_args != NULL);
    const size_t length = strlen(asked_method);
    bool asked = !*asked_scenes && (method != SHORT_STEPS || scene < MILD);
    for (char **name = asked_scenes; *name; name++)
        asked = asked || !strcmp(*name, scenes[scene].scene);
    return asked &&
           (!strcmp(asked_method, "all") || !strncmp(asked_method, methods[method], length));
}

TEST(nothing_goes_through) {
    uint32_t failed = 0, done = 0;
    for (size_t s = 0; s < LENGTH(scenes); s++)
        for (size_t m = 0; m < LENGTH(methods); m++)
            if (is_asked(s, m)) {
                struct meeting params = scenes[s];
                params.method = methods[m];
                failed += !run(&params);
                done++;
            }
    ck_assert_uint_gt(done, 0);
    ck_assert_msg(!failed, "%u of %u runs failed, see their rows", failed, done);
}
