/* args.h - commands and their options as tables, with one parser and one --help for all.
 *
 *   argv -> cs_args_parse: options and operands -> defaults, then cs_arg_read per option
 *   -> args->options, the command's struct
 *
 * A command therefore contains no parsing: it reads fields of its struct. */
#ifndef CS_ARGS_H
#define CS_ARGS_H

#include "base/arena.h"
#include "base/text.h"
#include "session/session.h"
#include "session/table.h"

/* One option of a command: the row of its table, and how its value is read. */

/* Kinds of values. The kind follows from the C type of the field, by _Generic: a row cannot
 * disagree with its struct. */
enum cs_arg_kind {
    CS_ARG_SWITCH, /* bool: without a value; turns the default round */
    /* const char *: as it was typed, of argv; repeated: with commas between, of the arena */
    CS_ARG_TEXT,
    /* uint32_t or an enum: a whole number in min..max; with names, the number of the name;
     * where it may be repeated as well, a list of names, as the set of 1 << number */
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
    const char *const *names; /* closed by NULL; of a text: those it may be, or list */
    const char *prefix;       /* put before each item of a list; or NULL */
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
    {"plugin", 'p', "FILE", "load an integrator module; may be repeated",                      \
     CS_ARG_LIST(struct_, session.plugins, session.n_plugins)},                                \
        CS_ARG_PROGRAM(struct_, session.plugins, session.n_plugins)
/* Programs are items of the list of modules. */
#define CS_ARG_PROGRAM(struct_, items, n_items)                                                \
    {                                                                                          \
        "program", 0, "[NAME=]COMMAND", "run this command as a method; may be repeated",       \
            CS_ARG_LIST(struct_, items, n_items), .prefix = "program:"                         \
    }
/* The same in every command that has it. */
#define CS_ARG_QUIET(struct_, field)                                                           \
    {                                                                                          \
        "quiet", 'q', NULL, "print only the answer, failures and differences",                 \
            CS_ARG_INTO(struct_, field)                                                        \
    }

/* Reads one value of an option into its field of the command's struct. Items of lists live as
 * long as the arena. CS_ERR_USAGE, CS_ERR_MEMORY. */
enum cs_status cs_arg_read(const struct cs_arg *row, const char *text, void *options,
                           struct cs_arena *arena, struct cs_error *error);

/* Fails with CS_ERR_USAGE and the list of names (closed by NULL) for an unknown one. */
enum cs_status cs_arg_refuse_name(const char *option, const char *const *names,
                                  const char *text, struct cs_error *error);

struct cs_args;

/* One command of the program: a constant table. */
struct cs_command {
    const char *name;
    const char *operands; /* as in the usage line, "" for none */
    const char *summary;
    const char *notes; /* paragraphs below the options, or NULL */
    const struct cs_arg *rows;
    uint32_t n_rows;
    const void *defaults;                /* of the struct that the rows fill */
    size_t size;                         /* of that struct */
    uint32_t operands_min, operands_max; /* number of operands */
    /* NULL: a program of its own, of which name and summary alone are known here */
    enum cs_status (*main)(struct cs_args *args, struct cs_error *error);
};

/* The table of a command: its rows, and the struct that they fill with its defaults. */
#define CS_COMMAND_OPTIONS(rows_, defaults_)                                                   \
    .rows = rows_, .n_rows = sizeof rows_ / sizeof *rows_, .defaults = &defaults_,             \
    .size = sizeof defaults_

/* One option as given. */
struct cs_arg_value {
    const struct cs_arg *row; /* of the command's table */
    const char *value;        /* "" of a switch */
};

/* The words after a command, sorted; zeroed: nothing. */
struct cs_args {
    const struct cs_command *command;
    void *options; /* the command's struct: defaults, and what was given */
    struct cs_arg_value *given;
    const char **operands;
    char **words; /* all of them, as they were typed */
    uint32_t n_given, n_operands, n_words;
    bool help;             /* --help was given: nothing else was read */
    struct cs_arena arena; /* owns the arrays and lists above; commands may take from it too */
};

/* Sorts the words after the command's name into options and operands, and reads the options
 * into args->options. Texts remain argv's. With --help nothing else is read. On failure
 * CS_ERR_USAGE or CS_ERR_MEMORY; cs_args_finish must be called in any case. */
enum cs_status cs_args_parse(struct cs_args *args, const struct cs_command *command, int argc,
                             char **argv, struct cs_error *error);

/* Adds the programs that --integrator names, "program:COMMAND", to the list that the option
 * --program fills: no file reaches that list, so that no file can start a program. Call it
 * after cs_args_parse. CS_ERR_MEMORY. */
enum cs_status cs_args_add_programs(struct cs_args *args, struct cs_error *error);

/* Frees everything that the arena owns, args->options included. */
void cs_args_finish(struct cs_args *args);

/* True if the option of that long name was given. */
bool cs_args_is_given(const struct cs_args *args, const char *name);

/* Fails with CS_ERR_USAGE if both of these options were given. */
enum cs_status cs_args_refuse_both(const struct cs_args *args, const char *a, const char *b,
                                   struct cs_error *error);

/* Adds the text of `clothsim COMMAND --help`. */
void cs_command_print_help(const struct cs_command *command, struct cs_text *out);

#endif
