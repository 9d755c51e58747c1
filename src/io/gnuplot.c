/* Runs gnuplot on a script if the program is installed. */
#include "io/gnuplot.h"

#include <spawn.h>
#include <sys/wait.h>

extern char **environ;

enum cs_status cs_gnuplot_run(const char *folder, const char *script, bool *drawn,
                              struct cs_error *error) {
    char *arguments[] = {"gnuplot", (char *)script, NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status = -1;
    *drawn = false;
    if (posix_spawn_file_actions_init(&actions))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a program to run");
    /* its warnings about fonts would only confuse the user */
    if (!posix_spawn_file_actions_addchdir_np(&actions, folder) &&
        !posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", 1, 0) &&
        !posix_spawnp(&child, "gnuplot", &actions, NULL, arguments, environ) &&
        waitpid(child, &status, 0) == child)
        *drawn = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    posix_spawn_file_actions_destroy(&actions);
    return CS_OK;
}
