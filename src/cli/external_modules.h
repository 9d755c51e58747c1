/* external_modules.h - modules that were not installed with the program, which studies run in a
 * process of their own. */
#ifndef CS_EXTERNAL_MODULES_H
#define CS_EXTERNAL_MODULES_H

#include "cli/line/args.h"

/* true where a command may load one: its option --plugin is given, one of the
 * texts (n) names a file in the place of a method, or there are folders of them. */
bool cs_external_modules_requested(const struct cs_args *args, const char *const *texts,
                                   uint32_t n);

#endif
