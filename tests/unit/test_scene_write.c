/* What is written of a scene reads back as the same scene; schema and manual follow the tables.
 */
#include "base/options.h"
#include "cli/commands.h"
#include "scene/file/json.h"
#include "scene/file/scene_read.h"
#include "scene/scene.h"
#include "unit.h"

#include <math.h>

static const char *const scenes[] = {
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 3]}, \"mass\": {\"total\": 2}}]}",
    "{\"about\": \"quotes \\\" \\\\ and caf\xc3\xa9 \\u0001\", \"source\": \"s\","
    " \"bodies\": [{\"cloth\": {\"grid\": [5, 6], \"size\": [0.1, 0.30000000000000004],"
    "   \"start\": \"flat\", \"place\": {\"translate\": [1e-300, 0, 1e9], \"rotate\": [1, 2, "
    "3, 4]},"
    "   \"velocity\": [0, -1, 0.333333333333333314829616256247]},"
    "   \"mass\": {\"areal_density\": 0.2}, \"springs\": {\"stretch\": 123456789.012345678,"
    "   \"damping_model\": \"relative\", \"stiffness_unit\": \"N\"}, \"strain_limit\": 1.1,"
    "   \"pins\": [\"top-left\", 29, {\"box\": {\"min\": [-1, -1, -1], \"max\": [1, 1, 1]}}],"
    "   \"material\": {\"back_colour\": [0, 0.5, 1], \"texture\": \"a/b.png\"}},"
    "   {\"cloth\": {\"grid\": [2, 2], \"place\": {\"matrix\": [0, 1, 0, -1, 0, 0, 0, 0, 1]}},"
    "   \"mass\": {\"particle\": 0.001}}],"
    " \"colliders\": [{\"floor\": {}}, {\"plane\": {\"normal\": [1, 1, 1]}, \"absorption\": "
    "-0.5},"
    "   {\"sphere\": {\"centre\": [0, 0, 0]}, \"visible\": false}],"
    " \"forces\": {\"wind\": {\"direction\": [1, 2, 3], \"strength\": 19.5}, \"drag\": 0.01},"
    " \"integrator\": {\"name\": \"cvode-bdf\", \"rtol\": 1e-4, \"fast\": true, \"k\": "
    "\"newton\"},"
    " \"light\": {\"direction\": [0, -1, 0]}, \"render\": {\"range\": [0, 2.5], "
    "\"background\": [0.5, 0.25, 1], "
    "\"viewpoint_forces\": true, \"ground\": \"grid\"}}"};

static void read_text(struct cs_scene *scene, const char *text) {
    struct cs_error error = {0};
    cs_scene_read_text(scene, "s.json", text, strlen(text), NULL, 0, &error);
    UNIT_ASSERT_OK(&error);
}

static void assert_same_table(const struct cs_table *table, const void *a, const void *b);

/* bit for bit, but an absent value equals an absent one */
static void assert_same_row(const struct cs_option *row, const void *a, const void *b) {
    const char *field_a = cs_option_value(row, a), *field_b = cs_option_value(row, b);
    const struct cs_list *list_a = (const void *)field_a, *list_b = (const void *)field_b;
    ck_assert_msg(cs_option_is_set(row, a) == cs_option_is_set(row, b), "%s", row->name);
    if (!cs_option_is_set(row, a))
        return;
    switch (row->type) {
    case CS_TABLE:
        assert_same_table(row->table, field_a, field_b);
        break;
    case CS_LIST:
        ck_assert_uint_eq(list_a->n, list_b->n);
        for (uint32_t i = 0; i < list_a->n; i++)
            assert_same_table(row->table, (const char *)list_a->items + i * row->table->size,
                              (const char *)list_b->items + i * row->table->size);
        break;
    case CS_TEXT:
        ck_assert_str_eq(field_a, field_b);
        break;
    case CS_BOOL:
        ck_assert_int_eq(*field_a, *field_b);
        break;
    case CS_CHOICE:
        ck_assert_mem_eq(field_a, field_b, sizeof(int32_t));
        break;
    default: /* doubles and int64_t alike */
        ck_assert_msg(!memcmp(field_a, field_b, 8 * row->count), "%s", row->name);
    }
}

static void assert_same_table(const struct cs_table *table, const void *a, const void *b) {
    for (uint32_t r = 0; r < table->n; r++)
        assert_same_row(table->rows + r, a, b);
}

static void assert_same_integrator(const struct cs_scene *a, const struct cs_scene *b) {
    const struct cs_setting *of_a = a->integrator_settings.items;
    const struct cs_setting *of_b = b->integrator_settings.items;
    ck_assert_str_eq(a->integrator, b->integrator);
    ck_assert_uint_eq(a->integrator_settings.n, b->integrator_settings.n);
    for (uint32_t i = 0; i < a->integrator_settings.n; i++) {
        ck_assert_str_eq(of_a[i].name, of_b[i].name);
        ck_assert_str_eq(of_a[i].value, of_b[i].value);
    }
}

TEST(what_is_printed_reads_back) {
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        struct cs_scene scene, back;
        struct cs_text first = {0}, second = {0};
        read_text(&scene, scenes[k]);
        cs_scene_print(&scene, NULL, NULL, 0, &first);
        read_text(&back, cs_text_get(&first));
        assert_same_table(&cs_scene_table, &scene, &back);
        assert_same_integrator(&scene, &back);
        cs_scene_print(&back, NULL, NULL, 0, &second);
        ck_assert_str_eq(cs_text_get(&first), cs_text_get(&second));
        cs_text_finish(&first);
        cs_text_finish(&second);
        cs_scene_finish(&scene);
        cs_scene_finish(&back);
    }
}

TEST(every_value_is_printed) {
    struct cs_scene scene;
    struct cs_text text = {0};
    read_text(&scene, scenes[0]);
    cs_scene_print(&scene, NULL, NULL, 4, &text);
    static const char *const parts[] = {"{\n      \"bodies\": [",
                                        "\"grid\": [4, 3]",
                                        "\"bend\": 8",
                                        "\"fps\": 6",
                                        "\"specular\": [1, 0.97, 0.92]",
                                        "\"look\": \"lit\"",
                                        "\"ground\": \"auto\"",
                                        "\"viewpoint_forces\": false",
                                        "\"name\": \"" CS_INTEGRATOR_DEFAULT
                                        "\"\n      }\n    }"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        ck_assert_msg(strstr(cs_text_get(&text), parts[i]) != NULL, "no %s in %s", parts[i],
                      cs_text_get(&text));
    static const char *const absent[] = {"null",      "nan",       "wind",  "strain_limit\"",
                                         "texture\"", "colliders", "about", "particle"};
    for (size_t i = 0; i < sizeof absent / sizeof *absent; i++)
        ck_assert_msg(!strstr(cs_text_get(&text), absent[i]), "%s", absent[i]);
    cs_text_finish(&text);
    cs_scene_finish(&scene);
}

/* with a method's table its own values stand there, resolved */
struct options {
    double dt, rtol;
    int64_t order;
    bool fast;
    int32_t kind;
};
static const char *const kinds[] = {"newton", "fixed-point", NULL};

TEST(resolved_options_are_printed) {
    static const struct cs_option rows[] = {
        CS_OPTION(struct options, dt, "s", (double)NAN, 1e-9, 1, "step"),
        CS_OPTION(struct options, rtol, "", 1e-4, 0, 1, "tolerance"),
        CS_OPTION(struct options, order, "", 5, 1, 5, "order"),
        CS_OPTION(struct options, fast, "", 0, 0, 1, "fast"),
        CS_OPTION_CHOICE(struct options, kind, kinds, 1, "kind")};
    const struct cs_table table = {.rows = rows, .n = 5, .size = sizeof(struct options)};
    struct options options;
    struct cs_scene scene;
    struct cs_text text = {0}, empty = {0};
    read_text(&scene, scenes[1]);
    cs_options_default(&table, &options);
    cs_scene_print(&scene, &table, &options, 0, &text);
    ck_assert_ptr_nonnull(strstr(
        cs_text_get(&text), "\"integrator\": {\n    \"name\": \"cvode-bdf\",\n    \"rtol\": "
                            "0.0001,\n    \"order\": 5,\n    \"fast\": false,\n    \"kind\": "
                            "\"fixed-point\"\n  }\n}"));
    /* a method without options */
    cs_scene_print(&scene, &(struct cs_table){0}, &options, 0, &empty);
    ck_assert_ptr_nonnull(
        strstr(cs_text_get(&empty), "\"integrator\": {\n    \"name\": \"cvode-bdf\"\n  }\n}"));
    cs_text_finish(&text);
    cs_text_finish(&empty);
    cs_scene_finish(&scene);
}

/* the value at a chain of keys, closed by NULL */
static const struct cs_json *find(const struct cs_json *value, const char *const *keys) {
    for (; *keys; keys++) {
        value = cs_json_find(value, *keys);
        ck_assert_msg(value != NULL, "no %s", *keys);
    }
    return value;
}
#define FIND(value, ...) find(value, (const char *const[]){__VA_ARGS__, NULL})

TEST(schema_says_what_the_tables_say) {
    struct cs_text text = {0};
    struct cs_json *root;
    struct cs_json_fault fault = {0};
    cs_scene_print_schema(&text);
    ck_assert_msg(!cs_json_parse(cs_text_get(&text), text.length, &root, &fault), "%zu %s",
                  fault.offset, fault.message);
    ck_assert_str_eq(cs_json_text(FIND(root, "$schema")),
                     "https://json-schema.org/draft/2020-12/schema");
    const struct cs_json *body = FIND(root, "properties", "bodies", "items");
    ck_assert(!cs_json_is_true(FIND(body, "additionalProperties")));
    ck_assert(cs_json_is_true(FIND(body, "patternProperties", "^(x-|\\$)")));
    ck_assert_str_eq(cs_json_text(cs_json_at(FIND(body, "required"), 0)), "mass");
    const struct cs_json *stretch =
        FIND(body, "properties", "springs", "properties", "stretch");
    ck_assert_double_eq(cs_json_number(FIND(stretch, "minimum")), 0);
    ck_assert_double_eq(cs_json_number(FIND(stretch, "maximum")), 1e12);
    ck_assert_double_eq(cs_json_number(FIND(stretch, "default")), 50);
    ck_assert_uint_eq(cs_json_count(FIND(body, "properties", "mass", "oneOf")), 4);
    ck_assert_uint_eq(cs_json_count(FIND(body, "properties", "pins", "items", "anyOf")), 3);
    const struct cs_json *grid = FIND(body, "properties", "cloth", "properties", "grid");
    ck_assert_double_eq(cs_json_number(FIND(grid, "minItems")), 2);
    ck_assert_str_eq(cs_json_text(FIND(grid, "items", "type")), "integer");
    ck_assert_ptr_nonnull(FIND(root, "properties", "integrator", "anyOf"));
    ck_assert_uint_eq(
        cs_json_count(FIND(root, "properties", "render", "properties", "look", "enum")), 10);
    cs_json_destroy(root);
    cs_text_finish(&text);
}

static void assert_in_manual(const struct cs_table *table, const char *manual) {
    for (uint32_t r = 0; r < table->n; r++) {
        char key[64];
        snprintf(key, sizeof key, "\n*%s*: ", table->rows[r].name);
        ck_assert_msg(strstr(manual, key) != NULL, "%s", key);
        if (table->rows[r].table)
            assert_in_manual(table->rows[r].table, manual);
    }
}

TEST(manual_has_every_key) {
    struct cs_text text = {0};
    cs_text_add(&text, "\n");
    cs_scene_print_manual(&text);
    assert_in_manual(&cs_scene_table, cs_text_get(&text));
    static const char *const parts[] = {
        "\n## bodies[].cloth.place\n", "required\n\tcolumns and rows.\n",
        "A plain string stands for an object with *at* alone.",
        "A plain list stands for an object with *colour* alone.",
        "Exactly one must be given of: *particle*, *areal_density*, *total*, *degree*.",
        /* a star of the text is no markup */
        "row \\* columns + column", "; default lit\n"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        ck_assert_msg(strstr(cs_text_get(&text), parts[i]) != NULL, "no %s", parts[i]);
    cs_text_finish(&text);
}
