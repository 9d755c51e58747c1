/* table_required.h - what a table insists on, and what its rows stand for in messages. */
#ifndef CS_TABLE_REQUIRED_H
#define CS_TABLE_REQUIRED_H

#include "scene/file/json_context.h"

#include <clothsim/option.h>

/* Adds what a row stands for and its range, for messages: "a list of 3 numbers (0..1)". */
void cs_table_add_expected(const struct cs_option *row, struct cs_text *out);

/* true if the reader insists on the row: no default, or a table that insists on one of its own.
 */
bool cs_table_needs_row(const struct cs_option *row);

/* Refuses a table in which a value without default is missing, or which wants exactly one of
 * its rows and has none or more. */
enum cs_status cs_table_check_complete(struct cs_json_context *context,
                                       const struct cs_json *value,
                                       const struct cs_table *table, const void *object);

#endif
