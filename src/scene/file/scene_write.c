/* Prints a scene as JSON with every value that it holds, defaults included. */
#include "scene/file/scene_read.h"

#include "base/json_writer.h"
#include "base/options.h"

#include <string.h>

enum { STEP = 2 };

static void end_table(const struct cs_table *table, const void *object, int indent,
                      struct cs_text *out);

static void end_list(const struct cs_option *row, const struct cs_list *list, int indent,
                     struct cs_text *out) {
    for (uint32_t i = 0; i < list->n; i++) {
        cs_json_line(out, indent + STEP, "{");
        end_table(row->table, (const char *)list->items + i * row->table->size, indent + STEP,
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
        n++;
        cs_json_line(out, indent,
                     row->type == CS_TABLE  ? "%s: {"
                     : row->type == CS_LIST ? "%s: ["
                                            : "%s: ",
                     row->name);
        if (row->type == CS_TABLE)
            end_table(row->table, field, indent, out);
        else if (row->type == CS_LIST)
            end_list(row, field, indent, out);
        else
            cs_option_print(row, object, out);
    }
    return n;
}

/* after its bracket */
static void end_table(const struct cs_table *table, const void *object, int indent,
                      struct cs_text *out) {
    if (print_rows(table, object, indent + STEP, out))
        cs_text_add(out, "\n%*s", indent, "");
    cs_text_add(out, "}");
}

/* an option that was kept as text, as the JSON that gives it back */
static void print_setting(const struct cs_setting *setting, int indent, struct cs_text *out) {
    double value;
    const bool yes = !strcmp(setting->value, "true");
    if (cs_parse_real(setting->value, &value))
        cs_json_line(out, indent, "%s: %g", setting->name, value);
    else if (yes || !strcmp(setting->value, "false"))
        cs_json_line(out, indent, "%s: %d", setting->name, yes);
    else
        cs_json_line(out, indent, "%s: %s", setting->name, setting->value);
}

static void print_integrator(const struct cs_scene *scene, const struct cs_table *table,
                             const void *options, int indent, struct cs_text *out) {
    const struct cs_setting *settings = scene->integrator_settings.items;
    cs_json_line(out, indent, "'integrator': {");
    cs_json_line(out, indent + STEP, "'name': %s", scene->integrator);
    if (table)
        print_rows(table, options, indent + STEP, out);
    for (uint32_t i = 0; !table && i < scene->integrator_settings.n; i++)
        print_setting(settings + i, indent + STEP, out);
    cs_text_add(out, "\n%*s}", indent, "");
}

void cs_scene_print(const struct cs_scene *scene, const struct cs_table *integrator_table,
                    const void *integrator_options, int indent, struct cs_text *out) {
    cs_text_add(out, "{");
    print_rows(&cs_scene_table, scene, indent + STEP, out);
    print_integrator(scene, integrator_table, integrator_options, indent + STEP, out);
    cs_text_add(out, "\n%*s}", indent, "");
}
