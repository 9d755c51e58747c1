/* Limits the processor time of a run, at little cost a step. */
#include "sim/budget.h"

#include "base/clock.h"

void cs_budget_start(struct cs_budget *budget, double cpu_seconds) {
    *budget = (struct cs_budget){
        .end = cs_clock_cpu() + cpu_seconds, .last = cs_clock_wall(), .between = 1};
}

/* The clock of the process is a system call: it is read about once a millisecond. */
bool cs_budget_is_over(struct cs_budget *budget) {
    enum { MOST_BETWEEN = 1024 };
    if (budget->end == 0 || ++budget->steps < budget->between)
        return false;
    const double now = cs_clock_wall();
    const bool seldom = now - budget->last > 1e-3;
    budget->between = seldom ? budget->between / 2 : budget->between * 2;
    budget->between = budget->between < 1              ? 1
                      : budget->between > MOST_BETWEEN ? MOST_BETWEEN
                                                       : budget->between;
    budget->last = now;
    budget->steps = 0;
    return cs_clock_cpu() > budget->end;
}
