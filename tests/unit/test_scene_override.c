/* --set: what is put in, and what is refused. */
#include "scene/body_keys.h"
#include "scene/force_keys.h"
#include "scene/picture_keys.h"
#include "scene_text.h"

TEST(overrides_are_put_in) {
    static const struct cs_override overrides[] = {{"bodies[0].springs.stretch", "200"},
                                                   {"bodies[0].cloth.grid", "[9, 8]"},
                                                   {"bodies[0].cloth.grid[1]", "7"},
                                                   {"bodies[0].pins[0]", "{\"at\": \"top\"}"},
                                                   {"bodies[0].pins[1]", "{\"index\": 5}"},
                                                   {"bodies[0].pins[0].at", "left"},
                                                   {"bodies[1]", BODY},
                                                   {"bodies[1].mass", "{\"particle\": 0.5}"},
                                                   {"forces.wind.direction", "[0, 0, 2]"},
                                                   {"forces.wind.strength", " 4 "},
                                                   {"about", "two words"},
                                                   {"source", "\"quoted\""},
                                                   {"render.look", "strain"},
                                                   {"render.ground", "grid"},
                                                   {"render.background.kind", "none"},
                                                   {"render.background.colour", "[1, 0.5, 0]"},
                                                   {"integrator", "cvode-bdf"},
                                                   {"integrator.rtol", "1e-3"},
                                                   {"integrator.rtol", "1e-5"},
                                                   {"x-tag.deep[0][0].key", "1"}};
    struct cs_scene scene;
    read_text(&scene, "{\"bodies\": [" BODY "], \"integrator\": \"explicit-euler\"}", overrides,
              sizeof overrides / sizeof *overrides);
    const struct cs_body *bodies = cs_scene_bodies(&scene);
    const struct cs_pin *pins = bodies[0].pins.items;
    ck_assert_uint_eq(scene.bodies.n, 2);
    ck_assert_double_eq(bodies[0].springs.stretch, 200);
    ck_assert_int_eq(bodies[0].cloth.grid[0], 9);
    ck_assert_int_eq(bodies[0].cloth.grid[1], 7);
    ck_assert_uint_eq(bodies[0].pins.n, 2);
    ck_assert_int_eq(pins[0].at, CS_PIN_LEFT);
    ck_assert_int_eq(pins[1].index, 5);
    ck_assert_double_eq(bodies[1].mass.particle, 0.5);
    ck_assert_double_eq(scene.forces->wind.direction[2], 1);
    ck_assert_double_eq(scene.forces->wind.strength, 4);
    ck_assert_str_eq(scene.about, "two words");
    ck_assert_str_eq(scene.source, "quoted");
    ck_assert_int_eq(scene.render->look, CS_LOOK_STRAIN);
    ck_assert_int_eq(scene.render->ground, CS_GROUND_GRID);
    ck_assert_int_eq(scene.render->background.kind, CS_BACKGROUND_NONE);
    ck_assert_double_eq(scene.render->background.colour[1], 0.5);
    const struct cs_setting *settings = scene.integrator_settings.items;
    ck_assert_str_eq(scene.integrator, "cvode-bdf");
    ck_assert_uint_eq(scene.integrator_settings.n, 1);
    ck_assert_str_eq(settings[0].value, "1e-05");
    /* the hash of a scene is that of its file */
    ck_assert_ptr_null(strstr(scene.text, "cvode"));
    cs_scene_finish(&scene);
}

TEST(a_plain_integrator_takes_options) {
    static const struct cs_override dt[] = {{"integrator.dt", "0.001"}};
    static const char *const texts[] = {"{\"bodies\": [" BODY
                                        "], \"integrator\": \"cvode-bdf\"}",
                                        "{\"bodies\": [" BODY "], \"integrator\": {\"name\": "
                                        "\"cvode-bdf\", \"dt\": 5}}"};
    for (size_t i = 0; i < 2; i++) {
        struct cs_scene scene;
        read_text(&scene, texts[i], dt, 1);
        const struct cs_setting *settings = scene.integrator_settings.items;
        ck_assert_str_eq(scene.integrator, "cvode-bdf");
        ck_assert_uint_eq(scene.integrator_settings.n, 1);
        ck_assert_str_eq(settings[0].name, "dt");
        ck_assert_str_eq(settings[0].value, "0.001");
        cs_scene_finish(&scene);
    }
}

TEST(bad_overrides_are_refused) {
    static const struct {
        struct cs_override override;
        enum cs_status status;
        const char *message;
    } rows[] = {
        {{"bodies[0].springs.stretch", "-1"},
         CS_ERR_SCENE,
         "--set bodies[0].springs.stretch: -1 is out of range (0..1e+12 N/m)"},
        {{"bodies[0].springs", "{\"bend\": \"b\"}"},
         CS_ERR_SCENE,
         "--set bodies[0].springs.bend: found string \"b\", expected a number (0..1e+12 N/m)"},
        {{"bodies[0].sprngs.stretch", "1"},
         CS_ERR_SCENE,
         "--set bodies[0].sprngs: unknown key; did you mean \"springs\"?"},
        {{"forces.wind.strength", "1"},
         CS_ERR_SCENE,
         "--set forces.wind.direction: missing, expected a list of 3 "
         "numbers, or velocity in m/s"},
        {{"bodies[0].mass.particle", "1"},
         CS_ERR_SCENE,
         "s.json:1:49: bodies[0].mass: found particle and total, expected exactly one of "
         "particle, areal_density, total, degree"},
        {{"integrator.dt", "{}"},
         CS_ERR_SCENE,
         "--set integrator.dt: found an object, expected a number, true, false or a string"},
        {{"", "1"},
         CS_ERR_USAGE,
         "--set : not a path, expected one like bodies[0].springs.stretch"},
        {{".time", "1"},
         CS_ERR_USAGE,
         "--set .time: not a path, expected one like bodies[0].springs.stretch"},
        {{"time.", "1"},
         CS_ERR_USAGE,
         "--set time.: not a path, expected one like bodies[0].springs.stretch"},
        {{"bodies[x]", "1"},
         CS_ERR_USAGE,
         "--set bodies[x]: not a path, expected one like bodies[0].springs.stretch"},
        {{"bodies[-1]", "1"},
         CS_ERR_USAGE,
         "--set bodies[-1]: not a path, expected one like bodies[0].springs.stretch"},
        {{"bodies[0", "1"},
         CS_ERR_USAGE,
         "--set bodies[0: not a path, expected one like bodies[0].springs.stretch"},
        {{"bodies[0]time", "1"},
         CS_ERR_USAGE,
         "--set bodies[0]time: not a path, expected one like bodies[0].springs.stretch"},
        {{"bodies[2].cloth", "{}"},
         CS_ERR_USAGE,
         "--set bodies[2].cloth: index 2 is out of range, expected 0..1 (1 adds one)"},
        {{"bodies.cloth", "{}"},
         CS_ERR_USAGE,
         "--set bodies.cloth: found a list of 1 before \"cloth\", expected an object"},
        {{"bodies[0][0]", "{}"},
         CS_ERR_USAGE,
         "--set bodies[0][0]: found an object before [0], expected a list"},
        {{"[0]", "1"}, CS_ERR_USAGE, "--set [0]: found an object before [0], expected a list"},
        {{"time.fps", "60fps"},
         CS_ERR_USAGE,
         "--set time.fps: the value is not JSON: found 'f', expected the end of the text (at "
         "column 3)"},
        {{"time.fps", "1e999"},
         CS_ERR_USAGE,
         "--set time.fps: the value is not JSON: the number 1e999 is too large (at column 1)"},
        {{"bodies[0].cloth.grid", "[1, 2"},
         CS_ERR_USAGE,
         "--set bodies[0].cloth.grid: the value is not JSON: found the end of the text, "
         "expected "
         "',' or ']' (at column 6)"},
        {{"about", "\xff"},
         CS_ERR_USAGE,
         "--set about: the value is not UTF-8 text without control characters"},
        {{"integrator.\xe4", "1"},
         CS_ERR_USAGE,
         "--set integrator.\xe4: the path is not UTF-8 text without control characters"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        assert_refused("{\"bodies\": [" BODY "]}", &rows[i].override, 1, rows[i].status,
                       rows[i].message);
}

TEST(deep_override_is_refused) {
    char path[400] = "x-a";
    for (int i = 0; i < 70; i++)
        strcat(path, "[0]");
    const struct cs_override override = {path, "1"};
    struct cs_error error = {0};
    struct cs_scene scene;
    cs_scene_read_text(&scene, "s.json", "{}", 2, &override, 1, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_USAGE, "not a path");
}
