/* Checks that a text is strict JSON (RFC 8259) within stated limits, and finds the first fault.
 *
 * A recursive descent with one function per rule of the grammar. Depth and number of values are
 * limited here, before a tree is built, so a hostile file can exhaust neither stack nor memory.
 */
#include "scene/file/json_check.h"

#include "base/status.h"

#include <ctype.h>
#include <string.h>

static bool is_between(unsigned char c, unsigned char low, unsigned char high) {
    return c >= low && c <= high;
}

/* Returns the bytes of the first character of a zero-terminated text, 0 if it is not valid:
 * overlong forms and surrogates are not. Well-formed sequences (the Unicode Standard, table
 * 3-7); second bytes are 80..bf unless given:
 *   00..7f  c2..df  e0 a0..bf  e1..ec, ee..ef  ed 80..9f  f0 90..bf  f1..f3  f4 80..8f */
static size_t utf8_length(const char *text) {
    const unsigned char *s = (const unsigned char *)text;
    if (s[0] < 0x80)
        return 1;
    if (is_between(s[0], 0xc2, 0xdf))
        return is_between(s[1], 0x80, 0xbf) ? 2 : 0;
    if (is_between(s[0], 0xe0, 0xef)) {
        const unsigned char low = s[0] == 0xe0 ? 0xa0 : 0x80, high = s[0] == 0xed ? 0x9f : 0xbf;
        return is_between(s[1], low, high) && is_between(s[2], 0x80, 0xbf) ? 3 : 0;
    }
    if (is_between(s[0], 0xf0, 0xf4)) {
        const unsigned char low = s[0] == 0xf0 ? 0x90 : 0x80, high = s[0] == 0xf4 ? 0x8f : 0xbf;
        return is_between(s[1], low, high) && is_between(s[2], 0x80, 0xbf) &&
                       is_between(s[3], 0x80, 0xbf)
                   ? 4
                   : 0;
    }
    return 0;
}

/* State of a check: everything before `at` is valid. */
struct check {
    const char *text; /* ends with a zero, which no rule accepts: it stops every loop */
    size_t length, at;
    uint32_t depth, values;
    struct cs_json_fault *fault;
};

/* Sets the fault; returns false. */
__attribute__((format(printf, 3, 4))) static bool fail_at(struct check *check, size_t offset,
                                                          const char *format, ...) {
    check->fault->offset = offset;
    CS_FORMAT(check->fault->message, format);
    return false;
}

/* Names a part of other formats, missing in JSON, by its first character; or NULL. */
static const char *foreign(char found) {
    return found == '/' || found == '#' ? "comments; a key that begins with \"x-\" is free"
           : found == '\''              ? "single quotes"
                                        : NULL;
}

/* Sets the fault "found ..., expected ..." at the current position. */
static bool fail_expected(struct check *check, const char *expected) {
    const unsigned char found = (unsigned char)check->text[check->at];
    const char *other = foreign(check->text[check->at]);
    if (other)
        return fail_at(check, check->at, "found '%c': JSON has no %s", found, other);
    if (check->at >= check->length)
        return fail_at(check, check->at, "found the end of the text, expected %s", expected);
    if (isprint(found))
        return fail_at(check, check->at, "found '%c', expected %s", found, expected);
    return fail_at(check, check->at, "found byte 0x%02x, expected %s", found, expected);
}

size_t cs_json_skip_blank(const char *text, size_t at) {
    return at + strspn(text + at, " \t\r\n");
}

size_t cs_json_skip_text(const char *text, size_t at) {
    for (at++; text[at] && text[at] != '"'; at++)
        if (text[at] == '\\' && text[at + 1])
            at++;
    return text[at] ? at + 1 : at;
}

static void skip_blank(struct check *check) {
    check->at = cs_json_skip_blank(check->text, check->at);
}

/* Reads \uXXXX at the current position and moves past it; -1 if it is not there. */
static long take_unit(struct check *check) {
    const char *s = check->text + check->at;
    if (s[0] != '\\' || s[1] != 'u')
        return -1;
    long unit = 0;
    for (int i = 2; i < 6; i++) {
        if (!isxdigit((unsigned char)s[i]))
            return -1;
        const int c = tolower((unsigned char)s[i]);
        unit = 16 * unit + (c <= '9' ? c - '0' : c - 'a' + 10);
    }
    check->at += 6;
    return unit;
}

/* Checks an escape in a string; surrogates must come in pairs. */
static bool check_escape(struct check *check) {
    const size_t start = check->at;
    /* one-letter escapes are final; only \u needs more work */
    if (check->text[start + 1] != 'u') {
        if (!check->text[start + 1] || !strchr("\"\\/bfnrt", check->text[start + 1]))
            return fail_at(check, start,
                           "unknown escape in a string, expected one of "
                           "\\\" \\\\ \\/ \\b \\f \\n \\r \\t \\uXXXX");
        check->at += 2;
        return true;
    }
    const long unit = take_unit(check);
    if (unit < 0)
        return fail_at(check, start, "expected four hexadecimal digits after \\u");
    /* a zero would end the C strings that hold the parsed text */
    if (unit == 0)
        return fail_at(check, start, "\\u0000 is not allowed in a string");
    /* characters above U+FFFF take two escapes, high surrogate first */
    const bool high = unit >= 0xd800 && unit <= 0xdbff;
    if (unit >= 0xdc00 && unit <= 0xdfff)
        return fail_at(check, start, "second half of a surrogate pair without the first");
    const long second = high ? take_unit(check) : 0;
    if (high && (second < 0xdc00 || second > 0xdfff))
        return fail_at(check, start, "first half of a surrogate pair without the second");
    return true;
}

/* Checks a string from its opening quote. */
static bool check_text(struct check *check) {
    const size_t start = check->at++;
    for (;;) {
        const unsigned char c = (unsigned char)check->text[check->at];
        /* compared by length: a zero byte inside the text is only a control character */
        if (check->at >= check->length)
            return fail_at(check, start, "the string that starts here does not end");
        if (c == '"')
            break;
        if (c < 0x20)
            return fail_at(check, check->at,
                           "found control character 0x%02x in a string, expected an escape", c);
        const size_t length = utf8_length(check->text + check->at);
        if (!length)
            return fail_at(check, check->at, "found byte 0x%02x, which is not UTF-8", c);
        if (c != '\\')
            check->at += length;
        else if (!check_escape(check))
            return false;
    }
    check->at++;
    return true;
}

/* Skips digits; returns false if there is none. */
static bool skip_digits(struct check *check) {
    const size_t n = strspn(check->text + check->at, "0123456789");
    check->at += n;
    return n > 0;
}

/* Checks a number: [-] digits [. digits] [e [+-] digits], and that it is a finite double. */
static bool check_number(struct check *check) {
    const size_t start = check->at;
    const char *text = check->text;
    check->at += text[check->at] == '-';
    if (text[check->at] == '0' && isdigit((unsigned char)text[check->at + 1]))
        return fail_at(check, start, "a number may not start with a needless 0");
    if (!skip_digits(check))
        return fail_expected(check, "a digit");
    if (text[check->at] == '.') {
        check->at++;
        if (!skip_digits(check))
            return fail_expected(check, "a digit after the point");
    }
    if (text[check->at] == 'e' || text[check->at] == 'E') {
        check->at++;
        check->at += text[check->at] == '+' || text[check->at] == '-';
        if (!skip_digits(check))
            return fail_expected(check, "a digit of the exponent");
    }

    /* a copy that ends in a zero, which cs_parse_real needs; it refuses what overflows */
    char digits[CS_JSON_NUMBER_MAX + 1];
    const size_t length = check->at - start;
    if (length >= sizeof digits)
        return fail_at(check, start, "found a number of %zu characters, expected at most %d",
                       length, CS_JSON_NUMBER_MAX);
    memcpy(digits, text + start, length);
    digits[length] = 0;
    double value;
    if (!cs_parse_real(digits, &value))
        return fail_at(check, start, "the number %s is too large", digits);
    return true;
}

/* Checks a literal: true, false or null. */
static bool check_word(struct check *check, const char *word) {
    if (strncmp(check->text + check->at, word, strlen(word)) != 0)
        return fail_expected(check, "a value");
    check->at += strlen(word);
    return true;
}

static bool check_value(struct check *check);

/* Checks a key and its colon. */
static bool check_key(struct check *check) {
    skip_blank(check);
    if (check->text[check->at] != '"')
        return fail_expected(check, "a key in quotes");
    if (!check_text(check))
        return false;
    skip_blank(check);
    if (check->text[check->at] != ':')
        return fail_expected(check, "':'");
    check->at++;
    return true;
}

/* Checks an object or a list from its opening bracket; close: the closing one. */
static bool check_members(struct check *check, char close) {
    if (++check->depth > CS_JSON_DEPTH_MAX)
        return fail_at(check, check->at, "nested deeper than %d levels", CS_JSON_DEPTH_MAX);
    check->at++;
    skip_blank(check);
    bool more = check->text[check->at] != close;
    while (more) {
        if ((close == '}' && !check_key(check)) || !check_value(check))
            return false;
        skip_blank(check);
        more = check->text[check->at] == ',';
        if (!more && check->text[check->at] != close)
            return fail_expected(check, close == '}' ? "',' or '}'" : "',' or ']'");
        check->at += more;
        skip_blank(check);
        if (more && check->text[check->at] == close)
            return fail_at(check, check->at, "found '%c' after ',': JSON has no trailing comma",
                           close);
    }
    check->at++;
    check->depth--;
    return true;
}

/* Checks any value. */
static bool check_value(struct check *check) {
    skip_blank(check);
    /* counted before the tree is built, so that its memory is bounded */
    if (++check->values > CS_JSON_VALUES_MAX)
        return fail_at(check, check->at, "more than %d values", CS_JSON_VALUES_MAX);
    switch (check->text[check->at]) {
    case '{':
        return check_members(check, '}');
    case '[':
        return check_members(check, ']');
    case '"':
        return check_text(check);
    case 't':
        return check_word(check, "true");
    case 'f':
        return check_word(check, "false");
    case 'n':
        return check_word(check, "null");
    default:
        if (check->text[check->at] == '-' || isdigit((unsigned char)check->text[check->at]))
            return check_number(check);
        return fail_expected(check, "a value");
    }
}

bool cs_json_check(const char *text, size_t length, struct cs_json_fault *fault) {
    struct check check = {.text = text, .length = length, .fault = fault};
    if (length > CS_JSON_BYTES_MAX)
        return fail_at(&check, 0, "found %zu bytes, expected at most %d", length,
                       CS_JSON_BYTES_MAX);
    /* with a byte-order mark, or by the zero byte of a first letter */
    if (!strncmp(text, "\xff\xfe", 2) || !strncmp(text, "\xfe\xff", 2) ||
        (length > 1 && !text[0] != !text[1]))
        return fail_at(&check, 0, "found UTF-16, expected UTF-8");
    if (!strncmp(text, "\xef\xbb\xbf", 3))
        return fail_at(&check, 0, "found a byte-order mark, expected UTF-8 without one");
    if (!check_value(&check))
        return false;
    skip_blank(&check);
    return check.at == length || fail_expected(&check, "the end of the text");
}

void cs_json_locate(const char *text, size_t offset, uint32_t *line, uint32_t *column) {
    *line = *column = 1;
    for (size_t i = 0; i < offset && text[i]; i++) {
        *column = text[i] == '\n' ? 1 : *column + 1;
        *line += text[i] == '\n';
    }
}

bool cs_utf8_is_plain(const char *s) {
    while (*s) {
        const size_t length = utf8_length(s);
        if (!length || (unsigned char)*s < 0x20)
            return false;
        s += length;
    }
    return true;
}

void cs_utf8_add_short(struct cs_text *out, const char *s) {
    enum { LONGEST = 48 };
    char kept[LONGEST + 1];
    size_t n = 0, length;
    while (s[n] && (length = utf8_length(s + n)) && n + length <= LONGEST) {
        memcpy(kept + n, s + n, length);
        n += length;
    }
    kept[n] = 0;
    cs_text_add_json(out, kept);
    if (s[n])
        cs_text_add(out, "...");
}
