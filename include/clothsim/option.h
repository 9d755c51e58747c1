/* SPDX-License-Identifier: MIT */
/* option.h - one self-describing table for every struct that a user can fill.
 *
 * A row names a field of a plain struct and gives its type, unit, default, range and meaning.
 * From such tables clothsim reads scenes and options, prints help and resolved values, and
 * writes the JSON schema. An integrator module describes its options with the first four
 * types of enum cs_type; the others serve the scene.
 */
#ifndef CLOTHSIM_OPTION_H
#define CLOTHSIM_OPTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The type of a row, and with it the C type of the field. */
enum cs_type {
    /* double; a default of NAN means: absent unless given. */
    CS_REAL,
    /* int64_t. */
    CS_INT,
    /* bool. */
    CS_BOOL,
    /* int32_t, an index into choices; a default of -1 means: absent unless given. */
    CS_CHOICE,

    /* double[count]; min and max hold for each component. */
    CS_VECTOR,
    /* int64_t[count]. */
    CS_COUNTS,
    /* char[CS_TEXT_MAX], closed by a zero; the default is "", which means absent. */
    CS_TEXT,
    /* A struct that a table of its own describes. */
    CS_TABLE,
    /* A struct cs_list of such structs. */
    CS_LIST
};

/* Bytes of a text, with the zero at its end. */
enum { CS_TEXT_MAX = 256 };

/* A list of structs, as it was read. */
struct cs_list {
    /* Owned by the arena it was read into; NULL if n is 0. */
    void *items;
    uint32_t n;
};

struct cs_table;

/* One row: a field of a struct. */
struct cs_option {
    /* What the user writes: [a-z_]+. */
    const char *name;
    /* The SI unit; "" for a pure number. */
    const char *unit;
    /* One line for the help, in lower case, without a full stop. */
    const char *help;
    enum cs_type type;
    /* Components of a VECTOR or COUNTS; else 1. */
    uint32_t count;
    /* Of the field in its struct. */
    size_t offset;

    /* Default and range, both ends included, of REAL, INT, BOOL and CHOICE; of VECTOR and
     * COUNTS the range of each component. */
    double def, min, max;
    /* Defaults of VECTOR and COUNTS; NULL: the user must give them. */
    const double *defs;
    /* Names of a CHOICE, closed by NULL. Of a REAL: one name, of the value HUGE_VAL; or NULL.
     */
    const char *const *choices;
    /* Rows of the struct of a TABLE or LIST. */
    const struct cs_table *table;
};

/* The rows of one struct. The struct of an optional TABLE starts with `bool present`: the
 * reader sets it, and where the table is absent the defaults stay in the other fields. */
struct cs_table {
    const struct cs_option *rows;
    uint32_t n;
    /* Of the struct in bytes. */
    size_t size;
    /* The struct starts with `bool present`. */
    bool optional;
    /* Exactly one of the optional rows must be given, but for the first n_always_optional
     * rows. */
    bool one_of;
    uint32_t n_always_optional;
    /* The field of a TABLE is a pointer to the struct, which stands elsewhere; NULL where an
     * optional table is absent. */
    bool apart;
    /* The row that a plain text, a plain number, or a plain list in place of the object
     * stands for; or NULL. */
    const char *shorthand_text;
    const char *shorthand_number;
    const char *shorthand_list;
};

#ifdef __cplusplus
}
#endif

/* The rows that integrator modules use. The option's type follows from the type of the field,
 * and a field of any other type does not compile. */
/* Says of an option that it has an effect only where another one, a choice, has certain values.
 * The host refuses an option that is given and has none. */
struct cs_option_use {
    /* Names of the option and of the choice. */
    const char *option, *choice;
    /* A bit for each value of the choice that the option has an effect with: 1u << number. */
    uint32_t values;
};

/* Says that an option had another name in the last release. The host takes both, and reports
 * the old one on standard error. */
struct cs_option_rename {
    const char *old_name, *option;
};

#ifdef __cplusplus
template <typename field> struct cs_number_type;
template <> struct cs_number_type<double> { static constexpr cs_type type = CS_REAL; };
template <> struct cs_number_type<int64_t> { static constexpr cs_type type = CS_INT; };
template <> struct cs_number_type<bool> { static constexpr cs_type type = CS_BOOL; };
template <typename field> struct cs_choice_type;
template <> struct cs_choice_type<int32_t> { static constexpr cs_type type = CS_CHOICE; };
#define CS_NUMBER_TYPE(struct_, field) cs_number_type<decltype(((struct_ *)0)->field)>::type
#define CS_CHOICE_TYPE(struct_, field) cs_choice_type<decltype(((struct_ *)0)->field)>::type
#else
#define CS_NUMBER_TYPE(struct_, field)                                                         \
    _Generic(((struct_ *)0)->field, double : CS_REAL, int64_t : CS_INT, bool : CS_BOOL)
#define CS_CHOICE_TYPE(struct_, field) _Generic(((struct_ *)0)->field, int32_t : CS_CHOICE)
#endif

/* A number or a switch: its unit, default, least and largest value, and help. */
#define CS_OPTION(struct_, field, unit_, def_, min_, max_, help_)                              \
    {                                                                                          \
        "" #field, unit_, help_, CS_NUMBER_TYPE(struct_, field), 1, offsetof(struct_, field),  \
            def_, min_, max_, NULL, NULL, NULL                                                 \
    }

/* A double that may also be a name, which is the one of names_ and means HUGE_VAL. */
#define CS_OPTION_OR_NAME(struct_, field, names_, unit_, def_, min_, max_, help_)              \
    {                                                                                          \
        "" #field, unit_, help_, CS_NUMBER_TYPE(struct_, field), 1, offsetof(struct_, field),  \
            def_, min_, max_, NULL, names_, NULL                                               \
    }

/* One of several names: an int32_t that is the number of the name, the default likewise. */
#define CS_OPTION_CHOICE(struct_, field, names_, def_, help_)                                  \
    {                                                                                          \
        "" #field, "", help_, CS_CHOICE_TYPE(struct_, field), 1, offsetof(struct_, field),     \
            def_, 0, 0, NULL, names_, NULL                                                     \
    }

#endif
