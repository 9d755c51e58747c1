/* interrupt.h - SIGINT and SIGTERM as a request to stop at the next step. */
#ifndef CS_INTERRUPT_H
#define CS_INTERRUPT_H

#include <signal.h>

/* Catches both from now on; what is pointed to becomes 1 with the first one. Should that not be
 * heard, another one two seconds later or more ends the program at once. A closed pipe becomes
 * an error of the write. */
const volatile sig_atomic_t *cs_interrupt_catch(void);

#endif
