/* program.h - runs another program where it is installed. */
#ifndef CS_PROGRAM_H
#define CS_PROGRAM_H

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

/* How a program ended. */
struct cs_program_end {
    bool found; /* it is on PATH and was started */
    bool done;  /* and ended with exit code 0 */
};

/* Runs arguments[0], looked for on PATH, with `folder` as its working directory, and waits for
 * it; arguments are closed by NULL. quiet: what it says on standard error is thrown away. It
 * may be absent or refuse, which is no failure here. CS_ERR_MEMORY. */
enum cs_status cs_program_run(const char *folder, const char *const *arguments, bool quiet,
                              struct cs_program_end *end, struct cs_error *error);

/* A program that runs on while what it writes on standard output is read. */
struct cs_program {
    pid_t id; /* 0: none */
    FILE *out;
};
/* Starts arguments[0], looked for on PATH, closed by NULL. CS_ERR_FILE. */
enum cs_status cs_program_open(struct cs_program *program, const char *const *arguments,
                               bool quiet, struct cs_error *error);
/* Waits for its end, or ends it where what it writes was not read to the end; returns its exit
 * code, -1 where a signal ended it. Safe on a zeroed one. */
int cs_program_close(struct cs_program *program);

#endif
