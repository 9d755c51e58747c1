/* options.h - defaults, parsing, checks, printing and old names of any struct that has a table
 * of options. */
#ifndef CS_OPTIONS_H
#define CS_OPTIONS_H

#include "base/status.h"
#include "base/text.h"

#include <clothsim/option.h>

/* Returns the field of a row in an object; of a table that stands apart, its struct, or NULL if
 * it is absent. */
static inline void *cs_option_field(const struct cs_option *row, void *object) {
    void *field = (char *)object + row->offset;
    return row->type == CS_TABLE && row->table->apart ? *(void **)field : field;
}
static inline const void *cs_option_value(const struct cs_option *row, const void *object) {
    const void *field = (const char *)object + row->offset;
    return row->type == CS_TABLE && row->table->apart ? *(void *const *)field : field;
}

/* Writes the defaults of all rows, and of nested tables, into *object. Lists become empty;
 * pointers to optional tables that stand apart become NULL. */
void cs_options_default(const struct cs_table *table, void *object);

/* Tells whether the row may be absent without a default in its place: an optional table, or a
 * row whose default is outside its range. */
bool cs_option_is_optional(const struct cs_option *row);

/* Tells whether a reader must find the row: it has no default, or is a table that needs one of
 * its own rows. */
bool cs_table_needs_row(const struct cs_option *row);

/* Tells whether the value of an optional row was given. */
bool cs_option_is_set(const struct cs_option *row, const void *object);

/* Tells whether a value is the default; absent counts as default for an optional row. Always
 * false for a VECTOR or COUNTS without defaults. Not for TABLE and LIST. */
bool cs_option_is_default(const struct cs_option *row, const void *object);

/* The row of a name; NULL: there is none. */
const struct cs_option *cs_option_find(const struct cs_table *table, const char *name);

/* The row's name nearest to a misspelt one; NULL: none is near. */
const char *cs_option_nearest(const struct cs_table *table, const char *name);

/* Sets a REAL, INT, BOOL or CHOICE row from text, with a check of its range. `where`
 * ("integrator.dt") begins the message; status is the status of a failure. *object is unchanged
 * on failure. */
enum cs_status cs_option_set(const struct cs_option *row, void *object, const char *text,
                             const char *where, enum cs_status status, struct cs_error *error);

/* The same for a REAL or INT that was parsed already, and for the name of a CHOICE. */
enum cs_status cs_option_set_number(const struct cs_option *row, void *object, double value,
                                    const char *where, enum cs_status status,
                                    struct cs_error *error);
enum cs_status cs_option_set_choice(const struct cs_option *row, void *object, const char *text,
                                    const char *where, enum cs_status status,
                                    struct cs_error *error);

/* Checks one component of a VECTOR or COUNTS, or a REAL or INT, against the row's range, and
 * that it is whole where it must be. index < 0 if the row has one component. */
enum cs_status cs_option_check_range(const struct cs_option *row, double value, int index,
                                     const char *where, enum cs_status status,
                                     struct cs_error *error);

/* Returns true if one number stands for all components of a VECTOR: a factor or a size, which
 * is above 0. */
static inline bool cs_option_takes_one(const struct cs_option *row) {
    return row->type == CS_VECTOR && row->min > 0;
}

/* Appends the value as JSON; nothing for TABLE and LIST. object NULL: prints the default. */
void cs_option_print(const struct cs_option *row, const void *object, struct cs_text *out);

/* Appends numbers, switches and choices as a user writes them, without quotes and brackets. */
void cs_option_print_plain(const struct cs_option *row, const void *object,
                           struct cs_text *out);

/* Appends the accepted values: "-1e+09..1e+09", or the list of choices. */
void cs_option_print_range(const struct cs_option *row, struct cs_text *out);

/* Appends the kind of value and its range, for messages: "a list of 3 numbers (0..1)". */
void cs_option_print_expected(const struct cs_option *row, struct cs_text *out);

/* The kinds of values that an option holds, and all that depends on the kind. A
 * new kind is a line of enum cs_type and a row of the table in options.c. */

/* JSON form of a value: a number or a list of numbers, true or false, a name of the option's
 * choices, a text, an object, a list of objects. */
enum cs_value_form {
    CS_FORM_NUMBER,
    CS_FORM_BOOL,
    CS_FORM_CHOICE,
    CS_FORM_TEXT,
    CS_FORM_TABLE,
    CS_FORM_LIST,
    CS_VALUE_FORMS
};

/* Properties of a kind, and its operations. */
struct cs_value_kind {
    enum cs_value_form form;
    bool several; /* a list of `count` numbers */
    bool whole;   /* whole numbers; a single one below the range is absent, else NAN is */
    const char *expected; /* for messages, before the range: "a number"; `several`: "numbers" */
    const char *schema;   /* of numbers: the type in a JSON schema */

    size_t
        size; /* of a component; of other forms the bytes that are 0 where there is no value */

    /* Numbers, switches and choices: one component as a double. NULL for other forms. */
    double (*get)(const void *field, uint32_t i);
    void (*set)(void *field, uint32_t i, double value);
    void (*print)(const struct cs_option *row, double value, struct cs_text *out); /* as JSON */

    /* Other forms: tells whether there is a value. NULL for numbers, switches and choices. */
    bool (*is_given)(const struct cs_option *row, const void *field);

    /* Print the accepted values: for people, and as members of a JSON schema. NULL: nothing to
     * add. */
    void (*print_range)(const struct cs_option *row, struct cs_text *out);
    void (*print_schema)(const struct cs_option *row, struct cs_text *out);
};

/* The kind of a row. */
const struct cs_value_kind *cs_value_kind_of(const struct cs_option *row);

#endif
