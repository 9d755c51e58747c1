/* Keeps the path of the value that is being read, and makes messages with file, line and
 * column. */
#include "scene/file/json_context.h"

#include "scene/file/json_check.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum cs_status cs_json_parse_named(const char *name, const char *text, size_t length,
                                   struct cs_json **root, struct cs_error *error) {
    struct cs_json_fault fault = {0};
    uint32_t line, column;
    const enum cs_status status = cs_json_parse(text, length, root, &fault);
    if (status == CS_ERR_MEMORY)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", name);
    if (!status)
        return CS_OK;
    cs_json_locate(text, fault.offset, &line, &column);
    return cs_fail(error, CS_ERR_SCENE, "%s:%u:%u: %s", name, line, column, fault.message);
}

bool cs_key_is_free(const char *key) {
    return !strncmp(key, "x-", 2) || key[0] == '$';
}

/* a path that is too long is cut: it is for messages only */
static size_t append(struct cs_json_context *context, const char *part) {
    const size_t before = context->path_length;
    snprintf(context->path + before, sizeof context->path - before, "%s", part);
    context->path_length += strlen(context->path + before);
    return before;
}

size_t cs_json_context_enter(struct cs_json_context *context, const char *key) {
    const size_t plain = strspn(key, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                     "0123456789_-$");
    struct cs_text part = {0};
    if (plain && !key[plain] && plain < 64) {
        cs_text_add(&part, "%s%s", context->path_length ? "." : "", key);
    } else {
        cs_text_add(&part, "[");
        cs_utf8_add_short(&part, key);
        cs_text_add(&part, "]");
    }
    const size_t before = append(context, cs_text_get(&part));
    cs_text_finish(&part);
    return before;
}

size_t cs_json_context_enter_at(struct cs_json_context *context, uint32_t index) {
    char part[16];
    snprintf(part, sizeof part, "[%u]", index);
    return append(context, part);
}

void cs_json_context_leave(struct cs_json_context *context, size_t length) {
    context->path_length = length;
    context->path[length] = 0;
}

enum cs_status cs_json_context_fail(struct cs_json_context *context,
                                    const struct cs_json *value, bool of_key,
                                    const char *format, ...) {
    char message[512];
    CS_FORMAT(message, format);

    const char *colon = context->path_length ? ": " : "";
    size_t offset;
    if (!cs_json_position(value, context->text, of_key, &offset))
        return cs_fail(context->error, CS_ERR_SCENE, "--set %s%s%s", context->path, colon,
                       message);
    uint32_t line, column;
    cs_json_locate(context->text, offset, &line, &column);
    return cs_fail(context->error, CS_ERR_SCENE, "%s:%u:%u: %s%s%s", context->name, line,
                   column, context->path, colon, message);
}

enum cs_status cs_json_context_fail_type(struct cs_json_context *context,
                                         const struct cs_json *value, const char *expected) {
    struct cs_text found = {0};
    cs_json_describe(value, &found);
    const enum cs_status status = cs_json_context_fail(
        context, value, false, "found %s, expected %s", cs_text_get(&found), expected);
    cs_text_finish(&found);
    return status;
}

const struct cs_option *cs_json_shorthand(const struct cs_table *table,
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

/* Finds and sets values of a JSON tree by a path such as bodies[0].springs.stretch. */

/* One step of a path: a key of an object or an index of a list. */
struct step {
    char key[128]; /* "": an index */
    uint32_t index;
};

/* Reads the step at *at and moves past it; returns false if there is none. */
static bool take_step(const char **at, bool first, struct step *step) {
    const char *s = *at;
    *step = (struct step){0};
    if (*s == '[') {
        const size_t digits = strspn(s + 1, "0123456789");
        /* at most 9 digits, so that the index fits 32 bits */
        if (digits < 1 || digits > 9 || s[1 + digits] != ']')
            return false;
        for (size_t i = 1; i <= digits; i++)
            step->index = 10 * step->index + (uint32_t)(s[i] - '0');
        *at = s + digits + 2;
        return true;
    }
    /* only the first key has no point before it */
    if (!first && *s++ != '.')
        return false;
    const size_t length = strcspn(s, ".[]");
    if (length < 1 || length >= sizeof step->key)
        return false;
    memcpy(step->key, s, length);
    *at = s + length;
    return true;
}

/* The member that a step selects, or NULL. */
static struct cs_json *member_at(const struct cs_json *value, const struct step *step) {
    return step->key[0] ? cs_json_find(value, step->key) : cs_json_at(value, step->index);
}

const struct cs_json *cs_json_nearest(const struct cs_json *root, const char *path) {
    struct step step;
    const struct cs_json *value = root;
    for (const char *at = path; *at && take_step(&at, at == path, &step);) {
        const struct cs_json *member = member_at(value, &step);
        if (!member)
            break;
        value = member;
    }
    return value;
}

/* Checks that a step fits its parent: a key an object, an index a list. */
static enum cs_status check_step(const struct cs_json *parent, const struct step *step,
                                 const char *path, struct cs_error *error) {
    const bool is_key = step->key[0] != 0;
    if (cs_json_kind_of(parent) != (is_key ? CS_JSON_OBJECT : CS_JSON_LIST)) {
        struct cs_text found = {0};
        cs_json_describe(parent, &found);
        if (is_key)
            cs_fail(error, CS_ERR_USAGE, "--set %s: found %s before \"%s\", expected an object",
                    path, cs_text_get(&found), step->key);
        else
            cs_fail(error, CS_ERR_USAGE, "--set %s: found %s before [%u], expected a list",
                    path, cs_text_get(&found), step->index);
        cs_text_finish(&found);
        return error->status;
    }
    /* an index equal to the count is allowed: it appends */
    if (!is_key && step->index > cs_json_count(parent))
        return cs_fail(error, CS_ERR_USAGE,
                       "--set %s: index %u is out of range, expected 0..%u (%u adds one)", path,
                       step->index, cs_json_count(parent), cs_json_count(parent));
    return CS_OK;
}

/* Puts a value at a step of its parent, which owns it from then on. */
static enum cs_status put(struct cs_json *parent, const struct step *step,
                          struct cs_json *value, struct cs_error *error) {
    const bool done = step->key[0] ? cs_json_put(parent, step->key, value)
                                   : cs_json_put_at(parent, step->index, value);
    return done ? CS_OK : cs_fail(error, CS_ERR_MEMORY, "out of memory for --set");
}

/* Returns false for a text that can only be meant as JSON. */
static bool is_bare_word(const char *value) {
    return !strchr("{[\"+-.0123456789", value[strspn(value, " \t\r\n")]) || !*value;
}

/* A hint for a number that is no JSON; "" without one. */
static const char *number_hint(const char *value) {
    if (!isdigit((unsigned char)*value) && *value != '-')
        return "";
    if (strstr(value, ".."))
        return "; a range is for compare and stability, a list of values for sweep";
    return strpbrk(value, "xX, ") ? "; a list has brackets, as in [640, 480], a decimal a point"
                                  : "";
}

/* Parses the value of an override: JSON, or else a bare word. */
static enum cs_status make_value(const char *path, const char *value, struct cs_json **made,
                                 struct cs_error *error) {
    struct cs_json_fault fault = {0};
    enum cs_status status = cs_json_parse(value, strlen(value), made, &fault);
    if (!status) {
        /* the offsets are those of the argument, not of the scene file */
        cs_json_drop_positions(*made);
        return CS_OK;
    }
    /* a bare word is a text, so that the shell needs no second pair of quotes */
    if (status == CS_ERR_SCENE && is_bare_word(value)) {
        if (!cs_utf8_is_plain(value))
            return cs_fail(error, CS_ERR_USAGE,
                           "--set %s: the value is not UTF-8 text without control characters",
                           path);
        *made = cs_json_create_text(value);
        status = *made ? CS_OK : CS_ERR_MEMORY;
    }
    if (status == CS_ERR_MEMORY)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for --set");
    if (status)
        return cs_fail(error, CS_ERR_USAGE,
                       "--set %s: the value is not JSON: %s (at column %zu)%s", path,
                       fault.message, fault.offset + 1, number_hint(value));
    return CS_OK;
}

/* The table of what a step leads to, or NULL: an element of a list has the list's own. */
static const struct cs_table *table_at(const struct cs_table *table, const struct step *step) {
    if (!table || !step->key[0])
        return table;
    const struct cs_option *row = cs_option_find(table, step->key);
    return row ? row->table : NULL;
}

/* Makes of a shorthand before a key the object that it stands for. */
static enum cs_status expand_shorthand(struct cs_json *value, const struct cs_table *table,
                                       const struct step *step, struct cs_error *error) {
    const struct cs_option *row =
        table && step->key[0] ? cs_json_shorthand(table, value) : NULL;
    return !row || cs_json_wrap(value, row->name)
               ? CS_OK
               : cs_fail(error, CS_ERR_MEMORY, "out of memory for --set");
}

/* Descends to the parent of the path's last step, and makes missing objects and lists. */
static enum cs_status make_parents(struct cs_json **parent, const struct cs_table *table,
                                   const char *path, struct step *step,
                                   struct cs_error *error) {
    const char *at = path;
    for (int depth = 1;; depth++) {
        if (depth > CS_JSON_DEPTH_MAX || !take_step(&at, at == path, step))
            return cs_fail(error, CS_ERR_USAGE,
                           "--set %s: not a path, expected one like bodies[0].springs.stretch",
                           path);
        if (expand_shorthand(*parent, table, step, error) ||
            check_step(*parent, step, path, error) || !*at)
            return error->status;
        if (!member_at(*parent, step) &&
            put(*parent, step, cs_json_create(*at == '[' ? CS_JSON_LIST : CS_JSON_OBJECT),
                error))
            return error->status;
        *parent = member_at(*parent, step);
        table = table_at(table, step);
    }
}

enum cs_status cs_json_override(struct cs_json *root, const struct cs_table *table,
                                const char *path, const char *value, struct cs_error *error) {
    struct step step;
    struct cs_json *parent = root, *made = NULL;
    /* its keys get into the scene, and from there into reports */
    if (!cs_utf8_is_plain(path))
        return cs_fail(error, CS_ERR_USAGE,
                       "--set %s: the path is not UTF-8 text without control characters", path);
    if (make_value(path, value, &made, error))
        return error->status;
    if (make_parents(&parent, table, path, &step, error)) {
        cs_json_destroy(made);
        return error->status;
    }
    return put(parent, &step, made, error);
}
