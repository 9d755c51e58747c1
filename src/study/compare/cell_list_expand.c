/* Expands a method to its steps or tolerances. */
#include "study/compare/cell_list_expand.h"

#include "base/options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Steps of a default range, each half of the last; and the limit of cells in any range. */
enum { DEFAULT_STEPS = 8, MOST_POINTS = 64 };

/* First step of an explicit method in units of 2/omega. omega is an upper bound: the true limit
 * is up to 1.5 times longer for the leap-frog, and about twice for Runge-Kutta methods. 2.2 is
 * just beyond both, so a series begins with an unstable step. */
#define BEYOND_LIMIT 2.2

/* Appends "name=value" to a list of options. */
static void add_option(char *options, size_t size, const char *name, double value) {
    struct cs_text number = {0};
    const size_t used = strlen(options);
    cs_text_add_real(&number, value);
    snprintf(options + used, size - used, "%s%s=%s", used ? "," : "", name,
             cs_text_get(&number));
    cs_text_finish(&number);
}

/* A cell with the options that all cells of the entry share. */
static void init_cell(struct cs_cell *cell, const struct cs_cell_list_entry *entry) {
    const struct cs_integrator *integrator = entry->method.integrator;
    cs_cell_init(cell, integrator->name);
    memcpy(cell->series, entry->series, sizeof cell->series);
    memcpy(cell->fixed, entry->fixed, sizeof cell->fixed);
    snprintf(cell->family, sizeof cell->family, "%s", cs_family_of(integrator));
    snprintf(cell->key, sizeof cell->key, "%s", entry->module);
    cell->adaptive = integrator->traits & CS_ADAPTIVE;
    snprintf(cell->options, sizeof cell->options, "%s", entry->fixed);
}

/* Adds the cell of one step or tolerance. An adaptive method without a given atol gets rtol
 * times the size of the scene, within the range of the option. */
static enum cs_status add_point(struct cs_cell_list *sweep,
                                const struct cs_cell_list_entry *entry, double value,
                                double size, struct cs_error *error) {
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
                   fmin(fmax(value * size, atol->min), atol->max));
    return cs_cell_list_add(sweep, &cell, error);
}

/* Default range: rtol from 1e-2 to 1e-9 of an adaptive method; DEFAULT_STEPS steps from one
 * frame down of a fixed one. Explicit methods begin just beyond their stability limit. */
static void default_range(const struct cs_cell_list_entry *entry,
                          const struct cs_cell_list_settings *settings, double *high,
                          double *low) {
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

enum cs_status cs_cell_list_expand(struct cs_cell_list *sweep,
                                   const struct cs_cell_list_entry *entry,
                                   const struct cs_cell_list_settings *settings,
                                   struct cs_error *error) {
    double high = entry->high, low = entry->low;
    if (entry->method.integrator->fidelity == CS_FIDELITY_OTHER) {
        struct cs_cell cell;
        init_cell(&cell, entry);
        cs_cell_refuse(
            &cell,
            "its model is not the equation of motion: an error against it has no meaning");
        return cs_cell_list_add(sweep, &cell, error);
    }
    if (!*entry->control)
        return add_point(sweep, entry, (double)NAN, settings->size, error);
    if (isnan(high))
        default_range(entry, settings, &high, &low);
    const bool adaptive = entry->method.integrator->traits & CS_ADAPTIVE;
    for (int k = 0; k < MOST_POINTS; k++) {
        // powers, so that 1e-3 is 1e-3 to the bit and a step halves exactly
        const double value =
            adaptive ? high * pow(10, -0.5 * k) : high / (double)(UINT64_C(1) << k);
        if (value < low * (1 - 1e-9) || add_point(sweep, entry, value, settings->size, error))
            break;
    }
    return error->status;
}
