/* read_back.h - the resolved text of a scene reads as a scene with the same text. */
#ifndef CS_FUZZ_READ_BACK_H
#define CS_FUZZ_READ_BACK_H

#include "scene/file/scene_read.h"
#include "scene/scene.h"

#include <string.h>

static inline void read_back(const struct cs_scene *scene) {
    struct cs_text first = {0}, second = {0};
    struct cs_error error = {0};
    struct cs_scene back;
    cs_scene_print(scene, NULL, NULL, 0, &first);
    cs_scene_read_text(&back, "back.json", cs_text_get(&first), first.length, NULL, 0, &error);
    CS_ASSERT(!error.status);
    cs_scene_print(&back, NULL, NULL, 0, &second);
    CS_ASSERT(!strcmp(cs_text_get(&first), cs_text_get(&second)));
    cs_text_finish(&first);
    cs_text_finish(&second);
    cs_scene_finish(&back);
}

#endif
