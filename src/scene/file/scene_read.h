/* scene_read.h - strict reader of scene files. */
#ifndef CS_SCENE_READ_H
#define CS_SCENE_READ_H

#include "scene/scene.h"

/* One --set: a JSON path, and a JSON value or a bare word, which is taken as a text. */
struct cs_override {
    const char *path, *value; /* "bodies[0].springs.stretch", "200" */
};

/* Reads, overrides, parses and checks (cs_scene_check) a scene. Every message starts with
 * `file:line:column: path: ` (values from --set: `--set path: `). On failure CS_ERR_FILE,
 * CS_ERR_SCENE, CS_ERR_USAGE (a --set that cannot be read) or CS_ERR_MEMORY; *scene is then
 * empty. The caller releases it by cs_scene_finish. */
enum cs_status cs_scene_read(struct cs_scene *scene, const char *path,
                             const struct cs_override *overrides, uint32_t n_overrides,
                             struct cs_error *error);

/* The same from text in memory; path is for messages, and for the folder of textures and
 * meshes. */
enum cs_status cs_scene_read_text(struct cs_scene *scene, const char *path, const char *text,
                                  size_t bytes, const struct cs_override *overrides,
                                  uint32_t n_overrides, struct cs_error *error);

#endif
