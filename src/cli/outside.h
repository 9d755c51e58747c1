/* outside.h - modules that were not installed with the program, which studies run in a process
 * of their own. */
#ifndef CS_OUTSIDE_H
#define CS_OUTSIDE_H

#include "cli/line/args.h"

/* true where a command may load one: its option --plugin is given, one of the
 * texts (n) names a file in the place of a method, or there are folders of them. */
bool cs_outside_is_named(const struct cs_args *args, const char *const *texts, uint32_t n);

#endif
