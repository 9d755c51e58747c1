/* json_check.h - checks that a text is strict JSON, and finds the first fault. */
#ifndef CS_JSON_CHECK_H
#define CS_JSON_CHECK_H

#include "base/text.h"

#include <stdint.h>

/* Limits of a scene file, against hostile ones. */
enum {
    CS_JSON_BYTES_MAX = 16 * 1024 * 1024,
    CS_JSON_DEPTH_MAX = 64,
    CS_JSON_VALUES_MAX = 500000, /* bounds the memory of the tree */
    CS_JSON_NUMBER_MAX = 63      /* characters: what the parser behind this check can hold */
};

/* The first fault of a text. */
struct cs_json_fault {
    size_t offset; /* bytes from the start of the text */
    char message[200];
};

/* Returns true if text (length bytes, a zero after them) is one JSON value by RFC 8259, and
 * also: valid UTF-8 without byte-order mark, no zero in any string, surrogates in pairs, finite
 * numbers, within the limits above. Else fills *fault. */
bool cs_json_check(const char *text, size_t length, struct cs_json_fault *fault);

/* Converts an offset to line and column, both from 1; the column counts bytes. */
void cs_json_locate(const char *text, size_t offset, uint32_t *line, uint32_t *column);

/* On checked text: the first offset from `at` that is not blank; the one after a string. */
size_t cs_json_skip_blank(const char *text, size_t at);
size_t cs_json_skip_text(const char *text, size_t at);

/* Checks that a text is valid UTF-8, and cuts it between characters. */

/* Returns true if s is valid UTF-8 without control characters. */
bool cs_utf8_is_plain(const char *s);

/* Adds s in quotes with JSON's escapes, for messages; a long one is cut and ends with "...". */
void cs_utf8_add_short(struct cs_text *out, const char *s);

#endif
