/* process_state.h - guards what foreign code must not change. Saves and restores the state that
 * belongs to the whole process: floating-point mode, locale, signal handlers, working folder,
 * standard streams. Shows modules from outside the system on pages that they cannot write.
 *
 * A module linked with fast-math switches flush-to-zero on for the whole process when it is
 * loaded. From then on no hash could be trusted. */
#ifndef CS_PROCESS_STATE_H
#define CS_PROCESS_STATE_H

#include "base/status.h"

#include <clothsim/integrator.h>

#include <signal.h>
#include <stdbool.h>
#include <sys/types.h>

/* The signals that ask a program to end: SIGINT, SIGTERM, SIGHUP, SIGXCPU (the processor time
 * of a shell or a batch system is used up) and SIGUSR1 (a batch system's warning). */
enum { CS_INTERRUPTS = 5 };
extern const int cs_interrupts[CS_INTERRUPTS];

/* A snapshot; compare it with the process after the foreign call. */
struct cs_process_state {
    unsigned
        fp_control; /* bits of the mode: rounding, masks, flush-to-zero; not the sticky flags */
    int rounding;   /* of fegetround */
    struct sigaction signals[CS_INTERRUPTS]; /* of cs_interrupts */
    dev_t cwd_device;                        /* of the working folder */
    ino_t cwd_inode;                         /* of the working folder */
    unsigned streams;                        /* a bit for each standard stream that is open */
    bool has_children; /* this process has child processes, running or not waited for */
};

/* "the floating-point mode": returned by address, to tell it from the other changes. */
extern const char cs_process_state_mode[];

/* The state now. */
struct cs_process_state cs_process_state_save(void);
/* Restores the mode, the handlers and the locale. Returns the name of the first change found,
 * a constant such as cs_process_state_mode, or NULL. Folder, streams and child processes are
 * detected only: nothing here can undo them. */
const char *cs_process_state_restore(const struct cs_process_state *state);

/* A copy of the view of a system on pages that nobody can write while a method runs. A module
 * from outside gets it: if it writes to what is const, it is named by its crash, and no other
 * number of the run is wrong. */

/* Zeroed: none, and all calls do nothing. */
struct cs_view_pages {
    struct cs_view *view; /* the copy; owned, with all arrays behind it */
    size_t bytes;
};

/* True if the integrator is neither the program's own nor installed with it. */
bool cs_view_pages_needed(const struct cs_integrator *integrator);

/* CS_ERR_MEMORY. */
enum cs_status cs_view_pages_create(struct cs_view_pages *pages, const struct cs_view *view,
                                    struct cs_error *error);
/* Copies again what pins, ramps and moves have changed. */
void cs_view_pages_update(struct cs_view_pages *pages, const struct cs_view *view);
void cs_view_pages_finish(struct cs_view_pages *pages);

#endif
