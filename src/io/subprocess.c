/* Runs another program and waits for it. */
#include "io/subprocess.h"

#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stddef.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

/* Starts the program in a folder, with `end` of a pipe as one of its streams unless that is 0.
 * The pipe's own descriptors are closed in it by FD_CLOEXEC. Returns 0 or an errno. */
static int spawn(const char *folder, const char *const *arguments, int end, int stream,
                 pid_t *child) {
    posix_spawn_file_actions_t actions;
    int reason = posix_spawn_file_actions_init(&actions);
    if (reason)
        return reason;
    reason = posix_spawn_file_actions_addchdir_np(&actions, folder);
    if (!reason && stream)
        reason = posix_spawn_file_actions_adddup2(&actions, end, stream);
    if (!reason)
        reason = posix_spawnp(child, arguments[0], &actions, NULL, (char *const *)arguments,
                              environ);
    posix_spawn_file_actions_destroy(&actions);
    return reason;
}

struct cs_subprocess_result cs_subprocess_run(const char *folder, const char *const *arguments,
                                              const volatile sig_atomic_t *stop) {
    const struct timespec pause = {.tv_nsec = 20000000};
    pid_t child, ended = 0;
    int status = -1;
    const bool found = !spawn(folder, arguments, 0, 0, &child);
    while (found && !(ended = waitpid(child, &status, WNOHANG))) {
        // a signal of the terminal reaches both, another one only us
        if (*stop)
            kill(child, SIGTERM);
        nanosleep(&pause, NULL);
    }
    return (struct cs_subprocess_result){found, found && ended == child && WIFEXITED(status) &&
                                                    WEXITSTATUS(status) == 0};
}

enum cs_status cs_subprocess_open(struct cs_subprocess *program, const char *folder,
                                  const char *const *arguments, int stream,
                                  struct cs_error *error) {
    int ends[2];
    *program = (struct cs_subprocess){0};
    if (pipe2(ends, O_CLOEXEC))
        return cs_fail(error, cs_file_status(errno), "cannot make a pipe: %s", strerror(errno));
    /* the stream first, because a program that is started could already do something */
    program->output = fdopen(ends[0], "r");
    const int reason =
        program->output ? spawn(folder, arguments, ends[1], stream, &program->pid) : errno;
    close(ends[1]);
    if (!reason)
        return CS_OK;
    if (program->output)
        fclose(program->output);
    else
        close(ends[0]);
    *program = (struct cs_subprocess){.reason = reason};
    return cs_fail(error, cs_file_status(reason), "cannot run %s: %s", arguments[0],
                   strerror(reason));
}

int cs_subprocess_close(struct cs_subprocess *program) {
    int status = -1;
    if (program->pid <= 0)
        return -1;
    if (!program->output || !feof(program->output))
        kill(program->pid, SIGKILL);
    if (program->output)
        fclose(program->output);
    while (waitpid(program->pid, &status, 0) < 0 && errno == EINTR)
        ;
    *program = (struct cs_subprocess){0};
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* --- gnuplot --- */

/* Notes a failure, and removes pictures that are half drawn or of an earlier script. */
static void add_failure(struct cs_gnuplot *gnuplot, const char *folder, const char *name,
                        const char *reason) {
    static const char *const endings[] = {"png", "svg", "pdf"};
    char path[4352];
    for (size_t k = 0; k < sizeof endings / sizeof *endings; k++)
        if (snprintf(path, sizeof path, "%s/%s.%s", folder, name, endings[k]) <
            (int)sizeof path)
            unlink(path);
    if (!gnuplot->n_failed++)
        snprintf(gnuplot->first, sizeof gnuplot->first, "%.255s.gp: %s", name, reason);
}

enum cs_status cs_gnuplot_run(const char *folder, const char *name, struct cs_gnuplot *gnuplot,
                              struct cs_error *error) {
    char script[272], line[256], last[256] = "", reason[300];
    struct cs_subprocess program;
    struct cs_error failure = {0};
    sigset_t interrupts, before;
    snprintf(script, sizeof script, "%s.gp", name);
    gnuplot->drawn = false;
    /* gnuplot inherits the mask: an interrupt of the terminal, which reaches both programs,
     * leaves no results without their picture */
    sigemptyset(&interrupts);
    sigaddset(&interrupts, SIGINT);
    sigaddset(&interrupts, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &interrupts, &before);
    cs_subprocess_open(&program, folder, (const char *const[]){"gnuplot", script, NULL}, 2,
                       &failure);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failure.status) {
        if (failure.status == CS_ERR_MEMORY)
            *error = failure;
        else if (program.reason != ENOENT && program.reason != ENOTDIR)
            add_failure(gnuplot, folder, name, failure.message);
        return error->status;
    }
    /* a failure is in the last line; warnings about fonts would only confuse the user */
    while (fgets(line, sizeof line, program.output))
        if (line[strspn(line, " \n")])
            snprintf(last, sizeof last, "%.*s", (int)strcspn(line, "\n"), line);
    const int code = cs_subprocess_close(&program);
    gnuplot->drawn = code == 0;
    snprintf(reason, sizeof reason, code < 0 ? "a signal ended it" : "it ended with code %d",
             code);
    if (*last)
        snprintf(reason + strlen(reason), sizeof reason - strlen(reason), ": %s", last);
    if (!gnuplot->drawn)
        add_failure(gnuplot, folder, name, reason);
    return CS_OK;
}

void cs_gnuplot_warn(const struct cs_gnuplot *gnuplot, const char *bullet,
                     struct cs_text *out) {
    if (gnuplot->n_failed)
        cs_text_add(out, "%sgnuplot could not draw %s", bullet, gnuplot->first);
    if (gnuplot->n_failed > 1)
        cs_text_add(out, " (and %u more)", gnuplot->n_failed - 1);
    if (gnuplot->n_failed)
        cs_text_add(out, "\n");
}
