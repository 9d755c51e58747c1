/* table_rows.h - macros for the rows of the scene's tables (struct cs_option), one line each.
 *
 * Arguments: s: struct; f: its field, also the key's name; unit_; def_ or defs_: default,
 * ABSENT or NULL if there is none; min_, max_: range, ends included; help_: text of schema and
 * manual. */
#ifndef CS_TABLE_ROWS_H
#define CS_TABLE_ROWS_H

#include <clothsim/option.h>
#include <math.h>

/* largest magnitude of a coordinate or stiffness; absent default; rows of a table */
#define BIG         1e9
#define ABSENT      ((double)NAN)
#define ROWS(array) .rows = array, .n = sizeof array / sizeof *array

#define REAL(s, f, unit_, def_, min_, max_, help_)                                             \
    {                                                                                          \
        .name = #f, .unit = unit_, .help = help_, .type = CS_REAL, .count = 1,                 \
        .offset = offsetof(s, f), .def = def_, .min = min_, .max = max_                        \
    }
#define INT(s, f, unit_, def_, min_, max_, help_)                                              \
    {                                                                                          \
        .name = #f, .unit = unit_, .help = help_, .type = CS_INT, .count = 1,                  \
        .offset = offsetof(s, f), .def = def_, .min = min_, .max = max_                        \
    }
#define BOOL(s, f, def_, help_)                                                                \
    {                                                                                          \
        .name = #f, .unit = "", .help = help_, .type = CS_BOOL, .count = 1,                    \
        .offset = offsetof(s, f), .def = def_                                                  \
    }
#define CHOICE(s, f, names_, def_, help_)                                                      \
    {                                                                                          \
        .name = #f, .unit = "", .help = help_, .type = CS_CHOICE, .count = 1,                  \
        .offset = offsetof(s, f), .def = def_, .choices = names_                               \
    }
#define TEXT(s, f, help_)                                                                      \
    {                                                                                          \
        .name = #f, .unit = "", .help = help_, .type = CS_TEXT, .count = 1,                    \
        .offset = offsetof(s, f)                                                               \
    }
#define VECTOR(s, f, n_, unit_, defs_, min_, max_, help_)                                      \
    {                                                                                          \
        .name = #f, .unit = unit_, .help = help_, .type = CS_VECTOR, .count = n_,              \
        .offset = offsetof(s, f), .defs = defs_, .min = min_, .max = max_                      \
    }
#define COUNTS(s, f, n_, unit_, defs_, min_, max_, help_)                                      \
    {                                                                                          \
        .name = #f, .unit = unit_, .help = help_, .type = CS_COUNTS, .count = n_,              \
        .offset = offsetof(s, f), .defs = defs_, .min = min_, .max = max_                      \
    }
#define TABLE(s, f, table_, help_)                                                             \
    {                                                                                          \
        .name = #f, .unit = "", .help = help_, .type = CS_TABLE, .count = 1,                   \
        .offset = offsetof(s, f), .table = &table_                                             \
    }
#define LIST(s, f, table_, help_)                                                              \
    {                                                                                          \
        .name = #f, .unit = "", .help = help_, .type = CS_LIST, .count = 1,                    \
        .offset = offsetof(s, f), .table = &table_                                             \
    }
/* Tables that the rows of another file name. */
extern const struct cs_table cs_body_table, cs_collider_table, cs_contact_table, cs_force_table;
extern const struct cs_table cs_holder_table, cs_mesh_table, cs_mesh_keys, cs_pairs_table,
    cs_pose_table;

/* The two rows of particles of a body; f: the field that holds `body` and `particles`. */
#define SIDE_ROWS(s, f, body_help, list_help)                                                  \
    {.name = "body",                                                                           \
     .unit = "",                                                                               \
     .help = body_help,                                                                        \
     .type = CS_INT,                                                                           \
     .count = 1,                                                                               \
     .offset = offsetof(s, f.body),                                                            \
     .def = -1,                                                                                \
     .min = 0,                                                                                 \
     .max = 4294967295.0},                                                                     \
    {                                                                                          \
        .name = "particles", .unit = "", .help = list_help, .type = CS_LIST, .count = 1,       \
        .offset = offsetof(s, f.particles), .table = &cs_pin_table                             \
    }

#endif
