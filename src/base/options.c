/* Defaults, checks and printing of any struct by its table of options. */
#include "base/options.h"

#include "base/json_writer.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Number of components. Rows of single-component kinds may leave `count` at 0. */
static uint32_t components_of(const struct cs_option *row) {
    return cs_value_kind_of(row)->several ? row->count : 1;
}

/* Default of component i of a row. */
static double default_of(const struct cs_option *row, uint32_t i) {
    return row->defs ? row->defs[i] : row->def;
}

/* Component i of a value, or of the default if object is NULL. */
static double value_of(const struct cs_option *row, const void *object, uint32_t i) {
    return object ? cs_value_kind_of(row)->get(cs_option_value(row, object), i)
                  : default_of(row, i);
}

void cs_options_default(const struct cs_table *table, void *object) {
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        const struct cs_value_kind *kind = cs_value_kind_of(row);
        void *field = cs_option_field(row, object);
        if (row->type == CS_TABLE && row->table->apart && row->table->optional)
            memset((char *)object + row->offset, 0, sizeof field);
        else if (!kind->set && cs_option_is_optional(row))
            memset(field, 0, kind->size);
        if (row->type == CS_TABLE && cs_option_value(row, object))
            cs_options_default(row->table, field);
        for (uint32_t i = 0; kind->set && i < components_of(row); i++)
            kind->set(field, i, default_of(row, i));
    }
}

/* Absence is coded in the value: NAN, or a single whole number below the range. */
static bool is_absent(const struct cs_option *row, const void *object) {
    const struct cs_value_kind *kind = cs_value_kind_of(row);
    const double value = value_of(row, object, 0);
    return isnan(value) || (kind->whole && !kind->several && value < row->min);
}

/* Several components without defaults must be given. */
static bool has_default(const struct cs_option *row) {
    return row->defs || !cs_value_kind_of(row)->several;
}

bool cs_option_is_optional(const struct cs_option *row) {
    if (row->type == CS_TABLE)
        return row->table->optional;
    return !cs_value_kind_of(row)->get || (has_default(row) && is_absent(row, NULL));
}

bool cs_table_needs_row(const struct cs_option *row) {
    if (row->type != CS_TABLE || row->table->optional)
        return !has_default(row);
    bool needs = row->table->one_of;
    for (uint32_t r = 0; r < row->table->n; r++)
        needs = needs || cs_table_needs_row(row->table->rows + r);
    return needs;
}

bool cs_option_is_set(const struct cs_option *row, const void *object) {
    const struct cs_value_kind *kind = cs_value_kind_of(row);
    return kind->is_given ? kind->is_given(row, cs_option_value(row, object))
                          : !is_absent(row, object);
}

bool cs_option_is_default(const struct cs_option *row, const void *object) {
    if (cs_option_is_optional(row))
        return !cs_option_is_set(row, object);
    bool same = cs_value_kind_of(row)->get && has_default(row);
    for (uint32_t i = 0; same && i < components_of(row); i++)
        same = value_of(row, object, i) == default_of(row, i);
    return same;
}

const struct cs_option *cs_option_find(const struct cs_table *table, const char *name) {
    for (uint32_t r = 0; r < table->n; r++)
        if (!strcmp(table->rows[r].name, name))
            return table->rows + r;
    return NULL;
}

const char *cs_option_nearest(const struct cs_table *table, const char *name) {
    const char *names[65];
    uint32_t n = 0;
    for (; n < table->n && n < 64; n++)
        names[n] = table->rows[n].name;
    names[n] = NULL;
    return cs_nearest_word(name, names);
}

enum cs_status cs_option_check_range(const struct cs_option *row, double value, int index,
                                     const char *where, enum cs_status status,
                                     struct cs_error *error) {
    char place[16] = "";
    if (index >= 0) {
        place[0] = '[';
        place[1] = (char)('0' + index);
        place[2] = ']';
    }
    struct cs_text range = {0};
    cs_option_print_range(row, &range);
    if (!isfinite(value) || value < row->min || value > row->max)
        cs_fail(error, status, "%s%s: %.12g is out of range (%s)", where, place, value,
                cs_text_get(&range));
    else if (cs_value_kind_of(row)->whole && value != trunc(value))
        cs_fail(error, status, "%s%s: %.12g is not an integer (%s)", where, place, value,
                cs_text_get(&range));
    cs_text_finish(&range);
    return error->status;
}

enum cs_status cs_option_set_number(const struct cs_option *row, void *object, double value,
                                    const char *where, enum cs_status status,
                                    struct cs_error *error) {
    if (cs_option_check_range(row, value, -1, where, status, error))
        return error->status;
    cs_value_kind_of(row)->set(cs_option_field(row, object), 0, value);
    return CS_OK;
}

enum cs_status cs_option_set_choice(const struct cs_option *row, void *object, const char *text,
                                    const char *where, enum cs_status status,
                                    struct cs_error *error) {
    for (int32_t i = 0; row->choices[i]; i++)
        if (!strcmp(row->choices[i], text)) {
            *(int32_t *)cs_option_field(row, object) = i;
            return CS_OK;
        }
    struct cs_text range = {0};
    cs_option_print_range(row, &range);
    const char *nearest = cs_nearest_word(text, row->choices);
    if (nearest)
        cs_fail(error, status, "%s: unknown choice \"%.60s\"; did you mean \"%s\"? (%s)", where,
                text, nearest, cs_text_get(&range));
    else
        cs_fail(error, status, "%s: unknown choice \"%.60s\" (%s)", where, text,
                cs_text_get(&range));
    cs_text_finish(&range);
    return status;
}

/* Parses a switch: true, yes, 1, or false, no, 0. */
static enum cs_status set_bool(bool *field, const char *text, const char *where,
                               enum cs_status status, struct cs_error *error) {
    if (!strcmp(text, "true") || !strcmp(text, "yes") || !strcmp(text, "1"))
        *field = true;
    else if (!strcmp(text, "false") || !strcmp(text, "no") || !strcmp(text, "0"))
        *field = false;
    else
        return cs_fail(error, status, "%s: expected true or false, found \"%.60s\"", where,
                       text);
    return CS_OK;
}

enum cs_status cs_option_set(const struct cs_option *row, void *object, const char *text,
                             const char *where, enum cs_status status, struct cs_error *error) {
    double value = HUGE_VAL;
    if (row->type == CS_BOOL)
        return set_bool(cs_option_field(row, object), text, where, status, error);
    if (row->type == CS_CHOICE)
        return cs_option_set_choice(row, object, text, where, status, error);
    if (row->type == CS_REAL && row->choices && !strcmp(text, row->choices[0])) {
        memcpy(cs_option_field(row, object), &value, sizeof value);
        return CS_OK;
    }
    if (!cs_parse_real(text, &value))
        return cs_fail(error, status, "%s: expected a number, found \"%.60s\"%s", where, text,
                       strstr(text, "..") ? " (a range is for compare and sweep)" : "");
    return cs_option_set_number(row, object, value, where, status, error);
}

/* Appends components, joined by ", ". */
static void print_components(const struct cs_option *row, const void *object,
                             struct cs_text *out) {
    for (uint32_t i = 0; i < components_of(row); i++) {
        cs_text_add(out, i ? ", " : "");
        cs_value_kind_of(row)->print(row, value_of(row, object, i), out);
    }
}

void cs_option_print(const struct cs_option *row, const void *object, struct cs_text *out) {
    const struct cs_value_kind *kind = cs_value_kind_of(row);
    if (row->type == CS_TEXT)
        cs_text_add_json(out, cs_option_value(row, object));
    if (!kind->get)
        return;
    cs_text_add(out, kind->several ? "[" : "");
    print_components(row, object, out);
    cs_text_add(out, kind->several ? "]" : "");
}

void cs_option_print_plain(const struct cs_option *row, const void *object,
                           struct cs_text *out) {
    if (row->type == CS_CHOICE)
        cs_text_add(out, "%s", row->choices[(int32_t)value_of(row, object, 0)]);
    else if (row->choices && isinf(value_of(row, object, 0)))
        cs_text_add(out, "%s", row->choices[0]);
    else
        print_components(row, object, out);
}

void cs_option_print_range(const struct cs_option *row, struct cs_text *out) {
    if (cs_value_kind_of(row)->print_range)
        cs_value_kind_of(row)->print_range(row, out);
}

void cs_option_print_expected(const struct cs_option *row, struct cs_text *out) {
    const struct cs_value_kind *kind = cs_value_kind_of(row);
    const bool number = kind->form == CS_FORM_NUMBER;
    if (kind->several)
        cs_text_add(out, "a list of %u ", row->count);
    cs_text_add(out, "%s%s", kind->expected, number ? " (" : "");
    cs_option_print_range(row, out);
    cs_text_add(out, "%s%s", number ? ")" : "",
                cs_option_takes_one(row) ? ", or one for all" : "");
}

/* The table of the kinds of values. */

/* --- components as doubles --- */

#define COMPONENT(name, type, converted)                                                       \
    static double get_##name(const void *field, uint32_t i) {                                  \
        return (double)((const type *)field)[i];                                               \
    }                                                                                          \
    static void put_##name(void *field, uint32_t i, double value) {                            \
        ((type *)field)[i] = converted;                                                        \
    }
COMPONENT(real, double, value)
COMPONENT(int, int64_t, (int64_t)value)
COMPONENT(bool, bool, value != 0)
COMPONENT(choice, int32_t, (int32_t)value)
#undef COMPONENT

/* --- a component as JSON --- */

static void print_real(const struct cs_option *row, double value, struct cs_text *out) {
    if (row->choices && isinf(value))
        cs_json_write(out, "%s", row->choices[0]);
    else
        cs_text_add_real(out, value);
}

static void print_int(const struct cs_option *row, double value, struct cs_text *out) {
    (void)row;
    cs_text_add(out, "%.0f", value);
}

static void print_bool(const struct cs_option *row, double value, struct cs_text *out) {
    (void)row;
    cs_json_write(out, "%d", value != 0);
}

static void print_choice(const struct cs_option *row, double value, struct cs_text *out) {
    cs_json_write(out, "%s", value < 0 ? NULL : row->choices[(int32_t)value]);
}

/* --- what may be absent --- */

static bool is_text_given(const struct cs_option *row, const void *field) {
    (void)row;
    return *(const char *)field;
}

/* an optional struct begins with its bool `present` */
static bool is_table_given(const struct cs_option *row, const void *field) {
    return !row->table->optional || (field && *(const bool *)field);
}

static bool is_list_given(const struct cs_option *row, const void *field) {
    (void)row;
    return ((const struct cs_list *)field)->n > 0;
}

/* --- what is accepted --- */

static void print_number_range(const struct cs_option *row, struct cs_text *out) {
    cs_text_add_real(out, row->min);
    cs_text_add(out, "..");
    cs_text_add_real(out, row->max);
    if (row->unit && *row->unit)
        cs_text_add(out, " %s", row->unit);
    if (row->choices)
        cs_text_add(out, " or %s", row->choices[0]);
}

static void print_bool_range(const struct cs_option *row, struct cs_text *out) {
    (void)row;
    cs_text_add(out, "true or false");
}

static void print_choice_range(const struct cs_option *row, struct cs_text *out) {
    for (uint32_t i = 0; row->choices[i]; i++)
        cs_text_add(out, "%s%s", i ? ", " : "", row->choices[i]);
}

static void print_number_schema(const struct cs_option *row, struct cs_text *out) {
    cs_json_write(out, "'type': %s, 'minimum': %g, 'maximum': %g",
                  cs_value_kind_of(row)->schema, row->min, row->max);
}

static void print_numbers_schema(const struct cs_option *row, struct cs_text *out) {
    const bool one = cs_option_takes_one(row);
    if (one)
        cs_json_write(out, "'anyOf': [{ 'type': 'number', 'minimum': %g }, { ", row->min);
    cs_json_write(out, "'type': 'array', 'minItems': %u, 'maxItems': %u, 'items': { ",
                  row->count, row->count);
    print_number_schema(row, out);
    cs_text_add(out, one ? " } }]" : " }");
}

static void print_bool_schema(const struct cs_option *row, struct cs_text *out) {
    (void)row;
    cs_json_write(out, "'type': 'boolean'");
}

static void print_choice_schema(const struct cs_option *row, struct cs_text *out) {
    cs_json_write(out, "'enum': [");
    for (uint32_t i = 0; row->choices[i]; i++)
        cs_json_write(out, ", %s", row->choices[i]);
    cs_text_add(out, "]");
}

static void print_text_schema(const struct cs_option *row, struct cs_text *out) {
    (void)row;
    cs_json_write(out, "'type': 'string', 'maxLength': %u", CS_TEXT_MAX - 1);
}

/* form, several, whole, expected, schema, size, get, set, print, is_given, range, schema */
static const struct cs_value_kind kinds[] = {
    [CS_REAL] = {CS_FORM_NUMBER, false, false, "a number", "number", sizeof(double), get_real,
                 put_real, print_real, NULL, print_number_range, print_number_schema},
    [CS_INT] = {CS_FORM_NUMBER, false, true, "an integer", "integer", sizeof(int64_t), get_int,
                put_int, print_int, NULL, print_number_range, print_number_schema},
    [CS_BOOL] = {CS_FORM_BOOL, false, false, "", NULL, sizeof(bool), get_bool, put_bool,
                 print_bool, NULL, print_bool_range, print_bool_schema},
    [CS_CHOICE] = {CS_FORM_CHOICE, false, true, "one of ", NULL, sizeof(int32_t), get_choice,
                   put_choice, print_choice, NULL, print_choice_range, print_choice_schema},
    [CS_VECTOR] = {CS_FORM_NUMBER, true, false, "numbers", "number", sizeof(double), get_real,
                   put_real, print_real, NULL, print_number_range, print_numbers_schema},
    [CS_COUNTS] = {CS_FORM_NUMBER, true, true, "integers", "integer", sizeof(int64_t), get_int,
                   put_int, print_real, NULL, print_number_range, print_numbers_schema},
    [CS_TEXT] = {.form = CS_FORM_TEXT,
                 .expected = "a string",
                 .size = CS_TEXT_MAX,
                 .is_given = is_text_given,
                 .print_schema = print_text_schema},
    [CS_TABLE] = {.form = CS_FORM_TABLE,
                  .expected = "an object",
                  .size = sizeof(bool),
                  .is_given = is_table_given},
    [CS_LIST] = {.form = CS_FORM_LIST,
                 .expected = "a list",
                 .size = sizeof(struct cs_list),
                 .is_given = is_list_given},
};

const struct cs_value_kind *cs_value_kind_of(const struct cs_option *row) {
    return kinds + row->type;
}
