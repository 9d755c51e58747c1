/* guard.h - keeps what belongs to the whole process as it was round foreign code: the
 * floating-point mode, the locale, what signals do, the working folder, the standard streams.
 *
 * A module linked with fast-math switches flush-to-zero on for the whole process when it is
 * loaded; from then on no hash could be trusted. */
#ifndef CS_GUARD_H
#define CS_GUARD_H

#include <signal.h>
#include <stdbool.h>
#include <sys/types.h>

enum { CS_GUARD_SIGNALS = 2 };

struct cs_guard {
    unsigned
        control; /* bits of the mode: rounding, masks, flush-to-zero; not the sticky flags */
    int rounding;
    struct sigaction signals[CS_GUARD_SIGNALS];
    dev_t device; /* of the working folder */
    ino_t number;
    unsigned streams; /* a bit for each standard stream that is open */
    bool parent;      /* there are processes that this one made */
};

/* "the floating-point mode" */
extern const char cs_guard_mode[];

struct cs_guard cs_guard_take(void);
/* Puts back what can be; what had been changed, as cs_guard_mode, or NULL. */
const char *cs_guard_restore(const struct cs_guard *guard);

#endif
