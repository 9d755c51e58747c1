/* print.h - text for readers: aligned, wrapped, and written with a check for failures. */
#ifndef CS_PRINT_H
#define CS_PRINT_H

#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>
#include <stdio.h>

/* Adds `left`, then `right` from `column` on, wrapped at 80 columns with a hanging indent. If
 * left is too long, right starts on the next line. Ends with one line break. */
void cs_print_hanging(const char *left, const char *right, size_t column, struct cs_text *out);

/* Writes a finished text to stdout or stderr and flushes it; frees the text in any case.
 * CS_ERR_MEMORY if the text failed, CS_ERR_FILE if it could not be written. */
enum cs_status cs_print_out(FILE *file, struct cs_text *text, struct cs_error *error);

/* Writes a text to a file, or to standard output for "-"; frees it in any case. */
enum cs_status cs_print_file(const char *path, struct cs_text *text, struct cs_error *error);

/* Writes "clothsim: message" to stderr in one line; control characters become "?". */
void cs_print_message(const char *message);

/* True for "-", which means standard output; path may be NULL. */
bool cs_print_is_stdout(const char *path);

#endif
