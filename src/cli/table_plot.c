/* Makes diagrams of tables of numbers: lines by unit, and stability maps. */
#include "cli/table_plot.h"

#include "sim/energy_ledger.h"
#include "study/compare/compare_cell.h"
#include "study/energy_monitor.h"
#include "study/parameter_sweep.h"
#include "study/stability/stability.h"
#include "study/stability/stability_state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { FIELDS_MAX = 128 };

/* A CSV in memory; a field that is no number is NAN. */
struct table {
    char *names[FIELDS_MAX]; /* (columns) */
    uint32_t columns, rows;
    double *values; /* (rows, columns) */
    char **first;   /* (rows) the fields of the first column */
};

static enum cs_status read_table(const char *path, struct cs_arena *arena, struct table *table,
                                 struct cs_error *error) {
    struct cs_rows rows;
    char *fields[FIELDS_MAX], *line;
    *table = (struct table){0};
    if (cs_rows_open(&rows, path, 0, error))
        return error->status;
    /* names and first fields point into the file's bytes */
    char *bytes = cs_arena_alloc(arena, rows.length + 1, error);
    if (bytes) {
        memcpy(bytes, rows.bytes, rows.length + 1);
        line = rows.bytes;
        rows.bytes = bytes;
        bytes = line;
    }
    if (bytes && (line = cs_rows_next(&rows)))
        table->columns = cs_csv_cut(line, ',', table->names, FIELDS_MAX);
    table->values = cs_arena_alloc_array(arena, (size_t)rows.n * table->columns + 1,
                                         sizeof *table->values, error);
    table->first = cs_arena_alloc_array(arena, rows.n + 1, sizeof *table->first, error);
    while (!error->status && (line = cs_rows_next(&rows))) {
        double *row = table->values + (size_t)table->rows * table->columns;
        const uint32_t n = cs_csv_cut(line, ',', fields, FIELDS_MAX);
        table->first[table->rows++] = fields[0];
        for (uint32_t c = 0; c < table->columns; c++)
            if (c >= n || !cs_parse_real(fields[c], row + c))
                row[c] = (double)NAN;
    }
    rows.bytes = bytes;
    cs_rows_close(&rows);
    return error->status;
}

static double value_of(const struct table *table, uint32_t row, uint32_t column) {
    return table->values[(size_t)row * table->columns + column];
}

/* Number of a column; that of the columns if there is none of this name. */
static uint32_t find(const struct table *table, const char *name) {
    uint32_t c = 0;
    while (c < table->columns && strcmp(table->names[c], name) != 0)
        c++;
    return c;
}

/* --- columns that are known --- */

const struct cs_column cs_ledger_columns[] = {
    CS_NUMBER_COLUMN("frame", "1", "number of the frame; 0: the start"),
    CS_NUMBER_COLUMN("t", "s", "simulated time"),
#define X(name, column) CS_NUMBER_COLUMN(column, "J", "energy: " column),
    CS_LEDGER_ENERGY_LIST(X)
#undef X
        CS_NUMBER_COLUMN("sum", "J", "sum of all energies"),
#define X(name, column) CS_NUMBER_COLUMN(column, "J", "work since the start: " column),
    CS_LEDGER_WORK_LIST(X)
#undef X
        CS_NUMBER_COLUMN("angular_x", "kg m2/s", "angular momentum about the origin"),
    CS_NUMBER_COLUMN("angular_y", "kg m2/s", "angular momentum about the origin"),
    CS_NUMBER_COLUMN("angular_z", "kg m2/s", "angular momentum about the origin"),
    CS_NUMBER_COLUMN("couple_x", "kg m2/s", "what friction between surfaces has added to it"),
    CS_NUMBER_COLUMN("couple_y", "kg m2/s", "what friction between surfaces has added to it"),
    CS_NUMBER_COLUMN("couple_z", "kg m2/s", "what friction between surfaces has added to it"),
};
const uint32_t cs_n_ledger_columns = sizeof cs_ledger_columns / sizeof *cs_ledger_columns;

static const struct {
    const struct cs_column *columns;
    const uint32_t *n;
} known_tables[] = {
    {cs_energy_monitor_columns, &cs_energy_monitor_n_columns},
    {cs_ledger_columns, &cs_n_ledger_columns},
    {cs_columns, &cs_n_columns},
    {cs_parameter_sweep_columns, &cs_parameter_sweep_n_columns},
    {cs_stability_columns, &cs_stability_n_columns},
    {cs_stability_border_columns, &cs_stability_n_border_columns},
};

/* The column of that name of a table that the program writes; NULL: none has one. */
static const struct cs_column *known_column(const char *name) {
    for (size_t k = 0; k < sizeof known_tables / sizeof *known_tables; k++)
        for (uint32_t c = 0; c < *known_tables[k].n; c++)
            if (!strcmp(known_tables[k].columns[c].name, name))
                return known_tables[k].columns + c;
    return NULL;
}

static void set_label(struct cs_plot_axis *axis, const char *name) {
    const struct cs_column *column = known_column(name);
    struct cs_text label = {0};
    if (column)
        cs_column_add_label(column, &label);
    snprintf(axis->label, CS_LABEL_BYTES, "%s", column ? cs_text_get(&label) : name);
    cs_text_finish(&label);
}

/* A line of the second column over the first, through the rows whose first field is `group`;
 * NULL: all. */
static enum cs_status add_series(struct cs_table_plot *plot, struct cs_panel *panel,
                                 const struct table *table, const uint32_t columns[2],
                                 const char *group, struct cs_error *error) {
    struct cs_series *series = (struct cs_series *)panel->series + panel->n_series;
    *series = (struct cs_series){.name = group ? group : table->names[columns[1]],
                                 .style = cs_style_of(panel->n_series++),
                                 .points = cs_arena_alloc_array(&plot->arena, table->rows,
                                                                sizeof *series->points, error)};
    for (uint32_t r = 0; series->points && r < table->rows; r++)
        if (!group || !strcmp(group, table->first[r])) {
            const struct cs_point point = {.x = value_of(table, r, columns[0]),
                                           .y = value_of(table, r, columns[1]),
                                           .mark = group ? CS_MARK_FULL : CS_MARK_NONE,
                                           .joined = true};
            series->points[series->n++] = point;
            cs_plot_axis_include(&panel->x, point.x);
            cs_plot_axis_include(&panel->y, point.y);
        }
    return error->status;
}

/* --- lines --- */

/* True for a word of "a,b,c". */
static bool has_word(const char *list, const char *word) {
    const size_t length = strlen(word);
    for (const char *at = list; (at = strstr(at, word)); at += length)
        if ((at == list || at[-1] == ',') && (!at[length] || at[length] == ','))
            return true;
    return false;
}

/* True for a column that was asked for; else for one that is not zero throughout, but for
 * indices, and bounds that are far above what they bound. */
static bool is_drawn(const struct table *table, uint32_t c, const char *y) {
    const bool quiet = has_word("frame,step,particle,fast_particles,bound", table->names[c]);
    if (y)
        return has_word(y, table->names[c]);
    for (uint32_t r = 0; r < table->rows && !quiet; r++)
        if (isfinite(value_of(table, r, c)) && value_of(table, r, c) != 0)
            return true;
    return false;
}

/* The panel of a column's unit, or a new one; NULL: there is no room, or no memory. */
static struct cs_panel *find_panel(struct cs_table_plot *plot, const struct table *table,
                                   uint32_t x, uint32_t c, const char *log_axes,
                                   struct cs_error *error) {
    const struct cs_column *column = known_column(table->names[c]), *other;
    struct cs_panel *panel = plot->panels;
    const bool grouped = !strcmp(table->names[0], "series");
    for (; panel < plot->panels + plot->diagram.n_panels; panel++)
        if (!grouped && ((other = known_column(panel->series->name)) == column ||
                         (column && other && !strcmp(column->unit, other->unit)))) {
            /* of several lines their names say what they are */
            snprintf(panel->y.label, CS_LABEL_BYTES, "%s%s",
                     column && !strcmp(column->unit, "J") ? "energy in " : "",
                     column ? column->unit : "");
            return panel;
        }
    if (panel == plot->panels + CS_TABLE_PANELS)
        return NULL;
    *panel = (struct cs_panel){
        .aspect = 0.4,
        .x = {.logarithmic = strchr(log_axes, 'x'), .range = {HUGE_VAL, -HUGE_VAL}},
        .y = {.logarithmic = strchr(log_axes, 'y'), .range = {HUGE_VAL, -HUGE_VAL}},
        .series = cs_arena_alloc_array(&plot->arena, table->columns + (size_t)table->rows,
                                       sizeof *panel->series, error)};
    set_label(&panel->x, table->names[x]);
    set_label(&panel->y, table->names[c]);
    plot->diagram.n_panels++;
    return panel->series ? panel : NULL;
}

/* Lines of all columns that are drawn; of a table of series one for each. */
static enum cs_status add_lines(struct cs_table_plot *plot, const struct table *table,
                                const struct cs_table_plot_settings *settings,
                                struct cs_error *error) {
    const bool grouped = !strcmp(table->names[0], "series");
    const uint32_t t = find(table, settings->x ? settings->x : "t");
    uint32_t columns[2] = {t < table->columns ? t : 0};
    for (uint32_t c = 0; c < table->columns && !error->status; c++) {
        struct cs_panel *panel =
            c != columns[0] && is_drawn(table, c, settings->y)
                ? find_panel(plot, table, columns[0], c, settings->log_axes, error)
                : NULL;
        columns[1] = c;
        if (panel && !grouped)
            add_series(plot, panel, table, columns, NULL, error);
        /* rows of a series stand together */
        for (uint32_t r = 0; panel && grouped && !error->status && r < table->rows; r++)
            if (r == 0 || strcmp(table->first[r], table->first[r - 1]) != 0)
                add_series(plot, panel, table, columns, table->first[r], error);
    }
    for (uint32_t k = 0; k < plot->diagram.n_panels; k++) {
        cs_plot_axis_widen(&plot->panels[k].y);
        if (grouped || !(plot->panels[k].x.range[0] < plot->panels[k].x.range[1]))
            cs_plot_axis_widen(&plot->panels[k].x);
    }
    return error->status;
}

/* Refuses names that no column has. */
static enum cs_status check_names(const struct table *table, const char *option,
                                  const char *names, struct cs_error *error) {
    for (size_t length; names && *names; names += length + (names[length] == ',')) {
        char name[64];
        length = strcspn(names, ",");
        snprintf(name, sizeof name, "%.*s", (int)length, names);
        if (find(table, name) == table->columns)
            return cs_fail(error, CS_ERR_USAGE,
                           "--%s: found no column \"%s\" in the first line of the file", option,
                           name);
    }
    return CS_OK;
}

/* --- maps --- */

static const char *const edges[] = {"cell_left", "cell_right", "cell_bottom", "cell_top",
                                    "verdict_number"};
enum { EDGES = sizeof edges / sizeof *edges };

static enum cs_status add_cells(struct cs_table_plot *plot, const struct table *table,
                                struct cs_error *error) {
    struct cs_panel *panel = plot->panels;
    struct cs_diagram_rect *box =
        cs_arena_alloc_array(&plot->arena, table->rows, sizeof *box, error);
    bool there[CS_STABILITY_VERDICTS] = {false};
    panel->boxes = box;
    for (uint32_t r = 0; box && r < table->rows; r++) {
        double at[EDGES];
        for (int k = 0; k < EDGES; k++)
            at[k] = value_of(table, r, find(table, edges[k]));
        for (int k = 0; k < 4; k++)
            cs_plot_axis_include(k < 2 ? &panel->x : &panel->y, at[k]);
        /* a cell that was not run yet has room, and no colour */
        if (!(at[4] >= 0 && at[4] < CS_STABILITY_VERDICTS))
            continue;
        const enum cs_stability_verdict v = (enum cs_stability_verdict)at[4];
        box[panel->n_boxes++] = (struct cs_diagram_rect){
            at[0], at[1], at[2], at[3], cs_stability_colour(v), cs_stability_letter(v)};
        if (!there[v])
            cs_diagram_add_key(&plot->diagram, CS_KEY_PATCH, cs_stability_colour(v),
                               cs_stability_letter(v), cs_stability_word(v))
                ->help = cs_stability_help(v);
        there[v] = true;
    }
    return error->status;
}

/* Border and limits of theory over the cells. */
static enum cs_status add_limits(struct cs_table_plot *plot, const struct table *border,
                                 struct cs_error *error) {
    static const struct {
        const char *column, *name;
        struct cs_style style;
    } lines[] = {
        {"gershgorin", "theory: Gershgorin", {0x5a5f66, 2, 0, 1.1}},
        {"at_start", "theory: at the start", {0x23262b, 1, 0, 1.1}},
        {"worst_on_way", "theory: worst on the way", {0x23262b, 0, 0, 1.4}},
        {"border", "border, bisected", {0x23262b, 0, 0, 0}},
    };
    enum { LINES = sizeof lines / sizeof *lines };
    /* the ranges are those of the cells */
    struct cs_panel scratch = *plot->panels;
    scratch.series = cs_arena_alloc_array(&plot->arena, LINES, sizeof *scratch.series, error);
    for (int k = 0; scratch.series && k < LINES && !error->status; k++) {
        const uint32_t c = find(border, lines[k].column);
        struct cs_series *series = (struct cs_series *)scratch.series + scratch.n_series;
        if (c == border->columns ||
            add_series(plot, &scratch, border, (uint32_t[2]){0, c}, NULL, error))
            continue;
        series->name = lines[k].name;
        series->style = lines[k].style;
        for (uint32_t i = 0; i < series->n && !(lines[k].style.width > 0); i++)
            series->points[i].mark = CS_MARK_HOLLOW;
    }
    plot->panels->series = scratch.series;
    plot->panels->n_series = scratch.n_series;
    return error->status;
}

static enum cs_status add_map(struct cs_table_plot *plot, const struct table *table,
                              const char *path, struct cs_error *error) {
    const struct cs_plot_axis axis = {.logarithmic = true, .range = {HUGE_VAL, -HUGE_VAL}};
    struct cs_panel *panel = plot->panels;
    struct table border;
    char name[4200];
    /* both axes are logarithmic, and end at the edges of the cells */
    plot->diagram.n_panels = 1;
    *panel = (struct cs_panel){.x = axis, .y = axis, .aspect = 0.75};
    set_label(&panel->x, table->names[0]);
    for (int k = 0; k < CS_AXES; k++)
        if (!strcmp(cs_axis_names[k], table->names[0]))
            snprintf(panel->x.label, CS_LABEL_BYTES, "%s in %s", cs_axis_names[k],
                     cs_axis_unit((enum cs_axis)k));
    snprintf(panel->y.label, CS_LABEL_BYTES, "time step in s");
    snprintf(name, sizeof name, "%.*s_border.csv", (int)(strlen(path) - strlen(".csv")), path);
    if (add_cells(plot, table, error) || access(name, R_OK) ||
        read_table(name, &plot->arena, &border, error))
        return error->status;
    return border.columns ? add_limits(plot, &border, error) : CS_OK;
}

enum cs_status cs_table_plot_make(struct cs_table_plot *plot,
                                  const struct cs_table_plot_settings *settings,
                                  struct cs_error *error) {
    const char *path = settings->path;
    struct table table;
    bool map = strlen(path) > strlen(".csv");
    *plot = (struct cs_table_plot){.diagram = {.title = settings->title,
                                               .width = settings->width,
                                               .columns = 1,
                                               .panels = plot->panels}};
    if (read_table(path, &plot->arena, &table, error))
        return error->status;
    if (!table.columns || !table.rows)
        return cs_fail(error, CS_ERR_FILE, "%s: found no rows below names of columns", path);
    /* a map is what has the edges of its cells */
    for (int k = 0; k < EDGES; k++)
        map = map && find(&table, edges[k]) < table.columns;
    if (map)
        return add_map(plot, &table, path, error);
    if (check_names(&table, "x", settings->x, error) ||
        check_names(&table, "y", settings->y, error) ||
        add_lines(plot, &table, settings, error))
        return error->status;
    return plot->diagram.n_panels
               ? CS_OK
               : cs_fail(error, CS_ERR_FILE, "%s: found no column with numbers to draw", path);
}

void cs_table_plot_finish(struct cs_table_plot *plot) {
    cs_arena_finish(&plot->arena);
    *plot = (struct cs_table_plot){0};
}
