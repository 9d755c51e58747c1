/* table_read.h - JSON values into structs, by the structs' tables. */
#ifndef CS_TABLE_READ_H
#define CS_TABLE_READ_H

#include "base/arena.h"
#include "io/json.h"

#include <clothsim/option.h>

/* Where the reading stands. All pointers are borrowed. */
struct cs_reader {
    const char *name, *text; /* of the file, for places */
    struct cs_arena *arena;  /* of lists */
    struct cs_error *error;
    char path[384]; /* JSON path of the value at hand */
    size_t path_length;
    const char *apart; /* key of the root that is read elsewhere, or NULL */
};

/* Fills *object, which holds the defaults, from value. Refused are unknown keys (but for
 * "x-..." and "$..."), wrong types, values out of range, missing ones that have no default, and
 * none or two of a table that wants exactly one of its rows. On failure CS_ERR_SCENE or
 * CS_ERR_MEMORY. */
enum cs_status cs_table_read(struct cs_reader *reader, const struct cs_json *value,
                             const struct cs_table *table, void *object);

/* Adds what a row stands for and its range, for messages: "a list of 3 numbers (0..1)". */
void cs_table_add_expected(const struct cs_option *row, struct cs_text *out);

/* true if the reader insists on the row: no default, or a table that insists on one of its own.
 */
bool cs_table_needs_row(const struct cs_option *row);

/* Refuses a table in which a value without default is missing, or which wants exactly one of
 * its rows and has none or more. */
enum cs_status cs_table_check_complete(struct cs_reader *reader, const struct cs_json *value,
                                       const struct cs_table *table, const void *object);

/* true for the keys that are the user's own: "x-..." and "$...". */
bool cs_key_is_free(const char *key);

/* Appends a member's key or index to the path; leave gives what enter returned. */
size_t cs_reader_enter(struct cs_reader *reader, const char *key);
size_t cs_reader_enter_at(struct cs_reader *reader, uint32_t index);
void cs_reader_leave(struct cs_reader *reader, size_t length);

/* Fails with CS_ERR_SCENE, `file:line:column: path: ` (or `--set path: ` for a value from
 * there) and the message. The place is that of value, or of its key. */
enum cs_status cs_reader_fail(struct cs_reader *reader, const struct cs_json *value,
                              bool of_key, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The same as "found <value>, expected <expected>". */
enum cs_status cs_reader_fail_type(struct cs_reader *reader, const struct cs_json *value,
                                   const char *expected);

#endif
