/* crash.h - says which module it was when foreign code brings the program down: by a fatal
 * signal, or by ending it.
 *
 * Round every call into a module. What a module breaks beside it, and is found later, cannot be
 * told from our own fault and is left to the debugger. */
#ifndef CS_CRASH_H
#define CS_CRASH_H

/* From here on a fatal signal, and an exit, prints one line (`integrator "rk4" crashed in
 * advance: it aborted`) and ends the program with the exit code of a module that cannot be
 * used. The texts must last until forget. */
void cs_crash_watch(const char *kind, const char *name, const char *place);

/* Puts the earlier handlers back. */
void cs_crash_forget(void);

#endif
