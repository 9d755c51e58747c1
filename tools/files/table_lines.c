/* Draws columns of a table as lines, a panel for each unit. */
#include "files/table_lines.h"

#include "shared/known_columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void set_label(struct cs_plot_axis *axis, const char *name) {
    const struct cs_column *column = cs_known_column(name);
    snprintf(axis->label, CS_LABEL_BYTES, "%s", name);
    if (column)
        cs_column_print_label(column, axis->label, CS_LABEL_BYTES);
}

bool cs_list_has(const char *list, const char *word) {
    const size_t length = strlen(word);
    for (const char *at = list; length && (at = strstr(at, word)); at += length)
        if ((at == list || at[-1] == ',') && (!at[length] || at[length] == ','))
            return true;
    return false;
}

/* True for a column that was asked for; else for one that is not zero throughout, but for
 * indices, and bounds that are far above what they bound. */
static bool is_drawn(const struct cs_number_table *table, uint32_t c, const char *y) {
    const bool quiet = cs_list_has("frame,step,particle,fast_particles,bound", table->names[c]);
    if (y)
        return cs_list_has(y, table->names[c]);
    for (uint32_t r = 0; r < table->rows && !quiet; r++)
        if (isfinite(cs_number_table_at(table, r, c)) && cs_number_table_at(table, r, c) != 0)
            return true;
    return false;
}

/* The panel of a column's unit, or a new one; NULL: there is no room, or no memory. */
static struct cs_panel *find_panel(struct cs_diagram *plot, const struct cs_number_table *table,
                                   uint32_t x, uint32_t c, const char *log_axes,
                                   struct cs_error *error) {
    const struct cs_column *column = cs_known_column(table->names[c]), *other;
    struct cs_panel *panel = plot->panels;
    const bool grouped = !strcmp(table->names[0], "series");
    for (; panel < plot->panels + plot->n_panels; panel++)
        if (!grouped && ((other = cs_known_column(panel->series->name)) == column ||
                         (column && other && !strcmp(column->unit, other->unit)))) {
            /* of several lines their names say what they are */
            if (column && !strcmp(column->help, other->help))
                return panel;
            snprintf(panel->y.label, CS_LABEL_BYTES, "%s%s",
                     column && !strcmp(column->unit, "J") ? "energy in " : "",
                     column ? column->unit : "");
            return panel;
        }
    panel = cs_plot_add_panel(plot, 0.4, table->columns + table->rows, error);
    if (panel) {
        panel->x.logarithmic = strchr(log_axes, 'x');
        panel->y.logarithmic = strchr(log_axes, 'y');
        set_label(&panel->x, table->names[x]);
        set_label(&panel->y, table->names[c]);
    }
    return panel;
}

/* Lines of all columns that are drawn; of a table of series one for each. */
static enum cs_status add_lines(struct cs_diagram *plot, const struct cs_number_table *table,
                                const struct cs_line_settings *settings,
                                struct cs_error *error) {
    const bool grouped = !strcmp(table->names[0], "series");
    const uint32_t t = cs_number_table_find(table, settings->x ? settings->x : "t");
    uint32_t columns[2] = {t < table->columns ? t : 0};
    for (uint32_t c = 0; c < table->columns && !error->status; c++) {
        struct cs_panel *panel =
            c != columns[0] && is_drawn(table, c, settings->y)
                ? find_panel(plot, table, columns[0], c, settings->log_axes, error)
                : NULL;
        columns[1] = c;
        if (panel && !grouped)
            cs_table_plot_add_series(plot, panel, table, columns, NULL, error);
        /* rows of a series stand together */
        for (uint32_t r = 0; panel && grouped && !error->status && r < table->rows; r++)
            if (r == 0 || strcmp(table->words[r], table->words[r - 1]) != 0)
                cs_table_plot_add_series(plot, panel, table, columns, table->words[r], error);
    }
    for (struct cs_panel *p = plot->panels; p < plot->panels + plot->n_panels; p++) {
        p->is_single = p->n_series == 1 && !grouped;
        cs_panel_fit(p);
        cs_plot_axis_widen(&p->y);
        if (grouped || !(p->x.range[0] < p->x.range[1]))
            cs_plot_axis_widen(&p->x);
    }
    return error->status;
}

/* Refuses names of "a,b,c" that no column has. */
static enum cs_status check_names(const struct cs_number_table *table, const char *option,
                                  const char *names, struct cs_error *error) {
    for (size_t length; names && *names && !error->status;
         names += length + (names[length] == ',')) {
        char name[64];
        length = strcspn(names, ",");
        snprintf(name, sizeof name, "%.*s", (int)length, names);
        if (cs_number_table_find(table, name) == table->columns)
            cs_fail(error, CS_ERR_USAGE,
                    "--%s: found no column \"%s\" in the first line of the file", option, name);
    }
    return error->status;
}

enum cs_status cs_table_lines_add(struct cs_diagram *plot, const struct cs_number_table *table,
                                  const struct cs_line_settings *settings,
                                  struct cs_error *error) {
    if (check_names(table, "x", settings->x, error) ||
        check_names(table, "y", settings->y, error) || add_lines(plot, table, settings, error))
        return error->status;
    return plot->n_panels ? CS_OK
                          : cs_fail(error, CS_ERR_FILE,
                                    "%s: found no column with numbers to draw", settings->path);
}
