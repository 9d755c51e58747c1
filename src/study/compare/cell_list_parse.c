/* Reads a list of methods with options and ranges, and makes the cells of each method. */
#include "study/compare/cell_list_parse.h"

#include "base/options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One method of a list, while it is read. */
struct cs_cell_list_entry {
    struct cs_method method;
    char series[CS_SERIES_BYTES];
    char fixed[sizeof((struct cs_cell *)0)->fixed]; /* options without the swept one */
    const char *control;                            /* "dt", "rtol" or "" */
    double low, high;                               /* of the control; NAN: the default sweep */
    char module[CS_HASH_DIGITS]; /* hash of the file: a rebuilt module is a different one */
};

/* Expands a method to its steps or tolerances. */

/* Steps of a default range, each half of the last, of which only those are run that are worth
 * it (compare.c); and the limit of cells in any range. */
enum { DEFAULT_STEPS = 20, MOST_POINTS = 64 };

/* First step of an explicit method in units of 2/omega. omega is an upper bound: the true limit
 * is up to 1.5 times longer for the leap-frog, and about twice for Runge-Kutta methods. 2.2 is
 * just beyond both, so a series begins with an unstable step. */
#define BEYOND_LIMIT 2.2

/* Appends "name=value" to a list of options. */
static void add_option(char *options, size_t size, const char *name, double value) {
    char number[CS_REAL_DIGITS];
    const size_t used = strlen(options);
    cs_print_real(value, number);
    snprintf(options + used, size - used, "%s%s=%s", used ? "," : "", name, number);
}

/* Marks a cell as refused, with the reason. */
static void refuse_cell(struct cs_cell *cell, const char *why) {
    snprintf(cell->outcome, sizeof cell->outcome, "refused");
    snprintf(cell->note, sizeof cell->note, "%.239s", why);
}

/* A cell with the options that all cells of the entry share. */
static void init_cell(struct cs_cell *cell, const struct cs_cell_list_entry *entry) {
    const struct cs_integrator *integrator = entry->method.integrator;
    cs_cell_init(cell, integrator->name);
    memcpy(cell->series, entry->series, sizeof cell->series);
    memcpy(cell->fixed, entry->fixed, sizeof cell->fixed);
    snprintf(cell->family, sizeof cell->family, "%s", cs_family_of(integrator));
    memcpy(cell->module, entry->module, sizeof cell->module);
    cell->declared_order = cs_method_order(integrator, entry->method.options, false);
    cell->adaptive = integrator->traits & CS_ADAPTIVE;
    snprintf(cell->options, sizeof cell->options, "%s", entry->fixed);
}

/* Sets the values of the control that a cell of the entry may have: those of its range, or all
 * that the option takes, up to one step per frame. */
static void set_limits(struct cs_cell *cell, const struct cs_cell_list_entry *entry,
                       double fps) {
    const struct cs_option *row = cs_option_find(&entry->method.table, entry->control);
    cell->open = isnan(entry->high);
    cell->low = cell->open ? row->min : entry->low;
    cell->high = cell->open ? cell->adaptive ? row->max : 1 / fps : entry->high;
}

/* Adds the cell of one step or tolerance. */
static enum cs_status add_point(struct cs_cell_list *list,
                                const struct cs_cell_list_entry *entry, double value,
                                const struct cs_cell_list_settings *settings,
                                struct cs_error *error) {
    struct cs_cell cell;
    init_cell(&cell, entry);
    snprintf(cell.control, sizeof cell.control, "%s", entry->control);
    if (*entry->control) {
        set_limits(&cell, entry, settings->fps);
        cell.value = value;
        add_option(cell.options, sizeof cell.options, entry->control, value);
    }
    return cs_cell_list_add(list, &cell, error);
}

void cs_cell_derive(struct cs_cell *cell, const struct cs_cell *of, double value) {
    cs_cell_init(cell, of->method);
    memcpy(cell->series, of->series, sizeof cell->series);
    memcpy(cell->fixed, of->fixed, sizeof cell->fixed);
    memcpy(cell->family, of->family, sizeof cell->family);
    memcpy(cell->control, of->control, sizeof cell->control);
    memcpy(cell->options, of->fixed, sizeof of->fixed);
    cell->adaptive = of->adaptive;
    cell->low = of->low;
    cell->high = of->high;
    cell->open = of->open;
    cell->declared_order = of->declared_order;
    if (!*of->control)
        return;
    cell->value = value;
    add_option(cell->options, sizeof cell->options, of->control, value);
}

/* Default range: rtol from 1e-2 to 1e-13 of an adaptive method; DEFAULT_STEPS steps from one
 * frame down of a fixed one. Explicit methods begin just beyond their stability limit. */
static void default_range(const struct cs_cell_list_entry *entry,
                          const struct cs_cell_list_settings *settings, double *high,
                          double *low) {
    const struct cs_option *row = cs_option_find(&entry->method.table, entry->control);
    if (entry->method.integrator->traits & CS_ADAPTIVE) {
        *high = fmin(1e-2, row->max);
        *low = fmax(1e-13, row->min);
        return;
    }
    *high = 1 / settings->fps;
    if (!(entry->method.integrator->traits & CS_IMPLICIT))
        while (*high > 2 * BEYOND_LIMIT * 2 / settings->omega)
            *high /= 2;
    *low = fmax(*high / (1 << (DEFAULT_STEPS - 1)), row->min);
}

/* Adds the cells of the entry over its range, or over the default range. A method of another
 * model gets one refused cell. CS_ERR_USAGE, CS_ERR_MEMORY. */
static enum cs_status expand_entry(struct cs_cell_list *list,
                                   const struct cs_cell_list_entry *entry,
                                   const struct cs_cell_list_settings *settings,
                                   struct cs_error *error) {
    double high = entry->high, low = entry->low;
    if (entry->method.integrator->fidelity == CS_FIDELITY_OTHER) {
        struct cs_cell cell;
        init_cell(&cell, entry);
        refuse_cell(
            &cell,
            "its model is not the equation of motion: an error against it has no meaning");
        return cs_cell_list_add(list, &cell, error);
    }
    if (!*entry->control)
        return add_point(list, entry, (double)NAN, settings, error);
    if (isnan(high))
        default_range(entry, settings, &high, &low);
    const bool adaptive = entry->method.integrator->traits & CS_ADAPTIVE;
    for (int k = 0; k < MOST_POINTS; k++) {
        // powers, so that 1e-3 is 1e-3 to the bit and a step halves exactly
        const double value =
            adaptive ? high * pow(10, -0.5 * k) : high / (double)(UINT64_C(1) << k);
        if (value < low * (1 - 1e-9) || add_point(list, entry, value, settings, error))
            break;
    }
    return error->status;
}

/* Inserts a copy at an index; the capacity doubles when it is used up. */
static enum cs_status insert(struct cs_cell_list *list, uint32_t at, const struct cs_cell *cell,
                             struct cs_error *error) {
    if (list->n == list->capacity) {
        const uint32_t capacity = list->capacity ? 2 * list->capacity : 64;
        struct cs_cell *cells = realloc(list->cells, capacity * sizeof *cells);
        if (!cells)
            return cs_fail(error, CS_ERR_MEMORY, "out of memory for %u cells", capacity);
        list->cells = cells;
        list->capacity = capacity;
    }
    struct cs_cell *place = list->cells + at;
    memmove(place + 1, place, (list->n++ - at) * sizeof *place);
    *place = *cell;
    return CS_OK;
}

/* Reports two different methods under one series name. */
static enum cs_status refuse_series(const struct cs_cell *one, const struct cs_cell *other,
                                    struct cs_error *error) {
    return cs_fail(error, CS_ERR_USAGE,
                   "series \"%s\" is %s%s%s and %s%s%s: give one of them another name",
                   one->series, one->method, *one->fixed ? ":" : "", one->fixed, other->method,
                   *other->fixed ? ":" : "", other->fixed);
}

/* Walks the whole series: a duplicate can be anywhere, and the place is before the first
 * smaller value. */
enum cs_status cs_cell_list_add(struct cs_cell_list *list, const struct cs_cell *cell,
                                struct cs_error *error) {
    uint32_t at = list->n;
    for (uint32_t k = 0; k < list->n; k++) {
        const struct cs_cell *other = list->cells + k;
        if (!cs_cell_same_series(other, cell))
            continue;
        if (strcmp(other->method, cell->method) != 0 || strcmp(other->fixed, cell->fixed) != 0)
            return refuse_series(other, cell, error);
        if (!strcmp(other->options, cell->options))
            return CS_OK;
        at = k + 1;
        if (other->value < cell->value) {
            at = k;
            break;
        }
    }
    return insert(list, at, cell, error);
}

/* Replaces the cells of the series in place; the cells after it move up. */
void cs_cell_list_refuse(struct cs_cell_list *list, uint32_t first, const char *why) {
    const struct cs_cell *of = list->cells + first;
    struct cs_cell cell;
    uint32_t next = first + 1;
    cs_cell_init(&cell, of->method);
    memcpy(cell.series, of->series, sizeof cell.series);
    memcpy(cell.fixed, of->fixed, sizeof cell.fixed);
    refuse_cell(&cell, why);
    while (next < list->n && cs_cell_same_series(list->cells + next, &cell))
        next++;
    memmove(list->cells + first + 1, list->cells + next,
            (list->n - next) * sizeof *list->cells);
    list->n -= next - first - 1;
    list->cells[first] = cell;
}

void cs_cell_list_drop_unrun(struct cs_cell_list *list) {
    uint32_t kept = 0;
    for (uint32_t k = 0; k < list->n; k++)
        if (*list->cells[k].outcome)
            list->cells[kept++] = list->cells[k];
    list->n = kept;
}

void cs_cell_list_finish(struct cs_cell_list *list) {
    free(list->cells);
    *list = (struct cs_cell_list){0};
}

void cs_cell_integrator(const struct cs_cell *cell, char *out, size_t size) {
    snprintf(out, size, "%s%s%s", cell->method, *cell->options ? ":" : "", cell->options);
}

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
    if (cs_registry_find(registry, integrator->name, &registered, error) ||
        cs_hash_file(registered->file, NULL, entry->module, error))
        return error->status;
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
static enum cs_status read_method(struct cs_cell_list *list, struct cs_registry *registry,
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
            expand_entry(list, &entry, settings, error);
    }
    cs_method_finish(&entry.method);
    return error->status;
}

/* Makes the cells of a method with one of its variants; NULL: with its defaults. */
static enum cs_status read_variant(struct cs_cell_list *list, struct cs_registry *registry,
                                   const struct cs_cell_list_settings *settings,
                                   const char *name, const char *variant,
                                   struct cs_error *error) {
    char item[CS_CELL_INTEGRATOR];
    snprintf(item, sizeof item, "%s%s%s", name, variant ? ":" : "", variant ? variant : "");
    return read_method(list, registry, settings, item, error);
}

/* Makes cells of all methods of the registry with their defaults, and of their variants. */
static enum cs_status take_all(struct cs_cell_list *list, struct cs_registry *registry,
                               const struct cs_cell_list_settings *settings,
                               struct cs_error *error) {
    if (cs_registry_open_all(registry, error))
        return error->status;
    for (uint32_t k = 0; k < registry->n && !error->status; k++) {
        const struct cs_integrator *integrator = registry->entries[k].integrator;
        if (!integrator)
            continue;
        read_variant(list, registry, settings, integrator->name, NULL, error);
        const char *const *variant = CS_HAS(integrator, variants) ? integrator->variants : NULL;
        for (; variant && *variant && !error->status; variant++)
            read_variant(list, registry, settings, integrator->name, *variant, error);
    }
    return error->status;
}

enum cs_status cs_cell_list_parse(struct cs_cell_list *cells,
                                  const struct cs_cell_list_settings *settings,
                                  struct cs_error *error) {
    struct cs_registry registry = {0};
    char *list = settings->list ? strdup(settings->list) : NULL;
    *cells = (struct cs_cell_list){0};
    cs_registry_add_files(&registry, settings->plugins, settings->n_plugins, error);
    if (settings->list && !list)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of methods");
    for (char *rest = list; rest && !error->status;)
        read_method(cells, &registry, settings, cs_method_split(&rest), error);
    if (!settings->list && !error->status)
        take_all(cells, &registry, settings, error);
    free(list);
    cs_registry_finish(&registry);
    if (error->status)
        cs_cell_list_finish(cells);
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
