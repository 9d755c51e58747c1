/* option.h - one self-describing table for every struct that a user can fill.
 *
 * A row names a field of a plain struct and says its type, unit, default, range and meaning.
 * From such tables clothsim parses scenes and options, prints help and resolved values, and
 * writes the JSON schema. An integrator module describes its options with the first four
 * types; the others serve the scene.
 */
#ifndef CLOTHSIM_OPTION_H
#define CLOTHSIM_OPTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum cs_type {
    CS_REAL,   /* double; a default of NAN means: absent unless given */
    CS_INT,    /* int64_t */
    CS_BOOL,   /* bool */
    CS_CHOICE, /* int32_t, index into choices; a default of -1 means: absent unless given */
    CS_VECTOR, /* double[count]; min and max hold for each component */
    CS_COUNTS, /* int64_t[count] */
    CS_TEXT,   /* char[CS_TEXT_MAX], zero-terminated; the default is "" = absent */
    CS_TABLE,  /* a struct described by table */
    CS_LIST    /* struct cs_list of such structs */
};

enum { CS_TEXT_MAX = 256 };

struct cs_list {
    void *items; /* owned by the arena it was read into; NULL if n is 0 */
    uint32_t n;
};

struct cs_table;

struct cs_option {
    const char *name; /* [a-z_]+ */
    const char *unit; /* SI, "" for a pure number */
    const char *help; /* lower case, no full stop */
    enum cs_type type;
    uint32_t count;               /* components of a VECTOR or COUNTS; else 1 */
    size_t offset;                /* of the field in its struct */
    double def, min, max;         /* REAL, INT, BOOL, CHOICE: default and range */
    const double *defs;           /* VECTOR, COUNTS: defaults, or NULL: must be given */
    const char *const *choices;   /* CHOICE: names, closed by NULL */
    const struct cs_table *table; /* TABLE, LIST: rows of the struct */
};

/* Rows of one struct. An optional TABLE's struct starts with `bool present`: the reader sets
 * it, and leaves the defaults of an absent one. */
struct cs_table {
    const struct cs_option *rows;
    uint32_t n;
    size_t size;                  /* of the struct */
    bool optional;                /* the struct starts with `bool present` */
    bool one_of;                  /* exactly one of the optional rows must be given */
    uint32_t uncounted;           /* first rows that one_of leaves alone */
    const char *shorthand_text;   /* row that a plain string stands for, or NULL */
    const char *shorthand_number; /* row that a plain number stands for, or NULL */
};

/* The four rows that integrator modules use; the C type of the field picks the option type,
 * and a field of any other type does not compile. C only (C++ modules fill the struct). */
#define CS_TYPE_OF(struct_, field)                                                             \
    _Generic(((struct_ *)0)->field, double : CS_REAL, int64_t : CS_INT, bool : CS_BOOL)
#define CS_OPTION(struct_, field, unit_, def_, min_, max_, help_)                              \
    {                                                                                          \
        .name = #field, .unit = unit_, .help = help_, .type = CS_TYPE_OF(struct_, field),      \
        .count = 1, .offset = offsetof(struct_, field), .def = def_, .min = min_, .max = max_  \
    }
#define CS_OPTION_CHOICE(struct_, field, names_, def_, help_)                                  \
    {                                                                                          \
        .name = #field, .unit = "", .help = help_, .type = CS_CHOICE,                          \
        .count = _Generic(((struct_ *)0)->field, int32_t : 1),                                 \
        .offset = offsetof(struct_, field), .def = def_, .choices = names_                     \
    }

#ifdef __cplusplus
}
#endif
#endif
