/* clothsim: finds the command, and turns its status into a message and an exit code.
 *
 *   argv -> dispatch -> cs_args_parse -> command->main -> message on stderr -> exit code
 * All errors of commands come back here as one struct cs_error; nothing exits on its own.
 * A command that is a program of its own (tools/) has this main too, with no other command in
 * its table: it is started in place of this one, with the same words. */
#include "base/install_paths.h"
#include "cli/commands.h"
#include "cli/ieee_check.h"
#include "cli/line/print.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

/* CS_TOOL: the one command of a program of its own; else all, those by name and summary */
#ifdef CS_TOOL
#define PROGRAM_LIST CS_TOOL
#else
#define PROGRAM_LIST CS_COMMAND_LIST
#define X(name_, text)                                                                         \
    const struct cs_command cs_command_##name_ = {.name = text, .summary = CS_SUMMARY_##name_};
CS_TOOL_LIST(X)
#undef X
#endif

static const struct cs_command *const commands[] = {
#define X(name) &cs_command_##name,
    PROGRAM_LIST(X)
#undef X
        NULL};
enum { COMMANDS = sizeof commands / sizeof *commands };

static const struct cs_command *find_command(const char *name) {
    for (uint32_t i = 0; commands[i]; i++)
        if (!strcmp(commands[i]->name, name))
            return commands[i];
    return NULL;
}

static enum cs_status unknown_command(const char *word, struct cs_error *error) {
    const char *names[COMMANDS + 1]; // help as well
    uint32_t n = 0;
    for (; commands[n]; n++)
        names[n] = commands[n]->name;
    names[n++] = "help";
    names[n] = NULL;
    if (*word == '-')
        return cs_fail(error, CS_ERR_USAGE,
                       "unknown option \"%.60s\"; a command comes first (see: clothsim help)",
                       word);
    /* a scene without a command */
    const char *scene = strstr(word, ".json");
    const char *nearest = scene ? "run SCENE" : cs_nearest_word(word, names);
    return cs_fail(error, CS_ERR_USAGE, "unknown command \"%.60s\"%s%s%s (see: clothsim help)",
                   word, nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                   nearest ? "\"?" : "");
}

static enum cs_status print_overview(FILE *file, struct cs_error *error) {
    struct cs_text out = {0};
    cs_text_add(&out, "usage: clothsim COMMAND [options]\n\n"
                      "Cloth as particles and springs: simulated, compared and drawn.\n\n");
    for (uint32_t i = 0; commands[i]; i++) {
        struct cs_text left = {0};
        cs_text_add(&left, "  %s", commands[i]->name);
        cs_print_hanging(cs_text_get(&left), commands[i]->summary, 16, &out);
        out.failed |= left.failed;
        cs_text_finish(&left);
    }
    cs_print_hanging("  help", "this text, or the options of a command: clothsim help run", 16,
                     &out);
    cs_text_add(&out,
                "\nA first run:  clothsim run scenes/sphere_rest.json --frames 60 -o out\n"
                "Manual:       man clothsim\n");
    return cs_print_out(file, &out, error);
}

static enum cs_status print_help(const struct cs_command *command, struct cs_error *error) {
    struct cs_text out = {0};
    cs_command_print_help(command, &out);
    return cs_print_out(stdout, &out, error);
}

static enum cs_status help(int argc, char **argv, struct cs_error *error) {
    if (!argc || !strcmp(argv[0], "help") || argv[0][0] == '-')
        return print_overview(stdout, error);
    const struct cs_command *command = find_command(argv[0]);
    return command ? print_help(command, error) : unknown_command(argv[0], error);
}

static enum cs_status print_version(struct cs_error *error) {
    struct cs_text out = {0};
    cs_text_add(&out, "clothsim " CS_VERSION "\n");
    return cs_print_out(stdout, &out, error);
}

/* Parses the arguments and runs the command, or prints its help. */
static enum cs_status run_command(const struct cs_command *command, int argc, char **argv,
                                  struct cs_error *error) {
    struct cs_args args = {0};
    const char *fault = cs_ieee_check();
    if (fault)
        return cs_fail(error, CS_ERR_INTERNAL, "%s: results would be wrong", fault);
    if (!cs_args_parse(&args, command, argc, argv, error) &&
        !cs_args_add_programs(&args, error)) {
        if (args.help)
            print_help(command, error);
        else
            command->main(&args, error);
    }
    cs_args_finish(&args);
    return error->status;
}

/* The command that the words are about; NULL: none. */
static const struct cs_command *command_of(int argc, char **argv) {
    static const char *const before[] = {"help", "--help", "-h"};
    int at = 1;
    for (size_t k = 0; k < sizeof before / sizeof *before; k++)
        if (argc > 2 && !strcmp(argv[1], before[k]))
            at = 2;
    return find_command(argv[at]);
}

/* Starts another program of clothsim's in place of this one. Returns only if that failed. */
static enum cs_status start_program(const char *name, char **argv, struct cs_error *error) {
    char path[CS_DATA_PATH_MAX];
    execv(cs_tool_path(name, path, sizeof path), argv);
    return cs_fail(error, CS_ERR_FILE, "%s: cannot start its program \"%.4000s\": %s", name,
                   path, strerror(errno));
}

/* True for words that clothsim-describe answers. */
static bool asks_description(int argc, char **argv) {
    return (argc <= 3 && (!strcmp(argv[1], "--completion") || !strcmp(argv[1], "--schema"))) ||
           (argc == 2 && !strcmp(argv[1], "--files")) ||
           (argc == 5 && !strcmp(argv[1], "--complete") && find_command(argv[2]));
}

static bool is_version(const char *word) {
    return !strcmp(word, "--version") || !strcmp(word, "-V");
}

/* Options of the program itself come first: version, descriptions, help. */
static enum cs_status dispatch(int argc, char **argv, struct cs_error *error) {
    if (argc < 2)
        return print_overview(stderr, error)
                   ? error->status
                   : cs_fail(error, CS_ERR_USAGE, "expected a command");
    const struct cs_command *tool = command_of(argc, argv);
    if (is_version(argv[1]) || (tool && argc == 3 && is_version(argv[2])))
        return print_version(error);
    if (tool && !tool->main)
        return start_program(tool->name, argv, error);
    if (asks_description(argc, argv))
        return start_program("describe", argv, error);
    if (argc == 5 && !strcmp(argv[1], "--complete"))
        return unknown_command(argv[2], error);
    if (!strcmp(argv[1], "help") || !strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))
        return help(argc - 2, argv + 2, error);
    const struct cs_command *command = find_command(argv[1]);
    if (!command)
        return unknown_command(argv[1], error);
    return run_command(command, argc - 2, argv + 2, error);
}

/* Puts /dev/null in the place of closed streams, so that no file of ours gets their numbers.
 * Reading from it, and writing results to it, fails as on a closed stream; messages are lost.
 */
static enum cs_status open_streams(struct cs_error *error) {
    static const int modes[] = {O_WRONLY, O_RDONLY, O_WRONLY};
    for (int k = 0; k <= STDERR_FILENO; k++)
        if (fcntl(k, F_GETFD) < 0 && open("/dev/null", modes[k]) != k)
            return cs_fail(error, CS_ERR_FILE,
                           "stream %d is closed, and /dev/null cannot be opened: %s", k,
                           strerror(errno));
    return CS_OK;
}

int main(int argc, char **argv) {
    struct cs_error error = {0};
    open_streams(&error);
#ifdef CS_TOOL
    /* clothsim, which started it, has told where it cannot find itself */
    cs_program_from_tool();
#else
    const char *fault = cs_program_path_fault();
    if (fault)
        cs_print_message(fault);
#endif
    /* a file that grew too long comes back from the write as an error, and is reported */
    signal(SIGXFSZ, SIG_IGN);
    if (!error.status && !dispatch(argc, argv, &error) && (fflush(stdout) || ferror(stdout)))
        cs_fail(&error, CS_ERR_FILE, "cannot write to standard output");
    /* what was printed before the failure stands before it */
    fflush(stdout);
    // none of a program that was started and has told it itself
    if (*error.message)
        cs_print_message(error.message);
    return error.status == CS_ERR_INTERRUPT ? cs_interrupt_exit_code()
                                            : cs_status_exit_code(error.status);
}
