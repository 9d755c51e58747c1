/* subprocess.h - runs another program if it is installed. */
#ifndef CS_SUBPROCESS_H
#define CS_SUBPROCESS_H

#include "base/status.h"
#include "base/text.h"

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

/* How a program ended. */
struct cs_subprocess_result {
    bool was_found; /* it is on PATH and was started */
    bool exited_ok; /* and ended with exit code 0 */
};

/* Runs arguments[0], searched on PATH, in the working directory `folder`, and waits for it;
 * arguments end with NULL. A program that is missing or fails is reported in the result. Once
 * *stop is set it is asked to end. */
struct cs_subprocess_result cs_subprocess_run(const char *folder, const char *const *arguments,
                                              const volatile sig_atomic_t *stop);

/* A child process of which one stream is read through a pipe. */
struct cs_subprocess {
    pid_t pid;    /* 0: none */
    int reason;   /* errno if it could not be started */
    FILE *output; /* the stream, owned */
};

/* Starts arguments[0], searched on PATH, in the working directory `folder`; arguments end with
 * NULL. stream: 1 to read its standard output, 2 its standard error. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_subprocess_open(struct cs_subprocess *process, const char *folder,
                                  const char *const *arguments, int stream,
                                  struct cs_error *error);

/* Waits for its end; kills it first if its output was not read to the end. Returns its exit
 * code, or -1 if a signal ended it. Safe on a zeroed one. */
int cs_subprocess_close(struct cs_subprocess *process);

#endif
