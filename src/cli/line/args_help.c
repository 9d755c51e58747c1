/* Prints the help of a command from its table of options. */
#include "cli/line/args.h"
#include "cli/line/print.h"

enum { HELP_COLUMN = 28 };

static void add_row(const struct cs_arg *row, struct cs_text *out) {
    struct cs_text left = {0};
    if (row->short_name)
        cs_text_add(&left, "  -%c, --%s", row->short_name, row->name);
    else
        cs_text_add(&left, "      --%s", row->name);
    if (row->value)
        cs_text_add(&left, " %s", row->value);
    cs_print_hanging(cs_text_get(&left), row->help, HELP_COLUMN, out);
    out->failed |= left.failed;
    cs_text_finish(&left);
}

void cs_command_print_help(const struct cs_command *command, struct cs_text *out) {
    static const struct cs_arg help = {.name = "help", .short_name = 'h', .help = "this text"};
    cs_text_add(out, "usage: clothsim %s%s%s [options]\n\n", command->name,
                *command->operands ? " " : "", command->operands);
    cs_print_hanging("", command->summary, 0, out);
    cs_text_add(out, "\n");
    for (uint32_t r = 0; r < command->n_rows; r++)
        if (command->rows[r].help)
            add_row(command->rows + r, out);
    add_row(&help, out);
    if (command->notes)
        cs_text_add(out, "\n%s", command->notes);
}
