/* Fills structs from JSON values by their option tables: one reader per form of value. */
#include "scene/file/json_context.h"

#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

/* Fails with "found ..., expected ..." for a row. */
static enum cs_status fail_row(struct cs_json_context *context, const struct cs_json *value,
                               const struct cs_option *row) {
    struct cs_text expected = {0};
    cs_option_print_expected(row, &expected);
    // of a list of the wrong length also what its numbers are
    if (row->count > 1 && cs_json_kind_of(value) == CS_JSON_LIST)
        cs_text_add(&expected, ": %.*s", (int)strcspn(row->help, ";"), row->help);
    const enum cs_status status =
        cs_json_context_fail_type(context, value, cs_text_get(&expected));
    cs_text_finish(&expected);
    return status;
}

/* Passes on an option function's message, without the ": " that follows an empty position. */
static enum cs_status pass_on(struct cs_json_context *context, const struct cs_json *value,
                              const struct cs_error *said) {
    return said->status ? cs_json_context_fail(context, value, false, "%s", said->message + 2)
                        : CS_OK;
}

/* Stores a number in range as component i. The range check gets index -1, because the context's
 * path names the component already. */
static enum cs_status read_component(struct cs_json_context *context,
                                     const struct cs_json *value, const struct cs_option *row,
                                     uint32_t i, void *object) {
    struct cs_error said = {0};
    const double number = cs_json_number(value);
    if (!cs_option_check_range(row, number, -1, "", CS_ERR_SCENE, &said))
        cs_value_kind_of(row)->set(cs_option_field(row, object), i, number);
    return pass_on(context, value, &said);
}

/* Reads a number, or a list of exactly as many as the row has. */
static enum cs_status read_number(struct cs_json_context *context, const struct cs_json *value,
                                  const struct cs_option *row, void *object) {
    if (!cs_value_kind_of(row)->several)
        return cs_json_kind_of(value) == CS_JSON_NUMBER
                   ? read_component(context, value, row, 0, object)
                   : fail_row(context, value, row);
    uint32_t i = 0;
    /* one number for all components */
    if (cs_option_takes_one(row) && cs_json_kind_of(value) == CS_JSON_NUMBER) {
        while (i < row->count && !read_component(context, value, row, i, object))
            i++;
        return context->error->status;
    }
    if (cs_json_kind_of(value) != CS_JSON_LIST || cs_json_count(value) != row->count)
        return fail_row(context, value, row);
    for (const struct cs_json *c = cs_json_first(value); c; c = cs_json_next(c), i++) {
        const size_t outside = cs_json_context_enter_at(context, i);
        if (cs_json_kind_of(c) != CS_JSON_NUMBER)
            return cs_json_context_fail_type(context, c, "a number");
        if (read_component(context, c, row, i, object))
            return context->error->status;
        cs_json_context_leave(context, outside);
    }
    return CS_OK;
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
    *(bool *)cs_option_field(row, object) = cs_json_is_true(value);
    return CS_OK;
}

/* Reads a text that fits into CS_TEXT_MAX bytes with its end. */
static enum cs_status read_text(struct cs_json_context *context, const struct cs_json *value,
                                const struct cs_option *row, void *object) {
    if (cs_json_kind_of(value) != CS_JSON_TEXT)
        return fail_row(context, value, row);
    const size_t length = strlen(cs_json_text(value));
    if (length >= CS_TEXT_MAX)
        return cs_json_context_fail(context, value, false,
                                    "found a string of %zu bytes, expected at most %d", length,
                                    CS_TEXT_MAX - 1);
    memcpy(cs_option_field(row, object), cs_json_text(value), length + 1);
    return CS_OK;
}

/* Reads a list into an array of the arena. */
static enum cs_status read_list(struct cs_json_context *context, const struct cs_json *value,
                                const struct cs_option *row, void *object) {
    if (cs_json_kind_of(value) != CS_JSON_LIST)
        return fail_row(context, value, row);
    struct cs_list *list = cs_option_field(row, object);
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

static enum cs_status read_table(struct cs_json_context *context, const struct cs_json *value,
                                 const struct cs_option *row, void *object) {
    void *field = cs_option_field(row, object);
    if (!field) {
        // apart and optional: there is none until it is read
        field = cs_arena_alloc(context->arena, row->table->size, context->error);
        if (!field)
            return context->error->status;
        cs_options_default(row->table, field);
        *(void **)(void *)((char *)object + row->offset) = field;
    }
    return cs_table_read(context, value, row->table, field);
}

/* Reads a value in the form of its row. */
static enum cs_status read_row(struct cs_json_context *context, const struct cs_json *value,
                               const struct cs_option *row, void *object) {
    static enum cs_status (*const readers[CS_VALUE_FORMS])(
        struct cs_json_context *, const struct cs_json *, const struct cs_option *,
        void *) = {[CS_FORM_NUMBER] = read_number, [CS_FORM_BOOL] = read_bool,
                   [CS_FORM_CHOICE] = read_choice, [CS_FORM_TEXT] = read_text,
                   [CS_FORM_TABLE] = read_table,   [CS_FORM_LIST] = read_list};
    return readers[cs_value_kind_of(row)->form](context, value, row, object);
}

/* The most similar key, or NULL. */
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

/* Adds the paths that end with these keys, so many tables below a table: "forces.gravity". */
static void add_paths(const struct cs_table *table, const char *path, const char *keys,
                      uint32_t below, struct cs_text *out) {
    const char *dot = strrchr(keys, '.'), *last = dot ? dot + 1 : keys;
    char inner[CS_TEXT_MAX];
    if (!below && cs_option_find(table, last)) {
        snprintf(inner, sizeof inner, "%s%s", path, last);
        if (cs_path_ends_with(inner, keys))
            cs_text_add(out, "%s%s", out->length ? " or " : "", inner);
    }
    for (uint32_t r = 0; below && r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        snprintf(inner, sizeof inner, "%s%s%s.", path, row->name,
                 row->type == CS_LIST ? "[0]" : "");
        if (row->table)
            add_paths(row->table, inner, keys, below - 1, out);
    }
}

/* Adds the paths that end with these keys, below this table, else in the whole scene, of the
 * least depth. */
static void add_nearest_paths(const struct cs_table *table, const char *keys,
                              struct cs_text *out) {
    /* the ends of paths are rarer than single keys */
    const uint32_t depth = strchr(keys, '.') ? 4 : 3;
    for (uint32_t below = 1; below < depth && !out->length; below++)
        add_paths(table, "", keys, below, out);
    for (uint32_t below = 0; below < depth && !out->length; below++)
        add_paths(&cs_scene_table, "", keys, below, out);
}

/* Adds the name or the paths that an unknown key most probably stands for. Returns true where
 * nothing but a key of the same name elsewhere says so. */
static bool suggest_key(const struct cs_table *table, const char *place, const char *apart,
                        const char *key, struct cs_text *out) {
    const char *near = nearest_key(table, apart, key);
    const char *other = cs_foreign_key(place, key, table);
    // "pin" is "pins" of this object rather than "pin" of another one
    if (!other && near && !strncmp(near, key, strlen(key)))
        other = near;
    if (!other || !cs_option_find(table, other))
        add_nearest_paths(table, other ? other : key, out);
    if (out->length)
        return !other;
    // the keys of an integrator are in no table
    if (other || near)
        cs_text_add(out, "%s", other ? other : near);
    return false;
}

/* Adds the keys of a table, if they are few. */
static void add_keys(const struct cs_table *table, struct cs_text *out) {
    enum { MOST = 12 };
    for (uint32_t r = 0; r < table->n && table->n <= MOST; r++)
        cs_text_add(out, "%s%s", r ? ", " : ", expected one of ", table->rows[r].name);
}

/* Fails with what the key may stand for. */
static enum cs_status fail_unknown(struct cs_json_context *context,
                                   const struct cs_json *member, const struct cs_table *table,
                                   const char *apart) {
    const char *key = cs_json_key(member);
    struct cs_text other = {0}, own = {0};
    char place[sizeof context->path];
    const size_t length = context->path_length - strlen(key);
    snprintf(place, sizeof place, "%.*s", (int)(length ? length - 1 : 0), context->path);
    const bool guessed = suggest_key(table, place, apart, key, &other);
    const bool any = other.length && !other.failed;
    /* a key that is right elsewhere, without a path: the scene's own */
    const bool top = any && !strcmp(cs_text_get(&other), key);
    const char *end = top ? "\" at the top of the scene?" : any ? "\"?" : "";
    if (!any || (guessed && !top))
        add_keys(table, &own);
    cs_json_context_fail(context, member, true, "unknown key%s%s%s%s", cs_text_get(&own),
                         any ? "; did you mean \"" : "", cs_text_get(&other), end);
    cs_text_finish(&own);
    cs_text_finish(&other);
    return context->error->status;
}

/* Reads a member of an object by its key; passes over the user's own keys. On failure the path
 * of the context stays at the member. */
static enum cs_status read_member(struct cs_json_context *context, const struct cs_json *member,
                                  const struct cs_table *table, void *object) {
    const char *key = cs_json_key(member);
    const char *apart = context->path_length ? NULL : context->skipped_key;
    if (cs_key_is_free(key) || (apart && !strcmp(key, apart)))
        return CS_OK;
    const size_t outside = cs_json_context_enter(context, key);
    const struct cs_option *row = cs_option_find(table, key);
    if (!row)
        return fail_unknown(context, member, table, apart);
    const enum cs_status status = read_row(context, member, row, object);
    if (!status)
        cs_json_context_leave(context, outside);
    return status;
}

/* Checks that exactly one of the optional rows is present. */
static enum cs_status check_one_of(struct cs_json_context *context, const struct cs_json *value,
                                   const struct cs_table *table, const void *object) {
    struct cs_text given = {0}, choices = {0};
    uint32_t n = 0;
    for (uint32_t r = table->n_always_optional; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        if (!cs_option_is_optional(row))
            continue;
        cs_text_add(&choices, "%s%s", choices.length ? ", " : "", row->name);
        if (cs_option_is_set(row, object))
            cs_text_add(&given, "%s%s", n++ ? " and " : "", row->name);
    }
    if (n != 1)
        cs_json_context_fail(context, value, false, "found %s, expected exactly one of %s",
                             n ? cs_text_get(&given) : "none", cs_text_get(&choices));
    cs_text_finish(&given);
    cs_text_finish(&choices);
    return n == 1 ? CS_OK : context->error->status;
}

/* Checks that values without a default are present, also in a table that is absent itself,
 * unless it is optional; value is then the nearest one that is present. */
static enum cs_status check_complete(struct cs_json_context *context,
                                     const struct cs_json *value, bool absent,
                                     const struct cs_table *table, const void *object) {
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        if (!cs_table_needs_row(row) || (!absent && cs_json_find(value, row->name)))
            continue;
        const size_t outside = cs_json_context_enter(context, row->name);
        /* a row without a default is a list of numbers or a table that holds one */
        if (row->type != CS_TABLE) {
            struct cs_text expected = {0};
            cs_option_print_expected(row, &expected);
            cs_json_context_fail(context, value, false, "missing, expected %s",
                                 cs_text_get(&expected));
            cs_text_finish(&expected);
        } else {
            /* the table itself may be absent: the message names the value that it lacks */
            check_complete(context, value, true, row->table, cs_option_value(row, object));
        }
        if (context->error->status)
            return context->error->status;
        cs_json_context_leave(context, outside);
    }
    return table->one_of ? check_one_of(context, value, table, object) : CS_OK;
}

/* Fails with what may stand there: an object with some of its keys, or a short form. */
static enum cs_status fail_not_object(struct cs_json_context *context,
                                      const struct cs_json *value,
                                      const struct cs_table *table) {
    enum { KEYS = 4 };
    struct cs_text expected = {0};
    cs_text_add(&expected, "an object");
    for (uint32_t r = 0; r < table->n && r < KEYS; r++)
        cs_text_add(&expected, "%s\"%s\"", r ? ", " : " (", table->rows[r].name);
    cs_text_add(&expected, table->n > KEYS ? ", ...)" : ")");
    if (table->shorthand_text)
        cs_text_add(&expected, " or a string");
    if (table->shorthand_number || table->shorthand_list)
        cs_text_add(&expected, " or a %s", table->shorthand_number ? "number" : "list");
    const enum cs_status status =
        cs_json_context_fail_type(context, value, cs_text_get(&expected));
    cs_text_finish(&expected);
    return status;
}

enum cs_status cs_table_read(struct cs_json_context *context, const struct cs_json *value,
                             const struct cs_table *table, void *object) {
    if (table->optional)
        *(bool *)object = true;
    const struct cs_option *shorthand = cs_json_shorthand(table, value);
    if (shorthand)
        return read_row(context, value, shorthand, object);
    if (cs_json_kind_of(value) != CS_JSON_OBJECT)
        return fail_not_object(context, value, table);
    for (const struct cs_json *m = cs_json_first(value); m; m = cs_json_next(m))
        if (read_member(context, m, table, object))
            return context->error->status;
    return check_complete(context, value, false, table, object);
}
