/* Defaults, checks and printing of any struct by its table of options. */
#include "base/options.h"

#include <math.h>
#include <string.h>

static void *field_of(const struct cs_option *row, void *object) {
    return (char *)object + row->offset;
}
static const void *const_field_of(const struct cs_option *row, const void *object) {
    return (const char *)object + row->offset;
}

/* default of component i of a row */
static double default_of(const struct cs_option *row, uint32_t i) {
    return row->defs ? row->defs[i] : row->def;
}

void cs_options_default(const struct cs_table *table, void *object) {
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        void *field = field_of(row, object);
        switch (row->type) {
        case CS_REAL:
            *(double *)field = row->def;
            break;
        case CS_INT:
            *(int64_t *)field = (int64_t)row->def;
            break;
        case CS_BOOL:
            *(bool *)field = row->def != 0;
            break;
        case CS_CHOICE:
            *(int32_t *)field = (int32_t)row->def;
            break;
        case CS_VECTOR:
            for (uint32_t i = 0; i < row->count; i++)
                ((double *)field)[i] = default_of(row, i);
            break;
        case CS_COUNTS:
            for (uint32_t i = 0; i < row->count; i++)
                ((int64_t *)field)[i] = (int64_t)default_of(row, i);
            break;
        case CS_TEXT:
            memset(field, 0, CS_TEXT_MAX);
            break;
        case CS_TABLE:
            /* an optional struct begins with its bool `present` */
            if (row->table->optional)
                *(bool *)field = false;
            cs_options_default(row->table, field);
            break;
        case CS_LIST:
            *(struct cs_list *)field = (struct cs_list){0};
            break;
        }
    }
}

bool cs_option_is_optional(const struct cs_option *row) {
    switch (row->type) {
    case CS_REAL:
        return isnan(row->def);
    case CS_INT:
        return row->def < row->min;
    case CS_CHOICE:
        return row->def < 0;
    case CS_VECTOR:
        return row->defs && isnan(row->defs[0]);
    case CS_TEXT:
    case CS_LIST:
        return true;
    case CS_TABLE:
        return row->table->optional;
    default:
        return false;
    }
}

bool cs_option_is_set(const struct cs_option *row, const void *object) {
    const void *field = const_field_of(row, object);
    /* absence is coded in the value: NaN, below the range, negative or empty */
    switch (row->type) {
    case CS_REAL:
    case CS_VECTOR:
        return !isnan(*(const double *)field);
    case CS_INT:
        return (double)*(const int64_t *)field >= row->min;
    case CS_CHOICE:
        return *(const int32_t *)field >= 0;
    case CS_TEXT:
        return *(const char *)field;
    case CS_LIST:
        return ((const struct cs_list *)field)->n > 0;
    case CS_TABLE:
        return !row->table->optional || *(const bool *)field;
    default:
        return true;
    }
}

bool cs_option_is_default(const struct cs_option *row, const void *object) {
    const void *field = const_field_of(row, object);
    /* a vector without defaults must be given, and so is never at its default */
    bool same = row->defs;
    if (cs_option_is_optional(row))
        return !cs_option_is_set(row, object);
    switch (row->type) {
    case CS_REAL:
        return *(const double *)field == row->def;
    case CS_INT:
        return (double)*(const int64_t *)field == row->def;
    case CS_BOOL:
        return *(const bool *)field == (row->def != 0);
    case CS_CHOICE:
        return *(const int32_t *)field == (int32_t)row->def;
    case CS_VECTOR:
        for (uint32_t i = 0; i < row->count && same; i++)
            same = ((const double *)field)[i] == row->defs[i];
        return same;
    case CS_COUNTS:
        for (uint32_t i = 0; i < row->count && same; i++)
            same = (double)((const int64_t *)field)[i] == row->defs[i];
        return same;
    default:
        return false;
    }
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
    else if ((row->type == CS_INT || row->type == CS_COUNTS) && value != trunc(value))
        cs_fail(error, status, "%s%s: %.12g is not a whole number (%s)", where, place, value,
                cs_text_get(&range));
    cs_text_finish(&range);
    return error->status;
}

enum cs_status cs_option_set_number(const struct cs_option *row, void *object, double value,
                                    const char *where, enum cs_status status,
                                    struct cs_error *error) {
    if (cs_option_check_range(row, value, -1, where, status, error))
        return error->status;
    if (row->type == CS_REAL)
        *(double *)field_of(row, object) = value;
    else
        *(int64_t *)field_of(row, object) = (int64_t)value;
    return CS_OK;
}

enum cs_status cs_option_set_choice(const struct cs_option *row, void *object, const char *text,
                                    const char *where, enum cs_status status,
                                    struct cs_error *error) {
    for (int32_t i = 0; row->choices[i]; i++)
        if (!strcmp(row->choices[i], text)) {
            *(int32_t *)field_of(row, object) = i;
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
    if (row->type == CS_BOOL)
        return set_bool(field_of(row, object), text, where, status, error);
    if (row->type == CS_CHOICE)
        return cs_option_set_choice(row, object, text, where, status, error);
    double value;
    if (!cs_parse_real(text, &value))
        return cs_fail(error, status, "%s: expected a number, found \"%.60s\"", where, text);
    return cs_option_set_number(row, object, value, where, status, error);
}

void cs_option_print(const struct cs_option *row, const void *object, struct cs_text *out) {
    const void *field = const_field_of(row, object);
    switch (row->type) {
    case CS_REAL:
        cs_text_add_real(out, *(const double *)field);
        break;
    case CS_INT:
        cs_text_add(out, "%lld", (long long)*(const int64_t *)field);
        break;
    case CS_BOOL:
        cs_text_add(out, *(const bool *)field ? "true" : "false");
        break;
    case CS_CHOICE:
        if (*(const int32_t *)field < 0)
            cs_text_add(out, "null");
        else
            cs_text_add_json(out, row->choices[*(const int32_t *)field]);
        break;
    case CS_VECTOR:
    case CS_COUNTS:
        for (uint32_t i = 0; i < row->count; i++) {
            cs_text_add(out, i ? ", " : "[");
            cs_text_add_real(out, row->type == CS_VECTOR ? ((const double *)field)[i]
                                                         : (double)((const int64_t *)field)[i]);
        }
        cs_text_add(out, "]");
        break;
    case CS_TEXT:
        cs_text_add_json(out, field);
        break;
    /* the caller prints these row by row */
    case CS_TABLE:
    case CS_LIST:
        break;
    }
}

void cs_option_print_range(const struct cs_option *row, struct cs_text *out) {
    switch (row->type) {
    case CS_REAL:
    case CS_INT:
    case CS_VECTOR:
    case CS_COUNTS:
        cs_text_add_real(out, row->min);
        cs_text_add(out, "..");
        cs_text_add_real(out, row->max);
        if (row->unit && *row->unit)
            cs_text_add(out, " %s", row->unit);
        break;
    case CS_BOOL:
        cs_text_add(out, "true or false");
        break;
    case CS_CHOICE:
        for (uint32_t i = 0; row->choices[i]; i++)
            cs_text_add(out, "%s%s", i ? ", " : "", row->choices[i]);
        break;
    /* any text; tables and lists have ranges in their own rows */
    case CS_TEXT:
    case CS_TABLE:
    case CS_LIST:
        break;
    }
}
