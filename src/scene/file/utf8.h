/* utf8.h - is a text valid UTF-8, and how to cut it. */
#ifndef CS_UTF8_H
#define CS_UTF8_H

#include "base/text.h"

/* Bytes of the sequence at text (zero-terminated), 0 if there is none: overlong forms and
 * surrogates are none. */
size_t cs_utf8_length(const char *text);

/* true if s is valid UTF-8 without control characters. */
bool cs_utf8_is_plain(const char *s);

/* Adds s in quotes with JSON's escapes, for messages: cut where it is long. */
void cs_utf8_add_short(struct cs_text *out, const char *s);

#endif
