/* arg_programs.c - the one place where a list of methods can start programs: the command line.
 */
#include "cli/line/args.h"

#include <string.h>

/* Adds the programs of a list of methods, as --program does. */
static enum cs_status add_programs(struct cs_args *args, const struct cs_arg *row,
                                   const char *methods, struct cs_error *error) {
    char *rest = cs_arena_copy_text(&args->arena, methods, error);
    while (rest && !error->status) {
        char *item = cs_method_split(&rest), name[CS_SERIES_BYTES];
        const char *method = item;
        struct cs_error unread = {0}; // reported when the list is read
        if (cs_series_parse_name(&method, name, &unread) || !cs_names_program(method))
            continue;
        // the name alone: without SERIES= and options
        item += method - item;
        item[cs_method_name_length(item)] = 0;
        cs_arg_read(row, item, args->options, &args->arena, error);
    }
    return error->status;
}

enum cs_status cs_args_add_programs(struct cs_args *args, struct cs_error *error) {
    const struct cs_command *command = args->command;
    const struct cs_arg *row = command->rows;
    while (row < command->rows + command->n_rows && !row->prefix)
        row++;
    if (args->help || row == command->rows + command->n_rows)
        return CS_OK;
    for (uint32_t i = 0; i < args->n_given && !error->status; i++)
        if (!strncmp(args->given[i].row->name, "integrator", 10))
            add_programs(args, row, args->given[i].value, error);
    return error->status;
}
