/* Runs another program and waits for it. */
#include "io/program.h"

#include <errno.h>
#include <spawn.h>
#include <stddef.h>
#include <sys/wait.h>

extern char **environ;

enum cs_status cs_program_run(const char *folder, const char *const *arguments, bool quiet,
                              struct cs_program_end *end, struct cs_error *error) {
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status = -1;
    *end = (struct cs_program_end){0};
    if (posix_spawn_file_actions_init(&actions))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a program to run");
    if (!posix_spawn_file_actions_addchdir_np(&actions, folder) &&
        (!quiet || !posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", 1, 0)) &&
        !posix_spawnp(&child, arguments[0], &actions, NULL, (char *const *)arguments, environ))
        end->found = true;
    /* a signal goes to both: the other program ends by itself */
    pid_t ended = -1;
    while (end->found && (ended = waitpid(child, &status, 0)) < 0 && errno == EINTR)
        ;
    end->done = end->found && ended == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    posix_spawn_file_actions_destroy(&actions);
    return CS_OK;
}
