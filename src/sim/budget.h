/* budget.h - processor time that a run may use, looked at every few steps. */
#ifndef CS_BUDGET_H
#define CS_BUDGET_H

#include <stdbool.h>
#include <stdint.h>

/* Zeroed: no limit. */
struct cs_budget {
    double end;              /* cs_clock_cpu; 0: none */
    double last_check;       /* cs_clock_wall of the last look */
    uint32_t steps;          /* since then */
    uint32_t check_interval; /* steps from one look to the next */
};

void cs_budget_start(struct cs_budget *budget, double cpu_seconds);
/* After every step. */
bool cs_budget_is_over(struct cs_budget *budget);

#endif
