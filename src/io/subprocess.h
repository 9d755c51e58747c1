/* subprocess.h - runs another program if it is installed. */
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

/* Runs arguments[0], searched on PATH, in the working directory `folder`, and waits for it;
 * arguments end with NULL. quiet: its standard error is discarded. A program that is missing or
 * fails is reported in *end, not as a failure. CS_ERR_MEMORY. */
enum cs_status cs_subprocess_run(const char *folder, const char *const *arguments, bool quiet,
                                 struct cs_subprocess_result *end, struct cs_error *error);

/* A child process whose standard output is read through a pipe. */
struct cs_subprocess {
    pid_t pid;    /* 0: none */
    FILE *output; /* its standard output, owned */
};

/* Starts arguments[0], searched on PATH; arguments end with NULL. CS_ERR_FILE, CS_ERR_MEMORY.
 */
enum cs_status cs_subprocess_open(struct cs_subprocess *program, const char *const *arguments,
                                  bool quiet, struct cs_error *error);

/* Waits for its end; kills it first if its output was not read to the end. Returns its exit
 * code, or -1 if a signal ended it. Safe on a zeroed one. */
int cs_subprocess_close(struct cs_subprocess *program);

/* Runs gnuplot on a script if the program is installed. */

/* Runs FOLDER/SCRIPT in the working directory FOLDER. *drawn: gnuplot ran and succeeded; it may
 * be missing or fail, which is no failure here. CS_ERR_MEMORY. */
enum cs_status cs_gnuplot_run(const char *folder, const char *script, bool *drawn,
                              struct cs_error *error);

#endif
