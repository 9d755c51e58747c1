/* text.h - growable text, and numbers that read back the same in every locale. */
#ifndef CS_TEXT_H
#define CS_TEXT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

/* A zeroed struct is an empty text. */
struct cs_text {
    char *bytes; /* owned, zero-terminated; NULL while empty */
    size_t length, capacity;
    bool failed; /* out of memory: later additions do nothing, the content is not to be used */
};

void cs_text_add(struct cs_text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Adds the shortest decimal that reads back as value; inf and nan are written as null. */
void cs_text_add_real(struct cs_text *text, double value);

/* Adds s in quotes with JSON's escapes. */
void cs_text_add_json(struct cs_text *text, const char *s);

/* Zero-terminated content, "" if empty. */
const char *cs_text_get(const struct cs_text *text);
void cs_text_finish(struct cs_text *text);

/* Reads a whole string as a finite double, with a point whatever the locale. */
bool cs_parse_real(const char *s, double *value);

/* The candidate (list closed by NULL) nearest to word, or NULL if none is: edits, of which a
 * swap of neighbours is one, of at most a third of the letters, or a beginning. */
const char *cs_nearest_word(const char *word, const char *const *candidates);

#endif
