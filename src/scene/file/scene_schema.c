/* Prints the JSON schema (draft 2020-12) of scene files from the scene tables. */
#include "base/options.h"
#include "scene/file/scene_write.h"
#include "scene/file/table_required.h"

#include <stdio.h>

enum { STEP = 2 };

static void add_line(struct cs_text *out, bool first, int indent) {
    cs_text_add(out, "%s\n%*s", first ? "" : ",", indent, "");
}

/* help and unit of a row; a comma stands before it */
static void add_description(const struct cs_option *row, struct cs_text *out) {
    struct cs_text text = {0};
    cs_text_add(&text, "%s", row->help);
    if (row->unit && *row->unit)
        cs_text_add(&text, " [%s]", row->unit);
    cs_text_add(out, ", \"description\": ");
    cs_text_add_json(out, cs_text_get(&text));
    out->failed = out->failed || text.failed;
    cs_text_finish(&text);
}

static void add_number(const struct cs_option *row, bool whole, struct cs_text *out) {
    cs_text_add(out, "\"type\": \"%s\", \"minimum\": ", whole ? "integer" : "number");
    cs_text_add_real(out, row->min);
    cs_text_add(out, ", \"maximum\": ");
    cs_text_add_real(out, row->max);
}

static void add_default(const struct cs_option *row, struct cs_text *out) {
    /* a value that may be absent or must be given has no default to state */
    if (cs_option_is_optional(row) || cs_table_needs_row(row))
        return;
    cs_text_add(out, ", \"default\": ");
    switch (row->type) {
    case CS_VECTOR:
    case CS_COUNTS:
        for (uint32_t i = 0; i < row->count; i++) {
            cs_text_add(out, i ? ", " : "[");
            cs_text_add_real(out, row->defs[i]);
        }
        cs_text_add(out, "]");
        break;
    case CS_CHOICE:
        cs_text_add_json(out, row->choices[(int)row->def]);
        break;
    case CS_BOOL:
        cs_text_add(out, row->def != 0 ? "true" : "false");
        break;
    default:
        cs_text_add_real(out, row->def);
    }
}

/* what a row that is neither table nor list accepts, without the braces */
static void add_plain(const struct cs_option *row, struct cs_text *out) {
    switch (row->type) {
    case CS_REAL:
    case CS_INT:
        add_number(row, row->type == CS_INT, out);
        break;
    case CS_BOOL:
        cs_text_add(out, "\"type\": \"boolean\"");
        break;
    case CS_CHOICE:
        cs_text_add(out, "\"enum\": [");
        for (uint32_t i = 0; row->choices[i]; i++) {
            cs_text_add(out, i ? ", " : "");
            cs_text_add_json(out, row->choices[i]);
        }
        cs_text_add(out, "]");
        break;
    case CS_VECTOR:
    case CS_COUNTS:
        cs_text_add(out,
                    "\"type\": \"array\", \"minItems\": %u, \"maxItems\": %u, \"items\": { ",
                    row->count, row->count);
        add_number(row, row->type == CS_COUNTS, out);
        cs_text_add(out, " }");
        break;
    /* CS_TEXT: add_row handles tables and lists */
    default:
        cs_text_add(out, "\"type\": \"string\", \"maxLength\": %d", CS_TEXT_MAX - 1);
    }
}

static void add_table(const struct cs_table *table, int indent, struct cs_text *out);

static void add_row(const struct cs_option *row, int indent, struct cs_text *out) {
    cs_text_add_json(out, row->name);
    cs_text_add(out, row->type == CS_TABLE ? ": {" : ": { ");
    if (row->type == CS_LIST) {
        cs_text_add(out, "\"type\": \"array\", \"items\": {");
        add_table(row->table, indent + STEP, out);
        cs_text_add(out, "\n%*s}", indent, "");
    } else if (row->type == CS_TABLE) {
        add_table(row->table, indent + STEP, out);
    } else {
        add_plain(row, out);
        add_default(row, out);
    }
    add_description(row, out);
    cs_text_add(out, " }");
}

static void add_rows(const struct cs_table *table, int indent, struct cs_text *out) {
    for (uint32_t r = 0; r < table->n; r++) {
        add_line(out, r == 0, indent);
        add_row(table->rows + r, indent, out);
    }
}

/* keys of the user's own are let through as the reader does */
static void add_other_keys(int indent, struct cs_text *out) {
    add_line(out, false, indent);
    cs_text_add(out, "\"patternProperties\": { \"^(x-|\\\\$)\": true }");
    add_line(out, false, indent);
    cs_text_add(out, "\"additionalProperties\": false");
}

static void add_needs(const struct cs_table *table, int indent, struct cs_text *out) {
    uint32_t n = 0;
    for (uint32_t r = 0; r < table->n; r++) {
        if (!cs_table_needs_row(table->rows + r))
            continue;
        /* opened at the first row that is needed, so that there is no empty list */
        if (!n)
            add_line(out, false, indent);
        cs_text_add(out, "%s\"%s\"", n++ ? ", " : "\"required\": [", table->rows[r].name);
    }
    cs_text_add(out, n ? "]" : "");
    if (!table->one_of)
        return;
    add_line(out, false, indent);
    n = 0;
    /* rows before `uncounted` are not part of the choice */
    for (uint32_t r = table->n_always_optional; r < table->n; r++)
        if (cs_option_is_optional(table->rows + r))
            cs_text_add(out, "%s{ \"required\": [\"%s\"] }", n++ ? ", " : "\"oneOf\": [",
                        table->rows[r].name);
    cs_text_add(out, "]");
}

static void add_object(const struct cs_table *table, int indent, struct cs_text *out) {
    add_line(out, true, indent);
    cs_text_add(out, "\"type\": \"object\"");
    add_line(out, false, indent);
    cs_text_add(out, "\"properties\": {");
    add_rows(table, indent + STEP, out);
    cs_text_add(out, "\n%*s}", indent, "");
    add_other_keys(indent, out);
    add_needs(table, indent, out);
}

/* the members of a table's schema, each on a line, without the braces */
static void add_table(const struct cs_table *table, int indent, struct cs_text *out) {
    const char *shorthands[] = {table->shorthand_text, table->shorthand_number,
                                table->shorthand_list};
    if (!shorthands[0] && !shorthands[1] && !shorthands[2]) {
        add_object(table, indent, out);
        return;
    }
    add_line(out, true, indent);
    cs_text_add(out, "\"anyOf\": [{");
    add_object(table, indent + STEP, out);
    cs_text_add(out, "\n%*s}", indent, "");
    for (uint32_t i = 0; i < 3; i++)
        if (shorthands[i]) {
            cs_text_add(out, ", { ");
            add_plain(cs_option_find(table, shorthands[i]), out);
            cs_text_add(out, " }");
        }
    cs_text_add(out, "]");
}

/* the one part that is not in the tables: only the integrator knows its options */
static void add_integrator(int indent, struct cs_text *out) {
    char name[80];
    snprintf(name, sizeof name,
             "{ \"type\": \"string\", \"minLength\": 1, \"maxLength\": %zu }",
             sizeof((struct cs_scene *)0)->integrator - 1);
    add_line(out, false, indent);
    cs_text_add(out, "\"integrator\": {");
    add_line(out, true, indent + STEP);
    cs_text_add(out, "\"description\": \"name of the method, alone or beside its options\"");
    add_line(out, false, indent + STEP);
    cs_text_add(out, "\"default\": ");
    cs_text_add_json(out, CS_INTEGRATOR_DEFAULT);
    add_line(out, false, indent + STEP);
    /* a plain name, or an object whose other keys the integrator itself checks */
    cs_text_add(out, "\"anyOf\": [%s, {", name);
    add_line(out, true, indent + 2 * STEP);
    cs_text_add(out, "\"type\": \"object\"");
    add_line(out, false, indent + 2 * STEP);
    cs_text_add(out, "\"properties\": { \"name\": %s }", name);
    add_line(out, false, indent + 2 * STEP);
    cs_text_add(out, "\"patternProperties\": { \"^(x-|\\\\$)\": true }");
    add_line(out, false, indent + 2 * STEP);
    cs_text_add(
        out, "\"additionalProperties\": { \"type\": [\"number\", \"boolean\", \"string\"] }");
    cs_text_add(out, "\n%*s}]", indent + STEP, "");
    cs_text_add(out, "\n%*s}", indent, "");
}

void cs_scene_print_schema(struct cs_text *out) {
    cs_text_add(out, "{");
    add_line(out, true, STEP);
    cs_text_add(out, "\"$schema\": \"https://json-schema.org/draft/2020-12/schema\"");
    add_line(out, false, STEP);
    cs_text_add(out, "\"title\": \"clothsim scene\"");
    add_line(out, false, STEP);
    cs_text_add(out, "\"type\": \"object\"");
    add_line(out, false, STEP);
    cs_text_add(out, "\"properties\": {");
    add_rows(&cs_scene_table, 2 * STEP, out);
    add_integrator(2 * STEP, out);
    cs_text_add(out, "\n%*s}", STEP, "");
    add_other_keys(STEP, out);
    add_line(out, false, STEP);
    cs_text_add(out, "\"required\": [\"bodies\"]\n}\n");
}
