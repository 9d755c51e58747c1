/* stdin_input.h - standard input as a scene file. */
#ifndef CS_STDIN_INPUT_H
#define CS_STDIN_INPUT_H

#include "base/status.h"

#include <stddef.h>

/* What stands for standard input where a scene file is asked for, and what messages call it. */
#define CS_STDIN_INPUT_NAME  "-"
#define CS_STDIN_INPUT_TITLE "standard input"

/* All of standard input, at most max bytes. It is read once and kept until the program ends, as
 * studies open their scene more than once; *text stays the input's. CS_ERR_FILE, CS_ERR_MEMORY.
 */
enum cs_status cs_stdin_input_read(size_t max, const char **text, size_t *bytes,
                                   struct cs_error *error);

#endif
