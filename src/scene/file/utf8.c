/* Checks UTF-8 and cuts long texts between characters.
 *
 * Well-formed sequences (the Unicode Standard, table 3-7); second bytes are 80..bf unless
 * given:
 *   00..7f    c2..df    e0 a0..bf    e1..ec, ee..ef    ed 80..9f    f0 90..bf    f1..f3    f4
 * 80..8f */
#include "scene/file/utf8.h"

#include <string.h>

static bool is_between(unsigned char c, unsigned char low, unsigned char high) {
    return c >= low && c <= high;
}

size_t cs_utf8_length(const char *text) {
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

bool cs_utf8_is_plain(const char *s) {
    while (*s) {
        const size_t length = cs_utf8_length(s);
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
    while (s[n] && (length = cs_utf8_length(s + n)) && n + length <= LONGEST) {
        memcpy(kept + n, s + n, length);
        n += length;
    }
    kept[n] = 0;
    cs_text_add_json(out, kept);
    if (s[n])
        cs_text_add(out, "...");
}
