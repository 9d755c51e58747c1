/* run_state.h - the settings and the state of a run, which the host fills while it steps. */
#ifndef CS_RUN_STATE_H
#define CS_RUN_STATE_H

#include "base/hash.h"
#include "base/serialise.h"
#include "base/trace_stream.h"
#include "model/force/diagnostics.h"
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
 * correction leaves: see base/trace_stream.h. */
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

/* Steps a system with a method, frame by frame.
 *
 * One run is begin, any number of frames, finish. Its host lies on the heap and never moves,
 * since the method keeps a pointer to it; struct cs_run must stay where it is too. */

/* The text of an outcome, a constant: "finished", "blew up: not finite". */
const char *cs_outcome_text(enum cs_outcome outcome);
extern const char *const cs_stage_names[]; /* closed by NULL */

/* Creates the method on the system with filled options (integrator->options_size bytes), and
 * restarts it at time 0. The system is borrowed until finish, and its state is the run's. On
 * failure *run is empty: CS_ERR_MODULE with the method's message, or CS_ERR_MEMORY. */
enum cs_status cs_run_begin(struct cs_run *run, struct cs_system *system,
                            const struct cs_integrator *integrator, const void *options,
                            const struct cs_run_settings *settings, struct cs_error *error);

/* Steps to the next frame, t = (frame + 1) / fps. A blow-up, an interrupt, the end of the
 * budget or a method that gives up sets run->outcome and returns CS_OK with run->frame
 * unchanged; the state is then the one of the last commit. CS_ERR_MODULE: the method failed;
 * the message says when and why. */
enum cs_status cs_run_frame(struct cs_run *run, struct cs_error *error);

/* The two calls of the method that make up a frame, alone: no events, no clock. The caller
 * may move the state before restart. CS_ERR_MODULE as above. */
enum cs_status cs_run_restart(struct cs_run *run, double t, struct cs_error *error);
enum cs_status cs_run_advance(struct cs_run *run, double from, double to,
                              struct cs_error *error);

/* The method's save or load, guarded as its other calls. CS_ERR_MODULE as above. */
typedef enum cs_step cs_archive_call(void *self, const struct cs_archive *archive);
enum cs_status cs_run_archive(struct cs_run *run, cs_archive_call *call,
                              const struct cs_archive *archive, struct cs_error *error);

/* The calls as the method sees them, valid until finish. */
const struct cs_host *cs_run_calls(const struct cs_run *run);
/* Makes every linear solve of the host fail from now on, to test what a method does then. */
void cs_run_fail_solves(struct cs_run *run);

/* True if a method has goals, the points that shape matching draws particles to. cs_run_goals
 * writes them for the present state to g (3,n) in m, and changes nothing of the run. */
bool cs_run_has_goals(const struct cs_integrator *integrator);
void cs_run_goals(const struct cs_run *run, double *g);
/* Bytes of all arrays of the run: the system's, the meshes', the solver's and the method's.
 * Exact, and the same on every machine with the same number of threads. The private memory of
 * foreign libraries is not included. */
size_t cs_run_bytes(const struct cs_run *run);

/* Hash of the state, as 32 hexadecimal digits: that of x and v, and in a scene with friction
 * that sticks the hash of that hash and the one of all anchors; if stitches broke the hash of
 * that one and the one of the broken. */
void cs_run_hash(const struct cs_run *run, char digits[CS_HASH_DIGITS]);

/* Adds a remark to the report, as the method does by host->note. */
void cs_run_note(struct cs_run *run, const char *format, ...) CS_PRINTF(2, 3);

/* Destroys the method and frees its memory; *run is then empty. Safe on an empty run. */
void cs_run_finish(struct cs_run *run);

/* --- a run between two frames as bytes, for a checkpoint --- */

/* True if the method has save and load. A method without them is restarted whenever a record
 * is made, in the unbroken run too: both runs then continue with the same bits. */
bool cs_run_method_has_history(const struct cs_integrator *integrator);

/* Writes everything that the next frame depends on: state, time, counts, events, contact, and
 * the method's history. May restart the method, see above. CS_ERR_MEMORY, or CS_ERR_MODULE
 * with the method's message. */
enum cs_status cs_run_save(struct cs_run *run, struct cs_serialiser *serialiser,
                           struct cs_error *error);

/* Reads a record into a run that was begun in the same way and has made no frame yet. After a
 * failure (CS_ERR_FILE: bytes of another run; CS_ERR_MODULE) the run must not be used. */
enum cs_status cs_run_load(struct cs_run *run, struct cs_serialiser *serialiser,
                           struct cs_error *error);

#endif
