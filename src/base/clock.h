/* clock.h - the only clocks of the program. Their values must never reach the state. */
#ifndef CS_CLOCK_H
#define CS_CLOCK_H

#include <sys/types.h>

double cs_clock_wall(void); /* s, monotonic */
double cs_clock_cpu(void);  /* s of this process */
/* s of processor time of another process; 0 if it has ended */
double cs_clock_cpu_of(pid_t process);

#endif
