/* What a scene and a method ask for, feature by feature. */
#include <inttypes.h>

#include "model/force/terms.h"
#include "model/plan.h"
#include "scene/scene.h"
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

#define BIT(feature) (UINT64_C(1) << CS_FEATURE_##feature)
#define FORCE(name)  (UINT64_C(1) << (CS_FEATURES + number_of(&cs_term_##name)))

static uint32_t number_of(const struct cs_term *term) {
    uint32_t k = 0;
    while (cs_terms[k] != term)
        k++;
    return k;
}

static uint64_t built(const struct cs_plan *plan) {
    uint64_t bits = 0;
    for (uint32_t f = 0; f < CS_FEATURES; f++) {
        bits |= (uint64_t)plan->rows[f].built << f;
        ck_assert_ptr_nonnull(plan->rows[f].reason);
        ck_assert(plan->rows[f].built || plan->rows[f].bytes == 0);
    }
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        const struct cs_plan_row *row = plan->forces + k;
        // the others have a line as features
        bits |= (uint64_t)(row->built && row->reason) << (CS_FEATURES + k);
        ck_assert(row->built || row->bytes == 0);
    }
    return bits;
}

/* one key at a time on top of a cloth in gravity */
TEST(each_key_builds_its_feature) {
    const uint64_t least = BIT(SPRINGS) | FORCE(gravity);
    static const char still[] = "\"wind\": {\"direction\": [1, 0, 0], \"strength\": ";
    char wind[200], wind_n[200], calm[200];
    snprintf(wind, sizeof wind, CLOTH("") ", \"forces\": {%s 2}}}", still);
    snprintf(wind_n, sizeof wind_n,
             CLOTH("") ", \"forces\": {%s 2, \"strength_unit\": \"N\"}}}", still);
    snprintf(calm, sizeof calm, CLOTH("") ", \"forces\": {%s 0}}}", still);
    const struct {
        const char *scene;
        uint32_t needs;
        uint64_t built;
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
        {CLOTH("") ", \"contact\": \"project\", \"colliders\": [{\"floor\": {}}]}", 0,
         least | BIT(CONTACT)},
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
        {CLOTH("") "}", CS_NEED_LAGGED_FRICTION, least},
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
        ck_assert_msg(built(&plan) == rows[k].built, "%s: built %" PRIx64 ", expected %" PRIx64,
                      rows[k].scene, built(&plan), rows[k].built);
    }
    const struct cs_plan drawn = plan_of(rows[0].scene, 0, true);
    ck_assert_uint_eq(built(&drawn), least | BIT(RENDER));
}

#define WIND ", \"forces\": {\"wind\": {\"direction\": [1, 0, 0], \"strength\": 2}}"

TEST(bytes_are_those_of_the_arrays) {
    struct sheet sheet;
    sheet_open(&sheet, CS_NEED_SPRINGS, "%s", CLOTH(", \"pins\": [\"top\"]") WIND "}");
    const struct cs_plan *plan = &sheet.system.plan;
    ck_assert_uint_eq(plan->n, N);
    ck_assert_uint_eq(plan->n_springs, S);
    ck_assert_uint_eq(plan->n_bodies, 1);
    ck_assert_uint_eq(plan->state_bytes,
                      11 * N * RS + sizeof(struct cs_body_range) + 3 * sizeof(uint32_t));
    ck_assert_uint_eq(plan->forces[number_of(&cs_term_wind)].bytes, 3 * N * RS);
    ck_assert_uint_eq(plan->rows[CS_FEATURE_AREA].bytes, N * RS);
    /* ends and kind; length, stiffness and damping; axial or not */
    ck_assert_uint_eq(plan->rows[CS_FEATURE_SPRING_LIST].bytes,
                      S * (3 * sizeof(uint32_t) + 3 * RS + 1));
    sheet_close(&sheet);
}

/* of a plan that was built; meshes are the scene's */
static size_t sum_of(const struct cs_plan *plan) {
    size_t bytes = plan->state_bytes - plan->rows[CS_FEATURE_MESHES].bytes;
    for (uint32_t f = 0; f < CS_FEATURES; f++)
        bytes += plan->rows[f].bytes;
    for (uint32_t k = 0; k < cs_n_terms; k++)
        bytes += plan->forces[k].bytes;
    return bytes;
}

/* rows that have bytes */
static uint64_t taken(const struct cs_plan *plan) {
    uint64_t bits = 0;
    for (uint32_t f = 0; f < CS_FEATURES; f++)
        bits |= (uint64_t)(plan->rows[f].bytes > 0) << f;
    for (uint32_t k = 0; k < cs_n_terms; k++)
        bits |= (uint64_t)(plan->forces[k].bytes > 0) << (CS_FEATURES + k);
    return bits;
}

/* what the system takes stands in the row of what it is for, contact's too */
TEST(every_byte_is_in_one_row) {
#define MET ", \"self_contact\": true, \"thickness\": 0.01"
#define LAW ", \"contact\": {\"law\": \"force\"}, \"colliders\": "
    const struct {
        const char *scene;
        uint32_t needs;
        uint64_t taken;
    } rows[] = {
        {CLOTH("") "}", 0, BIT(SPRINGS)},
        {CLOTH("") "}", CS_NEED_SPRINGS, BIT(SPRINGS) | BIT(SPRING_LIST)},
        {CLOTH(", \"shape_matching\": {\"springs\": true, \"clusters\": 2}") WIND "}",
         CS_NEED_CLUSTERS, BIT(SPRINGS) | BIT(CLUSTERS) | BIT(AREA) | FORCE(wind)},
        {CLOTH("") LAW "[{\"floor\": {\"height\": -2}}]}", 0, BIT(SPRINGS) | FORCE(contact)},
        {CLOTH("") LAW "[{\"sphere\": {\"centre\": [0, -9, 0], \"radius\": 0.1}, "
                       "\"thickness\": 0.02}]}",
         0, BIT(SPRINGS) | FORCE(contact) | FORCE(cover)},
        {CLOTH(MET) LAW "[{\"mesh\": {\"shape\": \"box\", \"place\": "
                        "{\"translate\": [0, -9, 0]}}}]}",
         0, BIT(SPRINGS) | BIT(MESHES) | BIT(CROSSINGS) | FORCE(pairs)},
        {CLOTH("") ", \"events\": [{\"from\": 1, \"to\": 2, \"viewpoint_force\": "
                   "{\"force\": 1}}]}",
         0, BIT(SPRINGS) | BIT(EVENTS) | BIT(VIEWPOINT_FORCES)},
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct sheet sheet;
        sheet_open(&sheet, rows[k].needs, "%s", rows[k].scene);
        ck_assert_msg(taken(&sheet.system.plan) == rows[k].taken,
                      "%s: bytes in %" PRIx64 ", expected in %" PRIx64, rows[k].scene,
                      taken(&sheet.system.plan), rows[k].taken);
        ck_assert_uint_eq(sum_of(&sheet.system.plan), sheet.system.arena.used);
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
    ck_assert_ptr_nonnull(strstr(cs_text_get(&text), "\ncontact projection not built "));
    ck_assert_ptr_nonnull(strstr(cs_text_get(&text), "\ngravity            built "));
    cs_text_finish(&text);
}
