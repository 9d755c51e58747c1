/* A small scene out of any bytes, run for two frames by a method out of them: it is refused
 * with a message, or ends finite or says that it did not; and where it is broken off after the
 * first frame, it goes on to the same bits. */
#include "base/options.h"
#include "made_scene.h"
#include "model/plan.h"
#include "scene/body_particles.h"
#include "scene/scene.h"
#include "session/session.h"
#include "sim/crash.h"
#include "sim/run_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

enum { FRAMES = 2, STEPS_MAX = 200, PARTICLES_MAX = 120 };

/* the methods of this tree, linked in: the sanitizers and the fuzzer see into them */
#define MODULES(X) X(dop853) X(explicit) X(implicit) X(newton) X(shape_matching) X(xpbd)
#define X(name)    extern const struct cs_module clothsim_module_##name;
MODULES(X)
#undef X
static const struct cs_module *const modules[] = {
#define X(name) &clothsim_module_##name,
    MODULES(X)
#undef X
};
enum { MODULES_N = sizeof modules / sizeof *modules };

/* a crash is the fuzzer's to see, not the program's to explain */
void cs_crash_watch(enum cs_crash_side side, const char *kind, const char *name,
                    const char *place) {
    (void)side, (void)kind, (void)name, (void)place;
}
void cs_crash_forget(enum cs_crash_side side) {
    (void)side;
}
void cs_crash_note_host(void) {
}
_Noreturn void cs_crash_end(enum cs_crash_side side, const char *what) {
    (void)side, (void)what;
    abort();
}
void cs_crash_begin(enum cs_crash_side side) {
    (void)side;
}
bool cs_crash_was_starved(enum cs_crash_side side) {
    (void)side;
    return false;
}

/* Ends a run by counting: a clock would end the two runs at different steps. */
struct counter {
    volatile sig_atomic_t stop;
    int steps;
};

static bool count_step(void *ctx, double t, double dt, double *x, double *v) {
    struct counter *counter = ctx;
    (void)t, (void)dt, (void)x, (void)v;
    counter->stop = ++counter->steps >= STEPS_MAX;
    return false;
}

static const struct cs_integrator *choose_method(struct choices *choices) {
    const struct cs_module *module = modules[choose(choices) % MODULES_N];
    return module->integrators[choose(choices) % module->n];
}

/* 0 leaves an option at its default; one that has no effect beside others is no mistake here */
static void choose_options(struct choices *choices, const struct cs_method *method) {
    for (uint32_t r = 0; r < method->table.n; r++) {
        const struct cs_option *row = method->table.rows + r;
        struct cs_error error = {0};
        if (choose(choices) < 192)
            continue;
        const double value = choose_number(choices, row);
        if (row->type == CS_REAL || row->type == CS_INT)
            cs_option_set_number(row, method->options, value, row->name, CS_ERR_USAGE, &error);
        else if (row->type == CS_CHOICE)
            cs_option_set_choice(row, method->options, row->choices[(int)value], row->name,
                                 CS_ERR_USAGE, &error);
        CS_ASSERT(!error.status);
    }
}

static int64_t count_particles(const struct cs_scene *scene) {
    int64_t n = 0;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        n += cs_body_count(cs_scene_body(scene, b));
    return n;
}

/* false: the scene or the method refused it, with a message */
static bool open_run(struct cs_session *session, const char *text, struct choices choices,
                     struct counter *counter) {
    struct cs_error error = {0};
    const struct cs_session_settings settings = {
        .scene = "fuzz.json",
        .text = text,
        .method = choose_method(&choices),
        .run = {
            .stop = &counter->stop, .after_commit = count_step, .ctx = counter, .budget = 0.5}};
    if (cs_session_open_plan(session, &settings, &error)) {
        CS_ASSERT(error.status == CS_ERR_SCENE && *error.message);
        return false;
    }
    choose_options(&choices, &session->method);
    if (count_particles(session->scene) <= PARTICLES_MAX &&
        !cs_plan_check(session->scene, session->method.integrator, &error) &&
        !cs_session_build(session, &error) && !cs_session_begin(session, NULL, &error))
        return true;
    CS_ASSERT(!error.status || *error.message);
    cs_session_close(session);
    return false;
}

/* whether it made all its frames; what it leaves then is finite */
static bool run_frames(struct cs_session *session, uint32_t frames) {
    struct cs_error error = {0};
    struct cs_run *run = &session->run;
    while (run->frame < frames && run->outcome == CS_RUNNING && !cs_run_frame(run, &error))
        continue;
    CS_ASSERT(!error.status || (error.status == CS_ERR_MODULE && *error.message));
    const bool finished = !error.status && run->outcome == CS_RUNNING;
    for (size_t i = 0; finished && i < 6 * (size_t)session->system.view.n; i++)
        CS_ASSERT(isfinite(run->x[i]));
    return finished;
}

/* the same run from its record */
static void go_on(const struct cs_session *whole, struct cs_serialiser *serialiser,
                  const char *text, struct choices choices) {
    struct cs_session resumed;
    struct counter counter = {0};
    struct cs_error error = {0};
    CS_ASSERT(open_run(&resumed, text, choices, &counter));
    serialiser->is_reading = true;
    CS_ASSERT(!cs_run_load(&resumed.run, serialiser, &error) &&
              cs_serialiser_is_done(serialiser));
    counter = (struct counter){0};
    CS_ASSERT(run_frames(&resumed, FRAMES));
    CS_ASSERT(!memcmp(resumed.run.x, whole->run.x,
                      6 * (size_t)whole->system.view.n * sizeof *whole->run.x));
    cs_session_close(&resumed);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    /* first what decides the method, then the scene, so that each can change alone */
    const size_t head = length < 16 ? length : 16;
    const struct choices method = {bytes, head};
    struct choices rest = {bytes + head, length - head};
    struct cs_text text = {0};
    struct cs_session whole;
    struct counter counter = {0};
    struct cs_serialiser serialiser = {0};
    struct cs_error error = {0};
    make_scene(&rest, &text);
    if (open_run(&whole, cs_text_get(&text), method, &counter)) {
        if (run_frames(&whole, 1) && !cs_run_save(&whole.run, &serialiser, &error) &&
            run_frames(&whole, FRAMES))
            go_on(&whole, &serialiser, cs_text_get(&text), method);
        cs_session_close(&whole);
    }
    cs_serialiser_finish(&serialiser);
    cs_text_finish(&text);
    return 0;
}
