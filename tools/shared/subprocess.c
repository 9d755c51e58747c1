/* Runs another program and waits for it. */
#include "shared/subprocess.h"

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

enum cs_status cs_subprocess_open(struct cs_subprocess *process, const char *folder,
                                  const char *const *arguments, int stream,
                                  struct cs_error *error) {
    int ends[2];
    *process = (struct cs_subprocess){0};
    if (pipe2(ends, O_CLOEXEC))
        return cs_fail(error, cs_file_status(errno), "cannot make a pipe: %s", strerror(errno));
    /* the stream first, because a program that is started could already do something */
    process->output = fdopen(ends[0], "r");
    const int reason =
        process->output ? spawn(folder, arguments, ends[1], stream, &process->pid) : errno;
    close(ends[1]);
    if (!reason)
        return CS_OK;
    if (process->output)
        fclose(process->output);
    else
        close(ends[0]);
    *process = (struct cs_subprocess){.reason = reason};
    return cs_fail(error, cs_file_status(reason), "cannot run %s: %s", arguments[0],
                   strerror(reason));
}

int cs_subprocess_close(struct cs_subprocess *process) {
    int status = -1;
    if (process->pid <= 0)
        return -1;
    if (!process->output || !feof(process->output))
        kill(process->pid, SIGKILL);
    if (process->output)
        fclose(process->output);
    while (waitpid(process->pid, &status, 0) < 0 && errno == EINTR)
        ;
    *process = (struct cs_subprocess){0};
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}
