/* process_state.h - keeps what belongs to the whole process as it was round foreign code: the
 * floating-point mode, the locale, what signals do, the working folder, the standard streams.
 *
 * A module linked with fast-math switches flush-to-zero on for the whole process when it is
 * loaded; from then on no hash could be trusted. */
#ifndef CS_PROCESS_STATE_H
#define CS_PROCESS_STATE_H

#include <signal.h>
#include <stdbool.h>
#include <sys/types.h>

enum { CS_PROCESS_STATE_SIGNALS = 2 };

struct cs_process_state {
    unsigned
        fp_control; /* bits of the mode: rounding, masks, flush-to-zero; not the sticky flags */
    int rounding;
    struct sigaction signals[CS_PROCESS_STATE_SIGNALS];
    dev_t cwd_device; /* of the working folder */
    ino_t cwd_inode;
    unsigned streams;  /* a bit for each standard stream that is open */
    bool has_children; /* there are processes that this one made */
};

/* "the floating-point mode" */
extern const char cs_process_state_mode[];

struct cs_process_state cs_process_state_save(void);
/* Puts back what can be; what had been changed, as cs_process_state_mode, or NULL. */
const char *cs_process_state_restore(const struct cs_process_state *guard);

#endif
