/* Any words as the command line of every command: sorted and read as what each option takes, or
 * refused with a message. Nothing is run. */
#include "cli/commands.h"
#include "cli/run/run_checkpoint.h"
#include "session/method.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

enum { WORDS_MAX = 32 };

static const struct cs_command *const commands[] = {
#define X(name) &cs_command_##name,
    CS_COMMAND_LIST(X)
#undef X
};
enum { COMMANDS = sizeof commands / sizeof *commands };

extern const struct cs_module clothsim_module_explicit;

/* every call starts without an error, and a status comes with its message */
static void expect(enum cs_status status, struct cs_error *error) {
    CS_ASSERT(status == error->status);
    CS_ASSERT(!status || (status == CS_ERR_USAGE && *error->message));
    *error = (struct cs_error){0};
}

/* NAME:key=value,... as far as it goes without opening a module */
static void read_method(const char *text) {
    struct cs_error error = {0};
    struct cs_method method = {0};
    const char *behind = strchr(text, ':');
    char *list = strdup(text), *rest = list;
    while (list && cs_method_split(&rest))
        continue;
    free(list);
    const struct cs_module *module = &clothsim_module_explicit;
    if (!behind ||
        cs_method_init(&method, module->integrators[strlen(text) % module->n], NULL, &error))
        return;
    expect(cs_method_set_pairs(&method, behind + 1, &error), &error);
    cs_method_finish(&method);
}

/* numbers that were read are in their bounds */
static void check_value(const struct cs_args *args, const struct cs_arg_value *given) {
    const struct cs_arg *row = given->row;
    const void *field = (const char *)args->options + row->offset;
    struct cs_error error = {0};
    struct cs_checkpoint_interval interval;
    if (row->kind == CS_ARG_REAL)
        CS_ASSERT(*(const double *)field >= 0 && *(const double *)field <= 1e9);
    if (row->kind == CS_ARG_SHARD)
        CS_ASSERT(((const struct cs_shard *)field)->index <=
                  ((const struct cs_shard *)field)->count);
    if (!strcmp(row->name, "checkpoint"))
        expect(cs_checkpointer_read_interval(given->value, &interval, &error), &error);
}

static void read_as(const struct cs_command *command, int argc, char **argv) {
    struct cs_args args = {0};
    struct cs_error error = {0};
    struct cs_text help = {0};
    expect(cs_args_parse(&args, command, argc, argv, &error), &error);
    if (args.help)
        cs_command_print_help(command, &help);
    /* what was read before a mistake, too */
    for (uint32_t k = 0; k < args.n_given; k++)
        check_value(&args, args.given + k);
    cs_text_finish(&help);
    cs_args_finish(&args);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    char *text = strndup((const char *)bytes, length), *rest = text, *argv[WORDS_MAX + 1];
    int argc = 0;
    if (!text)
        return 0;
    for (char *word; argc < WORDS_MAX && (word = strsep(&rest, "\n"));)
        argv[argc++] = word;
    argv[argc] = NULL;
    for (int k = 0; k < argc; k++)
        read_method(argv[k]);
    for (uint32_t k = 0; k < COMMANDS; k++)
        read_as(commands[k], argc, argv);
    free(text);
    return 0;
}
