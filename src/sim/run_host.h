/* run_host.h - the host's private data behind the calls of a method; for the files that
 * implement these calls. */
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

/* One per run, owned by struct cs_run; ctx of the method's calls. */
struct cs_run_host {
    struct cs_host table;    /* the calls that the method sees */
    struct cs_run *run;      /* borrowed: counts, outcome, notes */
    struct cs_linear linear; /* only with CS_NEED_SOLVE */
    double
        *setup_x; /* (3,n) in m: positions at the last solve_setup, for a clamped second one */
    double
        *setup_v; /* (3,n) in m/s: its velocities; NULL: no part of the matrix depends on v */
    double *bounds_work; /* (2n) scratch; NULL: no force has bounds at a state alone */
    struct cs_contact_projection contact; /* only with contact by projection */
    double penetration_max; /* m behind a surface that a step may end, of contact by
                               projection; HUGE_VAL: any */
    bool creating;          /* in create: the method may take memory */
    struct cs_process_state process_state; /* the process as it was before the first call */
    struct cs_run_settings settings;
    struct cs_budget budget;
    void *self;                   /* the method's object */
    struct cs_stats stats_before; /* the method's counts before the loaded checkpoint */
    struct cs_error error;        /* the method's first message */
    struct cs_blow_up_check blow_up;
    struct cs_blocked_step blocked_step; /* the last step that crossings refused */
    struct cs_advance_check advance_check;
    struct cs_arena arena; /* memory of the method and of the solver */
};

/* Wall time in s at the begin of a stage; 0 without settings.timed: no clock is read then. */
static inline double cs_stage_begin(const struct cs_run_host *host) {
    return host->settings.timed ? cs_clock_wall() : 0;
}

/* Adds the time since begin to a stage. */
static inline void cs_stage_end(struct cs_run_host *host, enum cs_stage stage, double begin) {
    if (host->settings.timed)
        host->run->stage_seconds[stage] += cs_clock_wall() - begin;
}

/* Sets ramped values to those at t, the time that the method asks about. */
static inline void cs_move_values(struct cs_run_host *host, double t) {
    if (host->run->system->events)
        cs_events_move_values(host->run->system, t);
}

#endif
