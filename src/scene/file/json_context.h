/* json_context.h - position of the reading of a scene, and messages that name it. */
#ifndef CS_JSON_CONTEXT_H
#define CS_JSON_CONTEXT_H

#include "base/arena.h"
#include "base/options.h"
#include "scene/file/json.h"

/* State of a reading; all pointers are borrowed. */
struct cs_json_context {
    const char *name, *text; /* of the file, for messages */
    struct cs_arena *arena;  /* of lists */
    struct cs_error *error;
    char path[384]; /* JSON path of the value being read */
    size_t path_length;
    const char *skipped_key; /* key of the root that is read elsewhere, or NULL */
};

/* Parses a text as cs_json_parse; a fault is CS_ERR_SCENE with name, line and column. */
enum cs_status cs_json_parse_named(const char *name, const char *text, size_t length,
                                   struct cs_json **root, struct cs_error *error);

/* Returns true for keys that are the user's own: "x-..." and "$...". */
bool cs_key_is_free(const char *key);

/* Append a member's key or index to the path; leave takes the value that enter returned. */
size_t cs_json_context_enter(struct cs_json_context *context, const char *key);
size_t cs_json_context_enter_at(struct cs_json_context *context, uint32_t index);
void cs_json_context_leave(struct cs_json_context *context, size_t length);

/* Fails with CS_ERR_SCENE and `file:line:column: path: message`, or `--set path: message` for a
 * value from there. The position is that of value, or of its key. */
enum cs_status cs_json_context_fail(struct cs_json_context *context,
                                    const struct cs_json *value, bool of_key,
                                    const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The same as "found <value>, expected <expected>". */
enum cs_status cs_json_context_fail_type(struct cs_json_context *context,
                                         const struct cs_json *value, const char *expected);

/* Finds and sets values of a JSON tree by a path: bodies[0].springs.stretch */

/* Returns the value at the path, or the deepest one that exists on the way to it. */
const struct cs_json *cs_json_nearest(const struct cs_json *root, const char *path);

/* The row of the table that a plain text, number or list sets in place of the whole object, or
 * NULL. */
const struct cs_option *cs_json_shorthand(const struct cs_table *table,
                                          const struct cs_json *value);

/* Puts value - JSON, or a bare word, which is taken as a text - at the path. Makes missing
 * objects and lists on the way, and of a shorthand of the root's table the object that it
 * stands for; an index is at most the length of its list (which appends). The new value has no
 * position. On failure CS_ERR_USAGE (message: "--set path: ...") or CS_ERR_MEMORY; objects that
 * were made on the way stay. */
enum cs_status cs_json_override(struct cs_json *root, const struct cs_table *table,
                                const char *path, const char *value, struct cs_error *error);

struct cs_scene;

/* Fills *object, which holds the defaults, from value. Refuses unknown keys (but "x-..." and
 * "$..."), wrong types, values out of range, missing values without a default, and none or two
 * rows of a table that wants exactly one. CS_ERR_SCENE or CS_ERR_MEMORY; *object is then
 * incomplete. */
enum cs_status cs_table_read(struct cs_json_context *context, const struct cs_json *value,
                             const struct cs_table *table, void *object);

/* Fills the geometry of every mesh of bodies and colliders, and the clusters of every matched
 * body, of a scene whose tables were read; root gives positions for messages. CS_ERR_SCENE,
 * CS_ERR_FILE (a mesh file) or CS_ERR_MEMORY. */
enum cs_status cs_scene_read_meshes(struct cs_json_context *context, const struct cs_json *root,
                                    struct cs_scene *scene);

/* Returns the key for an unknown one at a place, "bodies[0].springs"; NULL: none is known. It
 * is a key of the table at the place if there is one, else the end of a path
 * ("springs.stretch"), or a word of the command line. */
const char *cs_foreign_key(const char *place, const char *key, const struct cs_table *table);

/* Returns true if a path, "bodies[0].springs.stretch", ends with the keys of another one. */
bool cs_path_ends_with(const char *path, const char *keys);

#endif
