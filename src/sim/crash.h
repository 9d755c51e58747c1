/* crash.h - says which foreign code it was when that brings the program down, by a fatal signal
 * or by ending it, and notes which calls are under way for a process that watches from outside.
 *
 * Round every call into a module. What a module breaks beside it, and is found later, cannot be
 * told from our own fault and is left to the debugger. */
#ifndef CS_CRASH_H
#define CS_CRASH_H

#include "base/status.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/types.h>

/* Methods are called on one thread, renderers on another. */
enum cs_crash_side { CS_CRASH_METHOD, CS_CRASH_DRAWING, CS_CRASH_SIDES };

/* The last call of a side. */
struct cs_crash_call {
    char name[512];
    const char *kind, *place; /* texts that do not change */
    pthread_t thread;
    pid_t process;
    atomic_uint call_parity; /* begins and ends of calls: odd while one is under way */
    int signal;              /* that it crashed by; 0: none */
    bool out_of_memory;      /* memory ran out in it */
};

/* Zeroed: no calls yet. */
struct cs_crash_log {
    struct cs_crash_call calls[CS_CRASH_SIDES];
};

/* From here on a fatal signal, and an exit, prints one line (`integrator "rk4" crashed in
 * advance: it aborted`) and ends the program with the exit code of a module that cannot be
 * used, or that of memory where an allocation had failed. Kind and place must be constants. */
void cs_crash_watch(enum cs_crash_side side, const char *kind, const char *name,
                    const char *place);

/* The call is over. A copy of the process that it made ends here. */
void cs_crash_forget(enum cs_crash_side side);

/* Another module, or another object of it: what failed before does not matter any more. */
void cs_crash_begin(enum cs_crash_side side);
/* true: an allocation failed in a call since then. What goes on without may crash much later.
 */
bool cs_crash_was_starved(enum cs_crash_side side);

/* Calls are noted there from now on, in memory that another process sees, and that one is left
 * to tell how this one ended. */
void cs_crash_log_to(struct cs_crash_log *log);

static inline bool cs_crash_is_under_way(const struct cs_crash_call *call) {
    return atomic_load(&call->call_parity) % 2;
}

/* Tells how a process ended by the log that it noted its calls in. end: as of wait, and no
 * success. CS_ERR_MODULE; CS_ERR_MEMORY where an allocation had failed; CS_ERR_INTERNAL: it
 * made no calls. */
enum cs_status cs_crash_report_print(const struct cs_crash_log *log, int end,
                                     struct cs_error *error);

#endif
