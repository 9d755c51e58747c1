/* program.h - runs another program where it is installed. */
#ifndef CS_PROGRAM_H
#define CS_PROGRAM_H

#include "base/status.h"

#include <stdbool.h>

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

#endif
