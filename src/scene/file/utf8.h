/* utf8.h - checks that a text is valid UTF-8, and cuts it between characters. */
#ifndef CS_UTF8_H
#define CS_UTF8_H

#include "base/text.h"

/* Returns the bytes of the first character of a zero-terminated text, 0 if it is not valid:
 * overlong forms and surrogates are not. */
size_t cs_utf8_length(const char *text);

/* Returns true if s is valid UTF-8 without control characters. */
bool cs_utf8_is_plain(const char *s);

/* Adds s in quotes with JSON's escapes, for messages; a long one is cut and ends with "...". */
void cs_utf8_add_short(struct cs_text *out, const char *s);

#endif
