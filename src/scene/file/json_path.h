/* json_path.h - finds and sets values of a JSON tree by a path: bodies[0].springs.stretch */
#ifndef CS_JSON_PATH_H
#define CS_JSON_PATH_H

#include "scene/file/json.h"

/* The value at the path, or the deepest one on the way to it. */
const struct cs_json *cs_json_nearest(const struct cs_json *root, const char *path);

/* Puts value - JSON, or a bare word, which is taken as a text - at the path. Objects and lists
 * on the way that are missing are made; an index is at most the length of its list (that adds
 * one). What is put has no place. On failure CS_ERR_USAGE (message: "--set path: ...") or
 * CS_ERR_MEMORY; objects that were made on the way stay. */
enum cs_status cs_json_override(struct cs_json *root, const char *path, const char *value,
                                struct cs_error *error);

#endif
