/* crash.h - says which integrator it was when foreign code brings the program down.
 *
 * Only round the first call into a module, where one that was built against something else
 * fails; later crashes are left to the debugger. */
#ifndef CS_CRASH_H
#define CS_CRASH_H

/* From here on a fatal signal prints one line with the integrator's name and ends the program
 * with the exit code of a module that cannot be used. */
void cs_crash_watch(const char *integrator);

/* Puts the earlier handlers back. */
void cs_crash_forget(void);

#endif
