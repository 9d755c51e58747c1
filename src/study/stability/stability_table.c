/* stability_table.c - a map as text: letters for verdicts, the border and theory below. */
#include "study/stability/stability.h"

#include <math.h>

enum { NAME_WIDTH = 16, CELL_WIDTH = 10 };

/* a step in seconds, or what stands for none */
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

static void add_row(const struct cs_stability *map, uint32_t row, struct cs_text *out) {
    cs_text_add(out, "%-*.4g", NAME_WIDTH, map->dt[row]);
    for (uint32_t c = 0; c < map->n_columns; c++)
        cs_text_add(out, "%*c", CELL_WIDTH, cs_fate_letter(map->columns[c].cells[row].verdict));
    cs_text_add(out, "\n");
}

enum line { LINE_BORDER, LINE_WORST, LINE_REST, LINE_ROW_SUMS, LINES };

static double value_of(const struct cs_stability_column *column, enum line line) {
    const struct cs_reference *reference = &column->reference;
    switch (line) {
    case LINE_BORDER:
        return column->border;
    case LINE_WORST:
        return reference->worst.dt;
    case LINE_REST:
        return reference->at_rest.dt;
    default:
        return reference->row_sums;
    }
}

static void add_lines(const struct cs_stability *map, struct cs_text *out) {
    static const char *const names[LINES] = {"border", "worst on way", "at the start",
                                             "row sums"};
    for (enum line line = 0; line < LINES; line++) {
        cs_text_add(out, "%-*s", NAME_WIDTH, names[line]);
        for (uint32_t c = 0; c < map->n_columns; c++)
            add_dt(out, value_of(map->columns + c, line));
        cs_text_add(out, "\n");
    }
    cs_text_add(out, "%-*s", NAME_WIDTH, "border / worst");
    for (uint32_t c = 0; c < map->n_columns; c++) {
        const double ratio = map->columns[c].border / map->columns[c].reference.worst.dt;
        if (isfinite(ratio) && ratio > 0)
            cs_text_add(out, "%*.3f", CELL_WIDTH, ratio);
        else
            cs_text_add(out, "%*s", CELL_WIDTH, "-");
    }
    cs_text_add(out, "\n");
}

/* of the largest step that is stable with all below it */
static double drift_of(const struct cs_stability *map, uint32_t c) {
    double drift = (double)NAN;
    for (uint32_t r = 0; r < map->n_rows; r++) {
        const struct cs_stability_cell *cell = map->columns[c].cells + r;
        if (!cs_fate_is_sound(cell->verdict))
            break;
        drift = isnan(cell->drift) ? drift : cell->drift;
    }
    return drift;
}

static void add_drift(const struct cs_stability *map, struct cs_text *out) {
    cs_text_add(out, "%-*s", NAME_WIDTH, "energy drift");
    for (uint32_t c = 0; c < map->n_columns; c++)
        if (isnan(drift_of(map, c)))
            cs_text_add(out, "%*s", CELL_WIDTH, "-");
        else
            cs_text_add(out, "%*.1f%%", CELL_WIDTH - 1, 100 * drift_of(map, c));
    cs_text_add(out, "\n");
}

static void add_legend(const struct cs_stability *map, struct cs_text *out) {
    for (int v = 0; v < CS_FATES; v++) {
        bool there = false;
        for (uint32_t c = 0; c < map->n_columns; c++)
            for (uint32_t r = 0; r < map->n_rows; r++)
                there |= (int)map->columns[c].cells[r].verdict == v;
        if (there)
            cs_text_add(out, "  %c  %s: %s\n", cs_fate_letter((enum cs_fate)v),
                        cs_fate_word((enum cs_fate)v), cs_fate_help((enum cs_fate)v));
    }
}

void cs_stability_print_table(const struct cs_stability *map, struct cs_text *out) {
    const struct cs_stability_settings *settings = map->settings;
    cs_text_add(out, "%s on %s: %.6g s a cell, dt [s] against %s [%s]\n\n",
                map->integrator->name, map->session.scene.path, settings->seconds,
                cs_axis_names[settings->axis], cs_axis_unit(settings->axis));
    cs_text_add(out, "%-*s", NAME_WIDTH, cs_axis_names[settings->axis]);
    for (uint32_t c = 0; c < map->n_columns; c++)
        cs_text_add(out, "%*.4g", CELL_WIDTH, map->columns[c].value);
    cs_text_add(out, "\n");
    for (uint32_t r = map->n_rows; r-- > 0;)
        add_row(map, r, out);
    cs_text_add(out, "\n");
    add_lines(map, out);
    add_drift(map, out);
    cs_text_add(out, "\n");
    add_legend(map, out);
}
