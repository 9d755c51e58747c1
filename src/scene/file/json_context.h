/* json_context.h - where the reading of a scene stands, and messages that name the place. */
#ifndef CS_JSON_CONTEXT_H
#define CS_JSON_CONTEXT_H

#include "base/arena.h"
#include "scene/file/json.h"

/* Where the reading stands. All pointers are borrowed. */
struct cs_json_context {
    const char *name, *text; /* of the file, for positions in messages */
    struct cs_arena *arena;  /* of lists */
    struct cs_error *error;
    char path[384]; /* JSON path of the value being read */
    size_t path_length;
    const char *skipped_key; /* key of the root that is read elsewhere, or NULL */
};

/* true for the keys that are the user's own: "x-..." and "$...". */
bool cs_key_is_free(const char *key);

/* Appends a member's key or index to the path; leave gives what enter returned. */
size_t cs_json_context_enter(struct cs_json_context *context, const char *key);
size_t cs_json_context_enter_at(struct cs_json_context *context, uint32_t index);
void cs_json_context_leave(struct cs_json_context *context, size_t length);

/* Fails with CS_ERR_SCENE, `file:line:column: path: ` (or `--set path: ` for a value from
 * there) and the message. The place is that of value, or of its key. */
enum cs_status cs_json_context_fail(struct cs_json_context *context,
                                    const struct cs_json *value, bool of_key,
                                    const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The same as "found <value>, expected <expected>". */
enum cs_status cs_json_context_fail_type(struct cs_json_context *context,
                                         const struct cs_json *value, const char *expected);

#endif
