/* program_process.c - the process of a method that is a program: its start, its hello, its end.
 * What is said between is the work of plugins/program.c. */
#include "sim/module.h"
#include "sim/run_host.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Times for the hello and for the end of a program, which is looked at after each nap. */
enum { HELLO_MS = 60000, NAP_NS = 5000000, NAPS = 200 };

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

enum cs_status cs_program_process_start(struct cs_program_process *process,
                                        const struct cs_program_method *program, size_t n,
                                        struct cs_error *error) {
    const pid_t parent = getpid();
    const int memory = memfd_create("clothsim", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    int pair[2] = {-1, -1};
    const uint64_t history = program->description.history;
    const size_t rows =
        CS_PROGRAM_ROWS + (history == CS_PROGRAM_NO_HISTORY ? 0 : (size_t)history);
    *process = (struct cs_program_process){.program = program,
                                           .socket = -1,
                                           .bytes = sizeof(struct cs_program_head) +
                                                    rows * n * sizeof(double)};
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

void cs_program_process_end(struct cs_program_process *process, struct cs_text *out) {
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

int cs_program_receive_hello(const struct cs_program_process *process,
                             struct cs_program_message *message) {
    struct pollfd socket = {.fd = process->socket, .events = POLLIN};
    errno = 0;
    const int ready = poll(&socket, 1, HELLO_MS);
    // a message of this size comes whole
    return ready <= 0 ? -1 : recv(socket.fd, message, sizeof *message, 0) == sizeof *message;
}

/* Starts the process of a run, and hands it to the module that speaks with it. */
static enum cs_step create(const struct cs_host *table, const void *options, void **self) {
    struct cs_run_host *host = table->ctx;
    // the method is the first member of its program
    const struct cs_program_method *program = (const void *)host->run->integrator;
    struct cs_program_process *process = table->alloc(host, sizeof *process);
    struct cs_program_message message;
    if (!process || cs_program_process_start(process, program, table->view->n, &host->error))
        return CS_STEP_FAIL;
    // this one is allowed
    host->process_state.has_children = true;
    const struct cs_program_channel channel = {
        process,       process->socket,      process->pid,
        process->head, &program->integrator, program->description.history,
        options};
    enum cs_step step = CS_STEP_FAIL;
    if (cs_program_receive_hello(process, &message) > 0)
        step = program->calls->create(table, &channel, self);
    else
        cs_fail(&host->error, errno == EINTR ? CS_ERR_INTERRUPT : CS_ERR_MODULE,
                "its program did not describe itself again");
    if (!*self)
        cs_program_process_end(process, NULL);
    return step;
}

static void destroy(void *self) {
    struct cs_program_process *process = ((struct cs_program_channel *)self)->owner;
    process->program->calls->destroy(self);
    cs_program_process_end(process, NULL);
}

void cs_program_set_calls(struct cs_integrator *method) {
    method->create = create;
    method->destroy = destroy;
}
