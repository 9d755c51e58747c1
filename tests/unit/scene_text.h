/* scene_text.h - scenes that tests read from text. */
#ifndef CS_TESTS_SCENE_TEXT_H
#define CS_TESTS_SCENE_TEXT_H

#include "scene/file/scene_read.h"
#include "unit.h"

#define BODY "{\"cloth\": {\"grid\": [4, 3]}, \"mass\": {\"total\": 2}}"

static inline void read_text(struct cs_scene *scene, const char *text,
                             const struct cs_override *overrides, uint32_t n) {
    struct cs_error error = {0};
    cs_scene_read_text(scene, "dir/s.json", text, strlen(text), overrides, n, &error);
    UNIT_ASSERT_OK(&error);
}

/* the words of a message, so that each row below says the whole of it */
static inline void assert_refused(const char *text, const struct cs_override *overrides,
                                  uint32_t n, enum cs_status status, const char *message) {
    struct cs_error error = {0};
    struct cs_scene scene, empty = {0};
    ck_assert_int_eq(
        cs_scene_read_text(&scene, "s.json", text, strlen(text), overrides, n, &error), status);
    ck_assert_str_eq(error.message, message);
    ck_assert_ptr_eq(scene.text, empty.text);
    ck_assert_ptr_null(scene.arena.blocks);
    ck_assert_uint_eq(scene.bodies.n, 0);
}

#endif
