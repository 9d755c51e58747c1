/* Describes the columns of a comparison in one table, which every reader and writer uses. */
#include "study/compare/compare_cell.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Columns that a file may have. */
enum { FIELDS_MAX = 128 };

/* Rows of the table of columns, named after their fields; only columns with a label can be
 * drawn. */
#define TEXT(field)                                                                            \
    {                                                                                          \
#field, NULL, CS_CELL_TEXT, offsetof(struct cs_cell, field),                           \
            sizeof((struct cs_cell *)0)->field                                                 \
    }
#define NUMBER(field, label)                                                                   \
    { #field, label, CS_CELL_NUMBER, offsetof(struct cs_cell, field), sizeof(double) }

const struct cs_column cs_columns[] = {
    TEXT(series),
    TEXT(method),
    TEXT(fixed),
    TEXT(options),
    TEXT(family),
    TEXT(control),
    NUMBER(value, "step in s, or tolerance"),
    NUMBER(target, NULL),
    {"adaptive", NULL, CS_CELL_FLAG, offsetof(struct cs_cell, adaptive), sizeof(bool)},
    TEXT(outcome),
    NUMBER(time, NULL),
    NUMBER(step, "mean step in s"),
    NUMBER(error, "position error at the end in m (RMS)"),
    NUMBER(max_error, "largest position error at the end in m"),
    NUMBER(path_error, "position error over all frames in m (RMS)"),
    NUMBER(max_path_error, "position error of the worst particle over all frames in m"),
    NUMBER(velocity_error, "velocity error at the end in m/s (RMS)"),
    NUMBER(energy_error, "energy error / largest kinetic energy"),
    NUMBER(centre_error, "error of the centre of mass in m"),
    NUMBER(box_error, "error of the bounding box in m"),
    NUMBER(strain, "largest strain"),
    NUMBER(crossings, "edges through triangles, maximum over all frames"),
    NUMBER(bar, NULL),
    NUMBER(order, NULL),
    NUMBER(achieved, "achieved error / (requested tolerance x motion)"),
    NUMBER(work, "force evaluations, Jacobian products, solver iterations and sweeps"),
    NUMBER(evals, "force evaluations"),
    NUMBER(jvps, "Jacobian products"),
    NUMBER(solves, "linear solves"),
    NUMBER(iterations, "iterations of the linear solver"),
    NUMBER(sweeps, "passes of the method itself over the springs"),
    NUMBER(setups, "matrices set up"),
    NUMBER(steps, "steps"),
    NUMBER(rejected, "rejected steps"),
    NUMBER(newton, "nonlinear iterations"),
    NUMBER(clamped, NULL),
    NUMBER(cpu, "processor time in s"),
    NUMBER(cpu_low, NULL),
    NUMBER(cpu_high, NULL),
    NUMBER(wall, "wall time in s"),
    NUMBER(runs, NULL),
    NUMBER(outliers, NULL),
    TEXT(note),
    TEXT(key),
    TEXT(state_hash),
    TEXT(module),
#define X(name, column)                                                                        \
    {"ledger_" column, NULL, CS_CELL_NUMBER,                                                   \
     offsetof(struct cs_cell, ledger) + CS_WORK_##name * sizeof(double), sizeof(double)},
    CS_LEDGER_WORK_LIST(X)
#undef X
        TEXT(machine),
    TEXT(version),
};
const uint32_t cs_n_columns = sizeof cs_columns / sizeof *cs_columns;

/* Indices of cs_family_names. */
enum { EXPLICIT, IMPLICIT, APPROXIMATE, EXPLICIT_ADAPTIVE, IMPLICIT_ADAPTIVE };
const char *const cs_family_names[] = {"explicit",          "implicit",          "approximate",
                                       "adaptive explicit", "adaptive implicit", NULL};

const char *cs_family_of(const struct cs_integrator *integrator) {
    const bool implicit = integrator->traits & CS_IMPLICIT;
    if (integrator->traits & CS_ADAPTIVE)
        return cs_family_names[implicit ? IMPLICIT_ADAPTIVE : EXPLICIT_ADAPTIVE];
    if (integrator->fidelity != CS_FIDELITY_ODE)
        return cs_family_names[APPROXIMATE];
    return cs_family_names[implicit ? IMPLICIT : EXPLICIT];
}

const struct cs_column *cs_column_find(const char *name) {
    for (uint32_t c = 0; c < cs_n_columns; c++)
        if (!strcmp(cs_columns[c].name, name))
            return cs_columns + c;
    return NULL;
}

const char *const *cs_column_axes(void) {
    static const char *names[sizeof cs_columns / sizeof *cs_columns + 1];
    uint32_t n = 0;
    for (uint32_t c = 0; c < cs_n_columns; c++)
        if (cs_columns[c].label)
            names[n++] = cs_columns[c].name;
    return names;
}

double cs_cell_number(const struct cs_cell *cell, const struct cs_column *column) {
    double value;
    memcpy(&value, (const char *)cell + column->offset, sizeof value);
    return value;
}

void cs_cell_init(struct cs_cell *cell, const char *method) {
    *cell = (struct cs_cell){0};
    for (uint32_t c = 0; c < cs_n_columns; c++)
        if (cs_columns[c].type == CS_CELL_NUMBER)
            cs_column_parse(cs_columns + c, cell, "");
    cell->low = cell->high = (double)NAN;
    snprintf(cell->method, sizeof cell->method, "%s", method);
    snprintf(cell->series, sizeof cell->series, "%s", method);
}

void cs_cell_name_machine(struct cs_cell *cell, const char *here) {
    char *end = cell->series + strcspn(cell->series, "@");
    const size_t capacity = sizeof cell->series - (size_t)(end - cell->series);
    const int host = (int)strcspn(cell->machine, ":");
    *end = 0;
    if (*cell->machine && strcmp(cell->machine, here) != 0)
        snprintf(end, capacity, "@%.*s", host < 40 ? host : 40, cell->machine);
}

bool cs_cell_same_series(const struct cs_cell *a, const struct cs_cell *b) {
    return !strcmp(a->series, b->series);
}

bool cs_cell_is_finished(const struct cs_cell *cell) {
    return !strcmp(cell->outcome, cs_outcome_text(CS_RUNNING));
}

bool cs_cell_has_failed(const struct cs_cell *cell) {
    return !strcmp(cell->outcome, cs_outcome_text(CS_FAILED)) ||
           !strcmp(cell->outcome, cs_outcome_text(CS_GAVE_UP));
}

/* Finds a column by its name or by that of the last release; NULL if unknown. */
static const struct cs_column *find_column(const char *name) {
    static const char *const renamed[][2] = {{"ledger_push", "ledger_events_force"},
                                             {"ledger_values", "ledger_parameters"}};
    for (size_t k = 0; k < sizeof renamed / sizeof *renamed; k++)
        if (!strcmp(renamed[k][0], name))
            return cs_column_find(renamed[k][1]);
    return cs_column_find(name);
}

/* Assigns a column to each field of the first line; NULL for unknown names. */
static uint32_t find_columns(char *names, const struct cs_column *columns[FIELDS_MAX]) {
    char *fields[FIELDS_MAX];
    const uint32_t n = names ? cs_csv_cut(names, ',', fields, FIELDS_MAX) : 0;
    for (uint32_t c = 0; c < n; c++)
        columns[c] = find_column(fields[c]);
    return n;
}

/* Reads rows with as many fields as the first line has; others are dropped. */
static void read_cells(struct cs_rows *rows, const struct cs_column *const *columns,
                       uint32_t n_columns, struct cs_cell *cells, uint32_t *n) {
    char *fields[FIELDS_MAX];
    for (char *line; (line = cs_rows_next(rows));) {
        struct cs_cell *cell = cells + *n;
        char outcome[sizeof cell->outcome];
        const uint32_t n_fields = cs_csv_cut(line, ',', fields, FIELDS_MAX);
        cs_cell_init(cell, "");
        for (uint32_t c = 0; c < n_fields && c < n_columns; c++)
            if (columns[c])
                cs_column_parse(columns[c], cell, fields[c]);
        snprintf(outcome, sizeof outcome, "%s", cs_outcome_current(cell->outcome));
        memcpy(cell->outcome, outcome, sizeof outcome);
        // files of before there were series
        if (!*cell->series)
            memcpy(cell->series, cell->method, sizeof cell->method);
        *n += n_fields == n_columns;
    }
}

enum cs_status cs_csv_read(const char *path, struct cs_cell **cells, uint32_t *n,
                           struct cs_error *error) {
    const struct cs_column *columns[FIELDS_MAX];
    struct cs_rows rows;
    *cells = NULL;
    *n = 0;
    if (cs_rows_open(&rows, path, 0, error))
        return error->status;
    const uint32_t n_columns = find_columns(cs_rows_next(&rows), columns);
    if (!n_columns || !columns[0])
        cs_fail(error, CS_ERR_FILE,
                "%s: the first line does not name the columns of a comparison", path);
    else if (!(*cells = calloc(rows.n, sizeof **cells)))
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %u cells", rows.n);
    else
        read_cells(&rows, columns, n_columns, *cells, n);
    cs_rows_close(&rows);
    return error->status;
}
