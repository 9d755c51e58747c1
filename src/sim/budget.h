/* budget.h - limit on the processor time of a run, checked every few steps. */
#ifndef CS_BUDGET_H
#define CS_BUDGET_H

#include <stdbool.h>
#include <stdint.h>

/* Processor time and the rhythm of its checks. Zeroed: no limit. */
struct cs_budget {
    double end;              /* s of cs_clock_cpu; 0: no limit */
    double last_check;       /* s of cs_clock_wall, at the last check */
    uint32_t steps;          /* steps since the last check */
    uint32_t check_interval; /* steps between two checks, 1 to 1024 */
};

/* Grants cpu_seconds of processor time of the whole process, from now on. */
void cs_budget_start(struct cs_budget *budget, double cpu_seconds);
/* Returns true if the time is used up. Call it after every step: most calls only count. */
bool cs_budget_is_over(struct cs_budget *budget);

#endif
