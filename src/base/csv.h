/* csv.h - fields of tables as text (RFC 4180), one line a row. */
#ifndef CS_CSV_H
#define CS_CSV_H

#include "base/text.h"

#include <stdint.h>

/* Adds a text, in quotes where it must be; line breaks become blanks, so that a row is a line.
 */
void cs_csv_add_field(struct cs_text *out, const char *text);

/* Adds a comma and a number; nothing behind the comma if it is not finite. */
void cs_csv_add_real(struct cs_text *out, double value);

/* Cuts a line into its fields in place, without their quotes: (most) of them, those beyond are
 * passed over. Returns what is behind the line; NULL: the line has no end. */
char *cs_csv_cut_line(char *line, char **fields, uint32_t most, uint32_t *n);

#endif
