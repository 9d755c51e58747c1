/* Options fill the struct of their command, by the C types of its fields, or are refused. */
#include "cli/line/args.h"
#include "unit.h"

struct options {
    bool off, on;
    const char *text, *series;
    uint32_t whole, choice, set;
    double real;
    struct cs_shard shard;
    struct {
        const char *const *plugins;
        const struct cs_override *overrides;
        uint32_t n_plugins, n_overrides;
    } session;
    const char *const *methods;
    uint32_t n_methods;
};

static const struct options defaults = {.on = true, .text = "text", .whole = 7, .real = 0.5};
static const char *const names[] = {"none", "one", "two", NULL};

static const struct cs_arg rows[] = {
    {"off", 0, NULL, "", CS_ARG_INTO(struct options, off)},
    {"no-on", 0, NULL, "", CS_ARG_INTO(struct options, on)},
    {"text", 't', "TEXT", "", CS_ARG_INTO(struct options, text)},
    {"series", 0, "LIST", "", CS_ARG_INTO(struct options, series), .repeatable = true},
    {"whole", 'w', "N", "", CS_ARG_INTO(struct options, whole), .min = 3, .max = UINT32_MAX},
    {"choice", 0, "NAME", "", CS_ARG_INTO(struct options, choice), .names = names},
    {"kinds", 0, "NAME", "", CS_ARG_INTO(struct options, set), .names = names,
     .repeatable = true},
    {"real", 0, "X", "", CS_ARG_INTO(struct options, real)},
    {"shard", 0, "K/N", "", CS_ARG_INTO(struct options, shard)},
    CS_ARG_SET(struct options, session),
    CS_ARG_PLUGIN(struct options, session),
    {"methods", 'i', "LIST", "", CS_ARG_LIST(struct options, methods, n_methods),
     .methods = true},
};

static const struct cs_command command = {
    .name = "test", .operands = "FILE", CS_COMMAND_OPTIONS(rows, defaults), .operands_max = 1};

static struct cs_args args;

/* the options that a line of words comes to */
static const struct options *parse(char *line, struct cs_error *error) {
    char *words[64], *rest = line;
    int n = 0;
    while (n < 64 && rest)
        words[n++] = strsep(&rest, " ");
    args = (struct cs_args){0};
    cs_args_parse(&args, &command, n, words, error);
    return args.options;
}

TEST(fields_are_filled) {
    char line[] = "--off --no-on -t a=b --whole=4294967295 file --choice two --set a.b=1,2 "
                  "--series rk4:dt=1,a=2 --series=bdf2 "
                  "--kind one --set=c=d=e --kinds two --real 1e9 --shard 2/3";
    struct cs_error error = {0};
    const struct options *found = parse(line, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert(found->off && !found->on);
    ck_assert_str_eq(found->text, "a=b");
    ck_assert_str_eq(found->series, "rk4:dt=1,a=2,bdf2");
    ck_assert_uint_eq(found->whole, UINT32_MAX);
    ck_assert_uint_eq(found->choice, 2);
    ck_assert_uint_eq(found->set, 6);
    ck_assert_double_eq(found->real, 1e9);
    ck_assert(found->shard.index == 2 && found->shard.count == 3);
    ck_assert_uint_eq(found->session.n_overrides, 2);
    ck_assert_str_eq(found->session.overrides[0].path, "a.b");
    ck_assert_str_eq(found->session.overrides[0].value, "1,2");
    ck_assert_str_eq(found->session.overrides[1].value, "d=e");
    ck_assert_uint_eq(found->session.n_plugins, 0);
    ck_assert_str_eq(args.operands[0], "file");
    ck_assert(cs_args_is_given(&args, "whole") && !cs_args_is_given(&args, "plugin"));
    cs_args_finish(&args);
}

TEST(what_is_not_given_stays) {
    char line[] = "file";
    struct cs_error error = {0};
    const struct options *found = parse(line, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_mem_eq(found, &defaults, sizeof defaults);
    cs_args_finish(&args);
}

/* a list is moved as it grows */
TEST(lists_keep_their_order) {
    char line[] = "-p 0 -p 1 -i rk4:dt=1,a=2,newmark -p 2 -p 3 --method cvode -p 4 --plugin 5";
    struct cs_error error = {0};
    const struct options *found = parse(line, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(found->session.n_plugins, 6);
    for (int k = 0; k < 6; k++)
        ck_assert_int_eq(atoi(found->session.plugins[k]), k);
    ck_assert_uint_eq(found->n_methods, 3);
    ck_assert_str_eq(found->methods[0], "rk4:dt=1,a=2");
    ck_assert_str_eq(found->methods[1], "newmark");
    ck_assert_str_eq(found->methods[2], "cvode");
    cs_args_finish(&args);
}

TEST(other_values_are_refused) {
    static const char *const lines[][2] = {
        {"--whole 2", "--whole: expected an integer from 3 to 4294967295, found \"2\""},
        {"-w 4294967296", "expected an integer"},
        {"--whole 3.5", "expected an integer"},
        {"--choice three", "--choice: expected one of none, one, two, found \"three\""},
        {"--set=one --kind one", "--set: expected PATH=VALUE, found \"one\""},
        {"--kinds one --kinds 1", "--kinds: expected one of none, one, two, found \"1\""},
        {"--real 0", "--real: expected a number above 0 and up to 1e9, found \"0\""},
        {"--real 1.1e9", "expected a number"},
        {"--shard 4/3", "--shard: expected K/N with K from 1 to N, found \"4/3\""},
        {"--set =1", "expected PATH=VALUE"},
        {"--off --off", "--off is given more than once"},
        {"--off=1", "--off takes no value, found \"1\""},
        {"--text", "--text needs a value: --text TEXT"},
        {"a b", "unexpected argument \"b\""},
        {"--whol 4", "did you mean \"--whole\"?"},
    };
    for (size_t k = 0; k < sizeof lines / sizeof *lines; k++) {
        char line[64];
        struct cs_error error = {0};
        snprintf(line, sizeof line, "%s", lines[k][0]);
        parse(line, &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_USAGE, lines[k][1]);
        cs_args_finish(&args);
    }
}
