/* compare_json.c - compare.json: everything, for programs. */
#include "study/compare/compare_report.h"
#include "study/machine.h"

#include <math.h>

static void add_text(struct cs_text *out, const char *key, const char *value) {
    cs_text_add(out, "\"%s\": ", key);
    cs_text_add_json(out, value);
}

static void add_real(struct cs_text *out, const char *key, double value) {
    cs_text_add(out, "\"%s\": ", key);
    cs_text_add_real(out, value);
}

static void add_machine(struct cs_text *out) {
    struct cs_machine machine;
    cs_machine_look(&machine);
    cs_text_add(out, "  \"machine\": {");
    add_text(out, "processor", machine.processor);
    cs_text_add(out, ", \"processors\": %ld, ", machine.processors);
    add_real(out, "load", machine.load);
    cs_text_add(out, ", ");
    add_text(out, "version", machine.version);
    cs_text_add(out, ", ");
    add_text(out, "compiler", machine.compiler);
    cs_text_add(out, ", ");
    add_text(out, "flags", machine.flags);
    cs_text_add(out, "},\n");
}

static void add_reference(const struct cs_yardstick *yardstick, struct cs_text *out) {
    const struct {
        const char *key;
        double value;
    } numbers[] = {{"bar", yardstick->bar},
                   {"bar_max", yardstick->bar_max},
                   {"motion", yardstick->scale},
                   {"kinetic_energy", yardstick->kinetic},
                   {"strain", yardstick->strain},
                   {"accuracy", yardstick->accuracy},
                   {"amplification", yardstick->horizon.amplification},
                   {"horizon", yardstick->horizon.time}};
    cs_text_add(out, "  \"reference\": {\"methods\": [");
    for (int k = 0; k < CS_YARDSTICK_RUNS; k++) {
        cs_text_add(out, "%s", k ? ", " : "");
        cs_text_add_json(out, yardstick->methods[k]);
    }
    cs_text_add(out, "], \"agree\": %s, \"pointwise\": %s, ",
                yardstick->agree ? "true" : "false", yardstick->pointwise ? "true" : "false");
    add_text(out, "reason", yardstick->reason);
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        cs_text_add(out, ", ");
        add_real(out, numbers[k].key, numbers[k].value);
    }
    cs_text_add(out, "},\n");
}

static void add_rank(const struct cs_rank *rank, const struct cs_cell *cells,
                     struct cs_text *out) {
    cs_text_add(out, "{\"best\": %td", rank->best - cells);
    if (rank->next) {
        cs_text_add(out, ", \"next\": %td, ", rank->next - cells);
        add_real(out, "factor", rank->factor);
        cs_text_add(out, ", \"interval\": [");
        cs_text_add_real(out, rank->low);
        cs_text_add(out, ", ");
        cs_text_add_real(out, rank->high);
        cs_text_add(out, "]");
    }
}

/* best and next are indices of cells */
static void add_verdict(const struct cs_ranking *ranking, const struct cs_compare *compare,
                        struct cs_text *out) {
    const struct cs_cell *cells = compare->sweep.cells;
    cs_text_add(out, "  \"verdict\": [");
    for (uint32_t k = 0; k < ranking->n; k++) {
        cs_text_add(out, "%s\n    ", k ? "," : "");
        add_rank(ranking->ranks + k, cells, out);
        cs_text_add(out, ", \"error\": 1e%d}", ranking->ranks[k].exponent);
    }
    cs_text_add(out, "],\n  \"stable_at_frame_step\": ");
    if (ranking->frame.best) {
        add_rank(&ranking->frame, cells, out);
        cs_text_add(out, "},\n");
    } else
        cs_text_add(out, "null,\n");
}

static void add_cell(const struct cs_cell *cell, bool front, struct cs_text *out) {
    cs_text_add(out, "{\"front\": %s", front ? "true" : "false");
    for (uint32_t c = 0; c < cs_n_columns; c++) {
        const struct cs_column *column = cs_columns + c;
        const char *field = (const char *)cell + column->offset;
        cs_text_add(out, ", ");
        if (column->type == CS_CELL_TEXT)
            add_text(out, column->name, field);
        else if (column->type == CS_CELL_FLAG)
            cs_text_add(out, "\"%s\": %s", column->name,
                        *(const bool *)field ? "true" : "false");
        else
            add_real(out, column->name, cs_cell_number(cell, column));
    }
    cs_text_add(out, "}");
}

void cs_compare_print_json(const struct cs_compare *compare, const struct cs_ranking *ranking,
                           struct cs_text *out) {
    cs_text_add(out, "{\n  \"schema\": 1,\n  ");
    add_text(out, "scene", compare->scene);
    cs_text_add(out, ",\n  \"particles\": %u, \"springs\": %u, ", compare->particles,
                compare->springs);
    add_real(out, "time", compare->time);
    cs_text_add(out, ", ");
    add_real(out, "fps", compare->fps);
    cs_text_add(out, ",\n  ");
    add_text(out, "switched_off", cs_text_get(&compare->changes));
    cs_text_add(out, ",\n");
    add_machine(out);
    add_reference(&compare->yardstick, out);
    add_verdict(ranking, compare, out);
    cs_text_add(out, "  \"cells\": [");
    for (uint32_t k = 0; k < compare->sweep.n; k++) {
        cs_text_add(out, "%s\n    ", k ? "," : "");
        add_cell(compare->sweep.cells + k, ranking->front[k], out);
    }
    cs_text_add(out, "\n  ]\n}\n");
}
