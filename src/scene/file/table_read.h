/* table_read.h - JSON values into structs, by the structs' tables. */
#ifndef CS_TABLE_READ_H
#define CS_TABLE_READ_H

#include "scene/file/json_context.h"

#include <clothsim/option.h>

/* Fills *object, which holds the defaults, from value. Refused are unknown keys (but for
 * "x-..." and "$..."), wrong types, values out of range, missing ones that have no default, and
 * none or two of a table that wants exactly one of its rows. On failure CS_ERR_SCENE or
 * CS_ERR_MEMORY. */
enum cs_status cs_table_read(struct cs_json_context *context, const struct cs_json *value,
                             const struct cs_table *table, void *object);

#endif
