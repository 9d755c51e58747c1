/* json.h - a strict JSON text as a tree whose values know where they stand. */
#ifndef CS_JSON_H
#define CS_JSON_H

#include "base/status.h"
#include "base/text.h"
#include "scene/file/json_check.h"

/* One value; a root owns all below it. */
struct cs_json;

enum cs_json_kind {
    CS_JSON_NULL,
    CS_JSON_BOOL,
    CS_JSON_NUMBER,
    CS_JSON_TEXT,
    CS_JSON_LIST,
    CS_JSON_OBJECT
};

/* Parses a text with a zero behind its length bytes: cs_json_check, and no key twice in an
 * object. CS_ERR_SCENE: *fault says where and why; CS_ERR_MEMORY: *fault is untouched. On
 * failure *root is NULL. */
enum cs_status cs_json_parse(const char *text, size_t length, struct cs_json **root,
                             struct cs_json_fault *fault);
void cs_json_destroy(struct cs_json *root); /* NULL is fine */

enum cs_json_kind cs_json_kind_of(const struct cs_json *value);
double cs_json_number(const struct cs_json *value);    /* of a number */
bool cs_json_is_true(const struct cs_json *value);     /* of a bool */
const char *cs_json_text(const struct cs_json *value); /* of a text; borrowed */
uint32_t cs_json_count(const struct cs_json *value);   /* members of a list or object, else 0 */

/* Walks the members of a list or object, in order: NULL at the end (and if it is neither). */
const struct cs_json *cs_json_first(const struct cs_json *value);
const struct cs_json *cs_json_next(const struct cs_json *member);
const char *cs_json_key(const struct cs_json *member); /* NULL: not in an object */

/* Member of an object by its exact key, of a list by its index: NULL if there is none, or if
 * value is NULL or of another kind. */
struct cs_json *cs_json_find(const struct cs_json *value, const char *key);
struct cs_json *cs_json_at(const struct cs_json *value, uint32_t index);

/* The same by key, but NULL for a member of another kind. */
const struct cs_json *cs_json_find_kind(const struct cs_json *value, const char *key,
                                        enum cs_json_kind kind);

/* Offset in the parsed text of a value, or of its key; false if it did not come from there. */
bool cs_json_position(const struct cs_json *value, const char *text, bool of_key,
                      size_t *offset);

/* Adds what a value is, for messages: `text "top"`, `a list of 3`, `12.5`. */
void cs_json_describe(const struct cs_json *value, struct cs_text *out);

/* New values without a place; NULL: out of memory. */
struct cs_json *cs_json_create(enum cs_json_kind kind); /* LIST or OBJECT */
struct cs_json *cs_json_create_text(const char *text);

/* Takes the place from a root and all below it: it comes from elsewhere. */
void cs_json_drop_positions(struct cs_json *value);

/* Puts value in the place of a member, or behind the last one (index == count). Owns value from
 * then on, also on failure; false: out of memory. */
bool cs_json_put(struct cs_json *object, const char *key, struct cs_json *value);
bool cs_json_put_at(struct cs_json *list, uint32_t index, struct cs_json *value);

/* Turns the member `key: value` into `key: {inner: value}`, which keeps the place. */
bool cs_json_wrap(struct cs_json *object, const char *key, const char *inner);

#endif
