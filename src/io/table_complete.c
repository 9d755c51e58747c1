/* Refuses tables that lack a required value, or that do not give exactly one of a choice. */
#include "io/table_complete.h"

#include "base/options.h"

bool cs_table_needs_row(const struct cs_option *row) {
    if (row->type == CS_VECTOR || row->type == CS_COUNTS)
        return !row->defs;
    if (row->type != CS_TABLE || row->table->optional)
        return false;
    bool needs = row->table->one_of;
    for (uint32_t r = 0; r < row->table->n; r++)
        needs = needs || cs_table_needs_row(row->table->rows + r);
    return needs;
}

/* exactly one of the optional rows */
static enum cs_status check_one_of(struct cs_reader *reader, const struct cs_json *value,
                                   const struct cs_table *table, const void *object) {
    struct cs_text given = {0}, choices = {0};
    uint32_t n = 0;
    for (uint32_t r = table->uncounted; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        if (!cs_option_is_optional(row))
            continue;
        cs_text_add(&choices, "%s%s", choices.length ? ", " : "", row->name);
        if (cs_option_is_given(row, object))
            cs_text_add(&given, "%s%s", n++ ? " and " : "", row->name);
    }
    if (n != 1)
        cs_reader_fail(reader, value, false, "found %s, expected exactly one of %s",
                       n ? cs_text_get(&given) : "none", cs_text_get(&choices));
    cs_text_finish(&given);
    cs_text_finish(&choices);
    return n == 1 ? CS_OK : reader->error->status;
}

/* What must be given, was: in a table that is absent too, unless it may be (value is then the
 * nearest value that is there). */
static enum cs_status check_complete(struct cs_reader *reader, const struct cs_json *value,
                                     bool absent, const struct cs_table *table,
                                     const void *object) {
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        if (!cs_table_needs_row(row) || (!absent && cs_json_find(value, row->name)))
            continue;
        const size_t outside = cs_reader_enter(reader, row->name);
        /* a row without a default is a list of numbers or a table that holds one */
        if (row->type != CS_TABLE) {
            struct cs_text expected = {0};
            cs_option_print_expected(row, &expected);
            cs_reader_fail(reader, value, false, "missing, expected %s",
                           cs_text_get(&expected));
            cs_text_finish(&expected);
        } else {
            /* the table itself may be absent: the message names the value that it lacks */
            check_complete(reader, value, true, row->table, (const char *)object + row->offset);
        }
        if (reader->error->status)
            return reader->error->status;
        cs_reader_leave(reader, outside);
    }
    return table->one_of ? check_one_of(reader, value, table, object) : CS_OK;
}

enum cs_status cs_table_check_complete(struct cs_reader *reader, const struct cs_json *value,
                                       const struct cs_table *table, const void *object) {
    return check_complete(reader, value, false, table, object);
}
