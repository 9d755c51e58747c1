/* run_state.h - the settings and the state of a run, which the host fills while it steps. */
#ifndef CS_RUN_STATE_H
#define CS_RUN_STATE_H

#include "base/trace_stream.h"
#include "model/post_step/contact_projection.h"
#include "model/system/particle_system.h"

#include <clothsim/integrator.h>
#include <signal.h>

/* How a run stands. All but the first end it, and none is an error. CS_GAVE_UP: the method
 * found no step short enough. CS_FAILED occurs in stored results only: a run reports a method
 * that failed by an error. */
#define CS_OUTCOME_LIST(X)                                                                     \
    X(CS_RUNNING, "finished")                                                                  \
    X(CS_NOT_FINITE, "blew up: not finite")                                                    \
    X(CS_UNBOUNDED, "blew up: unbounded energy")                                               \
    X(CS_INTERRUPTED, "interrupted")                                                           \
    X(CS_OVER_BUDGET, "over budget")                                                           \
    X(CS_GAVE_UP, "gave up")                                                                   \
    X(CS_FAILED, "failed")
enum cs_outcome {
#define X(name, text) name,
    CS_OUTCOME_LIST(X)
#undef X
};

/* True for the two kinds of blow-up. */
static inline bool cs_outcome_is_blow_up(enum cs_outcome outcome) {
    return outcome == CS_NOT_FINITE || outcome == CS_UNBOUNDED;
}

/* True if the method said why it did not go on. */
static inline bool cs_outcome_has_reason(enum cs_outcome outcome) {
    return outcome == CS_GAVE_UP || outcome == CS_FAILED;
}

/* Stages of a step that the host times with settings.timed; names are in cs_stage_names. */
enum cs_stage {
    CS_STAGE_FORCE,
    CS_STAGE_SETUP,
    CS_STAGE_SOLVE,
    CS_STAGE_CONTACT,
    CS_STAGE_LIMIT,
    CS_STAGE_NORMALS,
    CS_STAGES
};

/* Counts of a run: exact, and the same on every machine.
 *
 * steps counts commits. The names up to solve_iterations are calls of the host by the method:
 * force_diagonal counts as one force and one diagonal, contact_blocks as one diagonal,
 * matrix_product as one jvp. solve_iterations is the sum over all solves of
 * conjugate-gradient iterations. */
struct cs_counts {
    uint64_t steps, forces, energies, jvps, diagonals, solve_setups, solves, solve_iterations;
    uint64_t
        clamped_setups; /* solver set-ups that fell back to CS_SOLVE_PSD or CS_SOLVE_BOUND */
    uint64_t projected_particles; /* pairs of particle and collider that were projected */
    uint64_t subdivided_steps;    /* displacements with an admissible fraction below 1 */
    uint64_t contact_tests;       /* particle-collider pairs tested */
    uint64_t strain_limit_moves;  /* springs shortened by the strain limit */
    uint64_t normals;             /* times that normals were computed in a step */
    struct cs_stats method;       /* what the method counted itself */
};

/* The work of a run in passes over the forces: a force evaluation, a Jacobian product, a solver
 * iteration and a sweep of the method itself count as equal. */
static inline double cs_counts_work(const struct cs_counts *counts) {
    return (double)(counts->forces + counts->jvps + counts->solve_iterations +
                    counts->method.sweeps);
}

/* Nominal s of one pass over the forces of a system (cs_counts_work): a fixed cost of each call
 * and of each spring, which no machine and no load changes. Budgets are in these seconds. */
double cs_pass_seconds(const struct cs_system *system);

/* Where and how a run blew up. */
struct cs_blow_up {
    double time;          /* s */
    uint32_t particle;    /* the first not finite, or the fastest */
    double energy, bound; /* kinetic energy and its bound in J */
};

/* Remarks of a method that are stored; later ones are dropped. */
enum { CS_NOTES_MAX = 8 };

/* Rows of cs_energy_input.given. */
enum cs_energy_source {
    CS_SOURCE_FORCES,      /* wind, pushes, moving colliders and pins */
    CS_SOURCE_VALUES,      /* ramps, at fixed positions */
    CS_SOURCE_CORRECTIONS, /* strain limit and projection */
    CS_SOURCE_EVENTS,      /* at once, between two steps */
    CS_SOURCE_UNTANGLE,    /* what moves particles out of colliders from the start on */
    CS_ENERGY_SOURCES
};

/* The energy that the scene has given since the start of a run; negative if it took more. */
struct cs_energy_input {
    double given[CS_ENERGY_SOURCES]; /* J */
    double pinned[2]; /* J, kinetic energy of pinned particles that turn; of tangled ones */
    double values_t;  /* s, to which ramps are booked */
    /* before the corrections of the running step, in J; the potential only if it is_sampled */
    double kinetic, potential;
    double corrected_steps; /* since the last sample, this one included */
    bool is_sampled;
    double powers_work, values_work, corrections_work; /* passes, when each was booked last */
};

struct cs_energy_ledger;
struct cs_run_host;

/* A run. It must stay at its address between begin and finish. */
struct cs_run {
    struct cs_system *system; /* borrowed */
    const struct cs_integrator *integrator;
    double *x, *v;  /* the state: x (3,n), v = x + 3n */
    double t;       /* s, of the last frame */
    uint32_t frame; /* frames done */
    enum cs_outcome outcome;
    struct cs_blow_up blow_up; /* where outcome says so */
    const char *reason;        /* with CS_GAVE_UP: the method's, the host's text */
    bool is_process_changed;   /* by the method: no other run is to follow in this process */
    struct cs_counts counts;
    struct cs_strain_limit strain_limit;
    struct cs_energy_input energy_input;
    double stage_seconds[CS_STAGES]; /* wall time; all 0 unless timed */
    double stage_cpu[CS_STAGES];     /* processor time of the process meanwhile; likewise */
    double advance_seconds;          /* wall time inside the method */
    double advance_cpu;              /* processor time of the process meanwhile */
    struct cs_plan plan;             /* the system's, with the bytes of the run's own arrays */
    size_t method_bytes;             /* of arrays that the method took from the host */
    char notes[CS_NOTES_MAX][160];   /* remarks of the method */
    uint32_t n_notes;
    struct cs_run_host *host; /* owned */
};

/* Receives each array that passes between a method and the host, and each state that a
 * correction leaves: see sim/trace.h. */
struct cs_trace {
    void (*emit)(void *ctx, const struct cs_trace_record *record);
    void *ctx;
    bool enabled; /* may be set and cleared between frames */
};

/* Settings of a run. Zeroed: no clock, limit, observer, ledger or trace. */
struct cs_run_settings {
    bool timed; /* stage times too */
    /* skips the post-conditions of advance: for checks that measure them themselves */
    bool skip_advance_check;
    const volatile sig_atomic_t *stop; /* set by a signal handler; may be NULL */
    /* Work in nominal s (cs_pass_seconds) after which the run ends as CS_OVER_BUDGET, checked
     * at every commit and solve; a step counts as a pass at least. 0: no limit. */
    double budget;
    /* Nominal s that are left for all runs with this pointer. Each is limited by it too, and
     * subtracts its work at its end. NULL: no limit. */
    double *pot;
    /* Called at the end of every commit, and may move the state: returns whether it did. May be
     * NULL. */
    bool (*after_commit)(void *ctx, double t, double dt, double *x, double *v);
    void *ctx;                       /* of after_commit */
    struct cs_energy_ledger *ledger; /* booked step by step, see energy_ledger.h; NULL: none */
    struct cs_trace *trace;          /* NULL: none */
    const struct cs_vector_kernels *vector; /* for the method; NULL: the program's own */
};

#endif
