/* Prints the scene tables as scdoc text for clothsim-scene(5). */
#include "base/options.h"
#include "scene/file/scene_write.h"

#include <stdio.h>
#include <string.h>

/* adds text in which nothing is markup to scdoc */
static void add_escaped(struct cs_text *out, const char *text) {
    for (; *text; text++)
        cs_text_add(out, strchr("\\*_", *text) ? "\\%c" : "%c", *text);
}

/* "must be given", the default, or nothing where it may be absent */
static void add_need(const struct cs_option *row, struct cs_text *out) {
    if (cs_table_needs_row(row)) {
        cs_text_add(out, "; must be given");
    } else if (cs_option_is_optional(row)) {
        cs_text_add(out, "; may be absent");
    } else if (row->type != CS_TABLE) {
        cs_text_add(out, "; default ");
        cs_option_print_plain(row, NULL, out);
    }
}

/* one key: what it takes, and what it means */
static void add_row(const struct cs_option *row, struct cs_text *out) {
    struct cs_text takes = {0};
    cs_option_print_expected(row, &takes);
    add_need(row, &takes);
    cs_text_add(out, "*%s*: ", row->name);
    add_escaped(out, cs_text_get(&takes));
    cs_text_add(out, "\n\t");
    add_escaped(out, row->help);
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
static void add_table(const struct cs_table *table, const char *path, struct cs_text *out) {
    add_rules(table, out);
    for (uint32_t r = 0; r < table->n; r++)
        add_row(table->rows + r, out);
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        char inner[256];
        if (!row->table)
            continue;
        snprintf(inner, sizeof inner, "%s%s%s%s", path, *path ? "." : "", row->name,
                 row->type == CS_LIST ? "[]" : "");
        cs_text_add(out, "## ");
        add_escaped(out, inner);
        cs_text_add(out, "\n\n");
        add_table(row->table, inner, out);
    }
}

void cs_scene_print_manual(struct cs_text *out) {
    add_table(&cs_scene_table, "", out);
}
