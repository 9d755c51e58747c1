/* commands.h - the commands of the program, one file each. */
#ifndef CS_COMMANDS_H
#define CS_COMMANDS_H

#include "cli/command_list.h"
#include "cli/line/args.h"

#define X(name) extern const struct cs_command cs_command_##name;

CS_COMMAND_LIST(X)
#undef X

/* The form of scene files, which the command scene prints. */

/* Adds the JSON schema (2020-12) of scene files. */
void cs_scene_print_schema(struct cs_text *out);
/* Adds the rows of the scene tables as scdoc text, for clothsim-scene(5). */
void cs_scene_print_manual(struct cs_text *out);

/* Modules that were not installed with the program, which studies run in a
 * process of their own. */

/* True if a command may load a module from outside: --plugin is given, one of the texts (n)
 * names a file in place of a method, or folders of modules are set up. Such code runs in a
 * child process (session/process_pool.h). */
bool cs_external_modules_requested(const struct cs_args *args, const char *const *texts,
                                   uint32_t n);

/* Runs a command in a child process. seconds: that a call into a module may take, 0: any;
 * stop_seconds: the same after the first signal to stop. */
enum cs_status
cs_external_modules_isolate(struct cs_args *args, double seconds, double stop_seconds,
                            enum cs_status (*task)(void *ctx, struct cs_error *error),
                            struct cs_error *error);

#endif
