/* A struct by its table: defaults, setting, ranges and printing. */
#include "base/options.h"
#include "unit.h"

#include <math.h>

static const char *const modes[] = {"fast", "exact", NULL};

struct inner {
    bool present;
    double weight;
};
static const struct cs_option inner_rows[] = {
    CS_OPTION(struct inner, weight, "kg", 3, 0, 10, "how heavy"),
};
static const struct cs_table inner_table = {
    .rows = inner_rows, .n = 1, .size = sizeof(struct inner), .optional = true};
static const struct cs_table apart_table = {
    .rows = inner_rows, .n = 1, .size = sizeof(struct inner), .apart = true};

struct all {
    double real, absent;
    int64_t whole;
    bool fact;
    int32_t mode;
    double vector[2];
    int64_t counts[2];
    char text[CS_TEXT_MAX];
    struct inner inner;
    struct cs_list list;
};
static const double pair[2] = {1.5, -2};
static const struct cs_option rows[] = {
    CS_OPTION(struct all, real, "s", 0.25, 0, 1, "a real"),
    CS_OPTION(struct all, absent, "m", (double)NAN, 0, 1, "absent unless given"),
    CS_OPTION(struct all, whole, "", 3, 1, 9, "a whole number"),
    CS_OPTION(struct all, fact, "", 1, 0, 1, "a fact"),
    CS_OPTION_CHOICE(struct all, mode, modes, 1, "a choice"),
    {.name = "vector",
     .unit = "m",
     .help = "",
     .type = CS_VECTOR,
     .count = 2,
     .offset = offsetof(struct all, vector),
     .defs = pair,
     .min = -5,
     .max = 5},
    {.name = "counts",
     .unit = "",
     .help = "",
     .type = CS_COUNTS,
     .count = 2,
     .offset = offsetof(struct all, counts),
     .def = 4,
     .min = 0,
     .max = 5},
    {.name = "text",
     .unit = "",
     .help = "",
     .type = CS_TEXT,
     .count = 1,
     .offset = offsetof(struct all, text)},
    {.name = "inner",
     .unit = "",
     .help = "",
     .type = CS_TABLE,
     .count = 1,
     .offset = offsetof(struct all, inner),
     .table = &inner_table},
    {.name = "list",
     .unit = "",
     .help = "",
     .type = CS_LIST,
     .count = 1,
     .offset = offsetof(struct all, list),
     .table = &inner_table},
};
static const struct cs_table table = {
    .rows = rows, .n = sizeof rows / sizeof *rows, .size = sizeof(struct all)};

static struct all defaults(void) {
    struct all all;
    memset(&all, 0x5a, sizeof all);
    cs_options_default(&table, &all);
    return all;
}

/* A table that stands apart is behind a pointer, which is followed and stays. */
TEST(struct_elsewhere_is_filled) {
    static const struct cs_option row = {
        .name = "apart", .type = CS_TABLE, .count = 1, .offset = 8, .table = &apart_table};
    static const struct cs_table holder_table = {.rows = &row, .n = 1, .size = 16};
    struct inner inner = {.weight = 7};
    struct holder {
        double before;
        struct inner *inner;
    } holder = {5, &inner};
    ck_assert_uint_eq(offsetof(struct holder, inner), row.offset);
    cs_options_default(&holder_table, &holder);
    ck_assert(holder.before == 5 && holder.inner == &inner && inner.weight == 3);
    ck_assert_ptr_eq(cs_option_value(&row, &holder), &inner);
    ck_assert(cs_option_is_set(&row, &holder));
}

/* An optional one is nowhere until it is read. */
TEST(absent_struct_elsewhere_is_null) {
    static const struct cs_table optional = {.rows = inner_rows,
                                             .n = 1,
                                             .size = sizeof(struct inner),
                                             .optional = true,
                                             .apart = true};
    static const struct cs_option row = {
        .name = "apart", .type = CS_TABLE, .count = 1, .table = &optional};
    static const struct cs_table holder_table = {.rows = &row, .n = 1, .size = sizeof(void *)};
    struct inner inner, *holder = &inner;
    memset(&inner, 0x5a, sizeof inner);
    cs_options_default(&holder_table, &holder);
    ck_assert_ptr_null(holder);
    ck_assert(!cs_option_is_set(&row, &holder) && cs_option_is_default(&row, &holder));
    ck_assert_int_eq(*(const char *)&inner, 0x5a);
}

/* over whatever was in the struct before */
TEST(every_field_gets_its_default) {
    const struct all all = defaults();
    ck_assert_double_eq(all.real, 0.25);
    ck_assert_double_nan(all.absent);
    ck_assert_int_eq(all.whole, 3);
    ck_assert(all.fact);
    ck_assert_int_eq(all.mode, 1);
    ck_assert_double_eq(all.vector[0], 1.5);
    ck_assert_double_eq(all.vector[1], -2);
    ck_assert_int_eq(all.counts[1], 4);
    ck_assert_str_eq(all.text, "");
    ck_assert(!all.inner.present);
    ck_assert_double_eq(all.inner.weight, 3);
    ck_assert(all.list.n == 0 && !all.list.items);
}

TEST(absent_values_are_known) {
    struct all all = defaults();
    static const char *const absent[] = {"absent", "text", "inner", "list"};
    for (uint32_t r = 0; r < table.n; r++) {
        bool is_absent = false;
        for (size_t k = 0; k < sizeof absent / sizeof *absent; k++)
            is_absent |= !strcmp(rows[r].name, absent[k]);
        ck_assert_msg(cs_option_is_optional(rows + r) == is_absent, "%s", rows[r].name);
        ck_assert_msg(cs_option_is_set(rows + r, &all) != is_absent, "%s", rows[r].name);
    }
    all.absent = 0;
    all.inner.present = true;
    all.list.n = 1;
    memcpy(all.text, "a", 2);
    for (uint32_t r = 0; r < table.n; r++)
        ck_assert(cs_option_is_set(rows + r, &all));
}

/* what `set` makes of a text: OK, or a message with all of the part */
static void check_set(struct all *all, const char *name, const char *text, const char *part) {
    struct cs_error error = {0};
    const struct cs_option *row = cs_option_find(&table, name);
    ck_assert_ptr_nonnull(row);
    const enum cs_status status = cs_option_set(row, all, text, "here", CS_ERR_USAGE, &error);
    ck_assert_int_eq(status, error.status);
    if (part) {
        UNIT_ASSERT_FAILED(&error, CS_ERR_USAGE, part);
        ck_assert_int_eq(strncmp(error.message, "here: ", 6), 0);
    } else
        UNIT_ASSERT_OK(&error);
}

TEST(text_sets_each_type) {
    struct all all = defaults();
    check_set(&all, "real", "1e-3", NULL);
    check_set(&all, "absent", "0", NULL);
    check_set(&all, "whole", "9", NULL);
    check_set(&all, "mode", "fast", NULL);
    ck_assert_double_eq(all.real, 1e-3);
    ck_assert_double_eq(all.absent, 0);
    ck_assert_int_eq(all.whole, 9);
    ck_assert_int_eq(all.mode, 0);
    static const char *const yes[] = {"true", "yes", "1"}, *const no[] = {"false", "no", "0"};
    for (int k = 0; k < 3; k++) {
        check_set(&all, "fact", no[k], NULL);
        ck_assert(!all.fact);
        check_set(&all, "fact", yes[k], NULL);
        ck_assert(all.fact);
    }
}

/* with the range in the message, and the field as it was */
TEST(wrong_values_are_refused) {
    struct all all = defaults();
    check_set(&all, "real", "1.0001", "1.0001 is out of range (0..1 s)");
    check_set(&all, "real", "-1e-9", "out of range");
    check_set(&all, "real", "fast", "expected a number, found \"fast\"");
    check_set(&all, "real", "nan", "expected a number");
    check_set(&all, "whole", "2.5", "2.5 is not an integer (1..9)");
    check_set(&all, "whole", "10", "10 is out of range (1..9)");
    check_set(&all, "fact", "maybe", "expected true or false, found \"maybe\"");
    check_set(&all, "mode", "exakt",
              "unknown choice \"exakt\"; did you mean \"exact\"? (fast, exact)");
    check_set(&all, "mode", "zzzzzzzz", "unknown choice \"zzzzzzzz\" (fast, exact)");
    ck_assert_double_eq(all.real, 0.25);
    ck_assert_int_eq(all.whole, 3);
    ck_assert(all.fact);
    ck_assert_int_eq(all.mode, 1);
}

TEST(components_are_named) {
    struct cs_error error = {0};
    const struct cs_option *row = cs_option_find(&table, "vector");
    ck_assert_int_eq(cs_option_check_range(row, 5, 1, "a.b", CS_ERR_SCENE, &error), CS_OK);
    cs_option_check_range(row, 6, 1, "a.b", CS_ERR_SCENE, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_SCENE, "a.b[1]: 6 is out of range (-5..5 m)");
    error = (struct cs_error){0};
    row = cs_option_find(&table, "counts");
    cs_option_check_range(row, 0.5, 0, "a.c", CS_ERR_SCENE, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_SCENE, "a.c[0]: 0.5 is not an integer");
    error = (struct cs_error){0};
    cs_option_check_range(row, HUGE_VAL, 0, "a.c", CS_ERR_SCENE, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_SCENE, "out of range");
}

TEST(rows_are_found_by_name) {
    ck_assert_ptr_eq(cs_option_find(&table, "whole"), rows + 2);
    ck_assert_ptr_null(cs_option_find(&table, "Whole"));
    ck_assert_ptr_null(cs_option_find(&table, ""));
    ck_assert_str_eq(cs_option_nearest(&table, "vectro"), "vector");
    ck_assert_ptr_null(cs_option_nearest(&table, "zzzzzzzz"));
}

TEST(values_are_printed_as_json) {
    static const char *const expected[] = {"0.25",      "null",   "3",    "true", "\"exact\"",
                                           "[1.5, -2]", "[4, 4]", "\"\"", "",     ""};
    const struct all all = defaults();
    for (uint32_t r = 0; r < table.n; r++) {
        struct cs_text text = {0};
        cs_option_print(rows + r, &all, &text);
        ck_assert_str_eq(cs_text_get(&text), expected[r]);
        cs_text_finish(&text);
    }
}

TEST(ranges_are_printed) {
    static const char *const expected[] = {
        "0..1 s", "0..1 m", "1..9", "true or false", "fast, exact", "-5..5 m", "0..5",
        "",       "",       ""};
    for (uint32_t r = 0; r < table.n; r++) {
        struct cs_text text = {0};
        cs_option_print_range(rows + r, &text);
        ck_assert_str_eq(cs_text_get(&text), expected[r]);
        cs_text_finish(&text);
    }
}

/* without an object: the default */
TEST(defaults_and_words_are_printed) {
    static const char *const json[] = {"0.25",      "null",      "3",     "true",
                                       "\"exact\"", "[1.5, -2]", "[4, 4]"};
    static const char *const plain[] = {"0.25",  "null",    "3",   "true",
                                        "exact", "1.5, -2", "4, 4"};
    for (uint32_t r = 0; r < sizeof json / sizeof *json; r++) {
        struct cs_text text = {0}, words = {0};
        cs_option_print(rows + r, NULL, &text);
        cs_option_print_plain(rows + r, NULL, &words);
        ck_assert_str_eq(cs_text_get(&text), json[r]);
        ck_assert_str_eq(cs_text_get(&words), plain[r]);
        cs_text_finish(&text);
        cs_text_finish(&words);
    }
}

TEST(what_is_expected_is_named) {
    static const char *const expected[] = {"a number (0..1 s)",
                                           "a number (0..1 m)",
                                           "an integer (1..9)",
                                           "true or false",
                                           "one of fast, exact",
                                           "a list of 2 numbers (-5..5 m)",
                                           "a list of 2 integers (0..5)",
                                           "a string",
                                           "an object",
                                           "a list"};
    for (uint32_t r = 0; r < table.n; r++) {
        struct cs_text text = {0};
        cs_option_print_expected(rows + r, &text);
        ck_assert_str_eq(cs_text_get(&text), expected[r]);
        cs_text_finish(&text);
    }
}
