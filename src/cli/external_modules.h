/* external_modules.h - modules that were not installed with the program, which studies run in a
 * process of their own. */
#ifndef CS_EXTERNAL_MODULES_H
#define CS_EXTERNAL_MODULES_H

#include "cli/line/args.h"

/* True if a command may load a module from outside: --plugin is given, one of the texts (n)
 * names a file in place of a method, or folders of modules are set up. Such code runs in a
 * child process (study/isolate.h). */
bool cs_external_modules_requested(const struct cs_args *args, const char *const *texts,
                                   uint32_t n);

#endif
