/* json_path.h - finds and sets values of a JSON tree by a path: bodies[0].springs.stretch */
#ifndef CS_JSON_PATH_H
#define CS_JSON_PATH_H

#include "scene/file/json.h"

/* Returns the value at the path, or the deepest one that exists on the way to it. */
const struct cs_json *cs_json_nearest(const struct cs_json *root, const char *path);

/* Puts value - JSON, or a bare word, which is taken as a text - at the path. Makes missing
 * objects and lists on the way; an index is at most the length of its list (which appends). The
 * new value has no position. On failure CS_ERR_USAGE (message: "--set path: ...") or
 * CS_ERR_MEMORY; objects that were made on the way stay. */
enum cs_status cs_json_override(struct cs_json *root, const char *path, const char *value,
                                struct cs_error *error);

#endif
