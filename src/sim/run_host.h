/* run_host.h - what stands behind the calls of a method, for those who make them. */
#ifndef CS_RUN_HOST_H
#define CS_RUN_HOST_H

#include "base/clock.h"
#include "model/contact/ccd/blocked_step.h"
#include "model/event/events.h"
#include "model/post_step/contact_projection.h"
#include "model/post_step/step_bound.h"
#include "model/solver/linear.h"
#include "sim/advance_check.h"
#include "sim/blow_up_check.h"
#include "sim/budget.h"
#include "sim/process_state.h"
#include "sim/run_state.h"

struct cs_run_host {
    struct cs_host table;    /* what the method sees */
    struct cs_run *run;      /* borrowed: counts, outcome, notes */
    struct cs_linear linear; /* only with CS_NEED_SOLVE */
    double *setup_x; /* (3,n) where solve_setup was, for the fall-back to CS_SOLVE_PSD */
    double
        *setup_v; /* (3,n) its velocity; NULL: no force's share of the matrix depends on it */
    double *bounds_work; /* (2n); NULL where no force has bounds at a state alone */
    struct cs_contact_projection contact; /* only with contact by projection */
    double penetration_max; /* m, to which a step may go behind a surface, of contact by
                               projection */
    bool creating;          /* the method may take memory */
    struct cs_process_state process_state; /* the process as it was before the first call */
    struct cs_run_settings settings;
    struct cs_budget budget;
    void *self;                   /* the method's own */
    struct cs_stats stats_before; /* counted before the checkpoint that the run goes on from */
    struct cs_error error;        /* the method's first message */
    struct cs_blow_up_check blow_up;
    struct cs_blocked_step blocked_step;
    struct cs_advance_check advance_check;
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
