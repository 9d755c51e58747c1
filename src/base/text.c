/* Growable text, numbers that read back exactly, and the nearest of several words by edit
 * distance. */
#include "base/text.h"

#include "base/arena.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Makes room for `more` bytes and the zero byte, at least doubling. Returns false if out of
 * memory. */
static bool reserve(struct cs_text *text, size_t more) {
    text->failed =
        text->failed || !CS_ARENA_REALLOC(text->bytes, text->capacity, text->length + more + 1);
    return !text->failed;
}

void cs_text_add(struct cs_text *text, const char *format, ...) {
    va_list args;
    va_start(args, format);
    const int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    if (length < 0 || !reserve(text, (size_t)length))
        return;
    va_start(args, format);
    vsnprintf(text->bytes + text->length, (size_t)length + 1, format, args);
    va_end(args);
    text->length += (size_t)length;
}

void cs_text_add_bytes(struct cs_text *text, const void *bytes, size_t length) {
    if (!reserve(text, length))
        return;
    memcpy(text->bytes + text->length, length ? bytes : "", length);
    text->length += length;
    text->bytes[text->length] = 0;
}

void cs_print_real(double value, char digits[CS_REAL_DIGITS]) {
    // fewer digits give the value back only if 15 do: decimals of so many are further apart
    snprintf(digits, CS_REAL_DIGITS, "%.15g", value);
    int precision = strtod(digits, NULL) == value ? 0 : 15, before_point = 1;
    do
        snprintf(digits, CS_REAL_DIGITS, "%.*g", ++precision, value);
    while (precision < 17 && strtod(digits, NULL) != value);
    /* 640 and not 6.4e+02 */
    for (double rest = value < 0 ? -value : value; rest >= 10 && before_point < 7; rest /= 10)
        before_point++;
    if (precision < before_point)
        snprintf(digits, CS_REAL_DIGITS, "%.*g", before_point, value);
}

void cs_text_add_real(struct cs_text *text, double value) {
    char digits[CS_REAL_DIGITS] = "null";
    if (isfinite(value))
        cs_print_real(value, digits);
    cs_text_add(text, "%s", digits);
}

void cs_text_add_base64(struct cs_text *text, const void *bytes, size_t length) {
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *at = bytes;
    for (size_t k = 0; k < length; k += 3) {
        const unsigned b = k + 1 < length ? at[k + 1] : 0, c = k + 2 < length ? at[k + 2] : 0;
        const unsigned three = (unsigned)at[k] << 16 | b << 8 | c;
        cs_text_add(text, "%c%c%c%c", digits[three >> 18], digits[three >> 12 & 63],
                    k + 1 < length ? digits[three >> 6 & 63] : '=',
                    k + 2 < length ? digits[three & 63] : '=');
    }
}

/* Length of the character at s in UTF-8, and its number; 0: it is none (RFC 3629). */
static size_t decode(const unsigned char *s, uint32_t *code) {
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const size_t length = *s < 0x80       ? 1
                          : *s >> 5 == 6  ? 2
                          : *s >> 4 == 14 ? 3
                          : *s >> 3 == 30 ? 4
                                          : 0;
    *code = length == 1 ? *s : *s & (0x7fu >> length);
    for (size_t k = 1; k < length; k++) {
        if (s[k] >> 6 != 2)
            return 0;
        *code = *code << 6 | (s[k] & 0x3f);
    }
    return *code >= least[length] && *code >> 11 != 0x1b && *code < 0x110000 ? length : 0;
}

/* True for a character that is a part of a text: no control character, none of Bidi_Control
 * (Unicode 15, PropList) or that hides. */
static bool is_text(uint32_t code) {
    static const uint32_t others[][2] = {{0, 0x1f},        {0x7f, 0x9f},     {0x61c, 0x61c},
                                         {0x200e, 0x200f}, {0x2028, 0x202e}, {0x2066, 0x2069},
                                         {0xfeff, 0xfeff}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (code >= others[k][0] && code <= others[k][1])
            return false;
    return true;
}

/* Adds a text with a character of `special` as its entry in `escapes`, or after a backslash;
 * those that are no text as "?", but for those in `kept`. */
static void add_escaped(struct cs_text *text, const char *s, const char *kept,
                        const char *special, const char *const *escapes) {
    while (*s) {
        uint32_t code;
        size_t run = 0, length;
        while (s[run] && !strchr(special, s[run]) &&
               (strchr(kept, s[run]) ||
                ((length = decode((const unsigned char *)s + run, &code)) && is_text(code))))
            run += strchr(kept, s[run]) ? 1 : length;
        cs_text_add(text, "%.*s", (int)run, s);
        s += run;
        if (!*s)
            return;
        const char *found = strchr(special, *s);
        if (found && escapes)
            cs_text_add(text, "%s", escapes[found - special]);
        else
            cs_text_add(text, found ? "\\%c" : "?", *s);
        length = decode((const unsigned char *)s, &code);
        s += length ? length : 1;
    }
}

void cs_text_add_plain(struct cs_text *text, const char *s) {
    add_escaped(text, s, "", "", NULL);
}

void cs_text_add_lines(struct cs_text *text, const char *s) {
    add_escaped(text, s, "\n\t", "", NULL);
}

void cs_text_add_html(struct cs_text *text, const char *s) {
    static const char *const escapes[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    add_escaped(text, s, "\n\t", "&<>\"'", escapes);
}

void cs_text_add_markdown(struct cs_text *text, const char *s) {
    add_escaped(text, s, "", "\\`*_[]<>|~&", NULL);
}

void cs_text_add_json(struct cs_text *text, const char *s) {
    cs_text_add(text, "\"");
    while (*s) {
        uint32_t code;
        const size_t length = decode((const unsigned char *)s, &code),
                     bytes = length ? length : 1;
        if (*s == '"' || *s == '\\')
            cs_text_add(text, "\\%c", *s);
        else if (!length || !is_text(code))
            cs_text_add(text, "\\u%04x", length ? code : 0xfffd);
        else
            cs_text_add(text, "%.*s", (int)bytes, s);
        s += bytes;
    }
    cs_text_add(text, "\"");
}

const char *cs_text_get(const struct cs_text *text) {
    return text->bytes ? text->bytes : "";
}

void cs_text_finish(struct cs_text *text) {
    free(text->bytes);
    *text = (struct cs_text){0};
}

bool cs_parse_real(const char *s, double *value) {
    /* strtod also takes blanks, hex and names */
    if (!*s || s[strspn(s, "+-.0123456789eE")])
        return false;
    char *end;
    const double read = strtod(s, &end);
    if (*end || !isfinite(read))
        return false;
    *value = read;
    return true;
}

bool cs_parse_range(const char *s, double *low, double *high) {
    char first[64];
    const char *dots = strstr(s, "..");
    if (!dots || dots - s >= (ptrdiff_t)sizeof first)
        return false;
    snprintf(first, sizeof first, "%.*s", (int)(dots - s), s);
    return cs_parse_real(first, low) && cs_parse_real(dots + 2, high) && 0 < *low &&
           *low <= *high;
}

static size_t min_of(size_t a, size_t b) {
    return a < b ? a : b;
}

/* Upper and lower case count as the same letter. */
static bool is_same(char a, char b) {
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

/* Edit distance of a and b with the edits insert, delete, replace, and swap of two neighbours
 * (Damerau 1964): the usual table by rows, of which a swap needs three. Restricted: no letter
 * is edited twice. */
static size_t edit_distance(const char *a, const char *b) {
    enum { LONGEST = 64 };
    size_t rows[3][LONGEST + 1];
    const size_t n = strlen(b);
    if (n > LONGEST || strlen(a) > LONGEST)
        return SIZE_MAX;
    for (size_t j = 0; j <= n; j++)
        rows[0][j] = j;
    size_t *row = rows[0], *above = rows[1], *second = rows[2];
    for (size_t i = 0; a[i]; i++) {
        size_t *const oldest = second;
        second = above, above = row, row = oldest;
        row[0] = i + 1;
        for (size_t j = 0; j < n; j++) {
            row[j + 1] =
                min_of(above[j] + !is_same(a[i], b[j]), min_of(above[j + 1], row[j]) + 1);
            if (i && j && is_same(a[i], b[j - 1]) && is_same(a[i - 1], b[j]))
                row[j + 1] = min_of(row[j + 1], second[j - 1] + 1);
        }
    }
    return row[n];
}

const char *cs_nearest_word(const char *word, const char *const *candidates) {
    const char *nearest = NULL;
    size_t least = SIZE_MAX;
    for (; *candidates; candidates++) {
        // beyond a third of the letters two words are hardly related; chosen by trial
        const size_t letters = strlen(strlen(word) > strlen(*candidates) ? word : *candidates);
        const size_t most = letters < 3 ? 1 : letters / 3;
        /* the beginning of a candidate counts as one edit */
        const bool begun = strlen(word) > 2 && !strncmp(word, *candidates, strlen(word));
        const size_t d = begun ? 1 : edit_distance(word, *candidates);
        if (d <= most && d < least) {
            least = d;
            nearest = *candidates;
        }
    }
    return nearest;
}

bool cs_names_program(const char *text) {
    return !strncmp(text, "program:", 8) || !strncmp(text, "tableau:", 8);
}

bool cs_names_code(const char *text) {
    const char *end = strrchr(text, '.');
    return cs_names_program(text) || strchr(text, '/') || (end && !strcmp(end, ".so"));
}
