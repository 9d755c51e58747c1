/* Reads tables of numbers, and makes the diagrams of stability maps. */
#include "shared/table_plot.h"

#include "borders/stability_state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

uint32_t cs_number_table_find(const struct cs_number_table *table, const char *name) {
    uint32_t c = 0;
    while (c < table->columns && strcmp(table->names[c], name) != 0)
        c++;
    return c;
}

static enum cs_status read_table(const char *path, struct cs_arena *arena,
                                 struct cs_number_table *table, struct cs_error *error) {
    struct cs_rows rows;
    char *fields[CS_TABLE_COLUMNS], *line;
    *table = (struct cs_number_table){0};
    if (cs_rows_open(&rows, path, 0, error))
        return error->status;
    /* names and words point into the file's bytes */
    cs_arena_adopt(arena, free, rows.bytes, error);
    if (error->status)
        cs_rows_close(&rows);
    else if ((line = cs_rows_next(&rows)))
        table->columns = cs_csv_cut(line, ',', table->names, CS_TABLE_COLUMNS);
    const bool grouped = table->columns && !strcmp(table->names[0], "series");
    const uint32_t verdict = grouped ? 0 : cs_number_table_find(table, "verdict");
    CS_ARENA_ARRAY(arena, table->values, (size_t)rows.n * table->columns + 1, error);
    CS_ARENA_ARRAY(arena, table->words, rows.n + 1, error);
    while (!error->status && (line = cs_rows_next(&rows))) {
        double *row = table->values + (size_t)table->rows * table->columns;
        const uint32_t n = cs_csv_cut(line, ',', fields, CS_TABLE_COLUMNS);
        table->words[table->rows++] = fields[verdict < n ? verdict : 0];
        for (uint32_t c = 0; c < table->columns; c++)
            if (c >= n || !cs_parse_real(fields[c], row + c))
                row[c] = (double)NAN;
    }
    return error->status;
}

struct cs_series *cs_table_plot_add_series(struct cs_diagram *plot, struct cs_panel *panel,
                                           const struct cs_number_table *table,
                                           const uint32_t columns[2], const char *group,
                                           struct cs_error *error) {
    struct cs_series *series =
        cs_plot_add_series(plot, panel,
                           (struct cs_series){.name = group ? group : table->names[columns[1]],
                                              .style = cs_style_of(panel->n_series)},
                           table->rows, error);
    for (uint32_t r = 0; series && r < table->rows; r++)
        if (!group || !strcmp(group, table->words[r]))
            series->points[series->n++] =
                (struct cs_point){.x = cs_number_table_at(table, r, columns[0]),
                                  .y = cs_number_table_at(table, r, columns[1]),
                                  .mark = group ? CS_MARK_FULL : CS_MARK_NONE,
                                  .joined = true};
    return series;
}

/* --- maps --- */

static const char *const edges[] = {"cell_left", "cell_right", "cell_bottom", "cell_top"};
enum { EDGES = sizeof edges / sizeof *edges };

static enum cs_status add_cells(struct cs_diagram *plot, struct cs_panel *panel,
                                const struct cs_number_table *table, struct cs_error *error) {
    bool there[CS_STABILITY_VERDICTS] = {false};
    CS_ARENA_ARRAY(&plot->arena, panel->boxes, table->rows, error);
    for (uint32_t r = 0; panel->boxes && r < table->rows; r++) {
        double at[EDGES];
        for (int k = 0; k < EDGES; k++) {
            at[k] = cs_number_table_at(table, r, cs_number_table_find(table, edges[k]));
            cs_plot_axis_include(k < 2 ? &panel->x : &panel->y, at[k]);
        }
        /* by the word: numbers shift where a verdict comes in between */
        enum cs_stability_verdict v = 0;
        while (v < CS_STABILITY_VERDICTS && strcmp(cs_stability_word(v), table->words[r]) != 0)
            v++;
        /* a cell that was not run yet has room, and no colour */
        if (v == CS_STABILITY_VERDICTS)
            continue;
        panel->boxes[panel->n_boxes++] = (struct cs_diagram_rect){
            at[0], at[1], at[2], at[3], cs_stability_colour(v), cs_stability_letter(v)};
        if (!there[v])
            cs_diagram_add_key(plot, CS_KEY_PATCH, cs_stability_colour(v),
                               cs_stability_letter(v), cs_stability_word(v))
                ->help = cs_stability_help(v);
        there[v] = true;
    }
    return error->status;
}

/* Border and limits of theory over the cells. */
static const struct {
    const char *column, *name;
    struct cs_style style;
} limits[] = {
    {"gershgorin", "theory: Gershgorin", {0x5a5f66, 2, 0, 1.1}},
    {"at_start", "theory: at the start", {0x23262b, 1, 0, 1.1}},
    {"worst_on_way", "theory: worst on the way", {0x23262b, 0, 0, 1.4}},
    {"border", "border, bisected", {0x23262b, 0, 0, 0}},
};
enum { LIMITS = sizeof limits / sizeof *limits };

static void add_limits(struct cs_diagram *plot, struct cs_panel *panel,
                       const struct cs_number_table *border, struct cs_error *error) {
    for (int k = 0; k < LIMITS && !error->status; k++) {
        const uint32_t columns[2] = {0, cs_number_table_find(border, limits[k].column)};
        struct cs_series *series =
            columns[1] < border->columns
                ? cs_table_plot_add_series(plot, panel, border, columns, NULL, error)
                : NULL;
        if (!series)
            continue;
        series->name = limits[k].name;
        series->style = limits[k].style;
        for (uint32_t i = 0; i < series->n && !(limits[k].style.width > 0); i++)
            series->points[i].mark = CS_MARK_HOLLOW;
    }
}

static enum cs_status add_map(struct cs_diagram *plot, const struct cs_number_table *table,
                              const char *path, struct cs_error *error) {
    struct cs_panel *panel = cs_plot_add_panel(plot, 0.75, LIMITS, error);
    struct cs_number_table border;
    char name[4200];
    if (!panel)
        return error->status;
    /* both axes are logarithmic, and end at the edges of the cells */
    panel->x.logarithmic = panel->y.logarithmic = true;
    snprintf(panel->x.label, CS_LABEL_BYTES, "%s", table->names[0]);
    for (int k = 0; k < CS_AXES; k++)
        if (!strcmp(cs_axis_names[k], table->names[0]))
            snprintf(panel->x.label, CS_LABEL_BYTES, "%s in %s", cs_axis_names[k],
                     cs_axis_unit((enum cs_axis)k));
    snprintf(panel->y.label, CS_LABEL_BYTES, "time step in s");
    snprintf(name, sizeof name, "%.*s_border.csv", (int)(strlen(path) - strlen(".csv")), path);
    if (!add_cells(plot, panel, table, error) && !access(name, R_OK) &&
        !read_table(name, &plot->arena, &border, error))
        add_limits(plot, panel, &border, error);
    return error->status;
}

enum cs_status cs_table_plot_read(struct cs_diagram *plot, struct cs_number_table *table,
                                  const char *path, struct cs_error *error) {
    bool map = strlen(path) > strlen(".csv");
    if (read_table(path, &plot->arena, table, error))
        return error->status;
    if (!table->columns || !table->rows)
        return cs_fail(error, CS_ERR_FILE, "%s: found no rows below names of columns", path);
    /* a map is what has the edges of its cells */
    for (int k = 0; k < EDGES; k++)
        map = map && cs_number_table_find(table, edges[k]) < table->columns;
    return map ? add_map(plot, table, path, error) : CS_OK;
}
