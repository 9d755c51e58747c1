/* stability_files.c - a map as CSV and JSON. */
#include "study/stability/stability.h"

#include <math.h>

/* a number; an empty field for one that is not there */
static void add_field(struct cs_text *out, double value) {
    cs_text_add(out, ",");
    if (isfinite(value))
        cs_text_add_real(out, value);
}

/* the middle between two neighbours on a logarithmic scale, and as far beyond the ends */
static double edge(double before, double here, double after) {
    if (before > 0)
        return sqrt(before * here);
    return after > 0 ? here * sqrt(here / after) : here / 1.3;
}

static double value_at(const struct cs_stability *map, uint32_t c) {
    return c < map->n_columns ? map->columns[c].value : 0;
}

static double dt_at(const struct cs_stability *map, uint32_t r) {
    return r < map->n_rows ? map->dt[r] : 0;
}

static void add_cell(const struct cs_stability *map, uint32_t c, uint32_t r,
                     struct cs_text *out) {
    const struct cs_stability_cell *cell = map->columns[c].cells + r;
    const double value = value_at(map, c), left = c ? value_at(map, c - 1) : 0;
    const double right = value_at(map, c + 1), below = r ? dt_at(map, r - 1) : 0;
    const double above = dt_at(map, r + 1);
    cs_text_add_real(out, value);
    add_field(out, cell->dt);
    cs_text_add(out, ",%s,%d", cs_fate_word(cell->verdict), (int)cell->verdict);
    add_field(out, cell->drift);
    add_field(out, cell->time);
    cs_text_add(out, ",%u", cell->particles);
    add_field(out, edge(left, value, right));
    add_field(out, edge(right, value, left));
    add_field(out, edge(below, cell->dt, above));
    add_field(out, edge(above, cell->dt, below));
    cs_text_add(out, "\n");
}

void cs_stability_print_csv(const struct cs_stability *map, struct cs_text *out) {
    cs_text_add(out,
                "%s,dt,verdict,verdict_number,energy_drift,time,particles,cell_left,cell_right,"
                "cell_bottom,cell_top\n",
                cs_axis_names[map->settings->axis]);
    for (uint32_t c = 0; c < map->n_columns; c++)
        for (uint32_t r = 0; r < map->n_rows; r++)
            add_cell(map, c, r, out);
}

void cs_stability_print_borders_csv(const struct cs_stability *map, struct cs_text *out) {
    cs_text_add(out,
                "%s,border,worst_on_way,at_start,row_sums,omega,damping_rate,particle,share\n",
                cs_axis_names[map->settings->axis]);
    for (uint32_t c = 0; c < map->n_columns; c++) {
        const struct cs_stability_column *column = map->columns + c;
        const struct cs_reference *reference = &column->reference;
        const struct cs_mode *mode = &reference->worst.mode;
        const double dts[] = {column->border, reference->worst.dt, reference->at_rest.dt,
                              reference->row_sums};
        cs_text_add_real(out, column->value);
        /* 0 stands for no stable step, which no logarithmic scale shows */
        for (int k = 0; k < 4; k++)
            add_field(out, dts[k] > 0 ? dts[k] : HUGE_VAL);
        add_field(out, mode->square > 0 ? sqrt(mode->square) : 0);
        add_field(out, mode->rate);
        cs_text_add(out, ",%u", mode->particle);
        add_field(out, mode->share);
        cs_text_add(out, "\n");
    }
}

static void add_member(struct cs_text *out, const char *before, double value) {
    cs_text_add(out, "%s", before);
    cs_text_add_real(out, value);
}

static void add_json_column(const struct cs_stability *map, uint32_t c, struct cs_text *out) {
    const struct cs_stability_column *column = map->columns + c;
    const struct cs_reference *reference = &column->reference;
    add_member(out, "    {\"value\": ", column->value);
    add_member(out, ", \"seconds\": ", reference->seconds);
    add_member(out, ", \"border\": ", column->border);
    add_member(out, ", \"worst_on_way\": ", reference->worst.dt);
    add_member(out, ", \"at_start\": ", reference->at_rest.dt);
    add_member(out, ", \"row_sums\": ", reference->row_sums);
    add_member(out, ", \"reference_step\": ", reference->trial.step);
    cs_text_add(out, ", \"cells\": [");
    for (uint32_t r = 0; r < map->n_rows; r++) {
        const struct cs_stability_cell *cell = column->cells + r;
        add_member(out, r ? ",\n      {\"dt\": " : "\n      {\"dt\": ", cell->dt);
        cs_text_add(out, ", \"verdict\": \"%s\"", cs_fate_word(cell->verdict));
        add_member(out, ", \"energy_drift\": ", cell->drift);
        add_member(out, ", \"time\": ", cell->time);
        cs_text_add(out, ", \"particles\": %u}", cell->particles);
    }
    cs_text_add(out, "]}%s\n", c + 1 < map->n_columns ? "," : "");
}

void cs_stability_print_json(const struct cs_stability *map, struct cs_text *out) {
    const struct cs_stability_settings *settings = map->settings;
    cs_text_add(out, "{\n  \"scene\": ");
    cs_text_add_json(out, map->session.scene.path);
    cs_text_add(out, ",\n  \"integrator\": \"%s\",\n  \"axis\": \"%s\",\n",
                map->integrator->name, cs_axis_names[settings->axis]);
    add_member(out, "  \"seconds\": ", settings->seconds);
    cs_text_add(out, ",\n  \"columns\": [\n");
    for (uint32_t c = 0; c < map->n_columns; c++)
        add_json_column(map, c, out);
    cs_text_add(out, "  ]\n}\n");
}
