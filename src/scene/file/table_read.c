/* Fills structs from JSON values as their option tables say. */
#include "scene/file/table_read.h"

#include "base/options.h"
#include "scene/file/table_required.h"

#include <string.h>

static void *field_of(const struct cs_option *row, void *object) {
    return (char *)object + row->offset;
}

static enum cs_status fail_row(struct cs_json_context *context, const struct cs_json *value,
                               const struct cs_option *row) {
    struct cs_text expected = {0};
    cs_table_add_expected(row, &expected);
    const enum cs_status status =
        cs_json_context_fail_type(context, value, cs_text_get(&expected));
    cs_text_finish(&expected);
    return status;
}

/* passes on what an option function said, without the ": " that follows an empty position */
static enum cs_status pass_on(struct cs_json_context *context, const struct cs_json *value,
                              const struct cs_error *said) {
    return said->status ? cs_json_context_fail(context, value, false, "%s", said->message + 2)
                        : CS_OK;
}

static enum cs_status read_number(struct cs_json_context *context, const struct cs_json *value,
                                  const struct cs_option *row, void *object) {
    struct cs_error said = {0};
    if (cs_json_kind_of(value) != CS_JSON_NUMBER)
        return fail_row(context, value, row);
    cs_option_set_number(row, object, cs_json_number(value), "", CS_ERR_SCENE, &said);
    return pass_on(context, value, &said);
}

static enum cs_status read_choice(struct cs_json_context *context, const struct cs_json *value,
                                  const struct cs_option *row, void *object) {
    struct cs_error said = {0};
    if (cs_json_kind_of(value) != CS_JSON_TEXT)
        return fail_row(context, value, row);
    cs_option_set_choice(row, object, cs_json_text(value), "", CS_ERR_SCENE, &said);
    return pass_on(context, value, &said);
}

static enum cs_status read_bool(struct cs_json_context *context, const struct cs_json *value,
                                const struct cs_option *row, void *object) {
    if (cs_json_kind_of(value) != CS_JSON_BOOL)
        return fail_row(context, value, row);
    *(bool *)field_of(row, object) = cs_json_is_true(value);
    return CS_OK;
}

static enum cs_status read_text(struct cs_json_context *context, const struct cs_json *value,
                                const struct cs_option *row, void *object) {
    if (cs_json_kind_of(value) != CS_JSON_TEXT)
        return fail_row(context, value, row);
    const size_t length = strlen(cs_json_text(value));
    if (length >= CS_TEXT_MAX)
        return cs_json_context_fail(context, value, false,
                                    "found a text of %zu bytes, expected at most %d", length,
                                    CS_TEXT_MAX - 1);
    memcpy(field_of(row, object), cs_json_text(value), length + 1);
    return CS_OK;
}

/* VECTOR and COUNTS */
static enum cs_status read_components(struct cs_json_context *context,
                                      const struct cs_json *value, const struct cs_option *row,
                                      void *object) {
    if (cs_json_kind_of(value) != CS_JSON_LIST || cs_json_count(value) != row->count)
        return fail_row(context, value, row);
    uint32_t i = 0;
    for (const struct cs_json *c = cs_json_first(value); c; c = cs_json_next(c), i++) {
        struct cs_error said = {0};
        const size_t outside = cs_json_context_enter_at(context, i);
        if (cs_json_kind_of(c) != CS_JSON_NUMBER)
            return cs_json_context_fail_type(context, c, "a number");
        const double number = cs_json_number(c);
        /* index -1: the reader's path names the component already */
        cs_option_check_range(row, number, -1, "", CS_ERR_SCENE, &said);
        if (pass_on(context, c, &said))
            return context->error->status;
        if (row->type == CS_VECTOR)
            ((double *)field_of(row, object))[i] = number;
        else
            ((int64_t *)field_of(row, object))[i] = (int64_t)number;
        cs_json_context_leave(context, outside);
    }
    return CS_OK;
}

static enum cs_status read_list(struct cs_json_context *context, const struct cs_json *value,
                                const struct cs_option *row, void *object) {
    if (cs_json_kind_of(value) != CS_JSON_LIST)
        return fail_row(context, value, row);
    struct cs_list *list = field_of(row, object);
    const uint32_t n = cs_json_count(value);
    /* the default is an empty list already */
    if (!n)
        return CS_OK;
    char *items = cs_arena_alloc_array(context->arena, n, row->table->size, context->error);
    if (!items)
        return context->error->status;
    uint32_t i = 0;
    for (const struct cs_json *item = cs_json_first(value); item;
         item = cs_json_next(item), i++) {
        const size_t outside = cs_json_context_enter_at(context, i);
        /* defaults first: the file need not give every key of an element */
        cs_options_default(row->table, items + i * row->table->size);
        if (cs_table_read(context, item, row->table, items + i * row->table->size))
            return context->error->status;
        cs_json_context_leave(context, outside);
    }
    list->items = items;
    list->n = n;
    return CS_OK;
}

static enum cs_status read_row(struct cs_json_context *context, const struct cs_json *value,
                               const struct cs_option *row, void *object) {
    /* no default case, so that the compiler reports a type that is missing here */
    switch (row->type) {
    case CS_REAL:
    case CS_INT:
        return read_number(context, value, row, object);
    case CS_BOOL:
        return read_bool(context, value, row, object);
    case CS_CHOICE:
        return read_choice(context, value, row, object);
    case CS_VECTOR:
    case CS_COUNTS:
        return read_components(context, value, row, object);
    case CS_TEXT:
        return read_text(context, value, row, object);
    case CS_TABLE:
        return cs_table_read(context, value, row->table, field_of(row, object));
    case CS_LIST:
        return read_list(context, value, row, object);
    }
    return CS_OK;
}

/* the row that a plain text, number or list stands for, or NULL */
static const struct cs_option *shorthand_of(const struct cs_table *table,
                                            const struct cs_json *value) {
    const enum cs_json_kind kind = cs_json_kind_of(value);
    if (kind == CS_JSON_TEXT && table->shorthand_text)
        return cs_option_find(table, table->shorthand_text);
    if (kind == CS_JSON_NUMBER && table->shorthand_number)
        return cs_option_find(table, table->shorthand_number);
    if (kind == CS_JSON_LIST && table->shorthand_list)
        return cs_option_find(table, table->shorthand_list);
    return NULL;
}

/* the key that was meant, or NULL */
static const char *nearest_key(const struct cs_table *table, const char *apart,
                               const char *key) {
    const char *names[66];
    uint32_t n = 0;
    for (; n < table->n && n < 64; n++)
        names[n] = table->rows[n].name;
    names[n] = apart;
    names[n + 1] = NULL;
    return cs_nearest_word(key, names);
}

/* the new name, if the table has it, of a key that had another one; or NULL */
static const char *new_name(const struct cs_table *table, const char *key) {
    static const char *const names[][2] = {{"prod", "viewpoint_force"},
                                           {"prods", "viewpoint_forces"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(key, names[i][0]) && cs_option_find(table, names[i][1]))
            return names[i][1];
    return NULL;
}

static enum cs_status read_member(struct cs_json_context *context, const struct cs_json *member,
                                  const struct cs_table *table, void *object) {
    const char *key = cs_json_key(member);
    const char *apart = context->path_length ? NULL : context->skipped_key;
    if (cs_key_is_free(key) || (apart && !strcmp(key, apart)))
        return CS_OK;
    const size_t outside = cs_json_context_enter(context, key);
    const struct cs_option *row = cs_option_find(table, key);
    if (!row) {
        const char *renamed = new_name(table, key);
        if (renamed)
            return cs_json_context_fail(context, member, true, "this key is now called \"%s\"",
                                        renamed);
        const char *nearest = nearest_key(table, apart, key);
        return nearest ? cs_json_context_fail(context, member, true,
                                              "unknown key; did you mean \"%s\"?", nearest)
                       : cs_json_context_fail(context, member, true, "unknown key");
    }
    const enum cs_status status = read_row(context, member, row, object);
    if (!status)
        cs_json_context_leave(context, outside);
    return status;
}

enum cs_status cs_table_read(struct cs_json_context *context, const struct cs_json *value,
                             const struct cs_table *table, void *object) {
    if (table->optional)
        *(bool *)object = true;
    const struct cs_option *shorthand = shorthand_of(table, value);
    if (shorthand)
        return read_row(context, value, shorthand, object);
    if (cs_json_kind_of(value) != CS_JSON_OBJECT)
        return cs_json_context_fail_type(context, value,
                                         table->shorthand_number
                                             ? "an object, a text or a number"
                                         : table->shorthand_list ? "an object, a text or a list"
                                         : table->shorthand_text ? "an object or a text"
                                                                 : "an object");
    for (const struct cs_json *m = cs_json_first(value); m; m = cs_json_next(m))
        if (read_member(context, m, table, object))
            return context->error->status;
    return cs_table_check_complete(context, value, table, object);
}
