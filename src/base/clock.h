/* clock.h - the only clocks of the program. Their values must never reach the state. */
#ifndef CS_CLOCK_H
#define CS_CLOCK_H

double cs_clock_wall(void); /* s, monotonic */
double cs_clock_cpu(void);  /* s of this process */

#endif
