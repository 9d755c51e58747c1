/* Reads a list of methods with options and ranges, and makes the cells of each method. */
#include "study/compare/cell_list_parse.h"

#include "base/options.h"
#include "sim/module.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Reads "LOW..HIGH" or one number. Both ends are checked as values of the option. */
static enum cs_status set_range(struct cs_cell_list_entry *entry, const char *key,
                                const char *value, struct cs_error *error) {
    const char *dots = strstr(value, "..");
    char *low = strndup(value, dots ? (size_t)(dots - value) : strlen(value));
    const char *high = dots ? dots + 2 : low;
    if (!low)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a range");
    const bool numbers = cs_parse_real(low, &entry->low) && cs_parse_real(high, &entry->high);
    if (dots && !(numbers && 0 < entry->low && entry->low <= entry->high))
        cs_fail(error, CS_ERR_USAGE,
                "integrator \"%s\": %s: expected a number or LOW..HIGH, found \"%.60s\"",
                entry->method.integrator->name, key, value);
    else if (!cs_method_set(&entry->method, key, low, NULL, CS_ERR_USAGE, error))
        cs_method_set(&entry->method, key, high, NULL, CS_ERR_USAGE, error);
    free(low);
    return error->status;
}

/* Sets one option of the method, or the range of its control. */
static enum cs_status set_option(struct cs_cell_list_entry *entry, const char *key,
                                 const char *value, struct cs_error *error) {
    return strcmp(key, entry->control)
               ? cs_method_set(&entry->method, key, value, NULL, CS_ERR_USAGE, error)
               : set_range(entry, key, value, error);
}

/* Begins an entry with a method, which it owns from now on. The control is rtol of an adaptive
 * method, else dt, if the method has it. */
static enum cs_status begin_entry(struct cs_cell_list_entry *entry,
                                  struct cs_registry *registry, const struct cs_method *method,
                                  struct cs_error *error) {
    const struct cs_registry_entry *registered;
    const struct cs_integrator *integrator = method->integrator;
    *entry = (struct cs_cell_list_entry){
        .method = *method, .low = (double)NAN, .high = (double)NAN, .control = ""};
    if (cs_registry_find(registry, integrator->name, &registered, error))
        return error->status;
    cs_module_hash(registered->file, entry->module);
    const char *control = integrator->traits & CS_ADAPTIVE ? "rtol" : "dt";
    if (cs_option_find(&method->table, control))
        entry->control = control;
    return CS_OK;
}

/* Names the series after method and options, unless the list gives a name. */
static enum cs_status end_entry(struct cs_cell_list_entry *entry, const char *name,
                                struct cs_error *error) {
    struct cs_text fixed = {0};
    if (cs_method_check(&entry->method, NULL, CS_ERR_USAGE, error) ||
        cs_series_name(&entry->method, entry->control, entry->series, error))
        return error->status;
    if (*name)
        memcpy(entry->series, name, sizeof entry->series);
    cs_method_add_options(&entry->method, entry->control, &fixed);
    if (fixed.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the options of a method");
    else if (fixed.length >= sizeof entry->fixed)
        cs_fail(error, CS_ERR_USAGE,
                "integrator \"%s\": options of more than %zu characters in one method",
                entry->method.integrator->name, sizeof entry->fixed - 1);
    else
        memcpy(entry->fixed, cs_text_get(&fixed), fixed.length + 1);
    cs_text_finish(&fixed);
    return error->status;
}

/* Reads one item of the list, with its options, into cells. */
static enum cs_status read_method(struct cs_cell_list *sweep, struct cs_registry *registry,
                                  const struct cs_cell_list_settings *settings, char *item,
                                  struct cs_error *error) {
    struct cs_cell_list_entry entry = {0};
    char name[CS_SERIES_BYTES];
    const char *pairs, *key, *value, *text = item;
    if (!cs_series_parse_name(&text, name, error) &&
        !cs_method_find(&entry.method, registry, text, &pairs, error) &&
        !cs_series_check_name(registry, name, &entry.method, error)) {
        const struct cs_method method = entry.method;
        char *rest = pairs ? item + (pairs - item) : NULL; // of the writable list
        begin_entry(&entry, registry, &method, error);
        while (!error->status && rest &&
               !cs_method_parse_pair(method.integrator->name, &rest, &key, &value, error))
            set_option(&entry, key, value, error);
        if (!error->status && !end_entry(&entry, name, error))
            cs_cell_list_expand(sweep, &entry, settings, error);
    }
    cs_method_finish(&entry.method);
    return error->status;
}

/* Makes cells of all methods of the registry with their defaults. */
static enum cs_status take_all(struct cs_cell_list *sweep, struct cs_registry *registry,
                               const struct cs_cell_list_settings *settings,
                               struct cs_error *error) {
    if (cs_registry_open_all(registry, error))
        return error->status;
    for (uint32_t k = 0; k < registry->n && !error->status; k++) {
        struct cs_method method;
        struct cs_cell_list_entry entry;
        if (!registry->entries[k].integrator)
            continue;
        if (!cs_method_init(&method, registry->entries[k].integrator, NULL, error) &&
            !begin_entry(&entry, registry, &method, error) && !end_entry(&entry, "", error))
            cs_cell_list_expand(sweep, &entry, settings, error);
        cs_method_finish(&method);
    }
    return error->status;
}

enum cs_status cs_cell_list_parse(struct cs_cell_list *sweep,
                                  const struct cs_cell_list_settings *settings,
                                  struct cs_error *error) {
    struct cs_registry registry = {0};
    char *list = settings->list ? strdup(settings->list) : NULL;
    *sweep = (struct cs_cell_list){0};
    cs_registry_add_files(&registry, settings->plugins, settings->n_plugins, error);
    if (settings->list && !list)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of methods");
    for (char *rest = list; rest && !error->status;)
        read_method(sweep, &registry, settings, cs_method_split(&rest), error);
    if (!settings->list && !error->status)
        take_all(sweep, &registry, settings, error);
    free(list);
    cs_registry_finish(&registry);
    if (error->status)
        cs_cell_list_finish(sweep);
    return error->status;
}

enum cs_status cs_cell_list_add_modules(const char *list, struct cs_arena *arena,
                                        const char *const **plugins, uint32_t *n_plugins,
                                        struct cs_error *error) {
    const uint32_t most = *n_plugins + (uint32_t)strlen(list) / 2 + 1;
    const char **all = cs_arena_alloc_array(arena, most, sizeof *all, error);
    char *rest = cs_arena_copy_text(arena, list, error);
    if (error->status)
        return error->status;
    if (*n_plugins)
        memcpy(all, *plugins, *n_plugins * sizeof *all);
    while (rest) {
        char *item = cs_method_split(&rest), name[CS_SERIES_BYTES];
        const char *method = item;
        struct cs_error unread = {0}; // reported when the list is read
        if (cs_series_parse_name(&method, name, &unread))
            continue;
        item += method - item;
        item[strcspn(item, ":")] = 0;
        if (strchr(item, '/'))
            all[(*n_plugins)++] = item;
    }
    *plugins = all;
    return CS_OK;
}
