/* The rows of `contact` and of `pairs`. */
#include "scene/contact_keys.h"
#include "scene/table_rows.h"

static const char *const contact_names[] = {"project", "force", NULL};
static const char *const inside_names[] = {"refuse", "move-out", "allow", NULL};
static const char *const friction_names[] = {"smooth", "stick", NULL};
static const struct cs_option contact_rows[] = {
    CHOICE(struct cs_contact_keys, law, contact_names, CS_CONTACT_FORCE,
           "force: a force between surfaces in contact range, part of the equation of motion; "
           "project: after each step particles inside a collider are moved to its surface, the "
           "default of methods that cannot follow the force"),
    CHOICE(
        struct cs_contact_keys, start, inside_names, CS_CONTACT_START_REFUSE,
        "a particle that starts inside a collider, or, for force, bodies that start with more "
        "contact energy than at rest: refuse the scene, move them out first, as the report "
        "then states, or allow it"),
    REAL(struct cs_contact_keys, untangle, "s", ABSENT, 1e-6, BIG,
         "particles that start inside a collider are moved out along the shortest way, from "
         "rest to rest in this time, and feel colliders from its end on; absent: see start"),
    REAL(struct cs_contact_keys, stiffness, "N/m", ABSENT, 1e-9, 1e12,
         "for force, per particle; absent: 40 m v^2/D^2 for the speed v at which surfaces may "
         "meet, at least springs.stretch of the softest body that has such springs"),
    REAL(struct cs_contact_keys, damping, "s", 0, 0, BIG,
         "for force: normal damping over contact stiffness; where law is not given either: "
         "sqrt(m/k) of the heaviest particle m and the stiffest collider k"),
    REAL(
        struct cs_contact_keys, restitution, "", ABSENT, 0, 1,
        "for force: speed after an impact over that before, at any speed and stiffness, with "
        "all "
        "methods, whose steps then resolve impacts; absent: damping alone, and what the method "
        "loses itself"),
    REAL(struct cs_contact_keys, friction_speed, "m/s", 1e-3, 1e-9, BIG,
         "for force, smooth: sliding speed at which friction reaches 0.7 of its limit"),
    CHOICE(struct cs_contact_keys, friction_law, friction_names, CS_FRICTION_SMOOTH,
           "for force: smooth: friction depends on the velocity alone, and what rests creeps; "
           "stick: particles hang on anchors in colliders and rest below the limit"),
    REAL(struct cs_contact_keys, sample_stretch, "", 1, 1, 16,
         "for force: length of an edge over that at the start, up to which contact samples "
         "leave "
         "no gap"),
};
const struct cs_table cs_contact_table = {ROWS(contact_rows),
                                          .size = sizeof(struct cs_contact_keys), .apart = true,
                                          .shorthand_text = "law"};

static const struct cs_option pair_rows[] = {
    COUNTS(struct cs_body_pair_keys, bodies, 2, "", NULL, 0, 65535, "numbers of two bodies"),
    REAL(struct cs_body_pair_keys, friction, "", 0, 0, 1000,
         "Coulomb coefficient between them"),
};
static const struct cs_table pair_table = {ROWS(pair_rows),
                                           .size = sizeof(struct cs_body_pair_keys)};
static const char *const among_names[] = {"listed", "all", NULL};
static const struct cs_option pairs_rows[] = {
    CHOICE(struct cs_body_pairs_keys, among, among_names, CS_PAIRS_NAMED,
           "listed: the pairs of list; all: every two bodies"),
    REAL(struct cs_body_pairs_keys, friction, "", 0, 0, 1000,
         "for all: Coulomb coefficient between two bodies that are not in the list"),
    LIST(struct cs_body_pairs_keys, list, pair_table,
         "pairs of bodies, each with its own friction"),
};
const struct cs_table cs_pairs_table = {ROWS(pairs_rows),
                                        .size = sizeof(struct cs_body_pairs_keys),
                                        .apart = true, .shorthand_text = "among"};
