/* What a scene and a method ask for, feature by feature. */
#include "model/force/terms.h"
#include "model/plan.h"
#include "sheet.h"

#define CLOTH(more)                                                                            \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3]}, \"mass\": {\"total\": 1}" more "}]"
#define N  9u
#define S  26u /* 12 stretch, 8 shear, 6 bend */
#define RS sizeof(double)

static struct cs_plan plan_of(const char *text, uint32_t needs, bool render) {
    struct cs_scene scene;
    struct cs_error error = {0};
    struct cs_plan plan;
    cs_scene_read_text(&scene, "scene.json", text, strlen(text), NULL, 0, &error);
    UNIT_ASSERT_OK(&error);
    cs_plan_make(&plan, &scene, needs, render);
    cs_scene_finish(&scene);
    return plan;
}

#define BIT(feature) (1u << CS_FEATURE_##feature)
#define FORCE(name)  (1u << (CS_FEATURES + number_of(&cs_term_##name)))

static uint32_t number_of(const struct cs_term *term) {
    uint32_t k = 0;
    while (cs_terms[k] != term)
        k++;
    return k;
}

static uint32_t built(const struct cs_plan *plan) {
    uint32_t bits = 0;
    for (uint32_t f = 0; f < CS_FEATURES; f++) {
        bits |= (uint32_t)plan->rows[f].built << f;
        ck_assert_ptr_nonnull(plan->rows[f].why);
        ck_assert(plan->rows[f].built || plan->rows[f].bytes == 0);
    }
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        const struct cs_plan_row *row = plan->forces + k;
        // the others have a line as features
        bits |= (uint32_t)(row->built && row->why) << (CS_FEATURES + k);
        ck_assert(row->built || row->bytes == 0);
    }
    return bits;
}

/* one key at a time on top of a cloth in gravity */
TEST(each_key_builds_its_feature) {
    const uint32_t least = BIT(SPRINGS) | FORCE(gravity);
    static const char still[] = "\"wind\": {\"direction\": [1, 0, 0], \"strength\": ";
    char wind[200], wind_n[200], calm[200];
    snprintf(wind, sizeof wind, CLOTH("") ", \"forces\": {%s 2}}}", still);
    snprintf(wind_n, sizeof wind_n,
             CLOTH("") ", \"forces\": {%s 2, \"strength_unit\": \"N\"}}}", still);
    snprintf(calm, sizeof calm, CLOTH("") ", \"forces\": {%s 0}}}", still);
    const struct {
        const char *scene;
        uint32_t needs, built;
    } rows[] = {
        {CLOTH("") "}", 0, least},
        {CLOTH("") ", \"forces\": {\"gravity\": [0, 0, 0]}}", 0, BIT(SPRINGS)},
        {CLOTH(", \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}") "}", 0,
         FORCE(gravity)},
        {CLOTH(", \"springs\": {\"damping\": 1}") "}", 0, least | BIT(DAMPING)},
        {CLOTH(", \"strain_limit\": 1.2") "}", 0, least | BIT(STRAIN_LIMIT)},
        {CLOTH("") ", \"forces\": {\"drag\": 1}}", 0, least | FORCE(drag)},
        {CLOTH("") ", \"forces\": {\"drag_unit\": \"Pa s/m\"}}", 0, least},
        {CLOTH("") ", \"forces\": {\"drag\": 1, \"drag_unit\": \"Pa s/m\"}}", 0,
         least | FORCE(drag) | BIT(AREA)},
        {CLOTH("") ", \"forces\": {\"velocity_loss\": 0.1}}", 0, least | BIT(VELOCITY_LOSS)},
        {CLOTH("") ", \"colliders\": [{\"floor\": {}}]}", 0, least | BIT(CONTACT)},
        {CLOTH("") ", \"crossings\": \"ignore\"}", 0, least},
        {CLOTH("") ", \"crossings\": \"count\"}", 0, least | BIT(CROSSINGS)},
        {wind, 0, least | FORCE(wind) | BIT(AREA)},
        {wind_n, 0, least | FORCE(wind)},
        {calm, 0, least},
        {CLOTH("") ", \"events\": [{\"at\": 1, \"release\": {}}]}", 0, least | BIT(EVENTS)},
        {CLOTH("") ", \"events\": [{\"at\": 1, \"viewpoint_force\": {\"force\": 1}}]}", 0,
         least | BIT(EVENTS) | BIT(VIEWPOINT_FORCES)},
        {CLOTH("") "}", CS_NEED_SPRINGS, least | BIT(SPRING_LIST)},
        {CLOTH("") "}", CS_NEED_SOLVE, least | BIT(SOLVER)},
        {CLOTH("") "}", CS_NEED_CLUSTERS, least},
        {CLOTH(", \"shape_matching\": {}") "}", 0, FORCE(gravity)},
        {CLOTH(", \"shape_matching\": {}") "}", CS_NEED_CLUSTERS,
         FORCE(gravity) | BIT(CLUSTERS)},
        {CLOTH(", \"shape_matching\": {\"springs\": true}") "}", CS_NEED_CLUSTERS,
         least | BIT(CLUSTERS)},
        {CLOTH("") "}", CS_NEED_JVP | CS_NEED_DIAGONAL | CS_NEED_ENERGY, least},
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const struct cs_plan plan = plan_of(rows[k].scene, rows[k].needs, false);
        ck_assert_msg(built(&plan) == rows[k].built, "%s: built %x, expected %x", rows[k].scene,
                      built(&plan), rows[k].built);
    }
    const struct cs_plan drawn = plan_of(rows[0].scene, 0, true);
    ck_assert_uint_eq(built(&drawn), least | BIT(RENDER));
}

TEST(bytes_are_those_of_the_arrays) {
    const struct cs_plan plan = plan_of(CLOTH("") ", \"forces\": {\"wind\": {\"direction\":"
                                                  " [1, 0, 0], \"strength\": 2}}}",
                                        CS_NEED_SPRINGS | CS_NEED_SOLVE, false);
    ck_assert_uint_eq(plan.n, N);
    ck_assert_uint_eq(plan.n_springs, S);
    ck_assert_uint_eq(plan.n_bodies, 1);
    ck_assert_uint_eq(plan.state_bytes, 11 * N * RS + sizeof(struct cs_body_range));
    ck_assert_uint_eq(plan.forces[number_of(&cs_term_wind)].bytes, 3 * N * RS);
    ck_assert_uint_eq(plan.rows[CS_FEATURE_AREA].bytes, N * RS);
    ck_assert_uint_eq(plan.rows[CS_FEATURE_SOLVER].bytes, (4 * S + 22 * N) * RS);
}

/* what the plan promises of the system's arrays is what the system takes */
TEST(system_takes_what_was_planned) {
    static const size_t arrays[] = {CS_FEATURE_SPRINGS, CS_FEATURE_AREA, CS_FEATURE_SPRING_LIST,
                                    CS_FEATURE_CLUSTERS};
    static const uint32_t needs[] = {0, CS_NEED_SPRINGS, CS_NEED_CLUSTERS};
    for (int n = 0; n < 3; n++) {
        struct sheet sheet;
        sheet_open(
            &sheet, needs[n],
            CLOTH(", \"shape_matching\": {\"springs\": true, \"clusters\": 2}") ", \"forces\": "
                                                                                "{\"wind\": "
                                                                                "{\"direction\""
                                                                                ": [1, 0, 0],"
                                                                                " \"strength\":"
                                                                                " 2}}}");
        size_t bytes = sheet.system.plan.state_bytes +
                       sheet.system.plan.forces[number_of(&cs_term_wind)].bytes;
        for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
            bytes += sheet.system.plan.rows[arrays[k]].bytes;
        ck_assert_uint_eq(sheet.system.arena.used, bytes);
        sheet_close(&sheet);
    }
}

TEST(plan_is_printed_a_line_a_feature) {
    const struct cs_plan plan = plan_of(CLOTH("") "}", 0, false);
    struct cs_text text = {0};
    cs_plan_print(&plan, &text);
    uint32_t lines = 0;
    for (const char *c = cs_text_get(&text); *c; c++)
        lines += *c == '\n';
    ck_assert_uint_eq(lines, 4 + CS_FEATURES + 3); // gravity, drag, wind
    ck_assert_ptr_nonnull(strstr(cs_text_get(&text), "\ncontact        left out "));
    ck_assert_ptr_nonnull(strstr(cs_text_get(&text), "\ngravity        built "));
    cs_text_finish(&text);
}
