#include "made_scene.h"

#include "base/options.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* few particles, few draws and few sweeps: a scene is to be run in a millisecond */
enum { COUNTS_MAX = 8, ITEMS_MAX = 3 };

uint8_t choose(struct choices *choices) {
    if (!choices->n)
        return 0;
    choices->n--;
    return *choices->bytes++;
}

static bool is_unit(const struct cs_option *row, const char *unit) {
    return row->unit && !strcmp(row->unit, unit);
}

static double within(const struct cs_option *row, double value) {
    return value < row->min ? row->min : value > row->max ? row->max : value;
}

/* times are those of the few frames that are run; what is far from its default is rare */
static double choose_real(struct choices *choices, const struct cs_option *row, double def) {
    const uint8_t way = choose(choices);
    const double size = def != 0 && isfinite(def) ? fabs(def) : 1;
    if (way == 255)
        return row->max;
    if (way == 254)
        return row->min;
    if (is_unit(row, "s"))
        return within(row, way / 4096.0);
    if (is_unit(row, "1/s"))
        return within(row, 20 + 4.0 * way);
    const double value = size * ldexp(1 + way % 8 / 8.0, way / 8 % 16 - 8);
    return within(row, way >= 128 && row->min < 0 ? -value : value);
}

double choose_number(struct choices *choices, const struct cs_option *row) {
    if (row->type == CS_BOOL)
        return choose(choices) % 2;
    if (row->type == CS_INT || row->type == CS_COUNTS)
        return within(row, row->min + choose(choices) % COUNTS_MAX);
    if (row->type == CS_REAL || row->type == CS_VECTOR)
        return choose_real(choices, row, row->def);
    uint32_t n = 0;
    while (row->choices[n])
        n++;
    return choose(choices) % n;
}

static void add_table(struct choices *choices, const struct cs_table *table, int needed,
                      struct cs_text *out);

static void add_vector(struct choices *choices, const struct cs_option *row,
                       struct cs_text *out) {
    cs_text_add(out, "[");
    for (uint32_t k = 0; k < row->count; k++) {
        cs_text_add(out, k ? ", " : "");
        cs_text_add_real(out, choose_number(choices, row));
    }
    cs_text_add(out, "]");
}

/* only the texts that name something a scene has; files are left to another target */
static void add_name(struct choices *choices, struct cs_text *out) {
    static const char *const keys[] = {"bodies[0].springs.stretch", "forces.gravity[1]",
                                       "bodies[0].springs.damping", "forces.drag",
                                       "bodies[1].springs.bend",    "colliders[0].friction",
                                       "bodies[0].strain_limit",    "forces.wind.strength"};
    cs_text_add_json(out, keys[choose(choices) % (sizeof keys / sizeof *keys)]);
}

static void add_list(struct choices *choices, const struct cs_option *row,
                     struct cs_text *out) {
    const uint32_t n = 1 + choose(choices) % ITEMS_MAX;
    cs_text_add(out, "[");
    for (uint32_t k = 0; k < n; k++) {
        cs_text_add(out, k ? ", " : "");
        add_table(choices, row->table, choose(choices), out);
    }
    cs_text_add(out, "]");
}

static void add_value(struct choices *choices, const struct cs_option *row,
                      struct cs_text *out) {
    switch (row->type) {
    case CS_BOOL:
        cs_text_add(out, choose(choices) % 2 ? "true" : "false");
        break;
    case CS_CHOICE:
        cs_text_add_json(out, row->choices[(int)choose_number(choices, row)]);
        break;
    case CS_REAL:
    case CS_INT:
        cs_text_add_real(out, choose_number(choices, row));
        break;
    case CS_VECTOR:
    case CS_COUNTS:
        add_vector(choices, row, out);
        break;
    case CS_TEXT:
        add_name(choices, out);
        break;
    case CS_TABLE:
        add_table(choices, row->table, choose(choices), out);
        break;
    case CS_LIST:
        add_list(choices, row, out);
        break;
    }
}

/* files, and what is only drawn */
static bool is_left_out(const struct cs_option *row) {
    static const char *const names[] = {"file",   "about", "source", "texture", "material",
                                        "camera", "light", "render", "extent",  "matrix"};
    bool found = false;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        found |= !strcmp(row->name, names[k]);
    return found;
}

static bool is_called(const struct cs_option *row, const char *name) {
    return !strcmp(row->name, name);
}

/* one of which a table must have exactly one */
static bool is_one_of(const struct cs_table *table, const struct cs_option *row) {
    return table->one_of && row >= table->rows + table->n_always_optional &&
           cs_option_is_optional(row) && !is_left_out(row);
}

static bool is_the_one(const struct cs_table *table, const struct cs_option *row, int kind) {
    int n = 0, place = 0;
    for (uint32_t r = 0; r < table->n; r++) {
        place = table->rows + r == row ? n : place;
        n += is_one_of(table, table->rows + r);
    }
    return kind % n == place;
}

/* an event happens at a time or from one to another, and a body is a cloth or a mesh */
static bool is_part(const struct cs_table *table, const struct cs_option *row, int kind) {
    if (table->n_always_optional)
        return is_called(row, "at")
                   ? kind >= 128
                   : kind < 128 && row < table->rows + table->n_always_optional;
    return is_called(row, "cloth") ? kind % 4 < 3 : is_called(row, "mesh") && kind % 4 == 3;
}

/* what a reader insists on */
static bool is_needed(const struct cs_option *row) {
    static const char *const names[] = {"bodies", "mass",     "force", "at",
                                        "value",  "collider", "path"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (is_called(row, names[k]))
            return true;
    return (row->type == CS_VECTOR || row->type == CS_COUNTS) && !row->defs;
}

static bool is_wanted(struct choices *choices, const struct cs_table *table,
                      const struct cs_option *row, int kind) {
    if (is_left_out(row))
        return false;
    if (is_one_of(table, row))
        return is_the_one(table, row, kind);
    if (is_called(row, "cloth") || is_called(row, "mesh") ||
        (table->n_always_optional && row < table->rows + table->n_always_optional))
        return is_part(table, row, kind);
    return is_needed(row) || choose(choices) >= 160;
}

static void add_table(struct choices *choices, const struct cs_table *table, int kind,
                      struct cs_text *out) {
    bool first = true;
    cs_text_add(out, "{");
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        if (!is_wanted(choices, table, row, kind))
            continue;
        cs_text_add(out, "%s\"%s\": ", first ? "" : ", ", row->name);
        first = false;
        add_value(choices, row, out);
    }
    cs_text_add(out, "}");
}

void make_scene(struct choices *choices, struct cs_text *out) {
    add_table(choices, &cs_scene_table, 0, out);
}
