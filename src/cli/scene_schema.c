/* Prints the JSON schema (draft 2020-12) of scene files from the scene tables. */
#include "base/json_writer.h"
#include "base/options.h"
#include "cli/commands.h"
#include "session/session.h"

#include <stdio.h>
#include <string.h>

/* adds n bytes of text in which nothing is markup to scdoc */
static void add_escaped(struct cs_text *out, const char *text, size_t n) {
    for (const char *end = text + n; text < end; text++)
        cs_text_add(out, strchr("\\*_", *text) ? "\\%c" : "%c", *text);
}

/* the list that the check of a scene needs, and not its table, which reads any length */
#define NEEDED_LIST "bodies"
/* how help ends of other rows that are checked after reading, beside other rows */
#define NEEDED_HELP "; must be given"

/* the length of a row's help without NEEDED_HELP */
static size_t help_length(const struct cs_option *row) {
    const char *needed = strstr(row->help, NEEDED_HELP);
    return needed ? (size_t)(needed - row->help) : strlen(row->help);
}

static bool is_needed(const struct cs_option *row, const char *path) {
    return cs_table_needs_row(row) || row->help[help_length(row)] ||
           (!*path && !strcmp(row->name, NEEDED_LIST));
}

/* "required", the default, or nothing where it may be absent */
static void add_need(const struct cs_option *row, const char *path, struct cs_text *out) {
    if (is_needed(row, path)) {
        cs_text_add(out, "; required");
    } else if (cs_option_is_optional(row)) {
        cs_text_add(out, "; may be absent");
    } else if (row->type != CS_TABLE) {
        cs_text_add(out, "; default ");
        cs_option_print_plain(row, NULL, out);
    }
}

/* one key: what it takes, and what it means */
static void manual_add_row(const struct cs_option *row, const char *path, struct cs_text *out) {
    struct cs_text takes = {0};
    cs_option_print_expected(row, &takes);
    add_need(row, path, &takes);
    cs_text_add(out, "*%s*: ", row->name);
    add_escaped(out, cs_text_get(&takes), strlen(cs_text_get(&takes)));
    cs_text_add(out, "\n\t");
    add_escaped(out, row->help, help_length(row));
    cs_text_add(out, ".\n\n");
    out->failed = out->failed || takes.failed;
    cs_text_finish(&takes);
}

static void add_rules(const struct cs_table *table, struct cs_text *out) {
    uint32_t n = 0;
    for (uint32_t r = table->n_always_optional; table->one_of && r < table->n; r++)
        if (cs_option_is_optional(table->rows + r))
            cs_text_add(out, "%s*%s*",
                        n++ ? ", " : "Exactly one must be given of: ", table->rows[r].name);
    cs_text_add(out, n ? ".\n\n" : "");
    if (table->shorthand_text)
        cs_text_add(out, "A plain string stands for an object with *%s* alone.\n\n",
                    table->shorthand_text);
    if (table->shorthand_number)
        cs_text_add(out, "A plain number stands for an object with *%s* alone.\n\n",
                    table->shorthand_number);
    if (table->shorthand_list)
        cs_text_add(out, "A plain list stands for an object with *%s* alone.\n\n",
                    table->shorthand_list);
}

/* the rows of a table, then those of the tables in it, each under its JSON path */
static void manual_add_table(const struct cs_table *table, const char *path,
                             struct cs_text *out) {
    add_rules(table, out);
    for (uint32_t r = 0; r < table->n; r++)
        manual_add_row(table->rows + r, path, out);
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        char inner[256];
        if (!row->table)
            continue;
        snprintf(inner, sizeof inner, "%s%s%s%s", path, *path ? "." : "", row->name,
                 row->type == CS_LIST ? "[]" : "");
        cs_text_add(out, "## ");
        add_escaped(out, inner, strlen(inner));
        cs_text_add(out, "\n\n");
        manual_add_table(row->table, inner, out);
    }
}

void cs_scene_print_manual(struct cs_text *out) {
    manual_add_table(&cs_scene_table, "", out);
}

enum { STEP = 2 };

/* keys of the user's own are let through as the reader does */
#define FREE_KEYS "{ '^(x-|\\\\$)': true }"

/* help and unit of a row; a comma stands before it */
static void add_description(const struct cs_option *row, struct cs_text *out) {
    struct cs_text text = {0};
    cs_text_add(&text, "%s", row->help);
    if (row->unit && *row->unit)
        cs_text_add(&text, " [%s]", row->unit);
    cs_json_write(out, ", 'description': %s", cs_text_get(&text));
    out->failed = out->failed || text.failed;
    cs_text_finish(&text);
}

static void add_default(const struct cs_option *row, struct cs_text *out) {
    /* a value that may be absent or must be given has no default to state */
    if (cs_option_is_optional(row) || cs_table_needs_row(row))
        return;
    cs_json_write(out, ", 'default': ");
    cs_option_print(row, NULL, out);
}

static void add_table(const struct cs_table *table, int indent, struct cs_text *out);

static void add_schema_row(const struct cs_option *row, int indent, struct cs_text *out) {
    cs_json_line(out, indent, row->type == CS_TABLE ? "%s: {" : "%s: { ", row->name);
    if (row->type == CS_LIST) {
        cs_json_write(out, "'type': 'array', 'items': {");
        add_table(row->table, indent + STEP, out);
        cs_text_add(out, "\n%*s}", indent, "");
    } else if (row->type == CS_TABLE) {
        add_table(row->table, indent + STEP, out);
    } else {
        cs_value_kind_of(row)->print_schema(row, out);
        add_default(row, out);
    }
    add_description(row, out);
    cs_text_add(out, " }");
}

static void add_rows(const struct cs_table *table, int indent, struct cs_text *out) {
    for (uint32_t r = 0; r < table->n; r++)
        add_schema_row(table->rows + r, indent, out);
}

static void add_other_keys(int indent, struct cs_text *out) {
    cs_json_line(out, indent, "'patternProperties': " FREE_KEYS);
    cs_json_line(out, indent, "'additionalProperties': false");
}

static void add_needs(const struct cs_table *table, int indent, struct cs_text *out) {
    uint32_t n = 0;
    for (uint32_t r = 0; r < table->n; r++) {
        if (!cs_table_needs_row(table->rows + r))
            continue;
        /* opened at the first row that is needed, so that there is no empty list */
        if (!n++)
            cs_json_line(out, indent, "'required': [");
        cs_json_write(out, ", %s", table->rows[r].name);
    }
    cs_text_add(out, n ? "]" : "");
    if (!table->one_of)
        return;
    cs_json_line(out, indent, "'oneOf': [");
    /* rows before `uncounted` are not part of the choice */
    for (uint32_t r = table->n_always_optional; r < table->n; r++)
        if (cs_option_is_optional(table->rows + r))
            cs_json_write(out, ", { 'required': [%s] }", table->rows[r].name);
    cs_text_add(out, "]");
}

static void add_object(const struct cs_table *table, int indent, struct cs_text *out) {
    cs_json_line(out, indent, "'type': 'object'");
    cs_json_line(out, indent, "'properties': {");
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
    cs_json_line(out, indent, "'anyOf': [{");
    add_object(table, indent + STEP, out);
    cs_text_add(out, "\n%*s}", indent, "");
    for (uint32_t i = 0; i < 3; i++)
        if (shorthands[i]) {
            const struct cs_option *row = cs_option_find(table, shorthands[i]);
            cs_text_add(out, ", { ");
            cs_value_kind_of(row)->print_schema(row, out);
            cs_text_add(out, " }");
        }
    cs_text_add(out, "]");
}

/* the one part that is not in the tables: only the integrator knows its options */
static void add_integrator(struct cs_text *out) {
    const size_t longest = sizeof((struct cs_scene *)0)->integrator - 1;
    cs_json_write(out,
                  ",\n    'integrator': {\n"
                  "      'description': 'name of the method, alone or with its options',\n"
                  "      'default': %s,\n",
                  CS_INTEGRATOR_DEFAULT);
    /* a plain name, or an object whose other keys the integrator itself checks */
    cs_json_write(
        out,
        "      'anyOf': [{ 'type': 'string', 'minLength': 1, 'maxLength': %zu }, {\n"
        "        'type': 'object',\n"
        "        'properties': { 'name': { 'type': 'string', 'minLength': 1, "
        "'maxLength': %zu } },\n"
        "        'patternProperties': " FREE_KEYS ",\n"
        "        'additionalProperties': { 'type': ['number', 'boolean', 'string'] }\n"
        "      }]\n    }",
        longest, longest);
}

void cs_scene_print_schema(struct cs_text *out) {
    cs_json_write(out, "{\n  '$schema': 'https://json-schema.org/draft/2020-12/schema',\n"
                       "  'title': 'clothsim scene',\n  'type': 'object',\n"
                       "  'properties': {");
    add_rows(&cs_scene_table, 2 * STEP, out);
    add_integrator(out);
    cs_text_add(out, "\n  }");
    add_other_keys(STEP, out);
    cs_json_write(out, ",\n  'required': ['" NEEDED_LIST "']\n}\n");
}
