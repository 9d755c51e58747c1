/* table_complete.h - what a table insists on. */
#ifndef CS_TABLE_COMPLETE_H
#define CS_TABLE_COMPLETE_H

#include "io/reader.h"

#include <clothsim/option.h>

/* true if the reader insists on the row: no default, or a table that insists on one of its own.
 */
bool cs_table_needs_row(const struct cs_option *row);

/* Refuses a table in which a value without default is missing, or which wants exactly one of
 * its rows and has none or more. */
enum cs_status cs_table_check_complete(struct cs_reader *reader, const struct cs_json *value,
                                       const struct cs_table *table, const void *object);

#endif
