/* json.h - strict JSON as a tree whose values know their position in the text. */
#ifndef CS_JSON_H
#define CS_JSON_H

#include "base/status.h"
#include "base/text.h"
#include "scene/file/json_check.h"

/* One value. A root owns everything below it; other pointers are borrowed from it. */
struct cs_json;

/* The kinds of values. */
enum cs_json_kind {
    CS_JSON_NULL,
    CS_JSON_BOOL,
    CS_JSON_NUMBER,
    CS_JSON_TEXT,
    CS_JSON_LIST,
    CS_JSON_OBJECT
};

/* Parses a text with a zero after its length bytes. Accepts what cs_json_check accepts, without
 * repeated keys in an object. CS_ERR_SCENE: *fault says where and why; CS_ERR_MEMORY: *fault is
 * unchanged. On failure *root is NULL. */
enum cs_status cs_json_parse(const char *text, size_t length, struct cs_json **root,
                             struct cs_json_fault *fault);
void cs_json_destroy(struct cs_json *root); /* NULL is fine */

/* Kind and contents of a value; the caller has checked the kind. */
enum cs_json_kind cs_json_kind_of(const struct cs_json *value);
double cs_json_number(const struct cs_json *value);    /* of a number */
bool cs_json_is_true(const struct cs_json *value);     /* of a bool */
const char *cs_json_text(const struct cs_json *value); /* of a text; borrowed */
uint32_t cs_json_count(const struct cs_json *value);   /* members of a list or object, else 0 */

/* First and next member of a list or object, in order; NULL at the end, or if it is neither. */
const struct cs_json *cs_json_first(const struct cs_json *value);
const struct cs_json *cs_json_next(const struct cs_json *member);
const char *cs_json_key(const struct cs_json *member); /* NULL: not in an object */

/* Member of an object by its exact key, of a list by its index; NULL if there is none, or if
 * value is NULL or of another kind. */
struct cs_json *cs_json_find(const struct cs_json *value, const char *key);
struct cs_json *cs_json_at(const struct cs_json *value, uint32_t index);

/* As cs_json_find, but NULL for a member of another kind. */
const struct cs_json *cs_json_find_kind(const struct cs_json *value, const char *key,
                                        enum cs_json_kind kind);

/* Sets the offset in the parsed text of a value, or of its key; false if it is not from
 * there. */
bool cs_json_position(const struct cs_json *value, const char *text, bool of_key,
                      size_t *offset);

/* Adds a description of a value for messages: `text "top"`, `a list of 3`, `12.5`. */
void cs_json_describe(const struct cs_json *value, struct cs_text *out);

/* New values without a position, owned by the caller; NULL if out of memory. */
struct cs_json *cs_json_create(enum cs_json_kind kind); /* LIST or OBJECT */
struct cs_json *cs_json_create_text(const char *text);

/* Removes the positions of a value and all below it, because they belong to another text. */
void cs_json_drop_positions(struct cs_json *value);

/* Replaces a member, or appends it (index == count). Owns value from then on, also on failure.
 * Returns false if out of memory. */
bool cs_json_put(struct cs_json *object, const char *key, struct cs_json *value);
bool cs_json_put_at(struct cs_json *list, uint32_t index, struct cs_json *value);

/* Turns a value into the object {inner: value}, in its place. Returns false if out of memory.
 */
bool cs_json_wrap(struct cs_json *value, const char *inner);

#endif
