/* json_check.h - is a text strict JSON, and where not. */
#ifndef CS_JSON_CHECK_H
#define CS_JSON_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    CS_JSON_BYTES_MAX = 16 * 1024 * 1024,
    CS_JSON_DEPTH_MAX = 64,
    CS_JSON_VALUES_MAX = 500000, /* bounds the memory of the tree */
    CS_JSON_NUMBER_MAX = 63      /* characters: what the parser behind this check can hold */
};

struct cs_json_fault {
    size_t offset; /* bytes from the start of the text */
    char message[200];
};

/* true if text (length bytes, a zero behind them) is one JSON value by RFC 8259 and also: valid
 * UTF-8 without byte-order mark, no zero in any string, surrogates in pairs, finite numbers,
 * and within the limits above. Else *fault is filled. */
bool cs_json_check(const char *text, size_t length, struct cs_json_fault *fault);

/* Line and column of an offset, both from 1; the column counts bytes. */
void cs_json_locate(const char *text, size_t offset, uint32_t *line, uint32_t *column);

/* On text that was checked: the first offset that is not blank, and the one behind a string. */
size_t cs_json_skip_blank(const char *text, size_t at);
size_t cs_json_skip_text(const char *text, size_t at);

#endif
