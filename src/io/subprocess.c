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
#include <unistd.h>

extern char **environ;

enum cs_status cs_subprocess_run(const char *folder, const char *const *arguments, bool quiet,
                                 struct cs_subprocess_result *end, struct cs_error *error) {
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status = -1;
    *end = (struct cs_subprocess_result){0};
    if (posix_spawn_file_actions_init(&actions))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a program to run");
    if (!posix_spawn_file_actions_addchdir_np(&actions, folder) &&
        (!quiet || !posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", 1, 0)) &&
        !posix_spawnp(&child, arguments[0], &actions, NULL, (char *const *)arguments, environ))
        end->was_found = true;
    /* a signal of the terminal reaches both: the other program ends by itself */
    pid_t ended = -1;
    while (end->was_found && (ended = waitpid(child, &status, 0)) < 0 && errno == EINTR)
        ;
    end->exited_ok =
        end->was_found && ended == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    posix_spawn_file_actions_destroy(&actions);
    return CS_OK;
}

/* Starts the program with `end` of the pipe as its standard output. The pipe's own descriptors
 * are closed in it by FD_CLOEXEC. Returns 0 or an errno. */
static int spawn(struct cs_subprocess *program, const char *const *arguments, bool quiet,
                 int end) {
    posix_spawn_file_actions_t actions;
    pid_t child = 0;
    int reason = posix_spawn_file_actions_init(&actions);
    if (reason)
        return reason;
    reason = posix_spawn_file_actions_adddup2(&actions, end, 1);
    if (!reason && quiet)
        reason = posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", 1, 0);
    if (!reason)
        reason = posix_spawnp(&child, arguments[0], &actions, NULL, (char *const *)arguments,
                              environ);
    posix_spawn_file_actions_destroy(&actions);
    program->pid = reason ? 0 : child;
    return reason;
}

enum cs_status cs_subprocess_open(struct cs_subprocess *program, const char *const *arguments,
                                  bool quiet, struct cs_error *error) {
    int ends[2];
    *program = (struct cs_subprocess){0};
    if (pipe(ends))
        return cs_fail(error, cs_file_status(errno), "cannot make a pipe: %s", strerror(errno));
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    const int reason = spawn(program, arguments, quiet, ends[1]);
    close(ends[1]);
    program->output = reason ? NULL : fdopen(ends[0], "r");
    const int why = reason ? reason : errno;
    if (program->output)
        return CS_OK;
    close(ends[0]);
    cs_subprocess_close(program);
    return cs_fail(error, cs_file_status(why), "cannot run %s: %s", arguments[0],
                   strerror(why));
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

/* Runs gnuplot on a script if the program is installed. */

enum cs_status cs_gnuplot_run(const char *folder, const char *script, bool *drawn,
                              struct cs_error *error) {
    struct cs_subprocess_result end;
    /* quiet: its warnings about fonts would only confuse the user */
    const enum cs_status status = cs_subprocess_run(
        folder, (const char *const[]){"gnuplot", script, NULL}, true, &end, error);
    *drawn = end.exited_ok;
    return status;
}
