/* crash.h - names the foreign code that brings the program down, by a fatal signal or by
 * ending it, and logs which calls are under way for a process that watches from outside.
 *
 * Every call into a module stands between cs_crash_watch and cs_crash_forget. Damage that a
 * module does outside its calls, found later, cannot be told from a fault of the program:
 * that is left to the debugger. */
#ifndef CS_CRASH_H
#define CS_CRASH_H

#include "base/status.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/types.h>

/* Methods are called on one thread, renderers on another: each has its own record. */
enum cs_crash_side { CS_CRASH_METHOD, CS_CRASH_DRAWING, CS_CRASH_SIDES };

/* The last call of a side. It may lie in memory shared with another process. */
struct cs_crash_call {
    char name[512];           /* of the module or integrator, cut to fit */
    const char *kind, *place; /* constant texts: "integrator", "in advance" */
    pthread_t thread;         /* that called */
    pid_t process;            /* that called: a fork of the module has another */
    atomic_uint call_parity;  /* begins and ends of calls: odd while one is under way */
    atomic_uint host_parity;  /* begins and ends of the host's work for it: odd while at work */
    int signal; /* the fatal signal; 0: none; -1: it called exit; -2: it changed `place` */
    bool out_of_memory; /* memory ran out in it */
};

/* The calls of both sides. Zeroed: no calls yet. */
struct cs_crash_log {
    struct cs_crash_call calls[CS_CRASH_SIDES];
    int own_signal; /* the fatal signal of the program itself, in no call; 0: none */
};

/* A call begins. Until cs_crash_forget a fatal signal or an exit prints one line (`integrator
 * "rk4" crashed in advance: it aborted`) and ends the program. The exit code is that of a
 * module that cannot be used, or that of memory if an allocation had failed. kind and place
 * must be constants; name is copied. */
void cs_crash_watch(enum cs_crash_side side, const char *kind, const char *name,
                    const char *place);

/* The call is over. If it forked, the copy of the process ends here. */
void cs_crash_forget(enum cs_crash_side side);

/* Ends the program like a crash does, for a change of the process in destroy, which has no
 * status: `integrator "rk4" changed the working folder in destroy`. what: a constant. */
_Noreturn void cs_crash_end(enum cs_crash_side side, const char *what);

/* Forgets failed allocations: another module, or another object of it, begins. */
void cs_crash_begin(enum cs_crash_side side);
/* Returns true if an allocation failed in a call since cs_crash_begin. Code that ignores that
 * may crash much later. */
bool cs_crash_was_starved(enum cs_crash_side side);

/* The host begins or ends work that the method asked for. */
void cs_crash_note_host(void);

/* Logs calls in *log from now on, memory that another process sees. That process then reports
 * how this one ended: this one stays silent. */
void cs_crash_log_to(struct cs_crash_log *log);

/* Sends what methods write to standard output from now on to standard error: that of this
 * process has results. */
void cs_crash_divert_output(void);

/* True between watch and forget. */
static inline bool cs_crash_is_running(const struct cs_crash_call *call) {
    return atomic_load(&call->call_parity) % 2;
}

/* Reports how a process ended, from the log of its calls. end: its status as wait gives it,
 * not a success. Returns CS_ERR_MODULE, CS_ERR_MEMORY if an allocation had failed, or
 * CS_ERR_INTERNAL if it crashed in no call or made none; the message is in *error. */
enum cs_status cs_crash_report_print(const struct cs_crash_log *log, int end,
                                     struct cs_error *error);

#endif
