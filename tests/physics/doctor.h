/* doctor.h - scenes in short, what the doctor must say of them, and what cures them. */
#ifndef DOCTOR_H
#define DOCTOR_H

#include "fixture.h"
#include "session/scene_findings.h"
#include "session/session.h"

#include <string.h>

#define SHEET(more)                                                                            \
    "{\"cloth\": {\"grid\": [8, 8], \"size\": [0.5, 0.5], \"start\": \"flat\"" more            \
    "}, \"mass\": {\"total\": 0.1}}"
#define BODY(cloth, more)                                                                      \
    "\"bodies\": [{\"cloth\": {\"grid\": [8, 8], \"size\": [0.5, 0.5]" cloth                   \
    "}, \"mass\": {\"total\": 0.1}" more "}]"
#define FLAT    ", \"start\": \"flat\""
#define HIGH    ", \"start\": \"flat\", \"place\": {\"translate\": [0, 1, 0]}"
#define PROJECT ", \"contact\": \"project\""
#define FLOOR   ", \"colliders\": [{\"floor\": {\"height\": 0}}]"

#define GRAB(body, when, what) BODY("", body) ", \"events\": [{" when ", \"grab\": {" what "}}]"
#define MOVE(body, collider, when, what)                                                       \
    BODY("", body)                                                                             \
    ", \"colliders\": [{" collider "}], \"contact\": \"force\", \"events\": [{" when           \
    ", \"move\": {\"collider\": 0, " what "}}]"
#define TOP  ", \"pins\": [\"top\"]"
#define LEFT ", \"pins\": [\"left\"]"
#define BALL "\"sphere\": {\"centre\": [0, 0.25, 0.6], \"radius\": 0.1}"
#define BAR                                                                                    \
    "\"capsule\": {\"from\": [-0.5, 0.25, 0.4], \"to\": [0.5, 0.25, 0.4], \"radius\": 0.05}"
#define SHIFTS "\"relative\": true, \"path\": "

/* A scene, what is said of it, and an override after which nothing of the kind is said. */
struct trap {
    const char *scene, *finding, *path, *value;
    bool is_warning;
};

/* Opens a scene and asks the doctor; n_overrides 0 or 1. */
static void check(const char *text, const struct cs_override *override, uint32_t n_overrides,
                  struct cs_scene_findings *found) {
    struct cs_session session;
    struct cs_error error = {0};
    cs_session_open(&session,
                    &(struct cs_session_settings){.scene = "trap.json",
                                                  .text = text,
                                                  .integrator = "implicit-linearised:dt=frame",
                                                  .overrides = override,
                                                  .n_overrides = n_overrides},
                    &error);
    ck_assert_msg(!error.status, "%s: %s", text, error.message);
    cs_scene_doctor_check(&session, 1, found, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    cs_session_close(&session);
}

/* Finds each of n traps, and none of the kind with its override. */
static void spring_traps(const struct trap *list, size_t n) {
    ck_assert_uint_ge(n, 20);
    for (size_t k = 0; k < n; k++) {
        char text[8192];
        const struct trap *trap = list + k;
        const struct cs_override cure = {trap->path, trap->value};
        struct cs_scene_findings before, after;
        snprintf(text, sizeof text, "{%s}", trap->scene);
        check(text, &cure, 0, &before);
        check(text, &cure, 1, &after);
        const struct cs_text *of = trap->is_warning ? &before.warnings : &before.hints;
        ck_assert_msg(strstr(cs_text_get(of), trap->finding) != NULL, "%s: %s%s", trap->finding,
                      cs_text_get(&before.warnings), cs_text_get(&before.hints));
        ck_assert_msg(!strstr(cs_text_get(&after.warnings), trap->finding) &&
                          !strstr(cs_text_get(&after.hints), trap->finding),
                      "%s with %s=%s: %s%s", trap->finding, trap->path, trap->value,
                      cs_text_get(&after.warnings), cs_text_get(&after.hints));
        cs_scene_findings_finish(&before);
        cs_scene_findings_finish(&after);
    }
}

#endif
