/* Parses a command's options and operands by its table of options. */
#include "cli/line/args.h"

#include "base/old_name.h"

#include <string.h>

/* Rows that a command may have; asserted. */
enum { LONGEST_TABLE = 31 };

/* CS_ERR_USAGE for an unknown option, with the nearest known one. Hidden rows are not
 * suggested. */
static enum cs_status unknown_option(const struct cs_command *command, const char *word,
                                     struct cs_error *error) {
    const char *names[LONGEST_TABLE + 1];
    uint32_t n = 0;
    CS_ASSERT(command->n_rows <= LONGEST_TABLE);
    for (uint32_t r = 0; r < command->n_rows; r++)
        if (command->rows[r].help)
            names[n++] = command->rows[r].name;
    names[n] = NULL;
    const char *nearest = word[1] == '-' ? cs_nearest_word(word + 2, names) : NULL;
    if (nearest)
        return cs_fail(
            error, CS_ERR_USAGE,
            "unknown option \"%.60s\"; did you mean \"--%s\"? (see: clothsim %s --help)", word,
            nearest, command->name);
    return cs_fail(error, CS_ERR_USAGE, "unknown option \"%.60s\" (see: clothsim %s --help)",
                   word, command->name);
}

static bool is_old_name(const struct cs_arg *row, const char *word, size_t length) {
    return row->old_name && strlen(row->old_name) == length &&
           !strncmp(row->old_name, word, length);
}

/* Compares with the long name. An option that may be repeated can also be given in the singular
 * (--integrator for --integrators). */
static bool is_called(const struct cs_arg *row, const char *word, size_t length) {
    const size_t whole = strlen(row->name);
    const bool singular = row->repeatable && whole == length + 1 && row->name[length] == 's';
    return (whole == length || singular) && !strncmp(row->name, word, length);
}

/* Finds the row of "--name", "--name=value", "-n" or "-nvalue", and the attached value. */
static const struct cs_arg *find_row(const struct cs_command *command, const char *word,
                                     const char **attached) {
    *attached = NULL;
    for (uint32_t r = 0; r < command->n_rows; r++) {
        const struct cs_arg *row = command->rows + r;
        if (word[1] == '-') {
            const size_t length = strcspn(word + 2, "=");
            const bool old = is_old_name(row, word + 2, length);
            if (!old && !is_called(row, word + 2, length))
                continue;
            if (old)
                cs_old_name_report("--", row->old_name, row->name);
            *attached = word[2 + length] ? word + 3 + length : NULL;
            return row;
        }
        if (row->short_name != word[1])
            continue;
        if (word[2])
            *attached = word + 2;
        return row;
    }
    return NULL;
}

bool cs_args_is_given(const struct cs_args *args, const char *name) {
    for (uint32_t i = 0; i < args->n_given; i++)
        if (!strcmp(args->given[i].row->name, name))
            return true;
    return false;
}

/* Takes the option at argv[*i], and its value if that is the next word. */
static enum cs_status take_option(struct cs_args *args, int argc, char **argv, int *i,
                                  struct cs_error *error) {
    const char *attached;
    const struct cs_arg *row = find_row(args->command, argv[*i], &attached);
    if (!row || (!row->value && attached && argv[*i][1] != '-'))
        return unknown_option(args->command, argv[*i], error);
    if (!row->repeatable && cs_args_is_given(args, row->name))
        return cs_fail(error, CS_ERR_USAGE, "--%s is given more than once", row->name);
    const char *value = attached;
    if (!row->value) {
        if (attached)
            return cs_fail(error, CS_ERR_USAGE, "--%s takes no value, found \"%.60s\"",
                           row->name, attached);
        value = "";
    } else if (!attached) {
        /* two dashes are the next option: its name is hardly meant as a value */
        if (*i + 1 >= argc || !strncmp(argv[*i + 1], "--", 2))
            return cs_fail(error, CS_ERR_USAGE, "--%s needs a value: --%s %s", row->name,
                           row->name, row->value);
        value = argv[++*i];
    }
    if (row->value && !*value)
        return cs_fail(error, CS_ERR_USAGE, "--%s needs a value: --%s %s", row->name, row->name,
                       row->value);
    args->given[args->n_given++] = (struct cs_arg_value){row, value};
    return CS_OK;
}

/* True if --help or -h occurs before "--": it takes precedence over all errors. */
static bool asks_for_help(int argc, char **argv) {
    for (int i = 0; i < argc && strcmp(argv[i], "--"); i++)
        if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h"))
            return true;
    return false;
}

static enum cs_status check_operands(const struct cs_args *args, struct cs_error *error) {
    const struct cs_command *command = args->command;
    if (args->n_operands < command->operands_min)
        return cs_fail(error, CS_ERR_USAGE, "expected %s (see: clothsim %s --help)",
                       command->operands, command->name);
    if (args->n_operands > command->operands_max)
        return cs_fail(error, CS_ERR_USAGE,
                       "unexpected argument \"%.60s\" (see: clothsim %s --help)",
                       args->operands[command->operands_max], command->name);
    return CS_OK;
}

/* Sorts options and operands into their arrays; values are read later. */
static enum cs_status sort(struct cs_args *args, int argc, char **argv,
                           struct cs_error *error) {
    bool options = true;
    for (int i = 0; i < argc; i++) {
        if (options && !strcmp(argv[i], "--"))
            options = false;
        /* a lone "-" is an operand */
        else if (options && argv[i][0] == '-' && argv[i][1]) {
            if (take_option(args, argc, argv, &i, error))
                return error->status;
        } else
            args->operands[args->n_operands++] = argv[i];
    }
    return check_operands(args, error);
}

enum cs_status cs_args_parse(struct cs_args *args, const struct cs_command *command, int argc,
                             char **argv, struct cs_error *error) {
    args->command = command;
    args->help = asks_for_help(argc, argv);
    if (args->help)
        return CS_OK;
    /* no word gives more than one option or operand */
    args->given = cs_arena_alloc_array(&args->arena, (size_t)argc, sizeof *args->given, error);
    args->operands =
        cs_arena_alloc_array(&args->arena, (size_t)argc, sizeof *args->operands, error);
    args->options = cs_arena_alloc(&args->arena, command->size, error);
    if (error->status || sort(args, argc, argv, error))
        return error->status;
    memcpy(args->options, command->defaults, command->size);
    for (uint32_t i = 0; i < args->n_given && !error->status; i++)
        cs_arg_read(args->given[i].row, args->given[i].value, args->options, &args->arena,
                    error);
    return error->status;
}

void cs_args_finish(struct cs_args *args) {
    cs_arena_finish(&args->arena);
    *args = (struct cs_args){0};
}
