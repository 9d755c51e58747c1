/* args.h - commands and their options as tables, with one parser and one --help for all.
 *
 *   argv -> cs_args_parse: options and operands -> defaults, then cs_arg_read per option
 *   -> args->options, the command's struct
 *
 * A command therefore contains no parsing: it reads fields of its struct. */
#ifndef CS_ARGS_H
#define CS_ARGS_H

#include "base/arena.h"
#include "base/table.h"
#include "base/text.h"
#include "cli/line/option_row.h"

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
    uint32_t n_given, n_operands;
    bool help;             /* --help was given: nothing else was read */
    struct cs_arena arena; /* owns the arrays and lists above; commands may take from it too */
};

/* Sorts the words after the command's name into options and operands, and reads the options
 * into args->options. Texts remain argv's. With --help nothing else is read. On failure
 * CS_ERR_USAGE or CS_ERR_MEMORY; cs_args_finish must be called in any case. */
enum cs_status cs_args_parse(struct cs_args *args, const struct cs_command *command, int argc,
                             char **argv, struct cs_error *error);
/* Frees everything that the arena owns, args->options included. */
void cs_args_finish(struct cs_args *args);

/* True if the option of that long name was given. */
bool cs_args_is_given(const struct cs_args *args, const char *name);

/* Adds the text of `clothsim COMMAND --help`. */
void cs_command_print_help(const struct cs_command *command, struct cs_text *out);

#endif
