/* Prints a scene as JSON with every value that it holds, defaults included. */
#include "scene/file/scene_write.h"

#include "base/options.h"

#include <string.h>

enum { STEP = 2 };

static void add_line(struct cs_text *out, bool first, int indent) {
    cs_text_add(out, "%s\n%*s", first ? "" : ",", indent, "");
}

static void print_table(const struct cs_table *table, const void *object, int indent,
                        struct cs_text *out);

static void print_list(const struct cs_option *row, const struct cs_list *list, int indent,
                       struct cs_text *out) {
    cs_text_add(out, "[");
    for (uint32_t i = 0; i < list->n; i++) {
        add_line(out, i == 0, indent + STEP);
        print_table(row->table, (const char *)list->items + i * row->table->size, indent + STEP,
                    out);
    }
    cs_text_add(out, "\n%*s]", indent, "");
}

/* The rows that are there, each on a line of its own; returns their number. */
static uint32_t print_rows(const struct cs_table *table, const void *object, int indent,
                           struct cs_text *out) {
    uint32_t n = 0;
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        const void *field = (const char *)object + row->offset;
        if (!cs_option_is_set(row, object))
            continue;
        add_line(out, n++ == 0, indent);
        cs_text_add_json(out, row->name);
        cs_text_add(out, ": ");
        if (row->type == CS_TABLE)
            print_table(row->table, field, indent, out);
        else if (row->type == CS_LIST)
            print_list(row, field, indent, out);
        else
            cs_option_print(row, object, out);
    }
    return n;
}

static void print_table(const struct cs_table *table, const void *object, int indent,
                        struct cs_text *out) {
    cs_text_add(out, "{");
    if (print_rows(table, object, indent + STEP, out))
        cs_text_add(out, "\n%*s", indent, "");
    cs_text_add(out, "}");
}

/* an option that was kept as text, as the JSON that gives it back */
static void print_setting(const struct cs_setting *setting, struct cs_text *out) {
    double value;
    cs_text_add_json(out, setting->name);
    cs_text_add(out, ": ");
    if (cs_parse_real(setting->value, &value))
        cs_text_add_real(out, value);
    else if (!strcmp(setting->value, "true") || !strcmp(setting->value, "false"))
        cs_text_add(out, "%s", setting->value);
    else
        cs_text_add_json(out, setting->value);
}

static void print_integrator(const struct cs_scene *scene, const struct cs_table *table,
                             const void *options, int indent, struct cs_text *out) {
    const struct cs_setting *settings = scene->integrator_settings.items;
    struct cs_text rows = {0};
    cs_text_add(out, "{");
    add_line(out, true, indent + STEP);
    cs_text_add(out, "\"name\": ");
    cs_text_add_json(out, scene->integrator);
    if (table && print_rows(table, options, indent + STEP, &rows))
        cs_text_add(out, ",%s", cs_text_get(&rows));
    for (uint32_t i = 0; !table && i < scene->integrator_settings.n; i++) {
        add_line(out, false, indent + STEP);
        print_setting(settings + i, out);
    }
    cs_text_add(out, "\n%*s}", indent, "");
    out->failed = out->failed || rows.failed;
    cs_text_finish(&rows);
}

void cs_scene_print(const struct cs_scene *scene, const struct cs_table *integrator_table,
                    const void *integrator_options, int indent, struct cs_text *out) {
    cs_text_add(out, "{");
    const uint32_t n = print_rows(&cs_scene_table, scene, indent + STEP, out);
    add_line(out, n == 0, indent + STEP);
    cs_text_add(out, "\"integrator\": ");
    print_integrator(scene, integrator_table, integrator_options, indent + STEP, out);
    cs_text_add(out, "\n%*s}", indent, "");
}
