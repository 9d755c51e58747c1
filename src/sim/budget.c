/* budget.c - reads the clocks seldom enough to cost nothing per step. */
#include "sim/budget.h"

#include "base/clock.h"

void cs_budget_start(struct cs_budget *budget, double cpu_seconds) {
    *budget = (struct cs_budget){.end = cs_clock_cpu() + cpu_seconds,
                                 .last_check = cs_clock_wall(),
                                 .check_interval = 1};
}

/* Reads the clock about once per millisecond, as the clock of the process is a system call.
 * The interval halves if the last one took longer and doubles if it took less, up to 1024
 * steps. */
bool cs_budget_is_over(struct cs_budget *budget) {
    enum { MOST_BETWEEN = 1024 };
    if (budget->end == 0 || ++budget->steps < budget->check_interval)
        return false;
    const double now = cs_clock_wall();
    const bool seldom = now - budget->last_check > 1e-3;
    budget->check_interval = seldom ? budget->check_interval / 2 : budget->check_interval * 2;
    budget->check_interval = budget->check_interval < 1              ? 1
                             : budget->check_interval > MOST_BETWEEN ? MOST_BETWEEN
                                                                     : budget->check_interval;
    budget->last_check = now;
    budget->steps = 0;
    return cs_clock_cpu() > budget->end;
}
