/* run_host.h - what stands behind the calls of a method, for those who make them. */
#ifndef CS_RUN_HOST_H
#define CS_RUN_HOST_H

#include "base/clock.h"
#include "model/commit/contact.h"
#include "model/commit/reach.h"
#include "model/event/events.h"
#include "model/solver/linear.h"
#include "sim/blocked.h"
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
    struct cs_contact contact; /* only with contact by projection */
    double reach;  /* m, to which a step may go behind a surface, of contact by projection */
    bool creating; /* the method may take memory */
    struct cs_guard guard; /* the process as it was before the first call */
    struct cs_run_settings settings;
    struct cs_budget budget;
    void *self;             /* the method's own */
    struct cs_stats before; /* counted before the checkpoint that the run goes on from */
    struct cs_error error;  /* the method's first message */
    struct cs_bound bound;
    struct cs_blocked blocked;
    struct cs_left left;
    struct cs_arena arena; /* the method's memory and the solver's */
};

/* Times of stages are taken only where they are asked for. */
static inline double cs_stage_begin(const struct cs_run_host *host) {
    return host->settings.timed ? cs_clock_wall() : 0;
}

static inline void cs_stage_end(struct cs_run_host *host, enum cs_stage stage, double begin) {
    if (host->settings.timed)
        host->run->stage_seconds[stage] += cs_clock_wall() - begin;
}

/* Ramps move on with every time that the method asks about. */
static inline void cs_move_values(struct cs_run_host *host, double t) {
    if (host->run->system->events)
        cs_events_move_values(host->run->system, t);
}

#endif
