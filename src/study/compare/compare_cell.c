/* Describes the columns of a comparison in one table, which every reader and writer uses. */
#include "study/compare/compare_cell.h"

#include "study/compare/timing_rounds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Columns and lines that a file may have. Diagrams and merges compare all rows with each other;
 * a comparison of all methods has a few hundred. */
enum { FIELDS_MAX = 128, LINES_MAX = 10000 };

/* Rows of the table of columns, named after their fields; AXIS rows can be drawn. */
#define FIELD(field, type, unit, help, drawn)                                                  \
    {                                                                                          \
#field, type, unit, help, drawn, offsetof(struct cs_cell, field),                      \
            sizeof((struct cs_cell *)0)->field                                                 \
    }
#define TEXT(field, help)         FIELD(field, CS_CELL_TEXT, "", help, false)
#define NUMBER(field, unit, help) FIELD(field, CS_CELL_NUMBER, unit, help, false)
#define AXIS(field, unit, help)   FIELD(field, CS_CELL_NUMBER, unit, help, true)

const struct cs_column cs_columns[] = {
    TEXT(series, "curve of the row: a method with its options, under one name"),
    TEXT(method, "integrator"),
    TEXT(fixed, "options that all rows of the series share"),
    TEXT(options, "all options of the row that are not at their defaults"),
    TEXT(family, "explicit, implicit or approximate, adaptive explicit or adaptive implicit"),
    TEXT(control, "option that varies along the series: dt, rtol, or nothing"),
    AXIS(value, "", "step in s, or tolerance"),
    NUMBER(target, "m", "error that the value was sought for; empty in the sweep"),
    FIELD(adaptive, CS_CELL_FLAG, "", "the method chooses its own steps", false),
    TEXT(outcome, "finished, blew up, over budget, gave up, failed or refused"),
    NUMBER(time, "s", "simulated time that was reached"),
    AXIS(step, "s", "mean step"),
    AXIS(error, "m", "position error at the end (RMS)"),
    AXIS(max_error, "m", "largest position error at the end"),
    AXIS(path_error, "m", "position error over all frames (RMS)"),
    AXIS(max_path_error, "m", "position error of the worst particle over all frames"),
    AXIS(velocity_error, "m/s", "velocity error at the end (RMS)"),
    AXIS(energy_error, "1", "energy error / largest kinetic energy"),
    AXIS(centre_error, "m", "error of the centre of mass"),
    AXIS(box_error, "m", "error of the bounding box"),
    AXIS(strain, "1", "largest strain"),
    AXIS(crossings, "1", "edges through triangles, maximum over all frames"),
    NUMBER(bar, "m", "error of the reference itself"),
    NUMBER(order, "1", "slope of log(error) over log(step) from the row before, if steady"),
    AXIS(achieved, "1", "achieved error / (requested tolerance x motion)"),
    AXIS(work, "1", "force evaluations, Jacobian products, solver iterations and sweeps"),
    AXIS(evals, "1", "force evaluations"),
    AXIS(jvps, "1", "Jacobian products"),
    AXIS(solves, "1", "linear solves"),
    AXIS(iterations, "1", "iterations of the linear solver"),
    AXIS(sweeps, "1", "passes of the method itself over the springs"),
    AXIS(setups, "1", "matrices set up"),
    AXIS(steps, "1", "steps"),
    AXIS(rejected, "1", "rejected steps"),
    AXIS(newton, "1", "nonlinear iterations"),
    NUMBER(clamped, "1", "set-ups of the solver that left out negative stiffness"),
    AXIS(cpu, "s", "processor time"),
    NUMBER(cpu_low, "s", "lower quartile of the processor time over the rounds"),
    NUMBER(cpu_high, "s", "upper quartile of the processor time over the rounds"),
    AXIS(wall, "s", "wall time"),
    NUMBER(runs, "1", "rounds that were timed"),
    NUMBER(outliers, "1", "rounds far above the median"),
    TEXT(note, "reason or remarks of the method"),
    TEXT(key, "hash of everything that the row depends on, but for the machine"),
    TEXT(state_hash, "hash of the state at the end, as of clothsim run --hash"),
    TEXT(module, "hash of the module's file"),
#define X(name, column)                                                                        \
    {"ledger_" column,                                                                         \
     CS_CELL_NUMBER,                                                                           \
     "J",                                                                                      \
     "work of " column " by the end, with --ledger: see ledger.csv",                           \
     false,                                                                                    \
     offsetof(struct cs_cell, ledger) + CS_WORK_##name * sizeof(double),                       \
     sizeof(double)},
    CS_LEDGER_WORK_LIST(X)
#undef X
        TEXT(machine, "machine that timed the row"),
    TEXT(version, "version of clothsim that timed it"),
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
        if (cs_columns[c].drawn)
            names[n++] = cs_columns[c].name;
    return names;
}

double cs_cell_number(const struct cs_cell *cell, const struct cs_column *column) {
    double value;
    memcpy(&value, (const char *)cell + column->offset, sizeof value);
    return value;
}

void cs_options_add_short(const char *options, struct cs_text *out) {
    while (*options) {
        const size_t name = strcspn(options, "=,"), length = strcspn(options, ",");
        char value[64];
        double number;
        /* a word, such as the name of a variant, stays */
        const bool has_value = options[name] == '=' && length - name < sizeof value;
        snprintf(value, sizeof value, "%.*s", has_value ? (int)(length - name) - 1 : 0,
                 options + name + 1);
        if (has_value && cs_parse_real(value, &number))
            cs_text_add(out, "%.*s=%.6g", (int)name, options, number);
        else
            cs_text_add(out, "%.*s", (int)length, options);
        options += length;
        if (*options)
            cs_text_add(out, "%c", *options++);
    }
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

/* Fraction of the error before that counts as no fall. Error control in contact stands still
 * twice in a row, at tolerances half a decade apart, and falls again. */
#define NO_FALL 0.8
enum { STANDS = 3 };
/* Growth of the work over these cells from which on steps became shorter: a third of that of
 * order 12. Looser tolerances of a method whose steps contact cuts are the same run. */
#define SHORTER 1.1

bool cs_cell_is_rounding(const struct cs_cell *cell, uint32_t n, double motion) {
    bool stands = n > STANDS && cs_cell_same_series(cell, cell - STANDS) &&
                  cell[-STANDS].error < 1e-3 * motion &&
                  cell->work > SHORTER * cell[-STANDS].work;
    for (int k = 0; stands && k < STANDS; k++)
        stands = cell[-k].error > NO_FALL * cell[-k - 1].error;
    return stands;
}

/* with room for rounding */
#define HALF_DECADE 3.1630059

double cs_cell_typical(const struct cs_cell *cells, uint32_t n, const struct cs_cell *cell,
                       const struct cs_column *column, double *low, double *high) {
    const double own = cs_cell_number(cell, column);
    const struct cs_cell *at = cell, *end = cells + n;
    double near[64];
    uint32_t count = 0;
    *low = *high = own;
    while (cell->adaptive && at > cells && cs_cell_same_series(at - 1, cell))
        at--;
    for (; cell->adaptive && at < end && cs_cell_same_series(at, cell) && count < 64; at++) {
        /* error control holds the error to a multiple of the tolerance */
        const double value = cs_cell_number(at, column) * cell->value / at->value;
        if (cs_cell_is_finished(at) && value > 0 && isfinite(value) &&
            at->value <= HALF_DECADE * cell->value && cell->value <= HALF_DECADE * at->value)
            near[count++] = value;
    }
    if (!(own > 0) || count < 2)
        return own;
    cs_sort(near, count);
    *low = near[0];
    *high = near[count - 1];
    return sqrt(near[(count - 1) / 2] * near[count / 2]);
}

bool cs_cell_is_finished(const struct cs_cell *cell) {
    return !strcmp(cell->outcome, cs_outcome_text(CS_RUNNING));
}

bool cs_cell_has_failed(const struct cs_cell *cell) {
    return !strcmp(cell->outcome, cs_outcome_text(CS_FAILED)) ||
           !strcmp(cell->outcome, cs_outcome_text(CS_GAVE_UP));
}

/* Assigns a column to each field of the first line; NULL for unknown names. */
static uint32_t find_columns(char *names, const struct cs_column *columns[FIELDS_MAX]) {
    char *fields[FIELDS_MAX];
    const uint32_t n = names ? cs_csv_cut(names, ',', fields, FIELDS_MAX) : 0;
    for (uint32_t c = 0; c < n; c++)
        columns[c] = cs_column_find(fields[c]);
    return n;
}

/* Reads rows with as many fields as the first line has, and a name; others are dropped. */
static void read_cells(struct cs_rows *rows, const struct cs_column *const *columns,
                       uint32_t n_columns, struct cs_cell *cells, uint32_t *n) {
    char *fields[FIELDS_MAX];
    for (char *line; (line = cs_rows_next(rows));) {
        struct cs_cell *cell = cells + *n;
        const uint32_t n_fields = cs_csv_cut(line, ',', fields, FIELDS_MAX);
        cs_cell_init(cell, "");
        for (uint32_t c = 0; c < n_fields && c < n_columns; c++)
            if (columns[c])
                cs_column_parse(columns[c], cell, fields[c]);
        // what follows an @ is a machine, before it is the name
        *n += n_fields == n_columns && *cell->series && *cell->series != '@';
    }
}

enum cs_status cs_csv_read(const char *path, bool unchecked, struct cs_cell **cells,
                           uint32_t *n, struct cs_error *error) {
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
    else if (rows.n > LINES_MAX)
        cs_fail(error, CS_ERR_FILE, "%s: found %u lines, expected at most %d", path, rows.n,
                LINES_MAX);
    else if (!unchecked && cs_rows_refuse_unchecked(&rows, path, error))
        ; // its cells are not read
    else if (!(*cells = calloc(rows.n, sizeof **cells)))
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %u cells", rows.n);
    else
        read_cells(&rows, columns, n_columns, *cells, n);
    cs_rows_close(&rows);
    return error->status;
}
