/* run_state.h - how a run is begun, and how it stands: what the host fills while it steps. */
#ifndef CS_RUN_STATE_H
#define CS_RUN_STATE_H

#include "base/trace_stream.h"
#include "model/system/system.h"

#include <clothsim/integrator.h>
#include <signal.h>

/* How a run stands. All but the first end it; none of them is an error. CS_FAILED stands in
 * results only: a run says by an error that its method gave up. */
#define CS_OUTCOME_LIST(X)                                                                     \
    X(CS_RUNNING, "finished")                                                                  \
    X(CS_NOT_FINITE, "blew up: not finite")                                                    \
    X(CS_UNBOUNDED, "blew up: unbounded energy")                                        \
    X(CS_INTERRUPTED, "interrupted")                                                           \
    X(CS_OVER_BUDGET, "over budget")                                                           \
    X(CS_FAILED, "failed")
enum cs_outcome {
#define X(name, text) name,
    CS_OUTCOME_LIST(X)
#undef X
};

static inline bool cs_outcome_is_blow_up(enum cs_outcome outcome) {
    return outcome == CS_NOT_FINITE || outcome == CS_UNBOUNDED;
}

/* Stages that the host times, when asked to. */
enum cs_stage {
    CS_STAGE_FORCE,
    CS_STAGE_SOLVE,
    CS_STAGE_CONTACT,
    CS_STAGE_LIMIT,
    CS_STAGE_NORMALS,
    CS_STAGES
};

/* Exact counts, the same on every machine. */
struct cs_counts {
    uint64_t steps, forces, energies, jvps, diagonals, solve_setups, solves, solve_iterations;
    uint64_t
        clamped_setups; /* solver set-ups that fell back to CS_SOLVE_PSD or CS_SOLVE_BOUND */
    uint64_t projected_particles; /* particles pushed out */
    uint64_t subdivided_steps;    /* moves that were too long for contact or crossings */
    uint64_t contact_tests;       /* particle-collider pairs tested */
    uint64_t strain_limit_moves;  /* springs shortened by the strain limit */
    uint64_t normals;             /* times that normals were computed in a step */
    struct cs_stats method;       /* what the method counted itself */
};

struct cs_blow_up {
    double time;          /* s */
    uint32_t particle;    /* the first not finite, or the fastest */
    double energy, bound; /* kinetic energy and its bound in J */
};

enum { CS_NOTES_MAX = 8 };

struct cs_energy_ledger;
struct cs_run_host;

/* Must stay where it is between begin and finish. */
struct cs_run {
    struct cs_system *system; /* borrowed */
    const struct cs_integrator *integrator;
    double *x, *v;  /* the state: x (3,n), v = x + 3n */
    double t;       /* s */
    uint32_t frame; /* frames done */
    enum cs_outcome outcome;
    struct cs_blow_up blow_up; /* where outcome says so */
    struct cs_counts counts;
    double stage_seconds[CS_STAGES]; /* all 0 unless timed */
    double advance_seconds;          /* wall time inside the method */
    struct cs_plan plan;             /* the system's, with the bytes of the run's own arrays */
    size_t method_bytes;             /* of arrays that the method took from the host */
    char notes[CS_NOTES_MAX][160];   /* remarks of the method */
    uint32_t n_notes;
    struct cs_run_host *host; /* owned */
};

/* Is told each array that a method and the host hand each other, and each state that a
 * correction after a step leaves: see sim/trace.h. */
struct cs_trace {
    void (*emit)(void *ctx, const struct cs_trace_record *point);
    void *ctx;
    bool enabled; /* may be set and cleared between frames */
};

/* How a run is begun. Zeroed: as the system stands, without clock, limit or observer. */
struct cs_run_settings {
    bool timed; /* stage times too */
    /* what the method leaves behind is not looked at: for checks that measure it themselves */
    bool skip_advance_check;
    const volatile sig_atomic_t *stop; /* set by a signal handler; may be NULL */
    /* s of processor time from the first step on, after which the run ends as CS_OVER_BUDGET;
     * 0: no limit. The clock is read between steps and never reaches the state. */
    double budget;
    /* Called at the end of every commit, and may move the state: returns whether it did. May be
     * NULL. */
    bool (*after_commit)(void *ctx, double t, double dt, double *x, double *v);
    void *ctx;                       /* of observe */
    struct cs_energy_ledger *ledger; /* kept step by step, see energy_ledger.h; NULL: none */
    struct cs_trace *trace;          /* NULL: none */
};

#endif
