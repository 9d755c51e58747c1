/* completion.h - shell scripts that complete commands and options, made from their tables. */
#ifndef CS_COMPLETION_H
#define CS_COMPLETION_H

#include "cli/line/args.h"

/* Adds the script for "bash", "zsh" or "fish"; CS_ERR_USAGE for any other shell. commands is
 * closed by NULL. */
enum cs_status cs_completion_print(const struct cs_command *const *commands, const char *shell,
                                   struct cs_text *out, struct cs_error *error);

#endif
