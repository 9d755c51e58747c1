/* Prints what the program writes as a manual and as JSON schemas, from the lists of keys and
 * columns. */
#include "base/json_writer.h"
#include "describe/output_keys.h"

#include <stdio.h>
#include <string.h>

enum { NAME_BYTES = 64, STEP = 2 };

/* A column as a key. In JSON a number may be null and a flag is one; in a table they are an
 * empty field, and 0 or 1. */
static struct cs_output_key key_of(const struct cs_column *column, bool table) {
    static const char *const types[][2] = {[CS_CELL_TEXT] = {"text", "text"},
                                           [CS_CELL_NUMBER] = {"number or null", "number"},
                                           [CS_CELL_FLAG] = {"flag", "0 or 1"}};
    return (struct cs_output_key){column->name, types[column->type][table], column->unit,
                                  column->help};
}

static bool is_optional(const struct cs_output_key *key) {
    return key->path[strlen(key->path) - 1] == '?';
}

/* Length of a path without its mark. */
static size_t path_length(const struct cs_output_key *key) {
    return strlen(key->path) - is_optional(key);
}

/* The last part of a path. */
static void name_of(const struct cs_output_key *key, char name[NAME_BYTES]) {
    const char *dot = strrchr(key->path, '.');
    const char *last = dot ? dot + 1 : key->path;
    snprintf(name, NAME_BYTES, "%.*s", (int)(key->path + path_length(key) - last), last);
}

/* True if the key is a member of the object at `place`: "" for the whole file. */
static bool is_in(const struct cs_output_key *key, const char *place) {
    const char *dot = strrchr(key->path, '.');
    const size_t length = dot ? (size_t)(dot - key->path) : 0;
    return length == strlen(place) && !strncmp(key->path, place, length);
}

/* --- the manual --- */

static void add_manual_row(const struct cs_output_key *key, struct cs_text *out) {
    cs_text_add(out, "*%.*s*: %s", (int)path_length(key), key->path, key->type);
    if (*key->unit)
        cs_text_add(out, ", %s", key->unit);
    cs_text_add(out, "%s\n\t", is_optional(key) ? "; may be absent" : "");
    for (const char *help = key->help; *help; help++)
        cs_text_add(out, strchr("\\*_", *help) ? "\\%c" : "%c", *help);
    cs_text_add(out, ".\n\n");
}

void cs_output_print_manual(struct cs_text *out) {
    for (uint32_t f = 0; f < cs_n_output_files; f++) {
        const struct cs_output_file *file = cs_output_files + f;
        cs_text_add(out, "## %s\n\n%s\n\n", file->name, file->about);
        for (uint32_t k = 0; k < file->n_keys; k++)
            add_manual_row(file->keys + k, out);
        for (uint32_t c = 0; file->columns && !file->columns_in && c < *file->n_columns; c++) {
            const struct cs_output_key key = key_of(file->columns + c, true);
            add_manual_row(&key, out);
        }
    }
}

/* --- the schema --- */

/* Adds the type of a value, "text" or "number or null", as members of a schema. */
static void add_type(const char *type, struct cs_text *out) {
    static const char *const words[][2] = {{"text", "string"},
                                           {"whole", "integer"},
                                           {"number", "number"},
                                           {"flag", "boolean"},
                                           {"object", "object"}};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (!strncmp(type, words[k][0], strlen(words[k][0])))
            cs_json_write(out, strstr(type, " or null") ? "'type': [%s, 'null']" : "'type': %s",
                          words[k][1]);
}

static void add_description(const char *help, const char *unit, struct cs_text *out) {
    struct cs_text text = {0};
    cs_text_add(&text, *unit && strcmp(unit, "1") != 0 ? "%s [%s]" : "%s", help, unit);
    cs_json_write(out, ", 'description': %s", cs_text_get(&text));
    out->failed |= text.failed;
    cs_text_finish(&text);
}

static void add_members(const struct cs_output_file *file, const char *place, int indent,
                        struct cs_text *out);

/* The schema of one key; objects and lists of objects have those of their members in it. */
static void add_key(const struct cs_output_file *file, const struct cs_output_key *key,
                    int indent, struct cs_text *out) {
    char name[NAME_BYTES], place[4 * NAME_BYTES];
    const bool list = !strcmp(key->type, "list");
    name_of(key, name);
    snprintf(place, sizeof place, "%.*s%s", (int)path_length(key), key->path, list ? "[]" : "");
    cs_json_line(out, indent, "%s: {", name);
    if (list) {
        /* the members of an item stand below "PATH[]" */
        cs_json_write(out, "'type': 'array', 'items': {'type': 'object'");
        add_members(file, place, indent + STEP, out);
        cs_text_add(out, "}");
    } else if (!strncmp(key->type, "list of ", 8)) {
        cs_json_write(out, "'type': 'array', 'items': {");
        add_type(key->type + 8, out);
        cs_text_add(out, "}");
    } else {
        add_type(key->type, out);
        if (!strncmp(key->type, "object", 6))
            add_members(file, place, indent + STEP, out);
    }
    add_description(key->help, key->unit, out);
    cs_text_add(out, "}");
}

/* Adds one member, and its name to the list of those that must be there. */
static void add_member(const struct cs_output_file *file, const struct cs_output_key *key,
                       int indent, struct cs_text *rows, struct cs_text *names) {
    char name[NAME_BYTES];
    name_of(key, name);
    if (!is_optional(key))
        cs_json_write(names, ", %s", name);
    add_key(file, key, indent, rows);
}

/* Adds the members of the object at a place, those that it must have, and that it has no other;
 * nothing for an object whose members the list does not have. */
static void add_members(const struct cs_output_file *file, const char *place, int indent,
                        struct cs_text *out) {
    struct cs_text names = {0}, rows = {0};
    /* cells of a comparison have the columns of its table as well */
    const bool columns = file->columns_in && !strcmp(file->columns_in, place);
    for (uint32_t k = 0; k < file->n_keys; k++)
        if (is_in(file->keys + k, place))
            add_member(file, file->keys + k, indent, &rows, &names);
    for (uint32_t c = 0; columns && c < *file->n_columns; c++) {
        const struct cs_output_key key = key_of(file->columns + c, false);
        add_member(file, &key, indent, &rows, &names);
    }
    if (rows.length)
        cs_text_add(out,
                    ", \"properties\": {%s}, \"required\": [%s], \"additionalProperties\": "
                    "false",
                    cs_text_get(&rows), cs_text_get(&names));
    out->failed |= names.failed || rows.failed;
    cs_text_finish(&names);
    cs_text_finish(&rows);
}

/* True for "run" and "run.json". */
static bool is_called(const struct cs_output_file *file, const char *name) {
    const size_t length = strcspn(file->name, ".");
    return !strcmp(file->name, name) ||
           (length == strlen(name) && !strncmp(file->name, name, length));
}

static void print_schema(const struct cs_output_file *file, struct cs_text *out) {
    const bool list = file->keys->path[0] == '[';
    cs_json_write(out,
                  "{\n  '$schema': 'https://json-schema.org/draft/2020-12/schema',\n"
                  "  'title': %s,\n  'type': %s",
                  file->name, list ? "array" : "object");
    if (list)
        cs_json_write(out, ", 'items': {'type': 'object'");
    add_members(file, list ? "[]" : "", 2 * STEP, out);
    cs_text_add(out, "%s\n}\n", list ? "}" : "");
}

enum cs_status cs_output_print_schema(const char *name, struct cs_text *out,
                                      struct cs_error *error) {
    struct cs_text known = {0};
    const struct cs_output_file *found = NULL;
    /* tables have no schema */
    for (uint32_t f = 0; f < cs_n_output_files; f++) {
        const struct cs_output_file *file = cs_output_files + f;
        if (file->keys && is_called(file, name))
            found = file;
        if (file->keys)
            cs_text_add(&known, "%s%.*s", known.length ? ", " : "",
                        (int)strcspn(file->name, "."), file->name);
    }
    if (found)
        print_schema(found, out);
    else
        cs_fail(error, CS_ERR_USAGE, "--schema: found \"%.60s\", expected one of %s", name,
                cs_text_get(&known));
    cs_text_finish(&known);
    return error->status;
}
