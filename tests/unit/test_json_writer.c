/* JSON by templates: values, escapes, separators, and that it reads back. */
#include "base/json_writer.h"
#include "scene/file/json.h"
#include "unit.h"

#include <math.h>

static void expect(struct cs_text *text, const char *expected) {
    ck_assert(!text->failed);
    ck_assert_str_eq(cs_text_get(text), expected);
    cs_text_finish(text);
}

TEST(each_conversion_is_a_value_of_json) {
    const char *volatile none = NULL;
    struct cs_text text = {0};
    cs_json_write(&text, "{'a': %s, 'b': %s, 'c': %g, 'd': %g, 'e': [%d, %d]}", "x\"\\\n", none,
                  1 / 60.0, (double)NAN, true, false);
    expect(&text, "{\"a\": \"x\\\"\\\\\\u000a\", \"b\": null, \"c\": 0.016666666666666666, "
                  "\"d\": null, \"e\": [true, false]}");
    cs_json_write(&text, "[%u, %llu, %zu, %ld]", 4294967295u, 18446744073709551615ull,
                  (size_t)7, -3L);
    expect(&text, "[4294967295, 18446744073709551615, 7, -3]");
}

/* also where a text ends in a bracket, or holds what templates are made of */
TEST(texts_are_not_templates) {
    struct cs_text text = {0};
    cs_json_write(&text, "[%s", "it's 5 %s {");
    cs_json_write(&text, ", %s", "[");
    cs_json_write(&text, ", %s]", "");
    expect(&text, "[\"it's 5 %s {\", \"[\", \"\"]");
}

TEST(a_leading_comma_stands_between_members_only) {
    struct cs_text text = {0}, part = {0};
    cs_json_write(&text, "{'list': [");
    for (unsigned i = 0; i < 3; i++)
        cs_json_write(&text, ", %u", i);
    cs_json_write(&text, "]");
    for (unsigned i = 0; i < 2; i++)
        cs_json_write(&part, ",\n  {'i': %u}", i);
    cs_json_write(&text, ", 'rows': [");
    cs_text_add(&text, "%s]}", cs_text_get(&part));
    expect(&part, "\n  {\"i\": 0},\n  {\"i\": 1}");
    expect(&text, "{\"list\": [0, 1, 2], \"rows\": [\n  {\"i\": 0},\n  {\"i\": 1}]}");
}

TEST(lines_are_indented) {
    struct cs_text text = {0};
    cs_json_write(&text, "{");
    cs_json_line(&text, 2, "'a': %u", 1u);
    cs_json_line(&text, 4, "'b': {}}");
    expect(&text, "{\n  \"a\": 1,\n    \"b\": {}}");
}

TEST(what_is_written_reads_back) {
    static const char hard[] = "\x01 \t\"quoted\" \\ / \xc3\xa9 'single' %d";
    struct cs_text text = {0};
    struct cs_json *root = NULL;
    struct cs_json_fault fault;
    cs_json_write(&text, "{%s: %s, 'number': %g}", hard, hard, 0.1 + 0.2);
    ck_assert_int_eq(cs_json_parse(cs_text_get(&text), text.length, &root, &fault), CS_OK);
    ck_assert_str_eq(cs_json_text(cs_json_find(root, hard)), hard);
    ck_assert(cs_json_number(cs_json_find(root, "number")) == 0.1 + 0.2);
    cs_json_destroy(root);
    cs_text_finish(&text);
}
