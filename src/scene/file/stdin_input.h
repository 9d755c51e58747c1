/* stdin_input.h - standard input as a scene file. */
#ifndef CS_STDIN_INPUT_H
#define CS_STDIN_INPUT_H

#include "base/status.h"

#include <stddef.h>

/* Name of standard input in place of a scene file, and its title in messages. */
#define CS_STDIN_INPUT_NAME  "-"
#define CS_STDIN_INPUT_TITLE "standard input"

/* Reads all of standard input, at most max bytes. It is read once and stored until the program
 * ends, because studies open their scene more than once; *text is borrowed. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_stdin_input_read(size_t max, const char **text, size_t *bytes,
                                   struct cs_error *error);

#endif
