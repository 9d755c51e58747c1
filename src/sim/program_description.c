/* program_description.c - starts a program to learn which method it is, and turns its
 * description into a method like that of a module. */
#include "sim/module.h"

#include "base/install_paths.h"

#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Closes a text of the description, which may hold anything. */
#define CLOSED(text) ((text)[sizeof(text) - 1] = 0, (text))

/* Makes the method of a description, with the calls that all programs share. name replaces the
 * program's own, unless it is NULL. */
static enum cs_status make_method(struct cs_program_method *program, const char *name,
                                  const struct cs_module *calls, struct cs_error *error) {
    struct cs_program_description *from = &program->description;
    if (from->n_options > CS_PROGRAM_OPTIONS_MAX)
        return cs_fail(error, CS_ERR_MODULE, "\"%.200s\" has %llu options, expected at most %d",
                       program->key, (unsigned long long)from->n_options,
                       CS_PROGRAM_OPTIONS_MAX);
    for (uint32_t k = 0; k < from->n_options; k++) {
        struct cs_program_option *row = from->options + k;
        program->options[k] = (struct cs_option){.name = CLOSED(row->name),
                                                 .unit = CLOSED(row->unit),
                                                 .help = CLOSED(row->help),
                                                 .type = CS_REAL,
                                                 .count = 1,
                                                 .offset = k * sizeof(double),
                                                 .def = row->def,
                                                 .min = row->min,
                                                 .max = row->max};
    }
    for (int k = 0; k < CS_PROGRAM_FAILS_MAX && *CLOSED(from->fails[k]); k++)
        program->fails[k] = from->fails[k];
    struct cs_integrator *method = &program->integrator;
    program->calls = calls->integrators[from->history == CS_PROGRAM_NO_HISTORY];
    *method = *program->calls;
    // the texts stay in the description
    method->name = name ? name : CLOSED(from->name);
    method->summary = CLOSED(from->summary);
    method->source = CLOSED(from->source);
    method->library = *CLOSED(from->library) ? from->library : NULL;
    method->order = (uint32_t)from->order;
    method->order_damped = (uint32_t)from->order_damped;
    method->needs = (uint32_t)from->needs;
    method->traits = (uint32_t)from->traits;
    method->fidelity = (uint32_t)from->fidelity;
    method->fails = program->fails;
    method->options = program->options;
    method->n_options = (uint32_t)from->n_options;
    method->options_size = (uint32_t)(from->n_options * sizeof(double));
    cs_program_set_calls(method);
    return cs_module_check_integrator(method, error);
}

/* The first argument that is a file, else what the process runs. */
static void find_file(struct cs_program_method *program, pid_t pid) {
    char link[32];
    snprintf(link, sizeof link, "/proc/%d/exe", (int)pid);
    for (const char *const *word = program->words + 1; *word; word++)
        if (!access(*word, R_OK) && realpath(*word, program->file))
            return;
    if (readlink(link, program->file, sizeof program->file - 1) < 0)
        snprintf(program->file, sizeof program->file, "%.4000s", program->words[0]);
}

/* Cuts a command into words at spaces, and at quotes around a word. Returns false if there are
 * more than fit. */
static bool cut_words(struct cs_program_method *program, char *text) {
    for (int n = 0; n < CS_PROGRAM_WORDS_MAX && text && *(text += strspn(text, " "));) {
        const char *end = *text == '\'' ? "'" : *text == '"' ? "\"" : " ";
        text += *end != ' ';
        program->words[n++] = strsep(&text, end);
    }
    return !text || !text[strspn(text, " ")];
}

/* Fails unless the first message is a hello of this version; got as cs_program_receive_hello
 * returns it, how: how the program ended. */
static enum cs_status check_hello(const struct cs_program_method *program, int got,
                                  const struct cs_program_message *message, const char *how,
                                  struct cs_error *error) {
    char why[160];
    if (got < 0 && errno == EINTR)
        return cs_fail(error, CS_ERR_INTERRUPT, "interrupted");
    if (got < 0)
        snprintf(why, sizeof why, "has not described itself within a minute");
    else if (got == 0)
        snprintf(why, sizeof why, "%.100s before it described itself", how);
    else if (!message->code)
        snprintf(why, sizeof why, "cannot be started: %.100s", strerror((int)message->count));
    else if (message->code != 'V' || message->count != CS_PROGRAM_VERSION)
        snprintf(why, sizeof why, "sent %#llx, %llu, expected 'V', %d",
                 (unsigned long long)message->code, (unsigned long long)message->count,
                 CS_PROGRAM_VERSION);
    else
        return CS_OK;
    return cs_fail(error, CS_ERR_MODULE, "\"%.200s\" %s (see: man clothsim-program)",
                   program->key, why);
}

/* Takes the description of a program that was started, and ends it. */
static enum cs_status ask_description(struct cs_program_method *program,
                                      struct cs_program_process *process,
                                      struct cs_error *error) {
    struct cs_program_message message = {0};
    struct cs_text how = {0};
    // the calls below set errno, which tells a signal
    const int got = cs_program_receive_hello(process, &message), reason = errno;
    find_file(program, process->pid);
    program->description = process->head->description;
    if (got < 0)
        kill(process->pid, SIGKILL);
    cs_program_process_end(process, &how);
    errno = reason;
    check_hello(program, got, &message, cs_text_get(&how), error);
    cs_text_finish(&how);
    return error->status;
}

/* Fills a program that has its key and command. */
static enum cs_status open_program(struct cs_program_method *program, struct cs_error *error) {
    struct cs_program_process process;
    const struct cs_module *calls;
    char *command = program->command, *name = NULL, file[PATH_MAX];
    const size_t length = strspn(command, "abcdefghijklmnopqrstuvwxyz0123456789-");
    if (length > 0 && command[length] == '=')
        name = strsep(&command, "=");
    static char tableau[PATH_MAX];
    snprintf(tableau, sizeof tableau, "%.4000s/tableau.py", cs_module_folder());
    if (*program->key == *"tableau:")
        program->words[0] = tableau, program->words[1] = command;
    // from here on the command is cut: the key has it whole
    else if (!cut_words(program, command))
        return cs_fail(error, CS_ERR_USAGE, "\"%.60s...\": more than %d words", program->key,
                       CS_PROGRAM_WORDS_MAX);
    if (!program->words[0])
        return cs_fail(error, CS_ERR_USAGE,
                       "found \"%.60s\", expected program:COMMAND or --program NAME=COMMAND",
                       program->key);
    snprintf(file, sizeof file, "%.4000s/program.bridge", cs_module_folder());
    return cs_module_open(file, &calls, error) ||
                   cs_program_process_start(&process, program, 0, error) ||
                   ask_description(program, &process, error)
               ? error->status
               : make_method(program, name, calls, error);
}

enum cs_status cs_program_method_open(const char *text, const struct cs_integrator **integrator,
                                      const char **file, struct cs_error *error) {
    static struct cs_program_method *programs; // they stay, as modules stay open
    const size_t bytes = strlen(text) + 1;
    struct cs_program_method *program = programs;
    while (program && strcmp(program->key, text) != 0)
        program = program->next;
    if (!program) {
        program = calloc(1, sizeof *program + 2 * bytes);
        if (!program)
            return cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%.200s\"", text);
        // two copies behind the struct: one stays, one is cut
        program->key = memcpy(program + 1, text, bytes);
        program->command = strcpy(program->key + bytes, strchr(text, ':') + 1);
        if (open_program(program, error)) {
            free(program);
            return error->status;
        }
        program->next = programs;
        programs = program;
    }
    *integrator = &program->integrator;
    *file = program->file;
    return CS_OK;
}
