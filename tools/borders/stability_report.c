/* Prints a stability map as text (letters for verdicts, border and theory below), as CSV and
 * JSON. */
#include "borders/stability.h"

#include "base/json_writer.h"
#include "borders/stability_state.h"
#include "session/session.h"

#include <math.h>

/* --- text --- */

enum { NAME_WIDTH = 16, CELL_WIDTH = 10, TABLE_MAX = 64 };

/* Half the extent of a single column or row in a diagram, as a factor. */
#define ALONE 1.3

/* Every stride-th column or row of a large map is printed, TABLE_MAX at most. */
static uint32_t stride(uint32_t n) {
    return (n + TABLE_MAX - 1) / TABLE_MAX;
}

/* A step in seconds, or a word for none, no limit or unknown. */
static void add_dt(struct cs_text *out, double dt) {
    if (isnan(dt))
        cs_text_add(out, "%*s", CELL_WIDTH, "?");
    else if (dt == 0)
        cs_text_add(out, "%*s", CELL_WIDTH, "none");
    else if (dt > 1e100)
        cs_text_add(out, "%*s", CELL_WIDTH, "no limit");
    else
        cs_text_add(out, "%*.4g", CELL_WIDTH, dt);
}

/* One row of the map: its dt and the letters of its cells. */
static void add_stability_row(const struct cs_stability *stability, uint32_t row,
                              struct cs_text *out) {
    cs_text_add(out, "%-*.4g", NAME_WIDTH, stability->dt[row]);
    for (uint32_t c = 0; c < stability->n_columns; c += stride(stability->n_columns))
        cs_text_add(out, "%*c", CELL_WIDTH,
                    cs_stability_letter(stability->columns[c].cells[row].verdict));
    cs_text_add(out, "\n");
}

enum line { LINE_BORDER, LINE_WORST, LINE_REST, LINE_ROW_SUMS, LINES };

/* Step in s of one line below the table. */
static double value_of(const struct cs_stability_column *column, enum line line) {
    const struct cs_reference *reference = &column->reference;
    switch (line) {
    case LINE_BORDER:
        return column->boundary;
    case LINE_WORST:
        return reference->smallest_limit.dt;
    case LINE_REST:
        return reference->start_limit.dt;
    default:
        return reference->gershgorin_limit;
    }
}

/* Border and limits of theory, and the ratio of measured to predicted border. */
static void add_lines(const struct cs_stability *stability, struct cs_text *out) {
    static const char *const names[LINES] = {"border", "worst on way", "at the start",
                                             "Gershgorin"};
    for (enum line line = 0; line < LINES; line++) {
        cs_text_add(out, "%-*s", NAME_WIDTH, names[line]);
        for (uint32_t c = 0; c < stability->n_columns; c += stride(stability->n_columns))
            add_dt(out, value_of(stability->columns + c, line));
        cs_text_add(out, "\n");
    }
    cs_text_add(out, "%-*s", NAME_WIDTH, "border / worst");
    for (uint32_t c = 0; c < stability->n_columns; c += stride(stability->n_columns)) {
        const double ratio =
            stability->columns[c].boundary / stability->columns[c].reference.smallest_limit.dt;
        if (isfinite(ratio) && ratio > 0)
            cs_text_add(out, "%*.3f", CELL_WIDTH, ratio);
        else
            cs_text_add(out, "%*s", CELL_WIDTH, "-");
    }
    cs_text_add(out, "\n");
}

/* Energy drift or crossings of the largest step that is stable with all below it; NAN: none. */
static double last_stable(const struct cs_stability *stability, uint32_t c, bool crossings) {
    double last = (double)NAN;
    for (uint32_t r = 0; r < stability->n_rows; r++) {
        const struct cs_stability_cell *cell = stability->columns[c].cells + r;
        const double value = crossings ? cell->crossings : cell->drift;
        if (!cs_stability_is_sound(cell->verdict))
            break;
        last = isnan(value) ? last : value;
    }
    return last;
}

/* Energy drift of the largest stable step, in per cent. */
static void add_drift(const struct cs_stability *stability, struct cs_text *out) {
    cs_text_add(out, "%-*s", NAME_WIDTH, "energy drift");
    for (uint32_t c = 0; c < stability->n_columns; c += stride(stability->n_columns))
        if (isnan(last_stable(stability, c, false)))
            cs_text_add(out, "%*s", CELL_WIDTH, "-");
        else
            cs_text_add(out, "%*.1f%%", CELL_WIDTH - 1, 100 * last_stable(stability, c, false));
    cs_text_add(out, "\n");
}

/* Crossings of the largest stable step, if the scene counts them. */
static void add_crossings(const struct cs_stability *stability, struct cs_text *out) {
    if (!stability->session.plan.rows[CS_FEATURE_CROSSINGS].built)
        return;
    cs_text_add(out, "%-*s", NAME_WIDTH, "crossings");
    for (uint32_t c = 0; c < stability->n_columns; c += stride(stability->n_columns))
        if (isnan(last_stable(stability, c, true)))
            cs_text_add(out, "%*s", CELL_WIDTH, "-");
        else
            cs_text_add(out, "%*.0f", CELL_WIDTH, last_stable(stability, c, true));
    cs_text_add(out, "\n");
}

/* Explains the letters that occur. */
static void add_legend(const struct cs_stability *stability, struct cs_text *out) {
    for (int v = 0; v < CS_STABILITY_VERDICTS; v++) {
        bool there = false;
        for (uint32_t c = 0; c < stability->n_columns; c++)
            for (uint32_t r = 0; r < stability->n_rows; r++)
                there |= (int)stability->columns[c].cells[r].verdict == v;
        if (there)
            cs_text_add(out, "  %c  %s: %s\n",
                        cs_stability_letter((enum cs_stability_verdict)v),
                        cs_stability_word((enum cs_stability_verdict)v),
                        cs_stability_help((enum cs_stability_verdict)v));
    }
}

/* Names the columns without a reference, and why. */
static void add_unjudged(const struct cs_stability *stability, struct cs_text *out) {
    for (uint32_t c = 0; c < stability->n_columns; c++)
        if (!stability->columns[c].reference.exists)
            cs_text_add(out,
                        "  %s = %.4g: the reference run failed (%s); try a shorter --time or a "
                        "larger --budget\n",
                        cs_axis_names[stability->settings->axis], stability->columns[c].value,
                        stability->columns[c].reference.message);
}

/* Duration of the runs of each column: at least 200 steps at the limit of its stiffest mode. */
static void add_watch(const struct cs_stability *stability, struct cs_text *out) {
    cs_text_add(out, "%-*s", NAME_WIDTH, "watched for [s]");
    for (uint32_t c = 0; c < stability->n_columns; c += stride(stability->n_columns))
        cs_text_add(out, "%*.4g", CELL_WIDTH, stability->columns[c].reference.seconds);
    cs_text_add(out, "\n");
}

void cs_stability_print_table(const struct cs_stability *stability, struct cs_text *out) {
    const struct cs_stability_settings *settings = stability->settings;
    cs_text_add(out, "%s on ", stability->series);
    cs_text_add_plain(out, stability->session.scene->path);
    cs_text_add(out, ": %.6g s per cell, dt [s] against %s [%s]", settings->seconds,
                cs_axis_names[settings->axis], cs_axis_unit(settings->axis));
    cs_contact_note_add(stability->session.scene, "; ", out);
    cs_text_add(out, "\n\n");
    cs_text_add(out, "%-*s", NAME_WIDTH, cs_axis_names[settings->axis]);
    for (uint32_t c = 0; c < stability->n_columns; c += stride(stability->n_columns))
        cs_text_add(out, "%*.4g", CELL_WIDTH, stability->columns[c].value);
    cs_text_add(out, "\n");
    for (uint32_t r = stability->n_rows; r-- > 0;)
        if (r % stride(stability->n_rows) == 0)
            add_stability_row(stability, r, out);
    if (stride(stability->n_columns) > 1 || stride(stability->n_rows) > 1)
        cs_text_add(out, "(columns in steps of %u, rows of %u; all %u x %u are in the files)\n",
                    stride(stability->n_columns), stride(stability->n_rows),
                    stability->n_columns, stability->n_rows);
    cs_text_add(out, "\n");
    add_watch(stability, out);
    add_lines(stability, out);
    add_drift(stability, out);
    add_crossings(stability, out);
    cs_text_add(out, "\n");
    add_legend(stability, out);
    add_unjudged(stability, out);
}

/* --- CSV and JSON --- */

/* Edge of a cell towards a neighbour on a logarithmic axis: the geometric mean of the two. At
 * the end of the axis the cell is symmetric; without neighbours it has the factor `alone`. */
static double edge(double before, double here, double after, double alone) {
    if (before > 0)
        return sqrt(before * here);
    return after > 0 ? here * sqrt(here / after) : here * alone;
}

/* Value of a column; 0 beyond the last one. */
static double value_at(const struct cs_stability *stability, uint32_t c) {
    return c < stability->n_columns ? stability->columns[c].value : 0;
}

/* Step of a row; 0 beyond the last one. */
static double dt_at(const struct cs_stability *stability, uint32_t r) {
    return r < stability->n_rows ? stability->dt[r] : 0;
}

/* One CSV row: value, dt, verdict, figures, and the rectangle of the cell. */
static void add_cell(const struct cs_stability *stability, uint32_t c, uint32_t r,
                     struct cs_text *out) {
    const struct cs_stability_cell *cell = stability->columns[c].cells + r;
    const double value = value_at(stability, c), left = c ? value_at(stability, c - 1) : 0;
    const double right = value_at(stability, c + 1), below = r ? dt_at(stability, r - 1) : 0;
    const double above = dt_at(stability, r + 1);
    cs_text_add_real(out, value);
    cs_csv_add_number(out, cell->dt);
    cs_text_add(out, ",%s,%d", cs_stability_word(cell->verdict), (int)cell->verdict);
    cs_csv_add_number(out, cell->drift);
    cs_csv_add_number(out, cell->time);
    cs_text_add(out, ",%u", cell->particles);
    cs_csv_add_number(out, edge(left, value, right, 1 / ALONE));
    cs_csv_add_number(out, edge(right, value, left, ALONE));
    cs_csv_add_number(out, edge(below, cell->dt, above, 1 / ALONE));
    cs_csv_add_number(out, edge(above, cell->dt, below, ALONE));
    cs_csv_add_number(out, cell->crossings);
    cs_text_add(out, "\n");
}

const struct cs_column cs_stability_columns[] = {
    CS_NUMBER_COLUMN("dt", "s", "step"),
    CS_TEXT_COLUMN("verdict", "how the cell ended: see clothsim-stability(1)"),
    CS_NUMBER_COLUMN("verdict_number", "1", "the same as a number, from 0 in that order"),
    CS_NUMBER_COLUMN("energy_drift", "1", "drift of the energy of a run that ended"),
    CS_NUMBER_COLUMN("time", "s", "when the verdict showed; the end of a stable run"),
    CS_NUMBER_COLUMN("particles", "1", "most particles at a time of a local instability"),
    CS_NUMBER_COLUMN("cell_left", "", "edge of the cell in a diagram, in the axis' unit"),
    CS_NUMBER_COLUMN("cell_right", "", "edge of the cell in a diagram, in the axis' unit"),
    CS_NUMBER_COLUMN("cell_bottom", "s", "edge of the cell in a diagram"),
    CS_NUMBER_COLUMN("cell_top", "s", "edge of the cell in a diagram"),
    CS_NUMBER_COLUMN("crossings", "1", "edges through triangles, maximum over the run"),
};
const uint32_t cs_stability_n_columns =
    sizeof cs_stability_columns / sizeof *cs_stability_columns;
const struct cs_column cs_stability_border_columns[] = {
    CS_NUMBER_COLUMN("border", "s", "largest stable step, found by bisection"),
    CS_NUMBER_COLUMN("worst_on_way", "s", "smallest limit of theory along the reference"),
    CS_NUMBER_COLUMN("at_start", "s", "limit of theory for small motions at the start"),
    CS_NUMBER_COLUMN("gershgorin", "s", "bound of theory by Gershgorin's theorem"),
    CS_NUMBER_COLUMN("omega", "1/s", "angular frequency of the mode that limits the step"),
    CS_NUMBER_COLUMN("damping_rate", "1/s", "damping rate of that mode"),
    CS_NUMBER_COLUMN("particle", "1", "index of the particle that moves most in it"),
    CS_NUMBER_COLUMN("share", "1", "fraction of the mode's kinetic energy in that particle"),
};
const uint32_t cs_stability_n_border_columns =
    sizeof cs_stability_border_columns / sizeof *cs_stability_border_columns;

void cs_stability_print_csv(const struct cs_stability *stability, struct cs_text *out) {
    cs_text_add(out, "%s", cs_axis_names[stability->settings->axis]);
    cs_columns_add_names(cs_stability_columns, cs_stability_n_columns, out);
    cs_text_add(out, "\n");
    for (uint32_t c = 0; c < stability->n_columns; c++)
        for (uint32_t r = 0; r < stability->n_rows; r++)
            add_cell(stability, c, r, out);
}

void cs_stability_print_borders_csv(const struct cs_stability *stability, struct cs_text *out) {
    cs_text_add(out, "%s", cs_axis_names[stability->settings->axis]);
    cs_columns_add_names(cs_stability_border_columns, cs_stability_n_border_columns, out);
    cs_text_add(out, "\n");
    for (uint32_t c = 0; c < stability->n_columns; c++) {
        const struct cs_stability_column *column = stability->columns + c;
        const struct cs_reference *reference = &column->reference;
        const struct cs_mode *mode = &reference->smallest_limit.mode;
        const double dts[] = {column->boundary, reference->smallest_limit.dt,
                              reference->start_limit.dt, reference->gershgorin_limit};
        cs_text_add_real(out, column->value);
        /* 0 means no stable step, which a logarithmic scale cannot show */
        for (int k = 0; k < 4; k++)
            cs_csv_add_number(out, dts[k] > 0 ? dts[k] : HUGE_VAL);
        cs_csv_add_number(out, mode->omega_squared > 0 ? sqrt(mode->omega_squared) : 0);
        cs_csv_add_number(out, mode->damping_rate);
        cs_text_add(out, ",%u", mode->particle);
        cs_csv_add_number(out, mode->participation);
        cs_text_add(out, "\n");
    }
}

/* One column with its limits and cells. */
static void add_json_column(const struct cs_stability *stability, uint32_t c,
                            struct cs_text *out) {
    const struct cs_stability_column *column = stability->columns + c;
    const struct cs_reference *reference = &column->reference;
    /* limits that do not exist are NAN or infinite, which are written as null */
    cs_json_write(out,
                  ",\n    {'value': %g, 'seconds': %g, 'border': %g, 'worst_on_way': %g, "
                  "'at_start': %g, 'gershgorin': %g, 'reference_step': %g, 'cells': [",
                  column->value, reference->seconds, column->boundary,
                  reference->smallest_limit.dt, reference->start_limit.dt,
                  reference->gershgorin_limit, reference->run.mean_step);
    for (uint32_t r = 0; r < stability->n_rows; r++) {
        const struct cs_stability_cell *cell = column->cells + r;
        cs_json_write(out,
                      ",\n      {'dt': %g, 'verdict': %s, 'energy_drift': %g, 'time': %g, "
                      "'particles': %u, 'crossings': %g}",
                      cell->dt, cs_stability_word(cell->verdict), cell->drift, cell->time,
                      cell->particles, cell->crossings);
    }
    cs_text_add(out, "]}");
}

void cs_stability_print_json(const struct cs_stability *stability, struct cs_text *out) {
    const struct cs_stability_settings *settings = stability->settings;
    cs_json_write(out,
                  "{\n  'scene': %s,\n  'series': %s,\n  'integrator': %s,\n  'axis': %s,\n"
                  "  'seconds': %g,\n  'columns': [",
                  stability->session.scene->path, stability->series,
                  stability->integrator->name, cs_axis_names[settings->axis],
                  settings->seconds);
    for (uint32_t c = 0; c < stability->n_columns; c++)
        add_json_column(stability, c, out);
    cs_text_add(out, "\n  ]\n}\n");
}
