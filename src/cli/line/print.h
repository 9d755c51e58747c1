/* print.h - text for people: aligned, wrapped, and written so that a failure is noticed. */
#ifndef CS_PRINT_H
#define CS_PRINT_H

#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>
#include <stdio.h>

/* Adds `left`, then `right` from `column` on, wrapped at 80 columns and hanging there; where
 * left is too long, right starts on the next line. One line break at the end. */
void cs_print_hanging(const char *left, const char *right, size_t column, struct cs_text *out);

/* Writes a finished text to stdout or stderr and flushes it; the text is freed either way.
 * CS_ERR_MEMORY where the text failed, CS_ERR_FILE where it could not be written. */
enum cs_status cs_print_out(FILE *file, struct cs_text *text, struct cs_error *error);

/* The same into a file; "-": standard output. */
enum cs_status cs_print_file(const char *path, struct cs_text *text, struct cs_error *error);

/* "clothsim: message" on stderr, in one line whatever the message holds. */
void cs_print_message(const char *message);

/* true for the name that stands for standard output; path may be NULL. */
bool cs_print_is_stdout(const char *path);

#endif
