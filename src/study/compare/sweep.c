/* Keeps the cells of a comparison by series, and expands a method into its steps or
 * tolerances. */
#include "study/compare/sweep_entry.h"

#include "base/options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_STEPS = 8, MOST_POINTS = 64 };

/* First step of an explicit method in units of the safe bound 2/omega, which is up to 1.5 times
 * below the limit of the leap-frog and twice below that of Runge-Kutta. */
#define BEYOND_LIMIT 2.2

static enum cs_status insert(struct cs_sweep *sweep, uint32_t at, const struct cs_cell *cell,
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

static enum cs_status refuse_series(const struct cs_cell *one, const struct cs_cell *other,
                                    struct cs_error *error) {
    return cs_fail(error, CS_ERR_USAGE,
                   "series \"%s\" is %s%s%s and %s%s%s: give one of them another name",
                   one->series, one->method, *one->fixed ? ":" : "", one->fixed, other->method,
                   *other->fixed ? ":" : "", other->fixed);
}

enum cs_status cs_sweep_add(struct cs_sweep *sweep, const struct cs_cell *cell,
                            struct cs_error *error) {
    uint32_t at = sweep->n;
    for (uint32_t k = 0; k < sweep->n; k++) {
        const struct cs_cell *other = sweep->cells + k;
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
    return insert(sweep, at, cell, error);
}

static void add_option(char *options, size_t size, const char *name, double value) {
    struct cs_text number = {0};
    const size_t used = strlen(options);
    cs_text_add_real(&number, value);
    snprintf(options + used, size - used, "%s%s=%s", used ? "," : "", name,
             cs_text_get(&number));
    cs_text_finish(&number);
}

static void init_cell(struct cs_cell *cell, const struct cs_sweep_entry *entry) {
    const struct cs_integrator *integrator = entry->method.integrator;
    cs_cell_init(cell, integrator->name);
    memcpy(cell->series, entry->series, sizeof cell->series);
    memcpy(cell->fixed, entry->fixed, sizeof cell->fixed);
    snprintf(cell->family, sizeof cell->family, "%s", cs_family_of(integrator));
    snprintf(cell->key, sizeof cell->key, "%s", entry->module);
    cell->adaptive = integrator->traits & CS_ADAPTIVE;
    snprintf(cell->options, sizeof cell->options, "%s", entry->fixed);
}

static enum cs_status add_point(struct cs_sweep *sweep, const struct cs_sweep_entry *entry,
                                double value, struct cs_error *error) {
    struct cs_cell cell;
    init_cell(&cell, entry);
    snprintf(cell.control, sizeof cell.control, "%s", entry->control);
    if (*entry->control) {
        cell.value = value;
        add_option(cell.options, sizeof cell.options, entry->control, value);
    }
    const struct cs_option *atol = cs_option_find(&entry->method.table, "atol");
    if (cell.adaptive && *entry->control && atol && !strstr(entry->fixed, "atol="))
        add_option(cell.options, sizeof cell.options, "atol",
                   fmin(fmax(value, atol->min), atol->max));
    return cs_sweep_add(sweep, &cell, error);
}

static void make_refused(struct cs_cell *cell, const char *why) {
    snprintf(cell->outcome, sizeof cell->outcome, "refused");
    snprintf(cell->note, sizeof cell->note, "%.239s", why);
}

void cs_sweep_refuse(struct cs_sweep *sweep, uint32_t first, const char *why) {
    const struct cs_cell *of = sweep->cells + first;
    struct cs_cell cell;
    uint32_t next = first + 1;
    cs_cell_init(&cell, of->method);
    memcpy(cell.series, of->series, sizeof cell.series);
    memcpy(cell.fixed, of->fixed, sizeof cell.fixed);
    make_refused(&cell, why);
    while (next < sweep->n && cs_cell_same_series(sweep->cells + next, &cell))
        next++;
    memmove(sweep->cells + first + 1, sweep->cells + next,
            (sweep->n - next) * sizeof *sweep->cells);
    sweep->n -= next - first - 1;
    sweep->cells[first] = cell;
}

/* what the default sweep goes over, largest first */
static void default_range(const struct cs_sweep_entry *entry,
                          const struct cs_sweep_settings *settings, double *high, double *low) {
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

enum cs_status cs_sweep_expand(struct cs_sweep *sweep, const struct cs_sweep_entry *entry,
                               const struct cs_sweep_settings *settings,
                               struct cs_error *error) {
    double high = entry->high, low = entry->low;
    if (entry->method.integrator->fidelity == CS_FIDELITY_OTHER) {
        struct cs_cell cell;
        init_cell(&cell, entry);
        make_refused(&cell, "another model than the equation of motion: an error against it "
                            "has no meaning");
        return cs_sweep_add(sweep, &cell, error);
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

void cs_sweep_finish(struct cs_sweep *sweep) {
    free(sweep->cells);
    *sweep = (struct cs_sweep){0};
}

void cs_cell_integrator(const struct cs_cell *cell, char *out, size_t size) {
    snprintf(out, size, "%s%s%s", cell->method, *cell->options ? ":" : "", cell->options);
}
