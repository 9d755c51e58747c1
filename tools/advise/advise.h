/* advise.h - finds the largest safe time step of each method on a scene, its cause and its
 * cost.
 *
 * For a method with a fixed step:
 *   1. Reference run by velocity-verlet, and the limit of linear theory along it (theory.h).
 *   2. Advised step: 0.9 of the limit, at most one frame and 10 s.
 *   3. Probe runs with this step over the time of the reference, judged like a cell of a map,
 * from the perturbed start and from the scene's own.
 *   4. If it is unstable, the border is bisected by probe runs and 0.9 of it is advised.
 * Without a limit in theory one step per frame is tried, and bisected if unstable; the
 * reference is not begun for such a method if its steps exceed the budget; beyond one that the
 * budget cut, steps are tested without it. An adaptive method
 * gets a probe run only, for its cost and verdict. */
#ifndef CS_ADVISE_H
#define CS_ADVISE_H

#include "borders/stability_state.h"

/* Origin of an advised step. */
enum cs_advice_kind {
    CS_ADVICE_THEORY,   /* the limit of linear theory along a trusted run */
    CS_ADVICE_LOWERED,  /* 0.9 of theory's limit was tried and is unstable: bisected */
    CS_ADVICE_MEASURED, /* theory knows no limit, but one was found by bisection */
    CS_ADVICE_FRAME,    /* one step a frame was tried and is stable */
    CS_ADVICE_NONE,     /* no step is stable; message says why, where it is not the damping */
    CS_ADVICE_ADAPTIVE, /* chooses its own steps */
    CS_ADVICE_REFUSED   /* message says why */
};

/* Advice for one method. */
struct cs_advice {
    const char *method;
    enum cs_advice_kind kind;
    double limit, safe;  /* s: largest stable step, and the one advised */
    double theory;       /* s, limit of linear theory; HUGE_VAL: none */
    struct cs_mode mode; /* that limits it, where theory has a limit */
    /* s: when theory's limit was smallest; the limit at the end and when, HUGE_VAL: none */
    double time, end_limit, seconds;
    enum cs_stability_verdict verdict; /* of a run with the safe step */
    double checked_seconds;            /* s, that this run lasted */
    double mode_growth;       /* 1/s, of the worst mode at the safe step; 0: it does not grow */
    double measured;          /* s, bisected; 0: not asked for; NAN: unknown */
    double speed;             /* m/s, largest of a particle in all runs; 0: none */
    double steps, frame_cost; /* steps and wall time in s of a frame with the safe step */
    double cut;               /* s, where the budget ended the reference; 0: it did not */
    double steps_ahead;       /* of a reference beyond the budget, not begun; 0: begun */
    /* nominal s of work that are left, while it is at work; and held back for its tests */
    double pot, held;
    char message[320];
};

/* True if the probe run was unstable: such a step is never advised. A run out of budget is not.
 */
static inline bool cs_advice_is_unstable(const struct cs_advice *advice) {
    return !cs_stability_is_stable(advice->verdict) &&
           advice->verdict != CS_STABILITY_OVER_BUDGET;
}

/* True if a row names a step. */
static inline bool cs_advice_has_step(const struct cs_advice *advice) {
    return advice->kind != CS_ADVICE_ADAPTIVE && advice->kind != CS_ADVICE_NONE &&
           advice->kind != CS_ADVICE_REFUSED;
}

/* Request and results; pointers of the request are borrowed. */
struct cs_advise {
    struct cs_session_settings session; /* of the scene; integrator is not used */
    const char *const *methods;         /* (n_methods); 0: all that can be used */
    uint32_t n_methods;
    double
        seconds;   /* that the advice is for: of the trusted run and the probe runs, at least */
    double budget; /* nominal s of work of all runs, divided equally among the methods; 0: 20,
                      or 5 per method up to 60. Out: the one used */
    bool bisect_too; /* bisect the limit too */
    uint32_t workers;
    const volatile sig_atomic_t *stop;
    void (*progress)(void *ctx, uint32_t done, uint32_t total);
    void *ctx;
    /* out */
    struct cs_session was_opened; /* the scene as it is given */
    struct cs_registry registry;
    const char *const *names;
    struct cs_advice *rows; /* (n) by method; workers see them */
    uint32_t n;
};

/* Fills rows for all methods, distributed over worker processes. A method that cannot follow
 * the scene is a row, not an error. Returns the errors of the scene and of unknown methods,
 * CS_ERR_MEMORY, CS_ERR_INTERRUPT. cs_advise_finish must be called in any case. */
enum cs_status cs_advise_run(struct cs_advise *advise, struct cs_error *error);
/* CS_ERR_UNSTABLE if no method has an answer, which a step or the lack of one is. The message
 * names the first method. */
enum cs_status cs_advise_check(const struct cs_advise *advise, struct cs_error *error);
/* Frees rows and registry and closes the session; the object is then zeroed. */
void cs_advise_finish(struct cs_advise *advise);

#endif
