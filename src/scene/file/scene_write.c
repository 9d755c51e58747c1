/* Prints a scene as JSON with every value that it holds, defaults included; and hashes what it
 * means: XXH3 (128 bits) over sorted "path=value" lines, defaults left out. */
#include "scene/file/scene_read.h"

#include "base/json_writer.h"
#include "base/options.h"
#include "mesh/trimesh.h"
#include "mesh/vertex_paths.h"
#include "scene/body_keys.h"
#include "scene/collider_keys.h"
#include "scene/mesh_keys.h"

#include <stdlib.h>
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
        const void *field = cs_option_value(row, object);
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

/* Adds a value in the form that is hashed. */
static void add_value(const struct cs_option *row, const void *object, struct cs_text *out) {
    const double *values = cs_option_value(row, object);
    if (row->type != CS_REAL && row->type != CS_VECTOR) {
        cs_option_print(row, object, out);
        return;
    }
    for (uint32_t i = 0; i < row->count; i++) {
        cs_text_add(out, "%s", i ? "," : "");
        cs_text_add_real(out, values[i] + 0.0); // -0 + 0 is 0
    }
}

/* Adds the lines of one row: of a table, of a list, or of a value that is not the default. */
static void add_scene_row(const struct cs_option *row, const void *object, const char *path,
                          struct cs_text *out) {
    const void *field = cs_option_value(row, object);
    struct cs_text inner = {0};
    if (row->type == CS_TABLE) {
        /* presence alone has a meaning, even if every value is the default */
        if (row->table->optional)
            cs_text_add(out, "%s%s={}\n", path, row->name);
        cs_text_add(&inner, "%s%s.", path, row->name);
        cs_scene_add_canonical(row->table, field, cs_text_get(&inner), out);
    } else if (row->type == CS_LIST) {
        /* every element has a line of its own, or lists of defaults would all look alike */
        const struct cs_list *list = field;
        for (uint32_t i = 0; i < list->n; i++) {
            struct cs_text item = {0};
            cs_text_add(out, "%s%s[%u]={}\n", path, row->name, i);
            cs_text_add(&item, "%s%s[%u].", path, row->name, i);
            cs_scene_add_canonical(row->table, (const char *)list->items + i * row->table->size,
                                   cs_text_get(&item), out);
            out->failed |= item.failed;
            cs_text_finish(&item);
        }
        /* a default has no line, so that a new key changes no scene's hash */
    } else if (!cs_option_is_default(row, object)) {
        cs_text_add(out, "%s%s=", path, row->name);
        add_value(row, object, out);
        cs_text_add(out, "\n");
    }
    out->failed |= inner.failed;
    cs_text_finish(&inner);
}

void cs_scene_add_canonical(const struct cs_table *table, const void *object, const char *path,
                            struct cs_text *out) {
    for (uint32_t r = 0; r < table->n; r++)
        if (cs_option_is_set(table->rows + r, object))
            add_scene_row(table->rows + r, object, path, out);
}

/* Adds the hash of a mesh's file, since its contents count. */
static void add_file(const struct cs_mesh_source *mesh, const struct cs_trimesh *geometry,
                     const char *list, uint32_t number, struct cs_text *out) {
    if (mesh && *mesh->file)
        cs_text_add(out, "%s[%u].mesh.file is %s\n", list, number, geometry->file_hash);
}

static void add_files(const struct cs_scene *scene, struct cs_text *out) {
    const struct cs_body *bodies = cs_scene_bodies(scene);
    const struct cs_collider *colliders = cs_scene_colliders(scene);
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        add_file(bodies[b].mesh, bodies[b].geometry, "bodies", b, out);
    for (uint32_t c = 0; c < scene->colliders.n; c++) {
        add_file(colliders[c].mesh, colliders[c].geometry, "colliders", c, out);
        if (colliders[c].paths)
            cs_text_add(out, "colliders[%u].mesh.key_frames.file is %s\n", c,
                        colliders[c].paths->file_hash);
    }
}

/* Orders lines by their bytes, independent of the locale. */
static int by_bytes(const void *left, const void *right) {
    return strcmp(*(const char *const *)left, *(const char *const *)right);
}

/* Adds the lines of the text, sorted; the text is cut up. */
static void add_sorted(char *text, struct cs_text *out) {
    size_t n = 0;
    for (const char *c = text; *c; c++)
        n += *c == '\n';
    char **lines = calloc(n + 1, sizeof *lines);
    out->failed |= !lines;
    for (size_t k = 0; k < n && lines; k++)
        lines[k] = strsep(&text, "\n");
    if (lines)
        qsort(lines, n, sizeof *lines, by_bytes);
    for (size_t k = 0; k < n && lines; k++)
        cs_text_add(out, "%s\n", lines[k]);
    free(lines);
}

enum cs_status cs_scene_hash(const struct cs_scene *scene,
                             const struct cs_table *integrator_table,
                             const void *integrator_options, char digits[CS_HASH_DIGITS],
                             struct cs_error *error) {
    struct cs_text lines = {0}, sorted = {0};
    *digits = 0;
    cs_scene_add_canonical(&cs_scene_table, scene, "", &lines);
    cs_text_add(&lines, "integrator=%s\n", scene->integrator);
    cs_scene_add_canonical(integrator_table, integrator_options, "integrator.", &lines);
    add_files(scene, &lines);
    cs_text_add(&sorted, "clothsim scene 1\n");
    if (!lines.failed)
        add_sorted(lines.bytes, &sorted);
    if (lines.failed || sorted.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the hash of a scene");
    else
        cs_hash_bytes(sorted.bytes, sorted.length, digits);
    cs_text_finish(&lines);
    cs_text_finish(&sorted);
    return error->status;
}
