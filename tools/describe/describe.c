/* clothsim-describe: prints what clothsim says of itself, from the tables of its commands and
 * of the files that they write. clothsim starts it in its own place, with the same words:
 *
 *   --completion SHELL              the completion script of a shell
 *   --complete COMMAND OPTION WORD  the words that a value may become, for those scripts
 *   --schema NAME                   the JSON schema of a file
 *   --files                         the source of the section FILES of clothsim-files(5) */
#include "base/install_paths.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "describe/completion.h"
#include "describe/completion_values.h"
#include "describe/output_keys.h"

#include <string.h>

static const struct cs_command *const commands[] = {
#define X(name) &cs_command_##name,
    CS_COMMAND_LIST(X)
#undef X
        NULL};

/* clothsim has refused a command that there is none of. */
static void add_values(char **argv, struct cs_text *out) {
    for (uint32_t i = 0; commands[i]; i++)
        if (!strcmp(commands[i]->name, argv[0]))
            cs_completion_print_values(commands[i], argv[1], argv[2], out);
}

/* Adds what the words ask for; without a name the message lists the names. */
static enum cs_status describe(int argc, char **argv, struct cs_text *out,
                               struct cs_error *error) {
    const char *what = argc > 1 ? argv[1] : "", *name = argc > 2 ? argv[2] : "";
    if (!strcmp(what, "--completion"))
        return cs_completion_print(commands, name, out, error);
    if (!strcmp(what, "--schema"))
        return cs_output_print_schema(name, out, error);
    if (!strcmp(what, "--complete") && argc == 5)
        add_values(argv + 2, out);
    else if (!strcmp(what, "--files"))
        cs_output_print_manual(out);
    else
        return cs_fail(error, CS_ERR_USAGE,
                       "clothsim starts this program (see: clothsim help)");
    return CS_OK;
}

int main(int argc, char **argv) {
    struct cs_text out = {0};
    struct cs_error error = {0};
    cs_program_from_tool();
    if (!describe(argc, argv, &out, &error))
        cs_print_out(stdout, &out, &error);
    cs_text_finish(&out);
    if (!error.status && (fflush(stdout) || ferror(stdout)))
        cs_fail(&error, CS_ERR_FILE, "cannot write to standard output");
    if (error.status)
        cs_print_message(error.message);
    return cs_status_exit_code(error.status);
}
