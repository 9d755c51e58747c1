/* unit.h - what unit tests ask besides what Check has. */
#ifndef UNIT_H
#define UNIT_H

#include "../suite.h"

#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* For loops of very many rounds: Check writes to a file at every assertion that holds. */
#define UNIT_ASSERT_OFTEN(condition)                                                           \
    do {                                                                                       \
        if (!(condition))                                                                      \
            ck_abort_msg("%s", #condition);                                                    \
    } while (0)

/* Files in a folder, without . and .. */
static inline int unit_count_files(const char *folder) {
    int n = 0;
    DIR *entries = opendir(folder);
    ck_assert_ptr_nonnull(entries);
    for (const struct dirent *entry; (entry = readdir(entries));)
        n += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(entries);
    return n;
}

/* fails unless the call, in a process of its own, aborts at an assertion */
#define UNIT_ASSERT_ABORTS(call)                                                               \
    do {                                                                                       \
        int end_ = 0;                                                                          \
        const pid_t child_ = fork();                                                           \
        if (!child_) {                                                                         \
            setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});                                    \
            signal(SIGABRT, SIG_DFL);                                                          \
            close(STDERR_FILENO);                                                              \
            call;                                                                              \
            _exit(0);                                                                          \
        }                                                                                      \
        waitpid(child_, &end_, 0);                                                             \
        ck_assert_msg(WIFSIGNALED(end_) && WTERMSIG(end_) == SIGABRT, "%s does not abort",     \
                      #call);                                                                  \
    } while (0)

/* fails unless the call failed so, with a message that has all of part in it */
#define UNIT_ASSERT_FAILED(error, status_, part)                                               \
    ck_assert_msg((error)->status == (status_) && strstr((error)->message, part),              \
                  "found %d \"%s\", expected %d \"%s\"", (int)(error)->status,                 \
                  (error)->message, (int)(status_), part)
#define UNIT_ASSERT_OK(error) ck_assert_msg(!(error)->status, "%s", (error)->message)

#endif
