/* args.h - commands and their options as tables: one parser, one --help. */
#ifndef CS_ARGS_H
#define CS_ARGS_H

#include "base/arena.h"
#include "base/table.h"
#include "base/text.h"
#include "cli/line/option_row.h"

struct cs_args;

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

struct cs_arg_value {
    const struct cs_arg *row; /* of the command's table */
    const char *value;        /* "" of a switch */
};

/* What was typed behind a command, in its order. Zeroed: nothing. */
struct cs_args {
    const struct cs_command *command;
    void *options; /* the command's struct: defaults, and what was given */
    struct cs_arg_value *given;
    const char **operands;
    uint32_t n_given, n_operands;
    bool help;             /* --help was there: nothing else was looked at */
    struct cs_arena arena; /* owns the arrays and lists above; commands may take from it too */
};

/* Sorts the arguments behind the command's name into options and operands, and reads the
 * options into args->options; the texts stay argv's. On failure CS_ERR_USAGE or CS_ERR_MEMORY;
 * finish is still to be called. */
enum cs_status cs_args_parse(struct cs_args *args, const struct cs_command *command, int argc,
                             char **argv, struct cs_error *error);
void cs_args_finish(struct cs_args *args);

/* true where the option of that long name was given. */
bool cs_args_is_given(const struct cs_args *args, const char *name);

/* Adds the text of `clothsim COMMAND --help`. */
void cs_command_print_help(const struct cs_command *command, struct cs_text *out);

#endif
