/* guard.h - keeps the floating-point mode as it was round foreign code.
 *
 * A module linked with fast-math switches flush-to-zero on for the whole process when it is
 * loaded; from then on no hash could be trusted. */
#ifndef CS_GUARD_H
#define CS_GUARD_H

#include <stdbool.h>

/* Control bits of the mode: rounding, masks, flush-to-zero; not the sticky flags. */
struct cs_guard {
    unsigned control;
    int rounding;
};

struct cs_guard cs_guard_take(void);
/* Puts the mode back; true if it had been changed. */
bool cs_guard_restore(struct cs_guard guard);

#endif
