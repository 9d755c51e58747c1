/* Makes the cells of a comparison from a list of methods with steps or tolerances. */
#include "study/compare/sweep.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/options.h"
#include "sim/method.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_STEPS = 8, MOST_POINTS = 64, MODULE_BYTES_MAX = 1 << 28 };

/* First step of an explicit method in units of the safe bound 2/omega, which is up to 1.5 times
 * below the limit of the leap-frog and twice below that of Runge-Kutta. */
#define BEYOND_LIMIT 2.2

/* One method of the list on its way to cells. */
struct entry {
    struct cs_method method;
    char fixed[128]; /* options without the swept one */
    const char *control;
    double low, high; /* NAN: the default sweep */
    bool atol_is_fixed;
    char module[CS_HASH_DIGITS]; /* hash of the file: a module built anew is another one */
};

enum cs_status cs_sweep_insert(struct cs_sweep *sweep, uint32_t at, const struct cs_cell *cell,
                               struct cs_error *error) {
    if (sweep->n == sweep->capacity) {
        const uint32_t capacity = sweep->capacity ? 2 * sweep->capacity : 64;
        struct cs_cell *cells = realloc(sweep->cells, capacity * sizeof *cells);
        if (!cells)
            return cs_fail(error, CS_ERR_MEMORY, "out of memory for %u cells", capacity);
        sweep->cells = cells;
        sweep->capacity = capacity;
    }
    struct cs_cell *place = sweep->cells + at;
    memmove(place + 1, place, (sweep->n++ - at) * sizeof *place);
    *place = *cell;
    return CS_OK;
}

static void add_option(char *options, size_t size, const char *name, double value) {
    struct cs_text number = {0};
    const size_t used = strlen(options);
    cs_text_add_real(&number, value);
    snprintf(options + used, size - used, "%s%s=%s", used ? "," : "", name,
             cs_text_get(&number));
    cs_text_finish(&number);
}

static enum cs_status add_point(struct cs_sweep *sweep, const struct entry *entry, double value,
                                struct cs_error *error) {
    struct cs_cell cell;
    cs_cell_init(&cell, entry->method.integrator->name);
    snprintf(cell.family, sizeof cell.family, "%s", cs_family_of(entry->method.integrator));
    snprintf(cell.key, sizeof cell.key, "%s", entry->module);
    cell.adaptive = entry->method.integrator->traits & CS_ADAPTIVE;
    snprintf(cell.options, sizeof cell.options, "%s", entry->fixed);
    snprintf(cell.control, sizeof cell.control, "%s", entry->control);
    if (*entry->control) {
        cell.value = value;
        add_option(cell.options, sizeof cell.options, entry->control, value);
    }
    const struct cs_option *atol = cs_option_find(&entry->method.table, "atol");
    if (cell.adaptive && *entry->control && atol && !entry->atol_is_fixed)
        add_option(cell.options, sizeof cell.options, "atol",
                   fmin(fmax(value, atol->min), atol->max));
    return cs_sweep_insert(sweep, sweep->n, &cell, error);
}

static struct cs_cell refused(const char *name, const char *why) {
    struct cs_cell cell;
    cs_cell_init(&cell, name);
    snprintf(cell.outcome, sizeof cell.outcome, "refused");
    snprintf(cell.note, sizeof cell.note, "%.239s", why);
    return cell;
}

void cs_sweep_refuse(struct cs_sweep *sweep, uint32_t first, const char *why) {
    const struct cs_cell cell = refused(sweep->cells[first].method, why);
    uint32_t next = first + 1;
    while (next < sweep->n && !strcmp(sweep->cells[next].method, cell.method))
        next++;
    memmove(sweep->cells + first + 1, sweep->cells + next,
            (sweep->n - next) * sizeof *sweep->cells);
    sweep->n -= next - first - 1;
    sweep->cells[first] = cell;
}

/* what the default sweep goes over, largest first */
static void default_range(const struct entry *entry, const struct cs_sweep_settings *settings,
                          double *high, double *low) {
    const struct cs_option *row = cs_option_find(&entry->method.table, entry->control);
    if (entry->method.integrator->traits & CS_ADAPTIVE) {
        *high = fmin(1e-2, row->max);
        *low = fmax(1e-9, row->min);
        return;
    }
    *high = 1 / settings->fps;
    if (!(entry->method.integrator->traits & CS_IMPLICIT))
        while (*high > 2 * BEYOND_LIMIT * 2 / settings->omega)
            *high /= 2;
    *low = fmax(*high / (1 << (DEFAULT_STEPS - 1)), row->min);
}

static enum cs_status expand(struct cs_sweep *sweep, const struct entry *entry,
                             const struct cs_sweep_settings *settings, struct cs_error *error) {
    double high = entry->high, low = entry->low;
    if (entry->method.integrator->fidelity == CS_FIDELITY_OTHER) {
        const struct cs_cell cell = refused(entry->method.integrator->name,
                                            "another model than the equation of "
                                            "motion: an error against it has no meaning");
        return cs_sweep_insert(sweep, sweep->n, &cell, error);
    }
    if (!*entry->control)
        return add_point(sweep, entry, (double)NAN, error);
    if (isnan(high))
        default_range(entry, settings, &high, &low);
    const bool adaptive = entry->method.integrator->traits & CS_ADAPTIVE;
    for (int k = 0; k < MOST_POINTS; k++) {
        // powers, so that 1e-3 is 1e-3 to the bit and a step halves exactly
        const double value =
            adaptive ? high * pow(10, -0.5 * k) : high / (double)(UINT64_C(1) << k);
        if (value < low * (1 - 1e-9) || add_point(sweep, entry, value, error))
            break;
    }
    return error->status;
}

static enum cs_status set_fixed(struct entry *entry, const char *key, const char *value,
                                struct cs_error *error) {
    const size_t used = strlen(entry->fixed);
    if (cs_method_set(&entry->method, key, value, NULL, CS_ERR_USAGE, error))
        return error->status;
    if (used + strlen(key) + strlen(value) + 2 >= sizeof entry->fixed)
        return cs_fail(error, CS_ERR_USAGE,
                       "integrator \"%s\": options of more than %zu characters in one method",
                       entry->method.integrator->name, sizeof entry->fixed - 1);
    entry->atol_is_fixed |= !strcmp(key, "atol");
    snprintf(entry->fixed + used, sizeof entry->fixed - used, "%s%s=%s", used ? "," : "", key,
             value);
    return CS_OK;
}

/* "low..high" or one number: both ends are checked as one number is */
static enum cs_status set_range(struct entry *entry, const char *key, const char *value,
                                struct cs_error *error) {
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

static enum cs_status set_option(struct entry *entry, const char *key, const char *value,
                                 struct cs_error *error) {
    return strcmp(key, entry->control) ? set_fixed(entry, key, value, error)
                                       : set_range(entry, key, value, error);
}

static void hash_module(const char *file, char digits[CS_HASH_DIGITS]) {
    char *bytes;
    size_t length;
    struct cs_error unread = {0};
    if (!cs_file_read(file, MODULE_BYTES_MAX, &bytes, &length, &unread))
        cs_hash_bytes(bytes, length, digits);
    free(bytes);
}

/* Takes the method over. */
static enum cs_status begin_entry(struct entry *entry, struct cs_registry *registry,
                                  const struct cs_method *method, struct cs_error *error) {
    const struct cs_registered *registered;
    const struct cs_integrator *integrator = method->integrator;
    *entry = (struct entry){
        .method = *method, .low = (double)NAN, .high = (double)NAN, .control = ""};
    if (cs_registry_find(registry, integrator->name, &registered, error))
        return error->status;
    hash_module(registered->file, entry->module);
    const char *control = integrator->traits & CS_ADAPTIVE ? "rtol" : "dt";
    if (cs_option_find(&method->table, control))
        entry->control = control;
    return CS_OK;
}

/* One method of the list, with its options. */
static enum cs_status read_method(struct cs_sweep *sweep, struct cs_registry *registry,
                                  const struct cs_sweep_settings *settings, char *text,
                                  struct cs_error *error) {
    struct cs_method method;
    struct entry entry = {0};
    const char *pairs, *key, *value;
    if (!cs_method_find(&method, registry, text, &pairs, error)) {
        char *rest = pairs ? text + (pairs - text) : NULL; // of the writable list
        begin_entry(&entry, registry, &method, error);
        while (!error->status && rest &&
               !cs_method_take_pair(method.integrator->name, &rest, &key, &value, error))
            set_option(&entry, key, value, error);
        if (!error->status)
            expand(sweep, &entry, settings, error);
    }
    cs_method_finish(&method);
    return error->status;
}

static enum cs_status take_all(struct cs_sweep *sweep, struct cs_registry *registry,
                               const struct cs_sweep_settings *settings,
                               struct cs_error *error) {
    if (cs_registry_open_all(registry, error))
        return error->status;
    for (uint32_t k = 0; k < registry->n && !error->status; k++) {
        struct cs_method method;
        struct entry entry;
        if (!registry->entries[k].integrator)
            continue;
        if (!cs_method_init(&method, registry->entries[k].integrator, NULL, error) &&
            !begin_entry(&entry, registry, &method, error))
            expand(sweep, &entry, settings, error);
        cs_method_finish(&method);
    }
    return error->status;
}

enum cs_status cs_sweep_make(struct cs_sweep *sweep, const struct cs_sweep_settings *settings,
                             struct cs_error *error) {
    struct cs_registry registry = {0};
    char *list = settings->list ? strdup(settings->list) : NULL;
    *sweep = (struct cs_sweep){0};
    for (uint32_t k = 0; k < settings->n_plugins && !error->status; k++)
        cs_registry_add_file(&registry, settings->plugins[k], error);
    if (settings->list && !list)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of methods");
    for (char *rest = list; rest && !error->status;)
        read_method(sweep, &registry, settings, cs_method_split(&rest), error);
    if (!settings->list && !error->status)
        take_all(sweep, &registry, settings, error);
    free(list);
    cs_registry_finish(&registry);
    if (error->status)
        cs_sweep_finish(sweep);
    return error->status;
}

void cs_sweep_finish(struct cs_sweep *sweep) {
    free(sweep->cells);
    *sweep = (struct cs_sweep){0};
}

void cs_cell_integrator(const struct cs_cell *cell, char *out, size_t size) {
    snprintf(out, size, "%s%s%s", cell->method, *cell->options ? ":" : "", cell->options);
}
