/* Reads the values of options into the struct of their command, and checks them. */
#include "cli/line/option_row.h"

#include "base/text.h"
#include "sim/method.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum cs_status read_whole(const struct cs_arg *row, const char *text, uint32_t *value,
                                 struct cs_error *error) {
    const size_t digits = strspn(text, "0123456789");
    const unsigned long read = digits <= 10 ? strtoul(text, NULL, 10) : row->max + 1ul;
    if (!digits || text[digits] || read < row->min || read > row->max)
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected an integer from %u to %u, found \"%.60s\"", row->name,
                       row->min, row->max, text);
    *value = (uint32_t)read;
    return CS_OK;
}

enum cs_status cs_arg_refuse_name(const char *option, const char *const *names,
                                  const char *text, struct cs_error *error) {
    struct cs_text list = {0};
    for (int i = 0; names[i]; i++)
        cs_text_add(&list, "%s%s", i ? ", " : "", names[i]);
    cs_fail(error, CS_ERR_USAGE, "--%s: expected one of %s, found \"%.60s\"", option,
            cs_text_get(&list), text);
    cs_text_finish(&list);
    return error->status;
}

/* Reads a name as its number, or as its bit in the set of those given. */
static enum cs_status read_name(const struct cs_arg *row, const char *text, uint32_t *value,
                                struct cs_error *error) {
    for (uint32_t i = 0; row->names[i]; i++)
        if (!strcmp(row->names[i], text)) {
            *value = row->repeatable ? *value | 1u << i : i;
            return CS_OK;
        }
    return cs_arg_refuse_name(row->name, row->names, text, error);
}

static enum cs_status read_real(const struct cs_arg *row, const char *text, double *value,
                                struct cs_error *error) {
    double read = 0;
    if (!cs_parse_real(text, &read) || !(read > 0 && read <= 1e9))
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected a number above 0 and up to 1e9, found \"%.60s\"",
                       row->name, text);
    *value = read;
    return CS_OK;
}

static enum cs_status read_shard(const struct cs_arg *row, const char *text,
                                 struct cs_shard *shard, struct cs_error *error) {
    char end;
    unsigned number, of;
    if (strspn(text, "0123456789/") < strlen(text) || strlen(text) > 13 ||
        sscanf(text, "%u/%u%c", &number, &of, &end) != 2 || number < 1 || number > of)
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected K/N with K from 1 to N, found \"%.60s\"", row->name,
                       text);
    *shard = (struct cs_shard){number, of};
    return CS_OK;
}

/* A list field of the command's struct. */
struct list {
    const struct cs_arg *row;
    char *options;
    struct cs_arena *arena;
};

/* Returns a place for one more item at the end of a list; NULL if out of memory. The capacity
 * is the next power of two of the count, so it is not stored: a full list has a count of 0 or a
 * power of two. Old arrays stay in the arena. */
static void *append(const struct list *list, size_t size, struct cs_error *error) {
    char *field = list->options + list->row->offset;
    uint32_t *n = (uint32_t *)(list->options + list->row->count);
    char *items;
    memcpy(&items, field, sizeof items);
    /* the room is a power of two */
    if ((*n & (*n - 1)) == 0) {
        char *larger = cs_arena_alloc_array(list->arena, *n ? 2 * (size_t)*n : 1, size, error);
        if (!larger)
            return NULL;
        if (*n)
            memcpy(larger, items, *n * size);
        items = larger;
        memcpy(field, &items, sizeof items);
    }
    return items + size * (*n)++;
}

/* Appends a text of argv. */
static enum cs_status add_word(const struct list *list, const char *text,
                               struct cs_error *error) {
    const char **word = append(list, sizeof *word, error);
    if (word)
        *word = text;
    return error->status;
}

/* Appends the methods of a list; commas within options do not separate. */
static enum cs_status add_methods(const struct list *list, const char *text,
                                  struct cs_error *error) {
    char *rest = cs_arena_copy_text(list->arena, text, error);
    while (rest && !error->status)
        add_word(list, cs_method_split(&rest), error);
    return error->status;
}

/* Splits PATH=VALUE; the copy is the arena's. */
static enum cs_status add_override(const struct list *list, const char *text,
                                   struct cs_error *error) {
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return cs_fail(error, CS_ERR_USAGE, "--%s: expected PATH=VALUE, found \"%.60s\"",
                       list->row->name, text);
    char *path = cs_arena_copy_text(list->arena, text, error);
    struct cs_override *override = append(list, sizeof *override, error);
    if (!path || !override)
        return error->status;
    path[equals - text] = 0;
    *override = (struct cs_override){path, path + (equals - text) + 1};
    return CS_OK;
}

enum cs_status cs_arg_read(const struct cs_arg *row, const char *text, void *options,
                           struct cs_arena *arena, struct cs_error *error) {
    void *field = (char *)options + row->offset;
    const struct list list = {row, options, arena};
    switch (row->kind) {
    case CS_ARG_SWITCH:
        *(bool *)field = !*(bool *)field;
        break;
    case CS_ARG_TEXT:
        *(const char **)field = text;
        break;
    case CS_ARG_WHOLE:
        return row->names ? read_name(row, text, field, error)
                          : read_whole(row, text, field, error);
    case CS_ARG_REAL:
        return read_real(row, text, field, error);
    case CS_ARG_SHARD:
        return read_shard(row, text, field, error);
    case CS_ARG_WORDS:
        return row->methods ? add_methods(&list, text, error) : add_word(&list, text, error);
    case CS_ARG_OVERRIDES:
        return add_override(&list, text, error);
    }
    return CS_OK;
}
