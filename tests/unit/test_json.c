/* The gate of JSON text: each rule, each with its place. */
#include "scene/file/json.h"
#include "unit.h"

struct refused {
    const char *text;
    size_t offset;
    const char *message;
};

static void assert_refused(const char *text, size_t length, size_t offset,
                           const char *message) {
    struct cs_json *root = (struct cs_json *)1;
    struct cs_json_fault fault = {0};
    ck_assert_msg(cs_json_parse(text, length, &root, &fault) == CS_ERR_SCENE, "accepted: %s",
                  text);
    ck_assert_ptr_null(root);
    ck_assert_msg(fault.offset == offset && strstr(fault.message, message),
                  "%s: found %zu \"%s\", expected %zu \"%s\"", text, fault.offset,
                  fault.message, offset, message);
}

static void assert_all_refused(const struct refused *rows, size_t n) {
    for (size_t i = 0; i < n; i++)
        assert_refused(rows[i].text, strlen(rows[i].text), rows[i].offset, rows[i].message);
}

static struct cs_json *parse(const char *text) {
    struct cs_json *root;
    struct cs_json_fault fault = {0};
    ck_assert_msg(!cs_json_parse(text, strlen(text), &root, &fault), "%s: %zu %s", text,
                  fault.offset, fault.message);
    return root;
}

TEST(numbers_are_strict) {
    static const struct refused rows[] = {
        {"01", 0, "needless 0"},
        {"-01", 0, "needless 0"},
        {"[1, 00]", 4, "needless 0"},
        {"5.", 2, "a digit after the point"},
        {"5.e1", 2, "found 'e', expected a digit after the point"},
        {".5", 0, "found '.', expected a value"},
        {"+1", 0, "found '+', expected a value"},
        {"-", 1, "found the end of the text, expected a digit"},
        {"-x", 1, "found 'x', expected a digit"},
        {"1e", 2, "a digit of the exponent"},
        {"1e+", 3, "a digit of the exponent"},
        {"0x10", 1, "found 'x', expected the end of the text"},
        {"1e999", 0, "the number 1e999 is too large"},
        {"-1e400", 0, "too large"},
        {"NaN", 0, "found 'N', expected a value"},
        {"Infinity", 0, "found 'I', expected a value"},
        {"-Infinity", 1, "found 'I', expected a digit"},
        {"nan", 0, "found 'n', expected a value"},
        {"1,5", 1, "expected the end of the text"},
        {"1111111111222222222233333333334444444444555555555566666666667777", 0,
         "a number of 64 characters, expected at most 63"}};
    assert_all_refused(rows, sizeof rows / sizeof *rows);

    static const struct {
        const char *text;
        double value;
    } good[] = {{"0", 0},      {"-0.0", -0.0},      {"1e308", 1e308},
                {"1E+2", 100}, {"2.5e-3", 2.5e-3},  {" \t\r\n7 ", 7},
                {"1e-999", 0}, {"3000000000", 3e9}, {"0.1", 0.1}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct cs_json *root = parse(good[i].text);
        ck_assert_int_eq(cs_json_kind_of(root), CS_JSON_NUMBER);
        ck_assert_double_eq(cs_json_number(root), good[i].value);
        cs_json_destroy(root);
    }
}

TEST(strings_are_strict) {
    static const struct refused rows[] = {
        {"\"abc", 0, "the string that starts here does not end"},
        {"\"abc\\", 4, "unknown escape"},
        {"\"abc\\\"", 0, "does not end"},
        {"\"a\nb\"", 2, "control character 0x0a"},
        {"\"a\tb\"", 2, "control character 0x09"},
        {"\"\\u0000\"", 1, "\\u0000 is not allowed"},
        {"{\"\\u0000\": 1}", 2, "\\u0000 is not allowed"},
        {"\"\\x41\"", 1, "unknown escape"},
        {"\"\\u12g4\"", 1, "four hexadecimal digits"},
        {"\"\\u12", 1, "four hexadecimal digits"},
        {"\"\\ud800\"", 1, "first half of a surrogate pair"},
        {"\"\\ud800\\u0041\"", 1, "first half of a surrogate pair"},
        {"\"\\udc00\"", 1, "second half of a surrogate pair"},
        {"'a'", 0, "found ''': JSON has no single quotes"},
        /* not UTF-8: a lone byte, overlong, surrogate, beyond the last, cut short */
        {"\"a\xff\"", 2, "byte 0xff, which is not UTF-8"},
        {"\"\x80\"", 1, "byte 0x80"},
        {"\"\xc0\x80\"", 1, "byte 0xc0"},
        {"\"\xe0\x80\x80\"", 1, "byte 0xe0"},
        {"\"\xed\xa0\x80\"", 1, "byte 0xed"},
        {"\"\xf0\x80\x80\x80\"", 1, "byte 0xf0"},
        {"\"\xf4\x90\x80\x80\"", 1, "byte 0xf4"},
        {"\"\xe2\x82\"", 1, "byte 0xe2"},
        {"\"\xe2\x82", 1, "byte 0xe2"},
        {"\xef\xbb\xbf{}", 0, "byte-order mark"},
        {"\xc3\xa4", 0, "found byte 0xc3, expected a value"}};
    assert_all_refused(rows, sizeof rows / sizeof *rows);

    static const char *const good[][2] = {
        {"\"\"", ""},
        {"\"\\\"\\\\\\/\\b\\f\\n\\r\\t\"", "\"\\/\b\f\n\r\t"},
        {"\"\\u00e4\\u20AC\\ud83d\\ude00\"", "\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80"},
        {"\"\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80\xf4\x8f\xbf\xbf\"",
         "\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80\xf4\x8f\xbf\xbf"}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct cs_json *root = parse(good[i][0]);
        ck_assert_str_eq(cs_json_text(root), good[i][1]);
        cs_json_destroy(root);
    }
}

TEST(structure_is_strict) {
    static const struct refused rows[] = {
        {"", 0, "found the end of the text, expected a value"},
        {"  \n ", 4, "found the end of the text, expected a value"},
        {"{} x", 3, "found 'x', expected the end of the text"},
        {"{}{}", 2, "found '{', expected the end of the text"},
        {"[1, 2", 5, "found the end of the text, expected ',' or ']'"},
        {"[1 2]", 3, "found '2', expected ',' or ']'"},
        {"[1,]", 3, "found ']' after ',': JSON has no trailing comma"},
        {"[,1]", 1, "found ',', expected a value"},
        {"{\"a\": 1,}", 8, "found '}' after ',': JSON has no trailing comma"},
        {"{a: 1}", 1, "found 'a', expected a key in quotes"},
        {"{\"a\" 1}", 5, "found '1', expected ':'"},
        {"{\"a\": }", 6, "found '}', expected a value"},
        {"{\"a\": 1 \"b\": 2}", 8, "expected ',' or '}'"},
        {"{\"a\": [1}]", 8, "found '}', expected ',' or ']'"},
        {"[1] // one", 4,
         "found '/': JSON has no comments; a key that begins with \"x-\" is free"},
        {"/* */ 1", 0, "found '/': JSON has no comments"},
        {"True", 0, "found 'T', expected a value"},
        {"truth", 0, "found 't', expected a value"},
        {"nullx", 4, "expected the end of the text"},
        {"[\x01]", 1, "found byte 0x01, expected a value"}};
    assert_all_refused(rows, sizeof rows / sizeof *rows);
    assert_refused("[1]\0", 4, 3, "found byte 0x00, expected the end of the text");
    assert_refused("[\"\0\"]", 5, 2, "control character 0x00");
}

TEST(keys_are_given_once) {
    static const struct refused rows[] = {
        {"{\"a\": 1, \"a\": 2}", 9, "key \"a\" is given twice"},
        {"{\"a\": 1, \"b\": 3, \"\\u0061\": 2}", 17, "key \"a\" is given twice"},
        {"[{\"x\": {\"k\": 1, \"j\": [], \"k\": {}}}]", 25, "key \"k\" is given twice"},
        {"{\"\": 1, \"\": 2}", 8, "key \"\" is given twice"}};
    assert_all_refused(rows, sizeof rows / sizeof *rows);
    cs_json_destroy(parse("{\"a\": {\"a\": 1}, \"A\": 2, \"b\": [{\"a\": 1}, {\"a\": 1}]}"));
}

TEST(depth_is_limited) {
    for (size_t depth = 63; depth <= 66; depth++) {
        char text[200] = "";
        memset(text, '[', depth);
        memset(text + depth, ']', depth);
        if (depth <= CS_JSON_DEPTH_MAX)
            cs_json_destroy(parse(text));
        else
            assert_refused(text, 2 * depth, 64, "nested deeper than 64 levels");
    }
}

/* a large text is refused before it costs memory or time */
TEST(size_is_limited) {
    const size_t most = CS_JSON_BYTES_MAX;
    char *text = malloc(most + 2);
    memset(text, '[', most + 1);
    text[most + 1] = 0;
    assert_refused(text, most + 1, 0, "expected at most 16777216");
    text[most] = 0;
    assert_refused(text, most, 64, "nested deeper");

    memset(text, '0', most);
    text[0] = '[';
    for (size_t i = 2; i < most; i += 2)
        text[i] = ',';
    assert_refused(text, most, 2 * (size_t)CS_JSON_VALUES_MAX - 1, "more than 500000 values");

    memset(text, ' ', most);
    text[most - 1] = '7';
    struct cs_json *root = parse(text);
    ck_assert_double_eq(cs_json_number(root), 7);
    cs_json_destroy(root);
    free(text);
}

/* many keys: sorted, not compared each with each */
TEST(many_keys_are_checked_quickly) {
    struct cs_text text = {0};
    for (int i = 0; i < 100000; i++)
        cs_text_add(&text, "%s\"k%d\": 0", i ? ", " : "{", i);
    const size_t length = text.length + 2;
    cs_text_add(&text, ", \"k777\": 1}");
    assert_refused(cs_text_get(&text), text.length, length, "key \"k777\" is given twice");
    cs_text_finish(&text);
}

static void assert_place(const struct cs_json *value, const char *text, bool of_key,
                         size_t at) {
    size_t offset = 0;
    ck_assert(cs_json_position(value, text, of_key, &offset));
    ck_assert_uint_eq(offset, at);
}

TEST(values_know_their_places) {
    const char *text =
        " {\n \"a\\\"]\" : [ 1,\"x,]\" , { } ,[ ],{\"b\":null} ],\"c\"\n:\ttrue}";
    struct cs_json *root = parse(text);
    const struct cs_json *list = cs_json_find(root, "a\"]");
    assert_place(root, text, false, 1);
    assert_place(list, text, true, 4);
    assert_place(list, text, false, 13);
    static const size_t places[] = {15, 17, 25, 30, 34};
    for (uint32_t i = 0; i < 5; i++)
        assert_place(cs_json_at(list, i), text, false, places[i]);
    const struct cs_json *inner = cs_json_find(cs_json_at(list, 4), "b");
    assert_place(inner, text, true, 35);
    assert_place(inner, text, false, 39);
    assert_place(cs_json_find(root, "c"), text, true, 47);
    assert_place(cs_json_find(root, "c"), text, false, 53);

    uint32_t line, column;
    cs_json_locate(text, 53, &line, &column);
    ck_assert_uint_eq(line, 3);
    ck_assert_uint_eq(column, 3);
    cs_json_locate(text, 0, &line, &column);
    ck_assert_uint_eq(line, 1);
    ck_assert_uint_eq(column, 1);
    cs_json_destroy(root);
}

TEST(members_are_found_exactly) {
    struct cs_json *root = parse("{\"ab\": [1, 2], \"AB\": \"t\", \"n\": null, \"f\": false}");
    ck_assert_int_eq(cs_json_kind_of(root), CS_JSON_OBJECT);
    ck_assert_uint_eq(cs_json_count(root), 4);
    ck_assert_str_eq(cs_json_text(cs_json_find(root, "AB")), "t");
    ck_assert_uint_eq(cs_json_count(cs_json_find(root, "ab")), 2);
    ck_assert_ptr_null(cs_json_find(root, "Ab"));
    ck_assert_ptr_null(cs_json_find(NULL, "AB"));
    ck_assert_ptr_eq(cs_json_find_kind(root, "AB", CS_JSON_TEXT), cs_json_find(root, "AB"));
    ck_assert_ptr_null(cs_json_find_kind(root, "AB", CS_JSON_NUMBER));
    ck_assert_ptr_null(cs_json_find_kind(root, "Ab", CS_JSON_TEXT));
    ck_assert_ptr_null(cs_json_at(cs_json_find(root, "ab"), 2));
    ck_assert_ptr_null(cs_json_at(root, 0));
    ck_assert_ptr_null(cs_json_find(cs_json_find(root, "n"), "x"));
    ck_assert_int_eq(cs_json_kind_of(cs_json_find(root, "n")), CS_JSON_NULL);
    ck_assert(!cs_json_is_true(cs_json_find(root, "f")));
    cs_json_destroy(root);
}
