/* The program's only clocks: monotonic wall time and processor time. */
#include "base/clock.h"

#include <time.h>

static double seconds_of(clockid_t clock) {
    struct timespec now = {0};
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double cs_clock_wall(void) {
    return seconds_of(CLOCK_MONOTONIC);
}

double cs_clock_cpu_of(pid_t process) {
    clockid_t clock;
    return clock_getcpuclockid(process, &clock) ? 0 : seconds_of(clock);
}

double cs_clock_cpu(void) {
    return seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}
