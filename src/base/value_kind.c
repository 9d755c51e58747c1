/* The table of the kinds of values. */
#include "base/value_kind.h"

#include "base/json_writer.h"

/* --- components as doubles --- */

static double get_real(const void *field, uint32_t i) {
    return ((const double *)field)[i];
}
static void set_real(void *field, uint32_t i, double value) {
    ((double *)field)[i] = value;
}
static double get_int(const void *field, uint32_t i) {
    return (double)((const int64_t *)field)[i];
}
static void set_int(void *field, uint32_t i, double value) {
    ((int64_t *)field)[i] = (int64_t)value;
}
static double get_bool(const void *field, uint32_t i) {
    return ((const bool *)field)[i];
}
static void set_bool(void *field, uint32_t i, double value) {
    ((bool *)field)[i] = value != 0;
}
static double get_choice(const void *field, uint32_t i) {
    return ((const int32_t *)field)[i];
}
static void set_choice(void *field, uint32_t i, double value) {
    ((int32_t *)field)[i] = (int32_t)value;
}

/* --- a component as JSON --- */

static void print_real(const struct cs_option *row, double value, struct cs_text *out) {
    (void)row;
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
    return !row->table->optional || *(const bool *)field;
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
    cs_json_write(out, "'type': 'array', 'minItems': %u, 'maxItems': %u, 'items': { ",
                  row->count, row->count);
    print_number_schema(row, out);
    cs_text_add(out, " }");
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
                 set_real, print_real, NULL, print_number_range, print_number_schema},
    [CS_INT] = {CS_FORM_NUMBER, false, true, "an integer", "integer", sizeof(int64_t), get_int,
                set_int, print_int, NULL, print_number_range, print_number_schema},
    [CS_BOOL] = {CS_FORM_BOOL, false, false, "", NULL, sizeof(bool), get_bool, set_bool,
                 print_bool, NULL, print_bool_range, print_bool_schema},
    [CS_CHOICE] = {CS_FORM_CHOICE, false, true, "one of ", NULL, sizeof(int32_t), get_choice,
                   set_choice, print_choice, NULL, print_choice_range, print_choice_schema},
    [CS_VECTOR] = {CS_FORM_NUMBER, true, false, "numbers", "number", sizeof(double), get_real,
                   set_real, print_real, NULL, print_number_range, print_numbers_schema},
    [CS_COUNTS] = {CS_FORM_NUMBER, true, true, "integers", "integer", sizeof(int64_t), get_int,
                   set_int, print_real, NULL, print_number_range, print_numbers_schema},
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
