/* table_read.h - reads JSON values into structs by their tables. */
#ifndef CS_TABLE_READ_H
#define CS_TABLE_READ_H

#include "scene/file/json_context.h"

#include <clothsim/option.h>

/* Fills *object, which holds the defaults, from value. Refuses unknown keys (but "x-..." and
 * "$..."), wrong types, values out of range, missing values without a default, and none or two
 * rows of a table that wants exactly one. CS_ERR_SCENE or CS_ERR_MEMORY; *object is then
 * incomplete. */
enum cs_status cs_table_read(struct cs_json_context *context, const struct cs_json *value,
                             const struct cs_table *table, void *object);

#endif
