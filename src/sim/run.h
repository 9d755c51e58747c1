/* run.h - a system stepped by a method, frame by frame. */
#ifndef CS_RUN_H
#define CS_RUN_H

#include "model/force/measure.h"
#include "model/system/system.h"

#include <clothsim/integrator.h>
#include <signal.h>

/* How a run stands. All but the first end it; none of them is an error. */
#define CS_OUTCOME_LIST(X)                                                                     \
    X(CS_RUNNING, "finished")                                                                  \
    X(CS_NOT_FINITE, "blew up: not finite")                                                    \
    X(CS_UNBOUNDED, "blew up: energy beyond all bound")                                        \
    X(CS_INTERRUPTED, "interrupted")                                                           \
    X(CS_OVER_BUDGET, "over budget")
enum cs_outcome {
#define X(name, text) name,
    CS_OUTCOME_LIST(X)
#undef X
};
const char *cs_outcome_text(enum cs_outcome outcome);

/* Stages that the host times, when asked to. */
enum cs_stage {
    CS_STAGE_FORCE,
    CS_STAGE_SOLVE,
    CS_STAGE_CONTACT,
    CS_STAGE_LIMIT,
    CS_STAGE_NORMALS,
    CS_STAGES
};
extern const char *const cs_stage_names[];

/* Exact counts, the same on every machine. */
struct cs_counts {
    uint64_t steps, forces, energies, jvps, diagonals, solve_setups, solves, solve_iterations;
    uint64_t clamped;       /* solver set-ups that fell back to CS_SOLVE_PSD */
    uint64_t contacts;      /* particles pushed out */
    uint64_t contact_tests; /* particle-collider pairs tested */
    uint64_t limit_moves;   /* springs shortened by the strain limit */
    uint64_t normals;       /* times that normals were computed in a step */
    struct cs_stats method; /* what the method counted itself */
};

struct cs_blow_up {
    double time;          /* s */
    uint32_t particle;    /* the first not finite, or the fastest */
    double energy, bound; /* kinetic energy and its bound in J */
};

enum { CS_NOTES_MAX = 8 };

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
    size_t method_bytes;             /* of arrays that the method took from the host */
    char notes[CS_NOTES_MAX][160];   /* remarks of the method */
    uint32_t n_notes;
    struct cs_run_host *host; /* owned */
};

/* Makes the method over the system with filled options (integrator->options_size bytes), and
 * restarts it at time 0. timed: stage times too. stop: set by a signal handler, may be NULL.
 * On failure *run is empty; CS_ERR_MODULE with the method's message, or CS_ERR_MEMORY. */
enum cs_status cs_run_begin(struct cs_run *run, struct cs_system *system,
                            const struct cs_integrator *integrator, const void *options,
                            bool timed, const volatile sig_atomic_t *stop,
                            struct cs_error *error);

/* Ends the run as CS_OVER_BUDGET once the process has used that much more processor time; the
 * clock is read between steps and never reaches the state. */
void cs_run_set_budget(struct cs_run *run, double cpu_seconds);

/* Steps to the next frame, t = (frame + 1) / fps. A blow-up, an interrupt or an end of the
 * budget sets run->outcome and returns CS_OK with run->frame as it was. CS_ERR_MODULE: the
 * method failed; the message says where and why. */
enum cs_status cs_run_frame(struct cs_run *run, struct cs_error *error);

/* Whether a method can say where it draws particles to; g (3,n) in m: where, as the run
 * stands. Nothing of the run changes. */
bool cs_run_has_goals(const struct cs_integrator *integrator);
void cs_run_goals(const struct cs_run *run, double *g);
/* Bytes of all arrays of the run: the system's, the meshes', the solver's and the method's.
 * Exact, and the same on every machine with as many threads; a foreign library's own memory is
 * not in it. */
size_t cs_run_bytes(const struct cs_run *run);

void cs_run_finish(struct cs_run *run);

#endif
