/* args.h - commands and their options as tables: one parser, one --help. */
#ifndef CS_ARGS_H
#define CS_ARGS_H

#include "base/arena.h"
#include "base/table.h"
#include "base/text.h"
#include "io/scene_read.h"

#include <stdbool.h>
#include <stdint.h>

/* One option of a command. */
struct cs_arg {
    const char *name;  /* long name without its dashes */
    char letter;       /* short name; 0: none */
    const char *value; /* what stands for its value in --help; NULL: a switch */
    const char *help;  /* lower case, no full stop; NULL: not shown */
    bool many;         /* may be given more than once */
};

struct cs_args;

struct cs_command {
    const char *name;
    const char *operands; /* as in the usage line, "" for none */
    const char *summary;
    const char *notes; /* paragraphs below the options, or NULL */
    const struct cs_arg *rows;
    uint32_t n_rows;
    uint32_t least, most; /* number of operands */
    enum cs_status (*main)(struct cs_args *args, struct cs_error *error);
};

struct cs_given {
    uint32_t row; /* of the command's table */
    const char *value;
};

/* What was typed behind a command, in its order. Zeroed: nothing. */
struct cs_args {
    const struct cs_command *command;
    struct cs_given *given;
    const char **operands;
    uint32_t n_given, n_operands;
    bool help;             /* --help was there: nothing else was looked at */
    struct cs_arena arena; /* owns the arrays above and what the calls below hand out */
};

/* Sorts the arguments behind the command's name into options and operands; the texts stay
 * argv's. On failure CS_ERR_USAGE or CS_ERR_MEMORY; finish is still to be called. */
enum cs_status cs_args_parse(struct cs_args *args, const struct cs_command *command, int argc,
                             char **argv, struct cs_error *error);
void cs_args_finish(struct cs_args *args);

/* The last value of an option ("" of a switch), or NULL if it was not given. */
const char *cs_args_get(const struct cs_args *args, uint32_t row);

/* All values of an option, in order; CS_ERR_MEMORY. */
enum cs_status cs_args_all(struct cs_args *args, uint32_t row, const char *const **values,
                           uint32_t *n, struct cs_error *error);

/* The methods of all values of an option, each a list NAME:key=value,...,NAME,... */
enum cs_status cs_args_methods(struct cs_args *args, uint32_t row, const char *const **methods,
                               uint32_t *n, struct cs_error *error);

/* An option as a whole number in min..max; *value is left alone where it was not given. */
enum cs_status cs_args_whole(const struct cs_args *args, uint32_t row, uint32_t min,
                             uint32_t max, uint32_t *value, struct cs_error *error);

/* An option as a number above 0 and up to 1e9; *value is left alone where it was not given. */
enum cs_status cs_args_real(const struct cs_args *args, uint32_t row, double *value,
                            struct cs_error *error);

/* An option "k/n" as a share of a study; *shard is left alone where it was not given. */
enum cs_status cs_args_shard(const struct cs_args *args, uint32_t row, struct cs_shard *shard,
                             struct cs_error *error);

/* An option as one of names (closed by NULL); *index is left alone where it was not given. */
enum cs_status cs_args_choice(const struct cs_args *args, uint32_t row,
                              const char *const *names, int *index, struct cs_error *error);

/* The same of an option that may be given more than once: *set has the bit of each name given,
 * and is left alone where there was none. */
enum cs_status cs_args_choices(struct cs_args *args, uint32_t row, const char *const *names,
                               uint32_t *set, struct cs_error *error);

/* All PATH=VALUE of an option as overrides of a scene. */
enum cs_status cs_args_overrides(struct cs_args *args, uint32_t row,
                                 const struct cs_override **overrides, uint32_t *n,
                                 struct cs_error *error);

/* Adds the text of `clothsim COMMAND --help`. */
void cs_command_print_help(const struct cs_command *command, struct cs_text *out);

#endif
