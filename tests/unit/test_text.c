/* Growable text, and numbers that read back the same. */
#include "base/text.h"
#include "unit.h"

#include <float.h>
#include <math.h>
#include <stdint.h>

static void check_real(double value, const char *expected) {
    struct cs_text text = {0};
    cs_text_add_real(&text, value);
    ck_assert_str_eq(cs_text_get(&text), expected);
    cs_text_finish(&text);
}

/* the test vectors of RFC 4648, section 10 */
TEST(base64_of_rfc_4648) {
    static const char *const coded[] = {"",         "Zg==",     "Zm8=",    "Zm9v",
                                        "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
    for (size_t n = 0; n < sizeof coded / sizeof *coded; n++) {
        struct cs_text out = {0};
        cs_text_add_base64(&out, "foobar", n);
        ck_assert_str_eq(cs_text_get(&out), coded[n]);
        cs_text_finish(&out);
    }
}

TEST(reals_are_short) {
    check_real(0, "0");
    check_real(-0.0, "-0");
    check_real(1, "1");
    check_real(-2.5, "-2.5");
    check_real(0.1, "0.1");
    check_real(640, "640");
    check_real(123456, "123456");
    check_real(1e6, "1000000");
    check_real(1e9, "1e+09");
    check_real(1e-5, "1e-05");
    check_real(1 / 3.0, "0.3333333333333333");
    check_real(1 / 60.0, "0.016666666666666666");
    check_real(HUGE_VAL, "null");
    check_real((double)NAN, "null");
}

TEST(ranges_have_two_positive_ends) {
    static const char *const none[] = {"",        "1",      "..",   "1..",
                                       "..2",     "2..1",   "0..1", "-1..1",
                                       "1..2..3", "1...2x", "a..b", "1..1e999"};
    double low, high;
    ck_assert(cs_parse_range("0.5..2e3", &low, &high));
    ck_assert_double_eq(low, 0.5);
    ck_assert_double_eq(high, 2000);
    ck_assert(cs_parse_range("3..3", &low, &high));
    for (size_t k = 0; k < sizeof none / sizeof *none; k++)
        ck_assert_msg(!cs_parse_range(none[k], &low, &high), "\"%s\" is a range", none[k]);
}

/* 100 000 bit patterns from all over the range */
TEST(reals_read_back_the_same) {
    uint64_t bits = 1;
    static const double edges[] = {DBL_MIN, DBL_MAX, -DBL_MAX, DBL_EPSILON, 4.9e-324, 1e23};
    for (size_t k = 0; k < 100000; k++) {
        double value, back;
        bits = bits * 6364136223846793005u + 1442695040888963407u;
        memcpy(&value, &bits, sizeof value);
        if (k < sizeof edges / sizeof *edges)
            value = edges[k];
        if (!isfinite(value))
            continue;
        struct cs_text text = {0};
        cs_text_add_real(&text, value);
        if (!cs_parse_real(cs_text_get(&text), &back) || memcmp(&back, &value, sizeof value))
            ck_abort_msg("%.17g became %s", value, cs_text_get(&text));
        cs_text_finish(&text);
    }
}

TEST(only_whole_finite_numbers_are_read) {
    static const char *const wrong[] = {"",    " ",   " 1",  "1 ",  "1x",    "0x10",
                                        "nan", "inf", "1,5", "1e",  "1e999", "--1",
                                        "+",   ".",   "e5",  "1_0", "1\n",   "-1e400"};
    double value = 7;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        ck_assert_msg(!cs_parse_real(wrong[k], &value), "\"%s\" was read", wrong[k]);
        ck_assert_double_eq(value, 7);
    }
    ck_assert(cs_parse_real("-1.5e+3", &value) && value == -1500);
    ck_assert(cs_parse_real(".5", &value) && value == 0.5);
    ck_assert(cs_parse_real("+2.", &value) && value == 2);
}

TEST(text_grows) {
    struct cs_text text = {0};
    ck_assert_str_eq(cs_text_get(&text), "");
    for (int i = 0; i < 5000; i++)
        cs_text_add(&text, "%d,", i % 10);
    ck_assert_uint_eq(text.length, 10000);
    ck_assert_uint_eq(strlen(cs_text_get(&text)), 10000);
    for (size_t i = 0; i < 5000; i++)
        UNIT_ASSERT_OFTEN(text.bytes[2 * i] == (char)('0' + i % 10) &&
                          text.bytes[2 * i + 1] == ',');
    ck_assert(!text.failed);
    cs_text_finish(&text);
    ck_assert_str_eq(cs_text_get(&text), "");
}

/* a failed text stays as it is */
TEST(failed_text_takes_nothing_more) {
    struct cs_text text = {.failed = true};
    cs_text_add(&text, "more");
    cs_text_add_real(&text, 1);
    cs_text_add_json(&text, "more");
    ck_assert_str_eq(cs_text_get(&text), "");
    cs_text_finish(&text);
}

TEST(json_strings_are_escaped) {
    struct cs_text text = {0};
    cs_text_add_json(&text, "a \"b\" \\ \n\t\x01 \xc3\xa4");
    ck_assert_str_eq(cs_text_get(&text), "\"a \\\"b\\\" \\\\ \\u000a\\u0009\\u0001 \xc3\xa4\"");
    cs_text_finish(&text);
}

TEST(nearest_word_is_found) {
    static const char *const words[] = {"stretch", "shear", "bend", "damping", NULL};
    static const struct {
        const char *word, *nearest;
    } rows[] = {
        {"strech", "stretch"}, {"Shear", "shear"}, {"bnd", "bend"}, {"dampnig", "damping"},
        {"dam", "damping"},    {"colour", NULL},   {"x", NULL},     {"stretch", "stretch"},
        {"bedn", "bend"},      {"bulk", NULL},     {"shape", NULL}, {"tend", "bend"}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const char *found = cs_nearest_word(rows[k].word, words);
        ck_assert_msg(rows[k].nearest ? found && !strcmp(found, rows[k].nearest) : !found,
                      "%s: found %s", rows[k].word, found ? found : "none");
    }
    // longer than the table of the distance: near to nothing
    char endless[200];
    memset(endless, 'a', sizeof endless - 1);
    endless[sizeof endless - 1] = 0;
    ck_assert_ptr_null(cs_nearest_word(endless, words));
}

/* What is no text: control characters of ASCII and of Unicode's second page, characters that
 * turn the direction or hide, half characters, overlong ones, a surrogate. */
static const char *const hostile[] = {
    "\x01",         "\x1b",         "\x7f",         "\xc2\x80",     "\xc2\x9b",
    "\xd8\x9c",     "\xe2\x80\x8e", "\xe2\x80\xae", "\xe2\x81\xa6", "\xe2\x80\xa8",
    "\xef\xbb\xbf", "\xff",         "\xc3",         "\xc0\xaf",     "\xed\xa0\x80"};
enum { HOSTILE = sizeof hostile / sizeof *hostile };

typedef void add_function(struct cs_text *text, const char *s);

static void check_added(add_function *add, const char *s, const char *expected) {
    struct cs_text text = {0};
    add(&text, s);
    ck_assert_str_eq(cs_text_get(&text), expected);
    cs_text_finish(&text);
}

TEST(characters_that_are_no_text_are_replaced) {
    for (int k = 0; k < HOSTILE; k++) {
        add_function *const all[] = {cs_text_add_plain, cs_text_add_lines, cs_text_add_html,
                                     cs_text_add_markdown};
        char around[16], found[16];
        snprintf(around, sizeof around, "a%sb", hostile[k]);
        for (int f = 0; f < 4; f++) {
            struct cs_text text = {0};
            all[f](&text, around);
            // one mark per character, or per byte that is none
            const size_t marks = text.length - 2;
            ck_assert(marks >= 1 && marks <= strlen(hostile[k]));
            snprintf(found, sizeof found, "a%.*sb", (int)marks, "???");
            ck_assert_str_eq(cs_text_get(&text), found);
            cs_text_finish(&text);
        }
    }
}

TEST(text_stays) {
    static const char plain[] = "\xc3\xa9 \xe4\xb8\x96 \xf0\x9f\xa7\xb5 ~ \xc2\xa0";
    check_added(cs_text_add_plain, plain, plain);
    check_added(cs_text_add_html, plain, plain);
    check_added(cs_text_add_plain, "a\nb\tc", "a?b?c");
    check_added(cs_text_add_lines, "a\nb\tc", "a\nb\tc");
}

TEST(no_text_is_code) {
    check_added(cs_text_add_html, "<b a=\"'\">&", "&lt;b a=&quot;&#39;&quot;&gt;&amp;");
    check_added(cs_text_add_markdown, "`*_[x](y)<|>\\\n# ",
                "\\`\\*\\_\\[x\\](y)\\<\\|\\>\\\\?# ");
    struct cs_text json = {0};
    cs_text_add_json(&json, "\"\\\n\xc2\x9b\xe2\x80\xae\xc3\xa9\xe9.");
    ck_assert_str_eq(cs_text_get(&json), "\"\\\"\\\\\\u000a\\u009b\\u202e\xc3\xa9\\ufffd.\"");
    cs_text_finish(&json);
}
