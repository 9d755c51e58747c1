/* subprocess.h - runs another program where it is installed. */
#ifndef CS_SUBPROCESS_H
#define CS_SUBPROCESS_H

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

/* How a program ended. */
struct cs_subprocess_result {
    bool was_found; /* it is on PATH and was started */
    bool exited_ok; /* and ended with exit code 0 */
};

/* Runs arguments[0], looked for on PATH, with `folder` as its working directory, and waits for
 * it; arguments are closed by NULL. quiet: what it says on standard error is thrown away. It
 * may be absent or refuse, which is no failure here. CS_ERR_MEMORY. */
enum cs_status cs_subprocess_run(const char *folder, const char *const *arguments, bool quiet,
                                 struct cs_subprocess_result *end, struct cs_error *error);

/* A program that runs on while what it writes on standard output is read. */
struct cs_subprocess {
    pid_t pid; /* 0: none */
    FILE *output;
};
/* Starts arguments[0], looked for on PATH, closed by NULL. CS_ERR_FILE. */
enum cs_status cs_subprocess_open(struct cs_subprocess *program, const char *const *arguments,
                                  bool quiet, struct cs_error *error);
/* Waits for its end, or ends it where what it writes was not read to the end; returns its exit
 * code, -1 where a signal ended it. Safe on a zeroed one. */
int cs_subprocess_close(struct cs_subprocess *program);

#endif
