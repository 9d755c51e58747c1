/* option_row.h - one option of a command: the row of its table, and how its value is read. */
#ifndef CS_OPTION_ROW_H
#define CS_OPTION_ROW_H

#include "base/arena.h"
#include "base/table.h"
#include "scene/file/scene_read.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Kinds of values. The kind follows from the C type of the field, by _Generic: a row cannot
 * disagree with its struct. */
enum cs_arg_kind {
    CS_ARG_SWITCH, /* bool: without a value; turns the default round */
    CS_ARG_TEXT,   /* const char *: as it was typed, of argv */
    /* uint32_t or an enum: a whole number in min..max; with names, the number of the name;
     * where it may be repeated as well, the set of 1 << number */
    CS_ARG_WHOLE,
    CS_ARG_REAL,      /* double: above 0, up to 1e9 */
    CS_ARG_SHARD,     /* struct cs_shard: "k/n" */
    CS_ARG_WORDS,     /* const char *const *: a list of texts */
    CS_ARG_OVERRIDES, /* const struct cs_override *: a list of PATH=VALUE */
};

/* One option of a command: a constant row. */
struct cs_arg {
    const char *name;  /* long name without its dashes */
    char short_name;   /* short name; 0: none */
    const char *value; /* placeholder of its value in --help; NULL: a switch */
    const char *help;  /* lower case, no full stop; NULL: not shown */
    enum cs_arg_kind kind;
    size_t offset;            /* of the field in the command's struct of options */
    size_t count;             /* of the uint32_t that counts the items of a list there */
    bool repeatable;          /* may be given more than once */
    bool methods;             /* each value is a list of methods NAME:key=value,...,NAME,... */
    uint32_t min, max;        /* of a whole number */
    const char *const *names; /* closed by NULL */
    const char *old_name;     /* long name of the release before, still taken; or NULL */
};

/* The part of a row that binds the option to a field, of a type named above. */
#define CS_ARG_INTO(struct_, field)                                                            \
    .kind = _Generic(((struct_ *)0)->field, bool                                               \
                     : CS_ARG_SWITCH, const char *                                             \
                     : CS_ARG_TEXT, uint32_t                                                   \
                     : CS_ARG_WHOLE, double                                                    \
                     : CS_ARG_REAL, struct cs_shard                                            \
                     : CS_ARG_SHARD),                                                          \
    .offset = offsetof(struct_, field)

/* The same of a list and the uint32_t that counts it; the option may then be repeated. */
#define CS_ARG_LIST(struct_, items, n_items)                                                   \
    .kind = _Generic(((struct_ *)0)->items, const char *const *                                \
                     : CS_ARG_WORDS, const struct cs_override *                                \
                     : CS_ARG_OVERRIDES),                                                      \
    .offset = offsetof(struct_, items),                                                        \
    .count = _Generic(((struct_ *)0)->n_items, uint32_t : offsetof(struct_, n_items)),         \
    .repeatable = true

/* Rows that most commands have, of a struct with a member `session`. */
#define CS_ARG_SET(struct_, session)                                                           \
    {                                                                                          \
        "set", 's', "PATH=VALUE", "override a scene value; may be repeated",                   \
            CS_ARG_LIST(struct_, session.overrides, session.n_overrides)                       \
    }
#define CS_ARG_PLUGIN(struct_, session)                                                        \
    {                                                                                          \
        "plugin", 'p', "FILE", "load an integrator module; may be repeated",                   \
            CS_ARG_LIST(struct_, session.plugins, session.n_plugins)                           \
    }

/* Reads one value of an option into its field of the command's struct. Items of lists live as
 * long as the arena. CS_ERR_USAGE, CS_ERR_MEMORY. */
enum cs_status cs_arg_read(const struct cs_arg *row, const char *text, void *options,
                           struct cs_arena *arena, struct cs_error *error);

/* Fails with CS_ERR_USAGE and the list of names (closed by NULL) for an unknown one. */
enum cs_status cs_arg_refuse_name(const char *option, const char *const *names,
                                  const char *text, struct cs_error *error);

#endif
