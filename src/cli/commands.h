/* commands.h - the commands of the program, one file each. */
#ifndef CS_COMMANDS_H
#define CS_COMMANDS_H

#include "cli/command_list.h"
#include "cli/line/args.h"

#define X(name) extern const struct cs_command cs_command_##name;

CS_COMMAND_LIST(X)
#undef X

/* Shell scripts that complete commands and options, made from their tables. */

/* Adds the script for "bash", "zsh" or "fish"; CS_ERR_USAGE for any other shell. commands is
 * closed by NULL; CS_ERR_FILE where the program of a command does not answer. */
enum cs_status cs_completion_print(const struct cs_command *const *commands, const char *shell,
                                   struct cs_text *out, struct cs_error *error);

/* Adds the part of one command to such a script. */
enum cs_status cs_completion_print_command(const struct cs_command *command, const char *shell,
                                           struct cs_text *out, struct cs_error *error);

/* Adds the words, one per line, that `text` may become as a value of the option ("--name" or
 * "-n"), or as an operand if there is no such option: methods and their options, paths of a
 * scene, names. For files and numbers none. */
void cs_completion_print_values(const struct cs_command *command, const char *option,
                                const char *text, struct cs_text *out);

/* Source of completions for a value or an operand, derived from its placeholder in the help;
 * from METHOD on `clothsim --complete` knows them. */
enum cs_completion_source {
    CS_COMPLETE_NOTHING,
    CS_COMPLETE_FOLDERS,
    CS_COMPLETE_FILES,
    CS_COMPLETE_METHOD,
    CS_COMPLETE_METHODS,
    CS_COMPLETE_PATHS,
    CS_COMPLETE_WORDS
};

/* The source of an operand, or of an option; nothing of a switch. */
enum cs_completion_source cs_completion_source_of(const char *value);
enum cs_completion_source cs_completion_source_of_row(const struct cs_arg *row);

/* Commands that are programs of their own, which have no function here. */

/* Starts the program of a command in place of this one; argv ends with NULL. Returns only if
 * that failed: CS_ERR_FILE. */
enum cs_status cs_tool_start(const struct cs_command *command, char **argv,
                             struct cs_error *error);

/* Adds the program's part of the completion script of a shell. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_tool_query(const struct cs_command *command, const char *shell,
                             struct cs_text *out, struct cs_error *error);

/* Modules that were not installed with the program, which studies run in a
 * process of their own. */

/* True if a command may load a module from outside: --plugin is given, one of the texts (n)
 * names a file in place of a method, or folders of modules are set up. Such code runs in a
 * child process (study/process_pool.h). */
bool cs_external_modules_requested(const struct cs_args *args, const char *const *texts,
                                   uint32_t n);

/* Runs a command in a child process. seconds: that a call into a module may take, 0: any;
 * stop_seconds: the same after the first signal to stop. */
enum cs_status
cs_external_modules_isolate(struct cs_args *args, double seconds, double stop_seconds,
                            enum cs_status (*task)(void *ctx, struct cs_error *error),
                            struct cs_error *error);

#endif
