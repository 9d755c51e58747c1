/* The scene hash: of what a scene means, not of how it is written or of how many keys there
 * are.
 */
#include "base/options.h"
#include "mesh/trimesh.h"
#include "scene/body_keys.h"
#include "scene/collider_keys.h"
#include "scene/file/scene_read.h"
#include "scene/mesh_keys.h"
#include "unit.h"

#include <math.h>

enum { HASHES_MAX = 1024 };

static const struct cs_table no_options = {.n = 0};

static void hash_of(const struct cs_scene *scene, char digits[CS_HASH_DIGITS]) {
    struct cs_error error = {0};
    ck_assert_int_eq(cs_scene_hash(scene, &no_options, scene, digits, &error), CS_OK);
    ck_assert_uint_eq(strlen(digits), CS_HASH_DIGITS - 1);
}

/* of a scene in text */
static void hash_of_text(const char *text, char digits[CS_HASH_DIGITS]) {
    struct cs_error error = {0};
    struct cs_scene scene;
    cs_scene_read_text(&scene, "s.json", text, strlen(text), NULL, 0, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    hash_of(&scene, digits);
    cs_scene_finish(&scene);
}

/* Every optional table is there, every list has one element; all values at their defaults. */
static void fill(const struct cs_table *table, void *object) {
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        void *field = cs_option_field(row, object);
        if (row->type == CS_TABLE) {
            if (!field) {
                *(void **)(void *)((char *)object + row->offset) = field =
                    calloc(1, row->table->size);
                cs_options_default(row->table, field);
            }
            if (row->table->optional)
                *(bool *)field = true;
            fill(row->table, field);
        } else if (row->type == CS_LIST) {
            struct cs_list *list = field;
            *list = (struct cs_list){.items = calloc(1, row->table->size), .n = 1};
            cs_options_default(row->table, list->items);
            fill(row->table, list->items);
        }
    }
}

static void empty(const struct cs_table *table, void *object) {
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        void *field = cs_option_field(row, object);
        if (row->type == CS_TABLE)
            empty(row->table, field);
        if (row->type == CS_TABLE && row->table->apart && row->table->optional)
            free(field);
        if (row->type == CS_LIST) {
            empty(row->table, ((struct cs_list *)field)->items);
            free(((struct cs_list *)field)->items);
        }
    }
}

/* All rows of the scene, and the hashes that their changes have led to. */
struct walk {
    struct cs_scene scene;
    char found[HASHES_MAX][CS_HASH_DIGITS];
    uint32_t n;
};

/* the hash as it now is has not been there before */
static void expect_another(struct walk *walk, const char *what) {
    ck_assert_uint_lt(walk->n, HASHES_MAX);
    hash_of(&walk->scene, walk->found[walk->n]);
    for (uint32_t k = 0; k < walk->n; k++)
        ck_assert_msg(strcmp(walk->found[k], walk->found[walk->n]) != 0,
                      "change %u, %s: the hash is that of change %u", walk->n, what, k);
    walk->n++;
}

/* One component of a value becomes another one, and its own again. */
static void change_component(struct walk *walk, const struct cs_option *row, void *object,
                             uint32_t i) {
    void *field = cs_option_field(row, object);
    double real = 0;
    int64_t whole = 0;
    switch (row->type) {
    case CS_REAL:
    case CS_VECTOR:
        real = ((double *)field)[i];
        // what may be absent is so as a whole
        for (uint32_t c = 0; isnan(real) && c < row->count; c++)
            ((double *)field)[c] = 0.5;
        ((double *)field)[i] += isnan(real) ? 0.25 * i : 0.25;
        expect_another(walk, row->name);
        for (uint32_t c = 0; isnan(real) && c < row->count; c++)
            ((double *)field)[c] = real;
        ((double *)field)[i] = real;
        break;
    case CS_INT:
    case CS_COUNTS:
        whole = ((int64_t *)field)[i];
        ((int64_t *)field)[i] = (int64_t)fmax((double)whole + 1, row->min);
        expect_another(walk, row->name);
        ((int64_t *)field)[i] = whole;
        break;
    default:
        ck_abort_msg("%s has no components", row->name);
    }
}

static void change_all(struct walk *walk, const struct cs_table *table, void *object);

static void change_row(struct walk *walk, const struct cs_option *row, void *object) {
    void *field = cs_option_field(row, object);
    struct cs_list *list = field;
    int32_t choice;
    memcpy(&choice, field, sizeof choice); // a row of another type may be at any address
    switch (row->type) {
    case CS_BOOL:
        *(bool *)field ^= true;
        expect_another(walk, row->name);
        *(bool *)field ^= true;
        break;
    case CS_CHOICE:
        for (int32_t k = 0; row->choices[k]; k++)
            if (k != choice) {
                *(int32_t *)field = k;
                expect_another(walk, row->choices[k]);
            }
        *(int32_t *)field = choice;
        break;
    case CS_TEXT:
        strcpy(field, "quoted \"text\"\n");
        expect_another(walk, row->name);
        *(char *)field = 0;
        break;
    case CS_TABLE:
        if (row->table->optional) {
            *(bool *)field = false;
            expect_another(walk, row->name);
            *(bool *)field = true;
        }
        change_all(walk, row->table, field);
        break;
    case CS_LIST:
        change_all(walk, row->table, list->items);
        list->n = 0;
        expect_another(walk, row->name);
        list->n = 1;
        break;
    default:
        for (uint32_t i = 0; i < row->count; i++)
            change_component(walk, row, object, i);
    }
}

static void change_all(struct walk *walk, const struct cs_table *table, void *object) {
    for (uint32_t r = 0; r < table->n; r++)
        change_row(walk, table->rows + r, object);
}

/* Each row of the schema in turn has another value: all hashes differ, pairwise. */
TEST(every_key_counts) {
    static struct walk walk;
    struct cs_trimesh mesh = {.file_hash = "0123"};
    struct cs_error error = {0};
    cs_scene_init(&walk.scene, &error);
    UNIT_ASSERT_OK(&error);
    fill(&cs_scene_table, &walk.scene);
    cs_scene_bodies(&walk.scene)->geometry = &mesh;
    cs_scene_colliders(&walk.scene)->geometry = &mesh;
    expect_another(&walk, "none");
    change_all(&walk, &cs_scene_table, &walk.scene);
    strcpy(walk.scene.integrator, "rk4");
    expect_another(&walk, "integrator");
    // the bytes of a mesh file, under the same name
    strcpy(cs_scene_bodies(&walk.scene)->mesh->file, "a.obj");
    expect_another(&walk, "mesh file");
    strcpy(cs_scene_colliders(&walk.scene)->mesh->file, "a.obj");
    expect_another(&walk, "mesh file of a collider");
    strcpy(mesh.file_hash, "4567");
    expect_another(&walk, "bytes of a mesh file");
    ck_assert_uint_gt(walk.n, 200);
    empty(&cs_scene_table, &walk.scene);
    cs_scene_finish(&walk.scene);
}

/* The table with a row more at its end, and with it in front: at its default it says nothing.
 */
TEST(new_key_at_its_default_changes_nothing) {
    struct later_time {
        struct cs_time known;
        double slowness;
        bool leaps;
    };
    const struct cs_table *known = NULL;
    for (uint32_t r = 0; r < cs_scene_table.n; r++)
        if (!strcmp(cs_scene_table.rows[r].name, "time"))
            known = cs_scene_table.rows[r].table;
    ck_assert_ptr_nonnull(known);
    struct cs_option rows[16] = {
        {.name = "slowness",
         .type = CS_REAL,
         .count = 1,
         .offset = offsetof(struct later_time, slowness),
         .def = 3,
         .max = 9},
        {.name = "leaps",
         .type = CS_BOOL,
         .count = 1,
         .offset = offsetof(struct later_time, leaps)},
    };
    ck_assert_uint_lt(known->n, 14);
    memcpy(rows + 2, known->rows, known->n * sizeof *rows);
    const struct cs_table later = {
        .rows = rows, .n = known->n + 2, .size = sizeof(struct later_time)};
    struct later_time time;
    struct cs_text before = {0}, after = {0}, given = {0};
    cs_options_default(&later, &time);
    time.known.fps = 25;
    cs_scene_add_canonical(known, &time.known, "time.", &before);
    cs_scene_add_canonical(&later, &time, "time.", &after);
    ck_assert_str_eq(cs_text_get(&before), "time.fps=25\n");
    ck_assert_str_eq(cs_text_get(&after), cs_text_get(&before));
    time.slowness = 4;
    cs_scene_add_canonical(&later, &time, "time.", &given);
    ck_assert_str_eq(cs_text_get(&given), "time.slowness=4\ntime.fps=25\n");
    cs_text_finish(&before);
    cs_text_finish(&after);
    cs_text_finish(&given);
}

#define BODY "\"cloth\": {\"grid\": [4, 3]}, \"mass\": {\"total\": 2}"

/* The same scene in other words: order of keys, numbers, defaults said, keys of the user's own.
 */
TEST(spelling_does_not_count) {
    static const char *const same[] = {
        "{\"bodies\": [{" BODY ", \"strain_limit\": 1.5}], \"time\": {\"fps\": 50}}",
        "{\"time\": {\"fps\": 5e1}, \"bodies\": [{\"strain_limit\": 1.50, " BODY "}]}",
        "{\"x-note\": 3, \"bodies\": [{" BODY ", \"strain_limit\": 15e-1}],\n"
        "  \"time\": {\"fps\": 50.000}, \"forces\": {\"gravity\": [0.0, -9.81, -0]},"
        " \"colliders\": [], \"render\": {}}"};
    static const char *const others[] = {
        "{\"bodies\": [{" BODY "}], \"time\": {\"fps\": 50}}",
        "{\"bodies\": [{" BODY ", \"strain_limit\": 1.5}]}",
        "{\"bodies\": [{" BODY ", \"strain_limit\": 1.5}], \"time\": {\"fps\": 50},"
        " \"forces\": {\"gravity\": [0, -9.81, 1e-300]}}",
        /* a floor at its defaults is a floor */
        "{\"bodies\": [{" BODY ", \"strain_limit\": 1.5}], \"time\": {\"fps\": 50},"
        " \"colliders\": [{\"floor\": {}}]}"};
    char first[CS_HASH_DIGITS], digits[CS_HASH_DIGITS];
    hash_of_text(same[0], first);
    for (size_t k = 1; k < sizeof same / sizeof *same; k++) {
        hash_of_text(same[k], digits);
        ck_assert_msg(!strcmp(digits, first), "%s", same[k]);
    }
    for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
        hash_of_text(others[k], digits);
        ck_assert_msg(strcmp(digits, first) != 0, "%s", others[k]);
    }
}

/* Bodies have numbers: which is the first means something. */
TEST(order_of_a_list_counts) {
    char ab[CS_HASH_DIGITS], ba[CS_HASH_DIGITS];
    hash_of_text("{\"bodies\": [{" BODY "}, {" BODY ", \"strain_limit\": 1.5}]}", ab);
    hash_of_text("{\"bodies\": [{" BODY ", \"strain_limit\": 1.5}, {" BODY "}]}", ba);
    ck_assert_str_ne(ab, ba);
}
