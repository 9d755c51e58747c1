/* Traps of scenes that end with exit code 0 and a good-looking table: each is found before the
 * first step, and the proposed value removes the finding. */
#include "doctor.h"

#include <string.h>

static const struct trap traps[] = {
    {"\"bodies\": [" SHEET("") ", " SHEET("") "]",
     "bodies[0] and bodies[1] overlap at the start", "bodies[1].cloth.place.translate",
     "[0, 0.3, 0]", true},
    {"\"bodies\": [" SHEET("") ", " SHEET(", \"place\": {\"translate\": [0, 0.3, 0]}") "]",
     "could collide, but no contact is defined", "pairs", "all", true},
    {BODY(FLAT ", \"stretch\": [9, 9]", ", \"springs\": {\"stretch\": 500}"), "springs store ",
     "bodies[0].cloth.stretch", "[1, 1]", true},
    {BODY(FLAT ", \"place\": {\"translate\": [0, 0.0001, 0]}", "") FLOOR
     ", \"contact\": {\"law\": \"force\", \"start\": \"allow\"}",
     "contact stores ", "contact.start", "move-out", true},
    {BODY(HIGH, "") FLOOR ", \"contact\": {\"law\": \"force\", \"stiffness\": 1}",
     "contact.stiffness: at 1 N/m a contact of bodies[0] with colliders[0]",
     "contact.stiffness", "1e6", true},
    {BODY(HIGH,
          "") ", \"contact\": \"project\", \"colliders\": [{\"sphere\": {\"centre\": [0, 0, "
              "0], \"radius\": 0.01}}]",
     "colliders[0] is 0.02 m wide, particles are 0.0714 m apart", "contact", "force", false},
    {BODY(HIGH, "") ", \"colliders\": [{\"floor\": {\"height\": 0}, \"thickness\": 0.001}], "
                    "\"contact\": \"force\"",
     "bodies[0] with colliders[0] may meet at ", "colliders[0].thickness", "0.01", false},
    {BODY("",
          ", \"pins\": [\"top\"], \"springs\": {\"stretch\": 2, \"bend\": 0, \"shear\": 0}"),
     "bodies[0]: its weight stretches the springs at its pins by at least ",
     "bodies[0].springs.stretch", "50", false},
    {BODY("", ", \"pins\": [\"top-left\", \"top-right\"]"), "bodies[0] lies in a plane",
     "bodies[0].cloth.bump", "0.001", false},
    {BODY(", \"stretch\": [0.8, 1]", ", \"pins\": [\"edges\"]"), "bodies[0] lies in a plane",
     "bodies[0].cloth.bump", "0.001", false},
    // a shift, written where a position belongs, and the other way round
    {BODY(HIGH, "") ", \"events\": [{\"at\": 0, \"grab\": {\"particles\": [0], \"path\": "
                    "[{\"at\": 0.01, \"point\": [0, 0, 0.01]}]}}]",
     "events[0].grab.path[0] is reached at ", "events[0].grab.relative", "true", false},
    {BODY("", ", \"pins\": [\"top\"]") ", \"colliders\": [{\"sphere\": {\"centre\": [4, 0, 0], "
                                       "\"radius\": 0.1}}], \"events\": [{\"from\": 0, \"to\": "
                                       "1, \"move\": {\"collider\": 0, \"path\": [{\"at\": "
                                       "0.01, \"point\": [4.001, 0, 0]}]}}]",
     "events[0].move.path[0] is reached at ", "events[0].move.relative", "false", false},
    {BODY("", ", \"pins\": [\"top\"]") ", \"events\": [{\"from\": 0, \"to\": 0.5, \"grab\": "
                                       "{\"particles\": [\"top\"], \"relative\": true, "
                                       "\"path\": [{\"at\": 0.5, \"point\": [0, 0, 0.1]}]}}]",
     "events[0].grab takes particles that pins hold", "bodies[0].pins", "[\"bottom\"]", false},
    {BODY("", ", \"pins\": [\"top\"]") ", \"forces\": {\"wind\": {\"direction\": [0, 0, 1], "
                                       "\"strength\": 5000}}",
     "the wind at the start stretches the springs at its pins", "forces.wind.strength", "10",
     false},
    {BODY("", ", \"pins\": [\"left\"]") ", \"events\": [{\"from\": 0, \"to\": 0.5, \"grab\": "
                                        "{\"particles\": [\"right\"], \"relative\": true, "
                                        "\"path\": [{\"at\": 0.5, \"point\": [3, 0, 0]}]}}]",
     "events[0].grab draws particle 7 of bodies[0] until 0.5 s to 3.5 m from particle 0",
     "events[0].grab.path[0].point", "[0.1, 0, 0]", true},
    // keys that nothing reads
    {BODY("", ", \"thickness\": 0.002"), "bodies[0].thickness has no effect",
     "bodies[0].self_contact", "true", false},
    {BODY("", ", \"friction\": 0.3"), "bodies[0].friction has no effect",
     "bodies[0].self_contact", "true", false},
    {BODY(HIGH, "") FLOOR ", \"contact\": {\"law\": \"project\", \"damping\": 0.001}",
     "contact.damping has no effect", "contact.law", "force", false},
    {BODY(HIGH, "") FLOOR ", \"contact\": {\"law\": \"project\", \"stiffness\": 1000}",
     "contact.stiffness has no effect", "contact.law", "force", false},
    {BODY(HIGH, "") ", \"colliders\": [{\"floor\": {\"height\": 0}, \"absorption\": 0.5}], "
                    "\"contact\": \"force\"",
     "colliders[0].absorption has no effect", "contact", "project", false},
    {BODY("", "") ", \"pairs\": \"all\"", "pairs.among has no effect", "pairs", "listed",
     false},
    {BODY(HIGH, "") ", \"contact\": \"project\"", "contact.law has no effect", "colliders",
     "[{\"floor\": {}}]", false},
    {BODY(HIGH, "") FLOOR ", \"contact\": {\"law\": \"force\", \"friction_speed\": 0.01}",
     "contact.friction_speed has no effect", "colliders[0].friction", "0.3", false},
    {BODY("", ", \"strain_limit_sweeps\": 20"), "bodies[0].strain_limit_sweeps has no effect",
     "bodies[0].strain_limit", "1.1", false},
    {BODY("", "") ", \"forces\": {\"drag_unit\": \"Pa s/m\"}", "forces.drag_unit has no effect",
     "forces.drag", "0.1", false},
    {BODY("", "") ", \"forces\": {\"wind\": {\"direction\": [1, 0, 0]}}",
     "forces.wind.direction has no effect", "forces.wind.strength", "1", false},
    {BODY("", ", \"springs\": {\"damping_model\": \"relative\"}"),
     "bodies[0].springs.damping_model has no effect", "bodies[0].springs.damping", "0.01",
     false},
    {"\"bodies\": [{\"mesh\": {\"shape\": \"sphere\"}, \"mass\": {\"total\": 1}, \"springs\": "
     "{\"shear\": 30}}]",
     "bodies[0].springs.shear has no effect", "bodies[0].springs.shear", "20", false},
    {BODY("", "") ", \"render\": {\"range\": [0, 1]}", "render.range has no effect",
     "render.look", "strain", false},
};

TEST(traps_are_found_and_cured) {
    spring_traps(traps, LENGTH(traps));
}

/* Each key of a scene has a rule, of which the first that fits counts. */
static void check_rules(const struct cs_table *table, const char *above) {
    for (uint32_t r = 0; r < table->n; r++) {
        const struct cs_option *row = table->rows + r;
        char key[256];
        snprintf(key, sizeof key, "%.200s%s%s%s", above, *above ? "." : "", row->name,
                 row->type == CS_LIST ? "[]" : "");
        if (row->table)
            check_rules(row->table, key);
        else
            ck_assert_msg(cs_idle_keys_rule(key) >= 0, "%s has no rule", key);
    }
}

TEST(each_key_has_a_rule) {
    check_rules(&cs_scene_table, "");
    ck_assert_int_lt(cs_idle_keys_rule("bodies[].no_such_key"), 0);
}

/* A key that is said to have no effect has none: the state after some frames is the same, to
 * the last bit, with another value. */
TEST(idle_keys_change_no_bit) {
    static const struct {
        const char *scene, *path, *value;
    } idle[] = {
        {BODY(HIGH, "") FLOOR PROJECT, "contact.damping", "0.01"},
        {BODY(HIGH, "") FLOOR PROJECT, "contact.stiffness", "12345"},
        {BODY(HIGH, "") FLOOR, "bodies[0].thickness", "0.1"},
        {BODY(HIGH, "") FLOOR ", \"contact\": \"force\"", "colliders[0].absorption", "0.1"},
        {BODY(HIGH, "") FLOOR ", \"contact\": \"force\"", "contact.friction_speed", "0.1"},
        {BODY(HIGH, "") FLOOR, "bodies[0].friction", "0.9"},
        {BODY(HIGH, "") FLOOR, "pairs", "all"},
        {BODY(HIGH, ""), "contact.law", "project"},
        {BODY(HIGH, ""), "forces.drag_unit", "Pa s/m"},
    };
    for (size_t k = 0; k < LENGTH(idle); k++) {
        const struct cs_override other = {idle[k].path, idle[k].value};
        char text[2048], hash[2][CS_HASH_DIGITS];
        snprintf(text, sizeof text, "{%s}", idle[k].scene);
        for (uint32_t n = 0; n < 2; n++) {
            struct cs_session session;
            struct cs_error error = {0};
            cs_session_open(
                &session,
                &(struct cs_session_settings){
                    .scene = "idle.json", .text = text, .overrides = &other, .n_overrides = n},
                &error);
            for (int frame = 0; frame < 30 && !error.status; frame++)
                cs_run_frame(&session.run, &error);
            ck_assert_msg(!error.status, "%s", error.message);
            cs_run_hash(&session.run, hash[n]);
            cs_session_close(&session);
        }
        ck_assert_msg(!strcmp(hash[0], hash[1]), "%s=%s", idle[k].path, idle[k].value);
    }
}
