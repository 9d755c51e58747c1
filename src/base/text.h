/* text.h - growable text, and numbers that read back exactly in every locale. */
#ifndef CS_TEXT_H
#define CS_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* A text. A zeroed struct is an empty one. */
struct cs_text {
    char *bytes; /* owned, zero-terminated; NULL while empty */
    size_t length, capacity;
    bool failed; /* out of memory: later additions do nothing; do not use the content */
};

/* Appends formatted text. */
void cs_text_add(struct cs_text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Appends bytes, zeros too. */
void cs_text_add_bytes(struct cs_text *text, const void *bytes, size_t length);

enum { CS_REAL_DIGITS = 40 };

/* Prints the shortest decimal that reads back as a finite value. */
void cs_print_real(double value, char digits[CS_REAL_DIGITS]);

/* Appends the shortest decimal that reads back as value; inf and nan become null. */
void cs_text_add_real(struct cs_text *text, double value);

/* Adds bytes as base64 (RFC 4648). */
void cs_text_add_base64(struct cs_text *text, const void *bytes, size_t length);

/* Adds s in quotes with JSON's escapes; characters that cs_text_add_plain replaces are escaped,
 * and bytes that are no UTF-8 become U+FFFD. */
void cs_text_add_json(struct cs_text *text, const char *s);

/* Text from outside, such as names of files and of other people's methods: each kind of output
 * has the one function that makes it data there. Characters that are no text become "?":
 * control characters, those that turn the direction of writing or hide (Unicode's Bidi_Control,
 * U+2028, U+2029, U+FEFF), and bytes that are no UTF-8. */

/* For a terminal, a diagram, a CSV field. */
void cs_text_add_plain(struct cs_text *text, const char *s);
/* The same for whole lines: line breaks and tabs stay. */
void cs_text_add_lines(struct cs_text *text, const char *s);
/* For HTML: & < > and quotes are escaped. */
void cs_text_add_html(struct cs_text *text, const char *s);
/* For Markdown outside of code: characters with a meaning are escaped. */
void cs_text_add_markdown(struct cs_text *text, const char *s);

/* Returns the zero-terminated content, "" if empty. Valid until the next addition. */
const char *cs_text_get(const struct cs_text *text);
void cs_text_finish(struct cs_text *text);

/* Parses a whole string as a finite double, with a decimal point in every locale. Returns
 * false, and leaves *value, if it is none. */
bool cs_parse_real(const char *s, double *value);
/* Reads LOW..HIGH, 0 < LOW <= HIGH; false for anything else. */
bool cs_parse_range(const char *s, double *low, double *high);

/* Returns the candidate (list closed by NULL) nearest to word, or NULL if none is near: at most
 * a third of its letters edited, where a swap of neighbours is one edit, or word is its
 * beginning. */
const char *cs_nearest_word(const char *word, const char *const *candidates);

/* True for "program:COMMAND" and "tableau:FILE" in the place of an integrator's name; and for
 * all that names code there: these, a path, a name with the ending .so. */
bool cs_names_program(const char *text);
bool cs_names_code(const char *text);

#endif
