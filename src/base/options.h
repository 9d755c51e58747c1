/* options.h - any struct by its table: defaults, setting, checking, printing. */
#ifndef CS_OPTIONS_H
#define CS_OPTIONS_H

#include "base/status.h"
#include "base/text.h"

#include <clothsim/option.h>

/* Writes the defaults of every row (and of nested tables) into *object; lists are empty. */
void cs_options_default(const struct cs_table *table, void *object);

/* true if the row may stay away without its default standing in: an optional table, or a
 * default outside the range. */
bool cs_option_is_optional(const struct cs_option *row);

/* true if the reader insists on the row: no default, or a table that insists on one of its own.
 */
bool cs_table_needs_row(const struct cs_option *row);

/* true if the value of an optional row was given. */
bool cs_option_is_set(const struct cs_option *row, const void *object);

/* true if a value stands at its default, also where that is to be absent; a VECTOR or COUNTS
 * that must be given never does. Not for TABLE and LIST. */
bool cs_option_is_default(const struct cs_option *row, const void *object);

const struct cs_option *cs_option_find(const struct cs_table *table, const char *name);

/* The row's name nearest to a wrong one, or NULL. */
const char *cs_option_nearest(const struct cs_table *table, const char *name);

/* Sets a REAL, INT, BOOL or CHOICE row from text, range-checked. `where` stands before the
 * message ("integrator.dt"); status is that of a failure. */
enum cs_status cs_option_set(const struct cs_option *row, void *object, const char *text,
                             const char *where, enum cs_status status, struct cs_error *error);

/* The same for a number that was read already (REAL, INT). */
enum cs_status cs_option_set_number(const struct cs_option *row, void *object, double value,
                                    const char *where, enum cs_status status,
                                    struct cs_error *error);
enum cs_status cs_option_set_choice(const struct cs_option *row, void *object, const char *text,
                                    const char *where, enum cs_status status,
                                    struct cs_error *error);

/* Checks one component of a VECTOR or COUNTS, or a REAL or INT, against the row's range (and
 * wholeness). index < 0 where the row has one component. */
enum cs_status cs_option_check_range(const struct cs_option *row, double value, int index,
                                     const char *where, enum cs_status status,
                                     struct cs_error *error);

/* Adds the value as JSON, but for TABLE and LIST; object NULL: the default. */
void cs_option_print(const struct cs_option *row, const void *object, struct cs_text *out);

/* The same of numbers, switches and choices as a user writes them: without quotes and brackets.
 */
void cs_option_print_plain(const struct cs_option *row, const void *object,
                           struct cs_text *out);

/* Adds "-1e+09..1e+09" or the list of choices: what the row accepts. */
void cs_option_print_range(const struct cs_option *row, struct cs_text *out);

/* Adds what a row stands for and its range, for messages: "a list of 3 numbers (0..1)". */
void cs_option_print_expected(const struct cs_option *row, struct cs_text *out);

#endif
