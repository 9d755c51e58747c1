/* host.h - the calls that a method may make, over the model: counted, timed, checked. */
#ifndef CS_HOST_H
#define CS_HOST_H

#include "model/commit/contact.h"
#include "model/commit/reach.h"
#include "model/event/events.h"
#include "model/solver/linear.h"
#include "sim/bound.h"
#include "sim/budget.h"
#include "sim/guard.h"
#include "sim/left.h"
#include "sim/run_state.h"

struct cs_run_host {
    struct cs_host calls;    /* what the method sees */
    struct cs_run *run;      /* borrowed: counts, outcome, notes */
    struct cs_linear linear; /* only with CS_NEED_SOLVE */
    double *kept_x; /* (3,n) where solve_setup was, for the fall-back to CS_SOLVE_PSD */
    double *kept_v; /* (3,n) its velocity; NULL: no force's share of the matrix depends on it */
    double *rate_work;         /* (2n); NULL where no force has bounds at a state alone */
    bool clamped;              /* the matrix in use is positive definite by construction */
    struct cs_contact contact; /* only with contact by projection */
    double reach;  /* m, to which a step may go behind a surface, of contact by projection */
    bool creating; /* the method may take memory */
    struct cs_run_settings settings;
    struct cs_budget budget;
    void *self;             /* the method's own */
    struct cs_stats before; /* counted before the checkpoint that the run goes on from */
    struct cs_error error;  /* the method's first message */
    struct cs_bound bound;
    struct cs_left left;
    struct cs_arena arena; /* the method's memory and the solver's */
};

/* Fills the calls for a run over system. CS_ERR_MEMORY. */
enum cs_status cs_run_host_init(struct cs_run_host *host, struct cs_run *run,
                                struct cs_error *error);

/* Replaces the call solve by one that fails. */
void cs_run_host_fail_solves(struct cs_run_host *host);

/* What happens at time t: the state, the pins and the values change, and so does the bound of
 * the kinetic energy. true: the method must be restarted; false: nothing changed. */
bool cs_run_host_apply_events(struct cs_run_host *host, double t);

#endif
