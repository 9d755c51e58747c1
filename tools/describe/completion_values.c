/* Prints the values that a completion offers for an option: methods, paths of a scene, names.
 */
#include "describe/completion_values.h"

#include "base/options.h"
#include "cli/line/print.h"
#include "export/export.h"
#include "session/scene_view.h"
#include "session/session.h"
#include "study/compare/compare_cell.h"

#include <stdio.h>
#include <string.h>

/* Words of placeholders; with a comma in it a list of them. */
static const char *const *words_of(const struct cs_arg *row) {
    const char *value = row->value;
    return row->names                       ? row->names
           : !strcmp(value, "COLUMN")       ? cs_column_axes()
           : !strcmp(value, "FORMAT[,...]") ? cs_export_format_names
           : !strcmp(value, "VALUE[,...]")  ? cs_export_value_names
                                            : NULL;
}

enum cs_completion_source cs_completion_source_of(const char *value) {
    if (!strcmp(value, "LIST"))
        return CS_COMPLETE_METHODS;
    if (!strncmp(value, "NAME[:", 6) || !strncmp(value, "NAME:", 5) || !strcmp(value, "[NAME]"))
        return CS_COMPLETE_METHOD;
    if (!strncmp(value, "PATH=", 5))
        return CS_COMPLETE_PATHS;
    if (!strncmp(value, "DIR", 3))
        return CS_COMPLETE_FOLDERS;
    return strstr(value, "FILE") || strstr(value, "SCENE") || strstr(value, "CSV")
               ? CS_COMPLETE_FILES
               : CS_COMPLETE_NOTHING;
}

enum cs_completion_source cs_completion_source_of_row(const struct cs_arg *row) {
    return !row->value     ? CS_COMPLETE_NOTHING
           : words_of(row) ? CS_COMPLETE_WORDS
                           : cs_completion_source_of(row->value);
}

/* The word that is completed, and the words that it may become. */
struct word {
    const char *text; /* as it is typed so far */
    size_t start;     /* of the item in it that is completed */
    struct cs_text *out;
};

static void offer(const struct word *word, const char *item, const char *end) {
    const char *typed = word->text + word->start;
    if (!strncmp(item, typed, strlen(typed)))
        cs_text_add(word->out, "%.*s%s%s\n", (int)word->start, word->text, item, end);
}

static void offer_all(const struct word *word, const char *const *items) {
    for (; items && *items; items++)
        offer(word, *items, "");
}

/* Start of the item behind the last separator. */
static size_t item_start(const char *text, const char *separators) {
    size_t start = strlen(text);
    while (start > 0 && !strchr(separators, text[start - 1]))
        start--;
    return start;
}

/* The row of a key of that length, or NULL. */
static const struct cs_option *find_key(const struct cs_table *table, const char *key,
                                        size_t length) {
    for (const struct cs_option *row = table->rows; row < table->rows + table->n; row++)
        if (strlen(row->name) == length && !strncmp(row->name, key, length))
            return row;
    return NULL;
}

/* Keys of a table, or behind "key=" the names that the key takes. */
static void offer_keys(struct word *word, const struct cs_table *table) {
    static const char *const switches[] = {"true", "false", NULL};
    const size_t length = strcspn(word->text + word->start, "=");
    const bool valued = word->text[word->start + length] == '=';
    const struct cs_option *row =
        valued ? find_key(table, word->text + word->start, length) : NULL;
    if (row) {
        word->start += length + 1;
        offer_all(word, row->type == CS_BOOL ? switches : row->choices);
    }
    for (row = table->rows; !valued && row < table->rows + table->n; row++)
        offer(word, row->name, !row->table ? "=" : row->type == CS_LIST ? "[0]." : ".");
}

/* NAME:key=value,key=value, and in a list, behind a comma, the next NAME. */
static void complete_methods(struct word *word, bool list) {
    struct cs_registry registry = {0};
    struct cs_error ignored = {0};
    const struct cs_registry_entry *entry;
    const char *text = word->text, *colon = strrchr(text, ':');
    uint32_t n;
    word->start = item_start(text, ",:");
    if (word->start ? list && text[word->start - 1] == ',' : true)
        offer_all(word, cs_registry_names(&registry, true, &n, &ignored));
    /* behind a colon the options of the method before it, up to the next method */
    if (colon) {
        char name[64];
        const char *first = colon;
        while (first > text && first[-1] != ',')
            first--;
        snprintf(name, sizeof name, "%.*s", (int)(colon - first), first);
        if (!cs_registry_find(&registry, name, &entry, &ignored))
            offer_keys(word, &(struct cs_table){.rows = entry->integrator->options,
                                                .n = entry->integrator->n_options});
    }
    cs_registry_finish(&registry);
}

/* One step of a path at a time: bodies[0]. springs. stretch= */
static void complete_path(struct word *word) {
    static const char method[] = "integrator.name=";
    const struct cs_table *table = &cs_scene_table;
    if (!strncmp(word->text, method, sizeof method - 1)) {
        struct word name = {word->text + sizeof method - 1, 0, &(struct cs_text){0}};
        complete_methods(&name, false);
        cs_print_lines(method, cs_text_get(name.out), word->out);
        cs_text_finish(name.out);
        return;
    }
    const size_t end = strcspn(word->text, "=");
    for (size_t dot; (dot = word->start + strcspn(word->text + word->start, ".")) < end;) {
        const char *key = word->text + word->start;
        const struct cs_option *row = find_key(table, key, strcspn(key, ".["));
        if (!row || !row->table)
            return;
        table = row->table;
        word->start = dot + 1;
    }
    /* the keys of an integrator are in no table; these two all scenes may have */
    if (!word->start) {
        offer(word, "integrator.name", "=");
        offer(word, "integrator.dt", "=");
    }
    offer_keys(word, table);
}

/* True for the long name and its singular (--integrator for --integrators). */
static bool is_name(const struct cs_arg *row, const char *name) {
    const size_t n = strlen(name);
    return !strncmp(row->name, name, n) && (!row->name[n] || !strcmp(row->name + n, "s"));
}

/* The row of "--name" or "-n" that takes a value, or NULL. */
static const struct cs_arg *find_row(const struct cs_command *command, const char *option) {
    for (const struct cs_arg *row = command->rows; row < command->rows + command->n_rows; row++)
        if (row->value && *option == '-' &&
            (option[1] == '-' ? is_name(row, option + 2)
                              : row->short_name && option[1] == row->short_name && !option[2]))
            return row;
    return NULL;
}

void cs_completion_print_values(const struct cs_command *command, const char *option,
                                const char *text, struct cs_text *out) {
    const struct cs_arg *row = find_row(command, option);
    const enum cs_completion_source source =
        row ? cs_completion_source_of_row(row) : cs_completion_source_of(command->operands);
    struct word word = {.text = text, .out = out};
    if (source == CS_COMPLETE_METHOD || source == CS_COMPLETE_METHODS)
        complete_methods(&word, source == CS_COMPLETE_METHODS);
    else if (source == CS_COMPLETE_PATHS)
        complete_path(&word);
    else if (source == CS_COMPLETE_WORDS) {
        word.start = strchr(row->value, ',') ? item_start(text, ",") : 0;
        offer_all(&word, words_of(row));
    }
}
