/* Prints a comparison as aligned text. */
#include "study/compare/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void cs_table_add_reference(const struct cs_compare *compare, struct cs_text *out) {
    const struct cs_compare_reference *reference = &compare->reference;
    const struct cs_horizon *horizon = &reference->horizon;
    const char *changes = cs_text_get(&compare->switched_off);
    cs_text_add(out, "%s: %u particles, %u springs, %.4g s in %u frames%s%s%s\n",
                compare->scene, compare->particles, compare->springs, compare->time,
                compare->settings->run.frames, compare->contact ? ", contact by force" : "",
                *changes ? "; off: " : "", changes);
    cs_text_add(out, "reference  ");
    cs_options_add_short(reference->methods[1], out);
    cs_text_add(out, "\n   against ");
    cs_options_add_short(reference->methods[3], out);
    cs_text_add(out, "\n");
    /* without a reference the figures below have no meaning */
    if (!reference->families_agree) {
        cs_text_add(out, "  no reference: %s\n", reference->reason);
        return;
    }
    if (reference->explicit_passes > 0)
        cs_text_add(
            out,
            "           implicit methods alone: explicit ones would take %.2g evaluations "
            "of the forces, %.2g nominal s\n           (--reference-budget)\n",
            reference->explicit_passes, reference->explicit_passes * compare->pass_seconds);
    const double *differences = reference->differences;
    cs_text_add(out, " error bar %.1e m", reference->error_bar);
    if (reference->has_one_family)
        cs_text_add(out, ", between twins of one family: no second one finished (%s)",
                    reference->reason);
    else
        cs_text_add(out, " (twins %.1e, %.1e; families %.1e)", differences[0], differences[1],
                    differences[2]);
    cs_text_add(out, "; the motion is %.2g m%s\n", reference->motion_scale,
                reference->cached ? "; from the cache" : "");
    cs_text_add(out, "   horizon ");
    if (horizon->time <= compare->time)
        cs_text_add(out, "%.3g s", horizon->time);
    else
        cs_text_add(out, "beyond %.3g s", compare->time);
    cs_text_add(out, " for %.0e m; a displacement at the start grows %.3g times\n",
                reference->accuracy, horizon->growth);
    if (!reference->pointwise)
        cs_text_add(out, "           statistics only: %s\n", reference->reason);
}

void cs_table_add_estimate(const struct cs_compare *compare, struct cs_text *out) {
    const double passes = compare->reference.passes, seconds = passes * compare->pass_seconds;
    if (seconds >= CS_COMPARE_LONG_SECONDS)
        cs_text_add(out, "reference: about %.2g evaluations of the forces, %.2g nominal s\n",
                    passes, seconds);
}

/* Width of the column of names: that of the longest, 20 to 48. */
static int name_width(const struct cs_compare *compare) {
    size_t width = 20;
    for (uint32_t k = 0; k < compare->cells.n; k++) {
        const size_t length = strlen(compare->cells.cells[k].series);
        width = length > width ? length : width;
    }
    return width < 48 ? (int)width : 48;
}

void cs_table_add_head(const struct cs_compare *compare, struct cs_text *out) {
    cs_text_add(out, "%-*s %-14s %8s %8s %8s %9s %18s  %s\n", name_width(compare), "series", "",
                "error m", "largest", "energy", "work", "processor time", "");
}

/* Series and step or tolerance of a cell. The mean step is printed, which may differ from dt.
 */
static void add_control(const struct cs_cell *cell, int width, struct cs_text *out) {
    char control[32] = "";
    if (!strcmp(cell->control, "dt"))
        snprintf(control, sizeof control, "dt %.3g ms",
                 1e3 * (isfinite(cell->step) ? cell->step : cell->value));
    else if (*cell->control)
        snprintf(control, sizeof control, "%s %.1e", cell->control, cell->value);
    cs_text_add(out, "%-*s %-14s", width, cell->series, control);
}

/* A number in a column of the table; "-" for none. */
static void add_number(struct cs_text *out, double value) {
    if (isfinite(value))
        cs_text_add(out, " %8.1e", value);
    else
        cs_text_add(out, " %8s", "-");
}

void cs_table_add_row(const struct cs_compare *compare, const struct cs_cell *cell,
                      struct cs_text *out) {
    add_control(cell, name_width(compare), out);
    add_number(out, cell->error);
    add_number(out, cell->max_error);
    add_number(out, cell->energy_error);
    if (isfinite(cell->work))
        cs_text_add(out, " %9.0f %8.3g ms", cell->work, 1e3 * cell->cpu);
    else
        cs_text_add(out, " %9s %8s   ", "-", "-");
    if (cell->runs > 1)
        cs_text_add(out, " +-%4.1f%%  ", 50 * (cell->cpu_high - cell->cpu_low) / cell->cpu);
    else
        cs_text_add(out, "          ");
    cs_text_add(out, "%s", cell->outcome);
    if (isfinite(cell->crossings))
        cs_text_add(out, ", %.0f crossings", cell->crossings);
    if (isfinite(cell->time) && !cs_cell_is_finished(cell))
        cs_text_add(out, " at %.3g s", cell->time);
    cs_text_add(out, "\n");
}

/* Summary of one series: finished cells of the sweep, order, largest step, achieved over
 * requested tolerance. */
static void add_series(const struct cs_cell *cells, uint32_t n, int width,
                       struct cs_text *out) {
    double least = HUGE_VAL, most = 0, step = 0, low = HUGE_VAL, high = 0;
    uint32_t finished = 0, swept = 0;
    for (uint32_t k = 0; k < n; k++) {
        swept += !isfinite(cells[k].target);
        if (!cs_cell_is_finished(cells + k))
            continue;
        finished += !isfinite(cells[k].target);
        step = fmax(step, cells[k].step);
        if (isfinite(cells[k].order)) {
            low = fmin(low, cells[k].order);
            high = fmax(high, cells[k].order);
        }
        if (isfinite(cells[k].achieved)) {
            least = fmin(least, cells[k].achieved);
            most = fmax(most, cells[k].achieved);
        }
    }
    cs_text_add(out, "%-*s %2u of %2u", width, cells->series, finished, swept);
    /* one figure for a steady order, a range for one that varies with the step */
    if (high > 0)
        cs_text_add(out, high - low > 0.1 ? "  order %.2f to %.2f" : "  order %.2f", low, high);
    if (finished > 0 && !cells->adaptive)
        cs_text_add(out, "  largest stable step %.3g ms", 1e3 * step);
    if (most > 0)
        cs_text_add(out, "  error / (tolerance x motion) from %.1e to %.1e", least, most);
    if (!strcmp(cells->outcome, "refused"))
        cs_text_add(out, "  refused: %s", cells->note);
    cs_text_add(out, "\n");
}

void cs_table_add_series(const struct cs_compare *compare, bool all, struct cs_text *out) {
    const struct cs_cell_list *list = &compare->cells;
    for (uint32_t first = 0, k = 1; k <= list->n; k++)
        if (k == list->n || !cs_cell_same_series(list->cells + k, list->cells + first)) {
            if (all || !strcmp(list->cells[first].outcome, "refused"))
                add_series(list->cells + first, k - first, name_width(compare), out);
            first = k;
        }
}

const char *const cs_table_work_names[] = {
#define X(name, column) column,
    CS_LEDGER_WORK_LIST(X)
#undef X
};

/* True if a column of the energy balance has an entry; the method's own work is always shown.
 */
static bool shows_work(const struct cs_compare *compare, int work) {
    const struct cs_cell_list *list = &compare->cells;
    bool shown = false, any = false;
    for (uint32_t k = 0; k < list->n; k++) {
        any |= cs_cell_has_ledger(list->cells + k);
        shown |= cs_cell_has_ledger(list->cells + k) && list->cells[k].ledger[work] != 0;
    }
    return shown || (any && work == CS_WORK_INTEGRATOR);
}

void cs_table_add_ledger(const struct cs_compare *compare, struct cs_text *out) {
    const struct cs_cell_list *list = &compare->cells;
    const int width = name_width(compare);
    if (!shows_work(compare, CS_WORK_INTEGRATOR))
        return;
    cs_text_add(out, "%-*s %-14s", width, "J since the start", "");
    for (int w = 0; w < CS_WORKS; w++)
        if (shows_work(compare, w))
            cs_text_add(out, " %10s", cs_table_work_names[w]);
    cs_text_add(out, "\n");
    for (uint32_t k = 0; k < list->n; k++) {
        const struct cs_cell *cell = list->cells + k;
        if (!cs_cell_has_ledger(cell))
            continue;
        add_control(cell, width, out);
        for (int w = 0; w < CS_WORKS; w++)
            if (shows_work(compare, w))
                cs_text_add(out, " %10.2e", cell->ledger[w]);
        cs_text_add(out, "\n");
    }
}

void cs_compare_plot_settings(const struct cs_compare *compare, double width,
                              struct cs_plot_settings *settings) {
    const bool known = cs_norm_is_known(compare->settings->ranking_norm, &compare->reference);
    *settings = (struct cs_plot_settings){
        .cells = compare->cells.cells,
        .n = compare->cells.n,
        .x = cs_column_find("work"),
        .second = cs_column_find("cpu"),
        .y = cs_norm_column(known ? compare->settings->ranking_norm : CS_NORM_ENERGY),
        .width = width};
}
