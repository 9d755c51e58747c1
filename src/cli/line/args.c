/* Parses a command's options and operands by its table of options. */
#include "cli/line/args.h"

#include "cli/line/print.h"

#include <stdlib.h>
#include <string.h>

enum { HELP_COLUMN = 28 };

static void add_option_row(const struct cs_arg *row, struct cs_text *out) {
    struct cs_text left = {0};
    if (row->short_name)
        cs_text_add(&left, "  -%c, --%s", row->short_name, row->name);
    else
        cs_text_add(&left, "      --%s", row->name);
    if (row->value)
        cs_text_add(&left, " %s", row->value);
    cs_print_hanging(cs_text_get(&left), row->help, HELP_COLUMN, out);
    out->failed |= left.failed;
    cs_text_finish(&left);
}

void cs_command_print_help(const struct cs_command *command, struct cs_text *out) {
    static const struct cs_arg help = {.name = "help", .short_name = 'h', .help = "this text"};
    cs_text_add(out, "usage: clothsim %s%s%s [options]\n\n", command->name,
                *command->operands ? " " : "", command->operands);
    cs_print_hanging("", command->summary, 0, out);
    cs_text_add(out, "\n");
    for (uint32_t r = 0; r < command->n_rows; r++)
        if (command->rows[r].help)
            add_option_row(command->rows + r, out);
    add_option_row(&help, out);
    if (command->notes)
        cs_text_add(out, "\n%s", command->notes);
}

/* Rows that a command may have; asserted. */
enum { LONGEST_TABLE = 32 };

/* CS_ERR_USAGE for an unknown option, with the nearest known one. Hidden rows are not
 * suggested. */
static enum cs_status unknown_option(const struct cs_command *command, const char *word,
                                     struct cs_error *error) {
    const char *names[LONGEST_TABLE + 1];
    uint32_t n = 0;
    CS_ASSERT(command->n_rows <= LONGEST_TABLE);
    for (uint32_t r = 0; r < command->n_rows; r++)
        if (command->rows[r].help)
            names[n++] = command->rows[r].name;
    names[n] = NULL;
    const char *nearest = word[1] == '-' ? cs_nearest_word(word + 2, names) : NULL;
    return cs_fail(error, CS_ERR_USAGE,
                   "unknown option \"%.60s\"%s%s%s (see: clothsim %s --help)", word,
                   nearest ? "; did you mean \"--" : "", nearest ? nearest : "",
                   nearest ? "\"?" : "", command->name);
}

/* Compares with the long name. An option that may be repeated can also be given in the singular
 * (--integrator for --integrators). */
static bool is_called(const struct cs_arg *row, const char *word, size_t length) {
    const size_t whole = strlen(row->name);
    const bool singular = row->repeatable && whole == length + 1 && row->name[length] == 's';
    return (whole == length || singular) && !strncmp(row->name, word, length);
}

/* Finds the row of "--name" or "--name=value", and the attached value. */
static const struct cs_arg *find_long(const struct cs_command *command, const char *word,
                                      const char **attached) {
    const size_t length = strcspn(word + 2, "=");
    for (uint32_t r = 0; r < command->n_rows; r++) {
        const struct cs_arg *row = command->rows + r;
        if (!is_called(row, word + 2, length))
            continue;
        *attached = word[2 + length] ? word + 3 + length : NULL;
        return row;
    }
    return NULL;
}

static const struct cs_arg *find_short(const struct cs_command *command, char letter) {
    for (uint32_t r = 0; r < command->n_rows; r++)
        if (command->rows[r].short_name == letter)
            return command->rows + r;
    return NULL;
}

bool cs_args_is_given(const struct cs_args *args, const char *name) {
    for (uint32_t i = 0; i < args->n_given; i++)
        if (!strcmp(args->given[i].row->name, name))
            return true;
    return false;
}

/* The words after a command, and which one is read. */
struct words {
    char **argv;
    int n, at;
};

enum cs_status cs_args_refuse_both(const struct cs_args *args, const char *a, const char *b,
                                   struct cs_error *error) {
    return cs_args_is_given(args, a) && cs_args_is_given(args, b)
               ? cs_fail(error, CS_ERR_USAGE, "--%s and --%s cannot both be given", a, b)
               : CS_OK;
}

/* Stores an option and its value: the attached one, or the next word. */
static enum cs_status store(struct cs_args *args, const struct cs_arg *row,
                            const char *attached, struct words *words, struct cs_error *error) {
    if (!row->repeatable && cs_args_is_given(args, row->name))
        return cs_fail(error, CS_ERR_USAGE, "--%s is given more than once", row->name);
    if (!row->value && attached)
        return cs_fail(error, CS_ERR_USAGE, "--%s takes no value, found \"%.60s\"", row->name,
                       attached);
    const char *value = row->value ? attached : "";
    /* two dashes are the next option: its name is hardly meant as a value */
    if (!value && words->at + 1 < words->n && strncmp(words->argv[words->at + 1], "--", 2) != 0)
        value = words->argv[++words->at];
    if (row->value && (!value || !*value))
        return cs_fail(error, CS_ERR_USAGE, "--%s needs a value: --%s %s", row->name, row->name,
                       row->value);
    args->given[args->n_given++] = (struct cs_arg_value){row, value};
    return CS_OK;
}

/* Takes the letters of "-qyn3": switches, and at the end one with a value, which is the rest of
 * the word or the next word. */
static enum cs_status take_letters(struct cs_args *args, struct words *words,
                                   struct cs_error *error) {
    const char *word = words->argv[words->at];
    for (const char *letter = word + 1; *letter && !error->status; letter++) {
        const struct cs_arg *row = find_short(args->command, *letter);
        args->help |= *letter == 'h';
        if (*letter == 'h')
            continue;
        if (!row)
            return unknown_option(args->command, word, error);
        if (row->value)
            return store(args, row, letter[1] ? letter + 1 : NULL, words, error);
        store(args, row, NULL, words, error);
    }
    return error->status;
}

/* Takes the options of a word, and the value if that is the next word. */
static enum cs_status take_option(struct cs_args *args, struct words *words,
                                  struct cs_error *error) {
    const char *word = words->argv[words->at], *attached = NULL;
    if (word[1] != '-')
        return take_letters(args, words, error);
    const struct cs_arg *row = find_long(args->command, word, &attached);
    return row ? store(args, row, attached, words, error)
               : unknown_option(args->command, word, error);
}

/* True if --help or -h occurs before "--": it takes precedence over all errors. */
static bool asks_for_help(int argc, char **argv) {
    for (int i = 0; i < argc && strcmp(argv[i], "--"); i++)
        if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h"))
            return true;
    return false;
}

static enum cs_status check_operands(const struct cs_args *args, struct cs_error *error) {
    const struct cs_command *command = args->command;
    if (args->n_operands < command->operands_min)
        return cs_fail(error, CS_ERR_USAGE, "expected %s (see: clothsim %s --help)",
                       command->operands, command->name);
    if (args->n_operands > command->operands_max)
        return cs_fail(error, CS_ERR_USAGE,
                       "unexpected argument \"%.60s\" (see: clothsim %s --help)",
                       args->operands[command->operands_max], command->name);
    return CS_OK;
}

/* Sorts options and operands into their arrays; values are read later. */
static enum cs_status sort(struct cs_args *args, int argc, char **argv,
                           struct cs_error *error) {
    bool options = true;
    for (struct words words = {argv, argc, 0}; words.at < argc; words.at++) {
        const char *word = argv[words.at];
        if (options && !strcmp(word, "--"))
            options = false;
        /* a lone "-" is an operand */
        else if (options && word[0] == '-' && word[1]) {
            if (take_option(args, &words, error))
                return error->status;
        } else
            args->operands[args->n_operands++] = word;
    }
    return args->help ? CS_OK : check_operands(args, error);
}

/* Most options that the words can give: a bundle of letters gives one by letter. */
static size_t count_options(int argc, char **argv) {
    size_t n = 0;
    for (int i = 0; i < argc; i++)
        n += argv[i][0] == '-' ? strlen(argv[i]) : 0;
    return n;
}

enum cs_status cs_args_parse(struct cs_args *args, const struct cs_command *command, int argc,
                             char **argv, struct cs_error *error) {
    args->command = command;
    args->words = argv;
    args->n_words = (uint32_t)argc;
    args->help = asks_for_help(argc, argv);
    if (args->help)
        return CS_OK;
    CS_ARENA_ARRAY(&args->arena, args->given, count_options(argc, argv) + 1, error);
    CS_ARENA_ARRAY(&args->arena, args->operands, (size_t)argc, error);
    args->options = cs_arena_alloc(&args->arena, command->size, error);
    if (error->status || sort(args, argc, argv, error) || args->help)
        return error->status;
    memcpy(args->options, command->defaults, command->size);
    for (uint32_t i = 0; i < args->n_given && !error->status; i++)
        cs_arg_read(args->given[i].row, args->given[i].value, args->options, &args->arena,
                    error);
    return error->status;
}

void cs_args_finish(struct cs_args *args) {
    cs_arena_finish(&args->arena);
    *args = (struct cs_args){0};
}

/* Reads the values of options into the struct of their command, and checks them. */

static enum cs_status read_whole(const struct cs_arg *row, const char *text, uint32_t *value,
                                 struct cs_error *error) {
    const size_t digits = strspn(text, "0123456789");
    const unsigned long read = digits <= 10 ? strtoul(text, NULL, 10) : row->max + 1ul;
    if (!digits || text[digits] || read < row->min || read > row->max)
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected an integer from %u to %u, found \"%.60s\"", row->name,
                       row->min, row->max, text);
    *value = (uint32_t)read;
    return CS_OK;
}

enum cs_status cs_arg_refuse_name(const char *option, const char *const *names,
                                  const char *text, struct cs_error *error) {
    struct cs_text list = {0};
    for (int i = 0; names[i]; i++)
        cs_text_add(&list, "%s%s", i ? ", " : "", names[i]);
    cs_fail(error, CS_ERR_USAGE, "--%s: expected one of %s, found \"%.60s\"", option,
            cs_text_get(&list), text);
    cs_text_finish(&list);
    return error->status;
}

/* Reads a name as its number, or a list of names as their bits in the set of those given. */
static enum cs_status read_name(const struct cs_arg *row, const char *text, uint32_t *value,
                                struct cs_error *error) {
    const size_t length = row->repeatable ? strcspn(text, ",") : strlen(text);
    uint32_t i = 0;
    while (row->names[i] &&
           (strncmp(row->names[i], text, length) != 0 || row->names[i][length]))
        i++;
    if (!row->names[i])
        return cs_arg_refuse_name(row->name, row->names, text, error);
    *value = row->repeatable ? *value | 1u << i : i;
    return text[length] ? read_name(row, text + length + 1, value, error) : CS_OK;
}

static enum cs_status read_real(const struct cs_arg *row, const char *text, double *value,
                                struct cs_error *error) {
    double read = 0;
    if (!cs_parse_real(text, &read) || !(read > 0 && read <= 1e9))
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected a number above 0 and up to 1e9, found \"%.60s\"%s",
                       row->name, text, strchr(text, ',') ? " (decimals have a point)" : "");
    *value = read;
    return CS_OK;
}

static enum cs_status read_shard(const struct cs_arg *row, const char *text,
                                 struct cs_shard *shard, struct cs_error *error) {
    char end;
    unsigned number, of;
    if (strspn(text, "0123456789/") < strlen(text) || strlen(text) > 13 ||
        sscanf(text, "%u/%u%c", &number, &of, &end) != 2 || number < 1 || number > of)
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected K/N with K from 1 to N, found \"%.60s\"", row->name,
                       text);
    *shard = (struct cs_shard){number, of};
    return CS_OK;
}

/* A list field of the command's struct. */
struct list {
    const struct cs_arg *row;
    char *options;
    struct cs_arena *arena;
};

/* Returns a place for one more item at the end of a list; NULL if out of memory. The capacity
 * is the next power of two of the count, so it is not stored: a full list has a count of 0 or a
 * power of two. Old arrays stay in the arena. */
static void *append(const struct list *list, size_t size, struct cs_error *error) {
    char *field = list->options + list->row->offset;
    uint32_t *n = (uint32_t *)(list->options + list->row->count);
    char *items;
    memcpy(&items, field, sizeof items);
    /* the room is a power of two */
    if ((*n & (*n - 1)) == 0) {
        char *larger = cs_arena_alloc_array(list->arena, *n ? 2 * (size_t)*n : 1, size, error);
        if (!larger)
            return NULL;
        if (*n)
            memcpy(larger, items, *n * size);
        items = larger;
        memcpy(field, &items, sizeof items);
    }
    return items + size * (*n)++;
}

/* Appends a text, with the row's prefix unless it has one. */
static enum cs_status add_word(const struct list *list, const char *text,
                               struct cs_error *error) {
    const char **word = append(list, sizeof *word, error);
    const bool is_whole = !list->row->prefix || cs_names_program(text);
    const char *prefix = is_whole ? "" : list->row->prefix;
    char *copy = cs_arena_alloc(list->arena, strlen(prefix) + strlen(text) + 1, error);
    if (word && copy)
        *word = strcat(strcpy(copy, prefix), text);
    return error->status;
}

/* Appends the methods of a list; commas within options do not separate. */
static enum cs_status add_methods(const struct list *list, const char *text,
                                  struct cs_error *error) {
    char *rest = cs_arena_copy_text(list->arena, text, error);
    while (rest && !error->status)
        add_word(list, cs_method_split(&rest), error);
    return error->status;
}

/* Splits PATH=VALUE; the copy is the arena's. */
static enum cs_status add_override(const struct list *list, const char *text,
                                   struct cs_error *error) {
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return cs_fail(error, CS_ERR_USAGE, "--%s: expected PATH=VALUE, found \"%.60s\"",
                       list->row->name, text);
    char *path = cs_arena_copy_text(list->arena, text, error);
    struct cs_override *override = append(list, sizeof *override, error);
    if (!path || !override)
        return error->status;
    path[equals - text] = 0;
    *override = (struct cs_override){path, path + (equals - text) + 1};
    return CS_OK;
}

/* Sets a text, or adds to it after a comma where it may be repeated. */
static enum cs_status read_text(const struct list *list, const char *text,
                                struct cs_error *error) {
    const char **field = (const char **)(list->options + list->row->offset), *before = *field;
    char *both = NULL;
    if (list->row->repeatable && before)
        both = cs_arena_alloc(list->arena, strlen(before) + strlen(text) + 2, error);
    *field = both ? strcat(strcat(strcpy(both, before), ","), text) : text;
    // a command checks a list itself, such as CHECK[,...]
    if (list->row->names && !strchr(list->row->value, ','))
        return read_name(list->row, text, &(uint32_t){0}, error);
    return error->status;
}

enum cs_status cs_arg_read(const struct cs_arg *row, const char *text, void *options,
                           struct cs_arena *arena, struct cs_error *error) {
    void *field = (char *)options + row->offset;
    const struct list list = {row, options, arena};
    switch (row->kind) {
    case CS_ARG_SWITCH:
        *(bool *)field = !*(bool *)field;
        break;
    case CS_ARG_TEXT:
        return read_text(&list, text, error);
    case CS_ARG_WHOLE:
        return (row->names ? read_name : read_whole)(row, text, field, error);
    case CS_ARG_REAL:
        return read_real(row, text, field, error);
    case CS_ARG_SHARD:
        return read_shard(row, text, field, error);
    case CS_ARG_WORDS:
        return row->methods ? add_methods(&list, text, error) : add_word(&list, text, error);
    case CS_ARG_OVERRIDES:
        return add_override(&list, text, error);
    }
    return CS_OK;
}
