/* host.h - the calls that a method may make, over the model: counted, timed, checked. */
#ifndef CS_HOST_H
#define CS_HOST_H

#include "model/events.h"
#include "model/linear.h"
#include "sim/guard.h"
#include "sim/run.h"

/* Processor time that the run may use, looked at every few steps. */
struct cs_budget {
    double end;       /* cs_clock_cpu; 0: none */
    double last;      /* cs_clock_wall of the last look */
    uint32_t steps;   /* since then */
    uint32_t between; /* steps from one look to the next */
};

struct cs_run_host {
    struct cs_host calls;    /* what the method sees */
    struct cs_run *run;      /* borrowed: counts, outcome, notes */
    struct cs_linear linear; /* only with CS_NEED_SOLVE */
    double *kept_x; /* (3,n) where solve_setup was, for the fall-back to CS_SOLVE_PSD */
    bool clamped;   /* the matrix in use is positive definite by construction */
    bool creating;  /* the method may take memory */
    bool timed;
    const volatile sig_atomic_t *stop;
    struct cs_budget budget;
    void *self;                                  /* the method's own */
    struct cs_error error;                       /* the method's first message */
    double bound_start, bound_speed, bound_push; /* of the kinetic energy, see blow_up_bound */
    double bound_since;                          /* s, from which it holds */
    struct cs_arena arena;                       /* the method's memory and the solver's */
};

/* Fills the calls for a run over system. CS_ERR_MEMORY. */
enum cs_status cs_run_host_init(struct cs_run_host *host, struct cs_run *run,
                                struct cs_error *error);

/* What happens at time t: the state, the pins and the values change, and so does the bound of
 * the kinetic energy. The method must be restarted. */
void cs_run_host_apply_events(struct cs_run_host *host, double t);

#endif
