/* run_host.h - the host's private data behind the calls of a method; for the files that
 * implement these calls. */
#ifndef CS_RUN_HOST_H
#define CS_RUN_HOST_H

#include "base/clock.h"
#include "base/trace_stream.h"
#include "model/contact/ccd/step_limit.h"
#include "model/event/events.h"
#include "model/post_step/contact_projection.h"
#include "model/solver/linear.h"
#include "model/system/particle_system.h"
#include "sim/crash.h"
#include "sim/process_state.h"
#include "sim/run_state.h"

#include <string.h>

/* Detects a blow-up: numbers that are not finite, or more kinetic energy
 * than the scene can give. */

/* The bound on kinetic energy at time t, in J:
 *   100 (start_energy + speed + (force_gain + sqrt(force_rate) (t - t_forces))^2)
 * start_energy is potential: the one of the start, the springs at twice their length, and
 * shape matching. The other two bound free flight under outer forces, sum m (|v| + a t)^2 /
 * 2, by (p + q)^2 <= 2 p^2 + 2 q^2 with speed = sum m v^2 and force_rate = sum m a^2. Where
 * the outer forces change, sqrt(sum m (a1 t1 + a2 t2)^2) <= sqrt(sum m a1^2) t1 + sqrt(sum m
 * a2^2) t2: force_gain adds up the pieces. The factor 100 is a margin, chosen by trial. */
struct cs_blow_up_check {
    double start_energy; /* J */
    double speed;        /* J: twice the kinetic energy of the start */
    double force_rate;   /* J/s2: sum of F^2 / m of the outer forces since t_forces */
    double force_gain;   /* sqrt(J), by the pieces before t_forces */
    double t_forces;     /* s, when the forces were last evaluated */
};

/* Sets the bound from the state and the forces that the system has at time t. */
void cs_blow_up_check_set(struct cs_blow_up_check *check, const struct cs_system *system,
                          double t);

/* Sets the bound again after the events at time t. It starts from the state that they leave,
 * with the larger of the values now and those at the end of the segment; a grab may pull all
 * particles along. If viewpoint forces only tested visibility again, the bound continues with
 * the new forces: a fresh start at each test would follow a blow-up. */
void cs_blow_up_check_after_events(struct cs_blow_up_check *check, struct cs_system *system,
                                   double t);

/* Checks the state (x, v) after a step. Returns true on a blow-up; run->outcome and
 * run->blow_up then say which, where and by how much. */
bool cs_blow_up_check_step(const struct cs_blow_up_check *check, struct cs_run *run, double t,
                           const double *x, const double *v);

/* Reads the method's own counts into run->counts, with those before the loaded checkpoint. */
void cs_run_host_count(struct cs_run_host *host);

/* Nominal s of the work of the run so far. */
double cs_run_host_work_seconds(const struct cs_run_host *host);

/* Ends a run whose work exceeds its budget, or what is left in its pot: sets its outcome and
 * returns true. */
bool cs_run_host_end_over_budget(struct cs_run_host *host);

/* Checks the post-conditions of advance() before a state is hashed, written
 * or drawn.
 *
 * The contract asks three things of a method: the last commit was at t1, all numbers are
 * finite, and pinned particles still have their bits. A method that breaks one could
 * otherwise report a wrong result as a success. */

/* The state of the check within one advance; host->commit sets last_commit. */
struct cs_advance_check {
    const struct cs_system *system; /* borrowed */
    uint64_t pins_hash;             /* hash of x and v of the pinned particles at the begin */
    double last_commit;             /* s, the end of the last committed step */
};

/* Starts the check of an advance that begins at t. */
void cs_advance_check_begin(struct cs_advance_check *left, const struct cs_system *system,
                            double t);

/* Checks the state after an advance to t. Pinned particles on a path are left out: commit
 * places them. Returns false on a violation and adds one line about it to why. */
bool cs_advance_check_passes(const struct cs_advance_check *left, double t,
                             struct cs_text *why);

/* The step of the last euler_setup, whose b follows A where that has to be clamped. The arrays
 * are the method's. */
struct cs_euler_step {
    double t, h;         /* s */
    const double *x, *v; /* (3,n) in m and m/s */
    double *b;           /* (3,n) in N s; NULL: solve_setup came last */
    bool tangent;        /* friction by its derivative in A: CS_SOLVE_TANGENT */
    const double *dv;    /* (3,n) in m/s: a solution, to whose end friction has its chord; NULL:
                            none yet */
};

/* One per run, owned by struct cs_run; ctx of the method's calls. */
struct cs_run_host {
    struct cs_host table;    /* the calls that the method sees */
    struct cs_run *run;      /* borrowed: counts, outcome, notes */
    struct cs_linear linear; /* only with CS_NEED_SOLVE */
    double
        *setup_x; /* (3,n) in m: positions at the last solve_setup, for a clamped second one */
    double
        *setup_v; /* (3,n) in m/s: its velocities; NULL: no part of the matrix depends on v */
    struct cs_euler_step euler;
    double *settled;     /* (3,n) in m/s: the solution before the last one, while friction is
                            settled; NULL: it never is */
    bool solve_may_fail; /* the method asked for it at the last set-up */
    double *bounds_work; /* (2n) scratch; NULL: no force has bounds at a state alone */
    struct cs_contact_projection contact; /* only with contact by projection */
    double penetration_max; /* m behind a surface that a step may end, of contact by
                               projection; HUGE_VAL: any */
    bool creating;          /* in create: the method may take memory */
    struct cs_process_state process_state; /* the process as it was before the first call */
    struct cs_run_settings settings;
    double pass_seconds; /* nominal s of a pass over the forces, the ledger's included */
    void *self;          /* the method's object */
    struct cs_stats stats_before; /* the method's counts before the loaded checkpoint */
    struct cs_error error;        /* the method's first message */
    struct cs_blow_up_check blow_up;
    struct cs_blocked_step blocked_step; /* the last step that crossings refused */
    struct cs_advance_check advance_check;
    double *power; /* (4n) power in W by which the scene gives energy to each particle at the
                      last evaluation of all forces, then a scratch for forces; NULL:
                      nothing can give any */
    bool power_is_set;  /* the method has asked for all forces since the last commit */
    double power_t;     /* s, when */
    bool power_by_end;  /* an implicit method with things that move: only the end of a step
                           counts, as an impact may begin within it */
    bool has_impact;    /* the last linearised step stepped particles alone (rebound.h) */
    double impact_work; /* J that colliders did on them: by their impulse, since their contact
                           may have come and gone within the step */
    bool corrects;      /* strain limit or contact by projection act */
    bool took_back;     /* the last commit: contact.state_before is the state again */
    double *held;    /* two copies (6,n) of a state, for cs_host_held_at; NULL: nothing turns */
    double lag_time; /* s, of the friction that is lagged */
    const struct cs_loop *loop; /* after the force that is asked for; NULL: none */
    struct cs_arena arena;      /* memory of the method and of the solver */
    struct cs_view_pages pages; /* what a module from outside sees of the system */
};

/* Fails the run with the reason why a linear solve did not end in CS_LINEAR_DONE. b (3,n) is
 * its right-hand side. Returns CS_STEP_FAIL. */
enum cs_step cs_run_host_fail_solve(struct cs_run_host *host, enum cs_linear_end end,
                                    const double *b, uint64_t iterations, double residual);

/* Times in s, such as at the begin of a stage: of the wall, and of the process. */
struct cs_stage_start {
    double wall, cpu;
};

static inline struct cs_stage_start cs_stage_now(void) {
    return (struct cs_stage_start){cs_clock_wall(), cs_clock_cpu()};
}

/* Without settings.timed no clock is read. */
static inline struct cs_stage_start cs_stage_begin(const struct cs_run_host *host) {
    cs_crash_note_host();
    return host->settings.timed ? cs_stage_now() : (struct cs_stage_start){0};
}

/* Adds the times since then to a stage. */
static inline void cs_stage_end(struct cs_run_host *host, enum cs_stage stage,
                                struct cs_stage_start begin) {
    cs_crash_note_host();
    if (!host->settings.timed)
        return;
    const struct cs_stage_start now = cs_stage_now();
    host->run->stage_seconds[stage] += now.wall - begin.wall;
    host->run->stage_cpu[stage] += now.cpu - begin.cpu;
}

/* Replaces x and v at t by a copy if held particles turn: there they are on their arc, which
 * x + h v of a stage is not. v may be NULL. copy: 0 or 1, which of the two copies; it stays
 * until the next call with that number. */
static inline void cs_host_held_at(struct cs_run_host *host, int copy, double t,
                                   const double **x, const double **v) {
    const struct cs_system *system = host->run->system;
    const size_t n3 = 3 * (size_t)system->view.n;
    if (!host->held || !system->events->has_turns)
        return;
    double *at = host->held + (size_t)copy * 2 * n3;
    memcpy(at, *x, n3 * sizeof *at);
    if (v)
        memcpy(at + n3, *v, n3 * sizeof *at);
    cs_events_apply_paths(system, t, at, at + n3);
    *x = at;
    if (v)
        *v = at + n3;
}

/* Sets ramped values to those at t, the time that the method asks about. */
static inline void cs_move_values(struct cs_run_host *host, double t) {
    if (!host->run->system->events)
        return;
    cs_events_move_values(host->run->system, t);
    cs_view_pages_update(&host->pages, &host->run->system->view);
}

/* Both, for a call of the method about (t, x, v). */
static inline void cs_host_state_at(struct cs_run_host *host, double t, const double **x,
                                    const double **v) {
    cs_move_values(host, t);
    cs_host_held_at(host, 0, t, x, v);
}

/* True if the method takes explicit steps without error control: friction of contact limits
 * them only so far (CS_FRICTION_IMPACT_RATIO). */
static inline bool cs_host_is_explicit(const struct cs_run_host *host) {
    return !(host->run->integrator->traits & (CS_IMPLICIT | CS_ADAPTIVE));
}

/* host->commit. Corrects the state (x, v) that a step of length dt left at time t, books the
 * corrections in the energy ledger, and decides if the run continues. *changed: the state or
 * the pins differ from those that the method left, other than by its own paths. Returns
 * CS_STEP_HALT after a blow-up, an interrupt or the end of the budget, with run->outcome set;
 * CS_STEP_FAIL with a message. */
enum cs_step cs_host_commit(void *ctx, double t, double dt, double *x, double *v,
                            bool *changed);

/* The account of energy: adds up in run->energy_input what the scene gives to the motion.
 *
 * Forces. A moving surface of velocity u that presses with the force f on a particle gives the
 * power f.u: the part of f.v that neither its potential nor friction takes up. A pinned
 * particle that moves gives -f.v with the sum f of all forces on it, wind and pushes give f.v.
 * The rule for a step of length h is h times the power at the last state at which the method
 * asked for all forces: of first order, and with the same error for any smooth motion as
 * backward Euler. Methods that make many passes over the forces per step pay one for the state
 * that they end in.
 *
 * Ramps give the change of the potentials at fixed positions. Corrections after a step give the
 * change of kinetic energy that they make, and of the potentials in one of so many steps, which
 * stands for all since the last. Both wait until their share of the work of the method is below
 * 3 %, in counts that no machine changes. Events between two steps give what the energy rises
 * by. The observer of a step is left out. */

/* Finds what can give energy, and takes the arrays for it. CS_ERR_MEMORY. */
enum cs_status cs_energy_input_init(struct cs_run_host *host, struct cs_error *error);
/* An evaluation of forces that the method asks for, with its powers if it is of all. */
struct cs_eval cs_energy_input_eval(struct cs_run_host *host, double t, const double *x,
                                    const double *v, uint32_t parts);
/* Books the step of length dt that ends at t in (x, v), before the corrections. */
void cs_energy_input_step(struct cs_run_host *host, double t, double dt, const double *x,
                          const double *v);
/* Books the corrections that have led from there to (x, v). */
void cs_energy_input_corrections(struct cs_run_host *host, double t, const double *x,
                                 const double *v);
/* Applies and books the events at time t; returns false if nothing changed. */
bool cs_energy_input_events(struct cs_run_host *host, double t);

/* Pins the particles that static friction holds, or releases them. They are pinned during the
 * method's calls only: corrections, the ledger and outputs see them as free. */
void cs_host_pin(struct cs_run_host *host, bool held);

/* Stores where a step begins, unless the method asks max_step_fraction about its steps. */
void cs_host_store_step(struct cs_run_host *host, double t, const double *x);

/* --- linear systems: linear_setup.c sets them up, host.c solves them --- */

/* The calls solve_setup and euler_setup of a method. */
enum cs_step cs_host_solve_setup(void *ctx, double t, const double *x, const double *v,
                                 double cm, double cd, double ck, uint32_t flags);
enum cs_step cs_host_euler_setup(void *ctx, double t, double h, const double *x,
                                 const double *v, uint32_t flags, double *b);
/* The call euler_finish. */
void cs_host_euler_finish(void *ctx, double *x, double *v);

/* --- the host of a run --- */

/* Fills host->table for a run over run->system, and takes the memory of contact and of the
 * linear solver. host is zeroed but for its settings. CS_ERR_MEMORY. */
enum cs_status cs_run_host_init(struct cs_run_host *host, struct cs_run *run,
                                struct cs_error *error);

/* Sets the scales of the host's table from the state at time 0. */
void cs_run_host_set_scales(struct cs_run_host *host);

/* Sets in the host's table whether steps may pass frames. */
void cs_run_host_set_overstep(struct cs_run_host *host);

/* Replaces the call solve by one that always fails, to test what a method does then. */
void cs_run_host_fail_solves(struct cs_run_host *host);

/* Applies the events at time t to the state, the pins and the values, and sets the blow-up
 * bound for them. Returns true if anything changed: the method must be restarted. */
bool cs_run_host_apply_events(struct cs_run_host *host, double t);

/* --- trace points: the arguments and results of the method's calls, and the state after each
 * correction. `clothsim bisect` compares two such streams to find the first number that
 * differs. Tracing changes no bit of the run, and costs one test per call when it is off. ---
 */

/* Sends n numbers at time t to the trace of the run, which must be on. named gives phase and
 * name; frame and step are those that are running. values is borrowed during the call. */
void cs_trace_emit(const struct cs_run_host *host, const struct cs_trace_record *named,
                   double t, const double *values, size_t n);

/* True if the run has a trace and it is enabled. */
static inline bool cs_trace_is_on(const struct cs_run_host *host) {
    return host->settings.trace && host->settings.trace->enabled;
}

/* Traces an array (3,n); values NULL: none. */
static inline void cs_trace_vector(const struct cs_run_host *host, const char *phase,
                                   const char *name, double t, const double *values) {
    if (cs_trace_is_on(host) && values)
        cs_trace_emit(host, &(struct cs_trace_record){.phase = phase, .name = name}, t, values,
                      3 * (size_t)host->run->system->view.n);
}

/* Traces one number. */
static inline void cs_trace_number(const struct cs_run_host *host, const char *phase,
                                   const char *name, double t, double value) {
    if (cs_trace_is_on(host))
        cs_trace_emit(host, &(struct cs_trace_record){.phase = phase, .name = name}, t, &value,
                      1);
}

/* Traces positions and velocities, both (3,n). */
static inline void cs_trace_state(const struct cs_run_host *host, const char *phase, double t,
                                  const double *x, const double *v) {
    cs_trace_vector(host, phase, "x", t, x);
    cs_trace_vector(host, phase, "v", t, v);
}

/* How a linear solve ended, and what it took. */
struct cs_solve_result {
    enum cs_linear_end end;
    uint64_t iterations;
    double residual;
};

/* Takes memory to settle friction, if the scene and the method may need it. CS_ERR_MEMORY. */
enum cs_status cs_host_init_settling(struct cs_run_host *host, struct cs_error *error);

/* Solves the last system, clamped where it is indefinite. One of euler_setup is solved again
 * with friction by its chord to the end of the solution, until that solves the new system too.
 * Contacts of surfaces with a small friction_speed alone need it (contact/friction_chord.h). If
 * a later solve fails, the solution before it stands. */
enum cs_linear_end cs_host_solve_settled(struct cs_run_host *host, const double *b, double rtol,
                                         double *u, struct cs_solve_result *result);

#endif
