/* interrupt.h - turns SIGINT and SIGTERM into a request to stop at the next step. */
#ifndef CS_INTERRUPT_H
#define CS_INTERRUPT_H

#include <signal.h>

/* Catches both signals from now on. Returns a flag that becomes 1 with the first one. A second
 * one after two seconds or more ends the program at once. Writing to a closed pipe becomes an
 * error of the write (SIGPIPE is ignored). */
const volatile sig_atomic_t *cs_interrupt_catch(void);

#endif
