/* Scenes are read whole, with defaults, shorthands; bad ones name the place. */
#include "base/options.h"
#include "scene/body_keys.h"
#include "scene/collider_keys.h"
#include "scene/force_keys.h"
#include "scene/picture_keys.h"
#include "scene_text.h"

#include <math.h>

TEST(defaults_stand_in) {
    struct cs_scene scene;
    const char *text = "{\"bodies\": [" BODY "]}";
    read_text(&scene, text, NULL, 0);
    ck_assert_uint_eq(scene.bodies.n, 1);
    const struct cs_body *body = cs_scene_bodies(&scene);
    ck_assert(body->cloth.present);
    ck_assert_int_eq(body->cloth.grid[0], 4);
    ck_assert_int_eq(body->cloth.grid[1], 3);
    ck_assert_double_eq(body->cloth.size[1], 1);
    ck_assert_double_eq(body->cloth.place.rotate[3], 1);
    ck_assert(isnan(body->cloth.place.matrix[0]));
    ck_assert_double_eq(body->mass.total, 2);
    ck_assert(isnan(body->mass.particle));
    ck_assert_double_eq(body->springs.stretch, 50);
    ck_assert_int_eq(body->springs.damping_model, CS_DAMPING_AXIAL);
    ck_assert(isnan(body->strain_limit));
    ck_assert_uint_eq(body->pins.n, 0);
    ck_assert_ptr_null(body->pins.items);
    ck_assert_uint_eq(scene.colliders.n, 0);
    ck_assert(!scene.forces->wind.present);
    ck_assert_double_eq(scene.forces->gravity[1], -9.81);
    ck_assert_double_eq(scene.time.fps, 60);
    ck_assert_int_eq(scene.render->size[0], 640);
    ck_assert_str_eq(scene.integrator, CS_INTEGRATOR_DEFAULT);
    ck_assert_uint_eq(scene.integrator_settings.n, 0);
    ck_assert_str_eq(scene.path, "dir/s.json");
    ck_assert_str_eq(scene.folder, "dir");
    ck_assert_uint_eq(scene.text_bytes, strlen(text));
    ck_assert_str_eq(scene.text, text);
    cs_scene_finish(&scene);
}

/* bit for bit, but elsewhere; the events are shared */
TEST(a_copy_has_numbers_of_its_own) {
    struct cs_scene scene, copy;
    struct cs_error error = {0};
    read_text(&scene,
              "{\"bodies\": [" BODY "], \"colliders\": [{\"floor\": {}}], \"events\":"
              " [{\"at\": 1, \"ramp\": {\"key\": \"forces.drag\", \"value\": 2}}]}",
              NULL, 0);
    cs_scene_copy(&copy, &scene, &copy.arena, &error);
    UNIT_ASSERT_OK(&error);
    for (uint32_t r = 0; r < cs_scene_table.n; r++) {
        const struct cs_option *row = cs_scene_table.rows + r;
        const void *own = cs_option_value(row, &scene), *copied = cs_option_value(row, &copy);
        const struct cs_list *list = own, *other = copied;
        if (row->type == CS_TABLE)
            ck_assert_mem_eq(own, copied, row->table->size);
        ck_assert(own != copied);
        if (row->type != CS_LIST || list->n == 0)
            continue;
        ck_assert_uint_eq(list->n, other->n);
        ck_assert_mem_eq(list->items, other->items, list->n * row->table->size);
        ck_assert_int_eq(list->items == other->items, row->table == &cs_event_table);
    }
    cs_scene_finish(&copy);
    ck_assert_double_eq(cs_scene_bodies(&scene)->mass.total, 2);
    cs_scene_finish(&scene);
}

TEST(everything_given_is_kept) {
    struct cs_scene scene;
    read_text(
        &scene,
        "{\"$schema\": \"s\", \"x-mine\": {\"any\": [null]}, \"about\": \"caf\xc3\xa9\","
        " \"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"start\": \"flat\"}, \"x-note\": 1,"
        "   \"mass\": {\"degree\": 0.5}, \"springs\": {\"stiffness_unit\": \"N\"},"
        "   \"pins\": [\"top-left\", 7, {\"at\": \"edges\"}, {\"index\": 3},"
        "             {\"box\": {\"min\": [0, 0, 0], \"max\": [1, 2, 3]}}],"
        "   \"strain_limit\": 1.1, \"material\": {\"texture\": \"weave.png\"}}, " BODY "],"
        " \"colliders\": [{\"floor\": {}}, {\"sphere\": {\"centre\": [1, 2, 3]},"
        "   \"friction\": 0.5, \"visible\": false}],"
        " \"integrator\": {\"name\": \"cvode-bdf\", \"rtol\": 1e-4, \"fast\": true,"
        "   \"kind\": \"newton\", \"x-why\": []}, \"render\": {\"look\": \"force\"}}",
        NULL, 0);
    const struct cs_body *body = cs_scene_bodies(&scene);
    const struct cs_pin *pins = body->pins.items;
    ck_assert_str_eq(scene.about, "caf\xc3\xa9");
    ck_assert_uint_eq(scene.bodies.n, 2);
    ck_assert_int_eq(body->cloth.start, CS_START_FLAT);
    ck_assert_int_eq(body->springs.stiffness_unit, CS_STIFFNESS_N);
    ck_assert_uint_eq(body->pins.n, 5);
    ck_assert_int_eq(pins[0].at, CS_PIN_TOP_LEFT);
    ck_assert_int_eq(pins[0].index, -1);
    ck_assert_int_eq(pins[1].at, -1);
    ck_assert_int_eq(pins[1].index, 7);
    ck_assert_int_eq(pins[2].at, CS_PIN_EDGES);
    ck_assert_int_eq(pins[3].index, 3);
    ck_assert(pins[4].box.present && !pins[3].box.present);
    ck_assert_double_eq(pins[4].box.max[2], 3);
    ck_assert_str_eq(body->material.texture, "weave.png");
    ck_assert_double_eq(body[1].mass.total, 2);
    const struct cs_collider *colliders = cs_scene_colliders(&scene);
    ck_assert(colliders[0].floor.present && !colliders[0].sphere.present);
    ck_assert_double_eq(colliders[1].sphere.radius, 0.3);
    ck_assert(!colliders[1].visible);
    ck_assert_int_eq(scene.render->look, CS_LOOK_FORCE);
    ck_assert_str_eq(scene.integrator, "cvode-bdf");
    const struct cs_setting *settings = scene.integrator_settings.items;
    ck_assert_uint_eq(scene.integrator_settings.n, 3);
    ck_assert_str_eq(settings[0].name, "rtol");
    ck_assert_str_eq(settings[0].value, "0.0001");
    ck_assert_str_eq(settings[1].value, "true");
    ck_assert_str_eq(settings[2].value, "newton");
    cs_scene_finish(&scene);
}

TEST(folder_is_that_of_the_path) {
    static const char *const rows[][2] = {
        {"a.json", "."}, {"s/a.json", "s"}, {"/a.json", "/"}, {"./s/t/a.json", "./s/t"}};
    const char *text = "{\"bodies\": [" BODY "]}";
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct cs_error error = {0};
        struct cs_scene scene;
        cs_scene_read_text(&scene, rows[i][0], text, strlen(text), NULL, 0, &error);
        UNIT_ASSERT_OK(&error);
        ck_assert_str_eq(scene.folder, rows[i][1]);
        cs_scene_finish(&scene);
    }
}

/* code is named on the command line alone, however long its name is */
#define NO_FILE                                                                                \
    ", expected a name: a module file is given with --integrator or --plugin, a program with " \
    "--program"

TEST(messages_name_the_place) {
    static const char *const rows[][2] = {
        {"{\n  \"time\": {\"fps\": 60,}\n}",
         "s.json:2:22: found '}' after ',': JSON has no trailing comma"},
        {"[1, 2]", "s.json:1:1: found a list of 2, expected an object (\"about\", \"source\", "
                   "\"bodies\", "
                   "\"colliders\", ...)"},
        {"{\"bodies\": [" BODY "],\n \"time\": {\"fps\": \"60\"}}",
         "s.json:2:18: time.fps: found string \"60\", expected a number (0.001..1000000 1/s)"},
        {"{\"bodies\": [\n" BODY ",\n{\"cloth\": {\"grid\": [2, 2]}}]}",
         "s.json:3:1: bodies[1].mass: found none, expected exactly one of particle, "
         "areal_density, total, degree"},
        {"{\"bodies\": [{\"cloth\": {\"grid\": [2, 2]},\n"
         "\"mass\": {\"total\": 1, \"degree\": 2}}]}",
         "s.json:2:9: bodies[0].mass: found total and degree, expected exactly one of "
         "particle, "
         "areal_density, total, degree"},
        {"{\"bodies\": [{\"cloth\": {}}]}",
         "s.json:1:23: bodies[0].cloth.grid: missing, expected "
         "a list of 2 integers (1..65535 particles)"},
        {"{\"bodies\": [{\n\"springs\": {\"sheer\": 1}}]}",
         "s.json:2:13: bodies[0].springs.sheer: unknown key; did you mean \"shear\"?"},
        {"{\"integratr\": 1}",
         "s.json:1:2: integratr: unknown key; did you mean \"integrator\"?"},
        {"{\"Bodies\": []}", "s.json:1:2: Bodies: unknown key; did you mean \"bodies\"?"},
        {"{\"zzzzzzzzz q\": 1}", "s.json:1:2: [\"zzzzzzzzz q\"]: unknown key"},
        {"{\"time\": {\"fps\": 0}}",
         "s.json:1:18: time.fps: 0 is out of range (0.001..1000000 1/s)"},
        {"{\"render\": {\"size\": [640, 12.5]}}",
         "s.json:1:27: render.size[1]: 12.5 is out of range (16..8192 pixels)"},
        {"{\"render\": {\"size\": [640, 99.5]}}",
         "s.json:1:27: render.size[1]: 99.5 is not an integer (16..8192 pixels)"},
        {"{\"render\": {\"size\": [640]}}",
         "s.json:1:21: render.size: found a list of 1, expected "
         "a list of 2 integers (16..8192 pixels): width and height"},
        {"{\"camera\": {\"eye\": [0, null, 1]}}",
         "s.json:1:24: camera.eye[1]: found null, expected a number"},
        {"{\"render\": {\"look\": \"strian\"}}",
         "s.json:1:21: render.look: unknown choice \"strian\"; did you mean \"strain\"? "
         "(lit, wireframe, springs, force, strain, goals, crossings, stress, normals, uv)"},
        {"{\"render\": {\"look\": 3}}",
         "s.json:1:21: render.look: found 3, expected one of lit, "
         "wireframe, springs, force, strain, goals, crossings, stress, normals, uv"},
        {"{\"render\": {\"ground\": 1}}",
         "s.json:1:23: render.ground: found 1, expected one of auto, none, shadow, grid"},
        {"{\"render\": {\"viewpoint_forces\": 1}}",
         "s.json:1:33: render.viewpoint_forces: found 1, expected true or false"},
        {"{\"bodies\": {}}", "s.json:1:12: bodies: found an object, expected a list"},
        {"{\"about\": true}", "s.json:1:11: about: found true, expected a string"},
        {"{\"bodies\": [{\"pins\": [[1]]}]}",
         "s.json:1:23: bodies[0].pins[0]: found a list of 1, "
         "expected an object (\"to\", \"at\", \"index\", \"box\", ...) or a string or a "
         "number"},
        {"{\"bodies\": [{\"pins\": [-1]}]}",
         "s.json:1:23: bodies[0].pins[0]: -1 is out of range (0..4294967295)"},
        {"{\"bodies\": [{\"pins\": [{}]}]}",
         "s.json:1:23: bodies[0].pins[0]: found none, expected "
         "exactly one of at, index, box, set"},
        {"{\"colliders\": [{\"sphere\": {\"radius\": 1}}]}",
         "s.json:1:27: colliders[0].sphere.centre: missing, expected a list of 3 numbers "
         "(-1e+09..1e+09 m)"},
        {"{\"bodies\": [" BODY "], \"integrator\": [1]}",
         "s.json:1:79: integrator: found a list of 1, expected an object or a string"},
        {"{\"bodies\": [" BODY "], \"integrator\": {\"name\": 1}}",
         "s.json:1:88: integrator.name: found 1, expected a string"},
        {"{\"bodies\": [" BODY "], \"integrator\": {\"dt\": null}}",
         "s.json:1:86: integrator.dt: found null, expected a number, true, false or a string"},
        {"{\"bodies\": [" BODY "], \"integrator\": \"\"}",
         "s.json:1:79: integrator: found 0 characters, expected 1..63"},
        {"{\"bodies\": [" BODY "], \"integrator\": \"tableau:a.json\"}",
         "s.json:1:79: integrator: found \"tableau:a.json\"" NO_FILE},
        {"{\"bodies\": [" BODY "], \"integrator\": {\"name\": \"tableau:/a/folder/"
         "whose/path/has/more/bytes/than/the/name/of/an/integrator.json\"}}",
         "s.json:1:88: integrator.name: found \"tableau:/a/folder/"
         "whose/path/has/more/bytes/than/the/name/of\"" NO_FILE}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        assert_refused(rows[i][0], NULL, 0, CS_ERR_SCENE, rows[i][1]);
}

/* what cs_scene_check says gets the place of the value at fault, or of the nearest one */
TEST(checks_get_a_place) {
    struct cs_error pins = {0}, none = {0}, pair = {0}, twice = {0}, law = {0};
    struct cs_scene scene;
    const char *text =
        "{\"bodies\": [{\"cloth\": {\"grid\": [4, 3]}, \"mass\": {\"total\": 2},\n"
        " \"pins\": [0,\n  12]}]}";
    cs_scene_read_text(&scene, "s.json", text, strlen(text), NULL, 0, &pins);
    UNIT_ASSERT_FAILED(&pins, CS_ERR_SCENE, "s.json:3:3: bodies[0].pins[1]: ");
    text = "{\"bodies\": [" BODY "], \"pairs\": {\"list\": [\n{\"bodies\": [0, 1]}]}}";
    cs_scene_read_text(&scene, "s.json", text, strlen(text), NULL, 0, &pair);
    UNIT_ASSERT_FAILED(&pair, CS_ERR_SCENE,
                       "s.json:2:12: pairs.list[0].bodies: found body 1, expected 0..0");
    text = "{\"bodies\": [" BODY "], \"pairs\": {\"list\": [\n{\"bodies\": [0, 0]}]}}";
    cs_scene_read_text(&scene, "s.json", text, strlen(text), NULL, 0, &twice);
    UNIT_ASSERT_FAILED(&twice, CS_ERR_SCENE,
                       "found body 0 twice, expected bodies[0].self_contact");
    text = "{\"bodies\": [" BODY ", " BODY "],\n\"pairs\": \"all\", \"contact\": \"project\"}";
    cs_scene_read_text(&scene, "s.json", text, strlen(text), NULL, 0, &law);
    UNIT_ASSERT_FAILED(&law, CS_ERR_SCENE, "s.json:2:10: pairs: contact.law is project");
    cs_scene_read_text(&scene, "s.json", "{}", 2, NULL, 0, &none);
    UNIT_ASSERT_FAILED(&none, CS_ERR_SCENE, "s.json:1:1: bodies: ");
}

TEST(long_texts_are_refused) {
    struct cs_error error = {0};
    struct cs_scene scene;
    char text[400];
    for (int length = CS_TEXT_MAX - 2; length <= CS_TEXT_MAX; length++) {
        snprintf(text, sizeof text, "{\"bodies\": [" BODY "], \"about\": \"%0*d\"}", length, 0);
        cs_scene_read_text(&scene, "s.json", text, strlen(text), NULL, 0, &error);
        if (length < CS_TEXT_MAX)
            ck_assert_uint_eq(strlen(scene.about), (size_t)length);
        cs_scene_finish(&scene);
    }
    UNIT_ASSERT_FAILED(&error, CS_ERR_SCENE,
                       "about: found a string of 256 bytes, expected at most 255");
}

TEST(files_are_read) {
    struct cs_error error = {0}, missing = {0}, folder = {0};
    struct cs_scene scene;
    FILE *file = fopen("a.json", "w");
    fputs("{\"bodies\": [" BODY "]}", file);
    fclose(file);
    cs_scene_read(&scene, "a.json", NULL, 0, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(scene.bodies.n, 1);
    cs_scene_finish(&scene);
    cs_scene_read(&scene, "b.json", NULL, 0, &missing);
    UNIT_ASSERT_FAILED(&missing, CS_ERR_FILE, "cannot read \"b.json\"");
    ck_assert_ptr_null(scene.path);
    cs_scene_read(&scene, ".", NULL, 0, &folder);
    UNIT_ASSERT_FAILED(&folder, CS_ERR_FILE, "it is a folder");
}
