/* program_method.c - methods that another process computes, and those of a file of
 * coefficients: starts a program to learn which method it is, and again for each run. What is
 * said between is the work of plugins/program.c. */
#include "base/install_paths.h"
#include "sim/module.h"
#include "sim/run_host.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* A process that was started, and the memory shared with it. */
struct process {
    const struct cs_program_method *program;
    pid_t pid; /* 0: none */
    int socket;
    struct cs_program_head *head; /* mapped */
    size_t bytes;                 /* of the mapping */
};

/* Times for the hello, after the first of which the wait is told, and for the end of a program,
 * which is looked at after each nap. */
enum { SILENT_MS = 5000, HELLO_MS = 60000, NAP_NS = 5000000, NAPS = 200 };

/* The child after fork: only calls that are safe there. Its standard output is our standard
 * error, since ours has results; the signals of a terminal reach us alone; it ends with us. */
static _Noreturn void become_program(const char *const *words, int socket, int memory,
                                     pid_t parent) {
    const int input = open("/dev/null", O_RDONLY);
    // above both numbers first: neither may hide the other
    const int from[] = {fcntl(socket, F_DUPFD, CS_PROGRAM_MEMORY + 1),
                        fcntl(memory, F_DUPFD, CS_PROGRAM_MEMORY + 1)};
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setpgid(0, 0);
    dup2(input, STDIN_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    dup2(from[0], CS_PROGRAM_SOCKET);
    dup2(from[1], CS_PROGRAM_MEMORY);
    close(from[0]);
    close(from[1]);
    if (getppid() == parent)
        execvp(words[0], (char *const *)words);
    // no letter: the number says why it did not start
    const struct cs_program_message why = {0, (uint64_t)errno, {0}};
    _exit(write(CS_PROGRAM_SOCKET, &why, sizeof why) == sizeof why ? 127 : 126);
}

/* Starts a program that shares arrays of n particles. CS_ERR_MEMORY; a command that cannot be
 * run is told by its first message, of code 0 and an errno. */
static enum cs_status start_process(struct process *process,
                                    const struct cs_program_method *program, size_t n,
                                    struct cs_error *error) {
    const pid_t parent = getpid();
    const int memory = memfd_create("clothsim", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    int pair[2] = {-1, -1};
    const uint64_t history = program->description.history;
    const size_t rows =
        CS_PROGRAM_ROWS + (history == CS_PROGRAM_NO_HISTORY ? 0 : (size_t)history);
    *process =
        (struct process){.program = program,
                         .socket = -1,
                         .bytes = sizeof(struct cs_program_head) + rows * n * sizeof(double)};
    void *shared = MAP_FAILED;
    if (memory >= 0 && !ftruncate(memory, (off_t)process->bytes) &&
        !fcntl(memory, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL))
        shared = mmap(NULL, process->bytes, PROT_READ | PROT_WRITE, MAP_SHARED, memory, 0);
    if (shared != MAP_FAILED) {
        process->head = shared;
        *process->head = (struct cs_program_head){.version = CS_PROGRAM_VERSION, .n = n};
        if (!socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) &&
            !(process->pid = fork()))
            become_program(program->words, pair[1], memory, parent);
    }
    if (process->pid <= 0) {
        process->pid = 0;
        if (process->head)
            munmap(process->head, process->bytes);
        cs_fail(error, CS_ERR_MEMORY, "program \"%.200s\": cannot be started: %s", program->key,
                strerror(errno));
    }
    process->socket = pair[0];
    close(pair[1]);
    close(memory);
    return error->status;
}

/* Closes the socket, which asks the program to end, ends it by force after a second, and frees
 * what was shared. Adds how it ended to out, unless that is NULL. */
static void end_process(struct process *process, struct cs_text *out) {
    const struct timespec nap = {.tv_nsec = NAP_NS};
    int status = 0;
    pid_t ended = 0;
    if (!process->pid)
        return;
    close(process->socket);
    for (int k = 0; k < NAPS && !(ended = waitpid(process->pid, &status, WNOHANG)); k++)
        nanosleep(&nap, NULL);
    if (!ended) {
        kill(process->pid, SIGKILL);
        waitpid(process->pid, &status, 0);
    }
    process->pid = 0;
    munmap(process->head, process->bytes);
    if (out && WIFSIGNALED(status))
        cs_text_add(out, "was ended by signal %d (%s)", WTERMSIG(status),
                    strsignal(WTERMSIG(status)));
    else if (out)
        cs_text_add(out, "ended with code %d", WEXITSTATUS(status));
}

/* Waits for the first message, which follows the description, for a minute. Returns 1; 0 if the
 * program has ended; -1 if it was silent, or a signal came (errno EINTR). */
static int receive_hello(const struct process *process, struct cs_program_message *message) {
    struct pollfd socket = {.fd = process->socket, .events = POLLIN};
    errno = 0;
    int ready = poll(&socket, 1, SILENT_MS);
    if (ready == 0) {
        // the key comes from the command line alone
        fprintf(stderr, "clothsim: \"%.200s\" is silent: it has a minute to describe itself\n",
                process->program->key);
        ready = poll(&socket, 1, HELLO_MS - SILENT_MS);
    }
    // a message of this size comes whole
    return ready <= 0 ? -1 : recv(socket.fd, message, sizeof *message, 0) == sizeof *message;
}

/* Starts the process of a run, and hands it to the module that speaks with it. */
static enum cs_step create(const struct cs_host *table, const void *options, void **self) {
    struct cs_run_host *host = table->ctx;
    // the method is the first member of its program
    const struct cs_program_method *program = (const void *)host->run->integrator;
    struct process *process = table->alloc(host, sizeof *process);
    struct cs_program_message message;
    if (!process || start_process(process, program, table->view->n, &host->error))
        return CS_STEP_FAIL;
    // this one is allowed
    host->process_state.has_children = true;
    const struct cs_program_channel channel = {
        process,       process->socket,      process->pid,
        process->head, &program->integrator, program->description.history,
        options};
    enum cs_step step = CS_STEP_FAIL;
    if (receive_hello(process, &message) > 0)
        step = program->calls->create(table, &channel, self);
    else
        cs_fail(&host->error, errno == EINTR ? CS_ERR_INTERRUPT : CS_ERR_MODULE,
                "its program did not describe itself again");
    if (!*self)
        end_process(process, NULL);
    return step;
}

static void destroy(void *self) {
    struct process *process = ((struct cs_program_channel *)self)->owner;
    process->program->calls->destroy(self);
    end_process(process, NULL);
}

static enum cs_step create_by_tableau(const struct cs_host *table, const void *options,
                                      void **self) {
    const struct cs_run_host *host = table->ctx;
    const struct cs_program_method *program = (const void *)host->run->integrator;
    const struct cs_tableau_channel channel = {&program->tableau, options};
    return program->calls->create(table, &channel, self);
}

/* Closes a text of the description, which may hold anything. */
#define CLOSED(text) ((text)[sizeof(text) - 1] = 0, (text))

/* Begins a method with calls of a module, and with the texts and orders of the description,
 * where they stay. name replaces that of the description, unless it is NULL. */
static void take_texts(struct cs_program_method *program, const struct cs_integrator *calls,
                       const char *name) {
    struct cs_program_description *from = &program->description;
    struct cs_integrator *method = &program->integrator;
    program->calls = calls;
    *method = *calls;
    method->name = name ? name : CLOSED(from->name);
    method->summary = CLOSED(from->summary);
    method->source = CLOSED(from->source);
    method->order = (uint32_t)from->order;
    method->order_damped = (uint32_t)from->order_damped;
}

/* Makes the method of a file of coefficients, with the calls that fit them. */
static enum cs_status open_tableau(struct cs_program_method *program, const char *path,
                                   const char *name, struct cs_error *error) {
    const uint64_t *traits = &program->description.traits;
    const struct cs_module *calls;
    char file[PATH_MAX];
    snprintf(file, sizeof file, "%.4000s/tableau.bridge", cs_module_folder());
    if (cs_tableau_read(path, &program->description, &program->tableau, error) ||
        cs_module_open(file, &calls, error))
        return error->status;
    const int kind = 2 * !!(*traits & CS_IMPLICIT) + !!(*traits & CS_ADAPTIVE);
    take_texts(program, calls->integrators[kind], name);
    program->integrator.create = create_by_tableau;
    if (!realpath(path, program->file))
        *program->file = 0;
    return cs_module_check_integrator(&program->integrator, error);
}

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
    take_texts(program, calls->integrators[from->history == CS_PROGRAM_NO_HISTORY], name);
    struct cs_integrator *method = &program->integrator;
    method->library = *CLOSED(from->library) ? from->library : NULL;
    method->needs = (uint32_t)from->needs;
    method->traits = (uint32_t)from->traits;
    method->fidelity = (uint32_t)from->fidelity;
    method->fails = program->fails;
    method->options = program->options;
    method->n_options = (uint32_t)from->n_options;
    method->options_size = (uint32_t)(from->n_options * sizeof(double));
    method->create = create;
    method->destroy = destroy;
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

/* Fails unless the first message is a hello of this version; got as receive_hello
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
                                      struct process *process, struct cs_error *error) {
    struct cs_program_message message = {0};
    struct cs_text how = {0};
    // the calls below set errno, which tells a signal
    const int got = receive_hello(process, &message), reason = errno;
    find_file(program, process->pid);
    program->description = process->head->description;
    if (got < 0)
        kill(process->pid, SIGKILL);
    end_process(process, &how);
    errno = reason;
    check_hello(program, got, &message, cs_text_get(&how), error);
    cs_text_finish(&how);
    return error->status;
}

/* Fills a program that has its key and command. */
static enum cs_status open_program(struct cs_program_method *program, struct cs_error *error) {
    struct process process;
    const struct cs_module *calls;
    char *command = program->command, *name = NULL, file[PATH_MAX];
    const size_t length = strspn(command, "abcdefghijklmnopqrstuvwxyz0123456789-");
    if (length > 0 && command[length] == '=')
        name = strsep(&command, "=");
    if (*program->key == *"tableau:")
        return open_tableau(program, command, name, error);
    // from here on the command is cut: the key has it whole
    if (!cut_words(program, command))
        return cs_fail(error, CS_ERR_USAGE, "\"%.60s...\": more than %d words", program->key,
                       CS_PROGRAM_WORDS_MAX);
    if (!program->words[0])
        return cs_fail(error, CS_ERR_USAGE,
                       "found \"%.60s\", expected program:COMMAND or --program NAME=COMMAND",
                       program->key);
    snprintf(file, sizeof file, "%.4000s/program.bridge", cs_module_folder());
    return cs_module_open(file, &calls, error) || start_process(&process, program, 0, error) ||
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
