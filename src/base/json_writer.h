/* json_writer.h - writes JSON by templates that look like the text they produce. */
#ifndef CS_JSON_WRITER_H
#define CS_JSON_WRITER_H

#include "base/text.h"

/* Adds JSON by a template in which ' stands for ". Conversions are those of printf, checked by
 * the compiler, but write values of JSON:
 *   %s         a text in quotes with JSON's escapes; NULL: null
 *   %g         the shortest decimal that reads back as the same double; inf and nan: null
 *   %d         a bool: true or false
 *   %u %llu %zu %ld   whole numbers
 * A comma that begins a template, and a blank after it, is left out where no member or item
 * stands before it. A text that holds JSON already is added by cs_text_add. */
void cs_json_write(struct cs_text *out, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* The same on a line of its own, with a comma before it where a member or item stands there. */
void cs_json_line(struct cs_text *out, int indent, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
