/* value_kind.h - the kinds of values that an option holds, and all that depends on the kind. A
 * new kind is a line of enum cs_type and a row of the table in value_kind.c. */
#ifndef CS_VALUE_KIND_H
#define CS_VALUE_KIND_H

#include "base/text.h"

#include <clothsim/option.h>

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
