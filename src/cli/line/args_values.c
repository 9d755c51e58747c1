/* Reads the values of options as numbers, choices and overrides, and checks them. */
#include "cli/line/args.h"
#include "sim/method.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum cs_status cs_args_integer(const struct cs_args *args, uint32_t row, uint32_t min,
                               uint32_t max, uint32_t *value, struct cs_error *error) {
    const char *text = cs_args_get(args, row);
    if (!text)
        return CS_OK;
    const size_t digits = strspn(text, "0123456789");
    const unsigned long read = digits <= 10 ? strtoul(text, NULL, 10) : max + 1ul;
    if (!digits || text[digits] || read < min || read > max)
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected a whole number from %u to %u, found \"%.60s\"",
                       args->command->rows[row].name, min, max, text);
    *value = (uint32_t)read;
    return CS_OK;
}

enum cs_status cs_args_methods(struct cs_args *args, uint32_t row, const char *const **methods,
                               uint32_t *n, struct cs_error *error) {
    size_t most = 0;
    for (uint32_t i = 0; i < args->n_given; i++)
        if (args->given[i].row == row)
            most += strlen(args->given[i].value) + 1;
    const char **all = cs_arena_alloc_array(&args->arena, most, sizeof *all, error);
    *n = 0;
    for (uint32_t i = 0; i < args->n_given && !error->status; i++) {
        if (args->given[i].row != row)
            continue;
        char *rest = cs_arena_copy_text(&args->arena, args->given[i].value, error);
        while (rest)
            all[(*n)++] = cs_method_split(&rest);
    }
    *methods = all;
    return error->status;
}

enum cs_status cs_args_shard(const struct cs_args *args, uint32_t row, struct cs_shard *shard,
                             struct cs_error *error) {
    const char *text = cs_args_get(args, row);
    char end;
    unsigned number, of;
    if (!text)
        return CS_OK;
    if (strspn(text, "0123456789/") < strlen(text) || strlen(text) > 13 ||
        sscanf(text, "%u/%u%c", &number, &of, &end) != 2 || number < 1 || number > of)
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected K/N with K from 1 to N, found \"%.60s\"",
                       args->command->rows[row].name, text);
    *shard = (struct cs_shard){number, of};
    return CS_OK;
}

enum cs_status cs_args_real(const struct cs_args *args, uint32_t row, double *value,
                            struct cs_error *error) {
    const char *text = cs_args_get(args, row);
    double read = 0;
    if (!text)
        return CS_OK;
    if (!cs_parse_real(text, &read) || !(read > 0 && read <= 1e9))
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected a number above 0 and up to 1e9, found \"%.60s\"",
                       args->command->rows[row].name, text);
    *value = read;
    return CS_OK;
}

/* *index = place of the text among the names */
static enum cs_status find(const struct cs_args *args, uint32_t row, const char *const *names,
                           const char *text, int *index, struct cs_error *error) {
    for (int i = 0; names[i]; i++)
        if (!strcmp(names[i], text)) {
            *index = i;
            return CS_OK;
        }
    struct cs_text list = {0};
    for (int i = 0; names[i]; i++)
        cs_text_add(&list, "%s%s", i ? ", " : "", names[i]);
    cs_fail(error, CS_ERR_USAGE, "--%s: expected one of %s, found \"%.60s\"",
            args->command->rows[row].name, cs_text_get(&list), text);
    cs_text_finish(&list);
    return error->status;
}

enum cs_status cs_args_choice(const struct cs_args *args, uint32_t row,
                              const char *const *names, int *index, struct cs_error *error) {
    const char *text = cs_args_get(args, row);
    return text ? find(args, row, names, text, index, error) : CS_OK;
}

enum cs_status cs_args_choices(struct cs_args *args, uint32_t row, const char *const *names,
                               uint32_t *set, struct cs_error *error) {
    const char *const *texts;
    uint32_t n, found = 0;
    if (cs_args_get_all(args, row, &texts, &n, error))
        return error->status;
    for (uint32_t i = 0; i < n; i++) {
        int index = 0;
        if (find(args, row, names, texts[i], &index, error))
            return error->status;
        found |= 1u << index;
    }
    if (found)
        *set = found;
    return CS_OK;
}

/* Splits PATH=VALUE; the copy lives in the arena. */
static enum cs_status split(struct cs_args *args, const char *option, const char *text,
                            struct cs_override *override, struct cs_error *error) {
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return cs_fail(error, CS_ERR_USAGE, "--%s: expected PATH=VALUE, found \"%.60s\"",
                       option, text);
    char *path = cs_arena_copy_text(&args->arena, text, error);
    if (!path)
        return error->status;
    path[equals - text] = 0;
    *override = (struct cs_override){path, path + (equals - text) + 1};
    return CS_OK;
}

enum cs_status cs_args_overrides(struct cs_args *args, uint32_t row,
                                 const struct cs_override **overrides, uint32_t *n,
                                 struct cs_error *error) {
    const char *const *texts;
    if (cs_args_get_all(args, row, &texts, n, error))
        return error->status;
    struct cs_override *all = cs_arena_alloc_array(&args->arena, *n, sizeof *all, error);
    if (!all)
        return error->status;
    for (uint32_t i = 0; i < *n; i++)
        if (split(args, args->command->rows[row].name, texts[i], all + i, error))
            return error->status;
    *overrides = all;
    return CS_OK;
}
