/* advise.h - which step each method takes safely on a scene, what limits it, what it costs. */
#ifndef CS_ADVISE_H
#define CS_ADVISE_H

#include "study/stability/stability_boundary.h"

enum cs_advice_kind {
    CS_ADVICE_THEORY,   /* the limit of linear theory along a trusted run */
    CS_ADVICE_LOWERED,  /* 0.9 of theory's limit was tried and is unstable: bisected */
    CS_ADVICE_MEASURED, /* theory knows no limit, but one was found by bisection */
    CS_ADVICE_FRAME,    /* one step a frame was tried and is stable */
    CS_ADVICE_NONE,     /* no step is stable; message says why, where it is not the damping */
    CS_ADVICE_ADAPTIVE, /* chooses its own steps */
    CS_ADVICE_REFUSED   /* message says why */
};

struct cs_advice {
    const char *method;
    enum cs_advice_kind kind;
    double limit, safe;                /* s: largest stable step, and the one advised */
    double theory;                     /* s, limit of linear theory; HUGE_VAL: none */
    struct cs_mode mode;               /* that limits it, where theory has a limit */
    enum cs_stability_verdict verdict; /* of a run with the safe step */
    double checked_seconds;            /* s, that this run lasted */
    double mode_growth;       /* 1/s, of the worst mode at the safe step; 0: it does not grow */
    double measured;          /* s, bisected; 0: not asked for; NAN: unknown */
    double speed;             /* m/s, largest of a particle in the trusted run; 0: none */
    double steps, frame_cost; /* steps and wall time in s of a frame with the safe step */
    char message[320];
};

/* What the watch of its own run calls unstable is never advised. */
static inline bool cs_advice_is_unstable(const struct cs_advice *row) {
    return !cs_stability_is_stable(row->verdict) && row->verdict != CS_STABILITY_OVER_BUDGET;
}

struct cs_advise {
    struct cs_session_settings session; /* of the scene; integrator is not used */
    const char *const *methods;         /* (n_methods); 0: all that can be used */
    uint32_t n_methods;
    double
        seconds;   /* that the advice is for: of the trusted run and the probe runs, at least */
    double budget; /* s of processor time of a probe run */
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

enum cs_status cs_advise_run(struct cs_advise *advise, struct cs_error *error);
void cs_advise_finish(struct cs_advise *advise);

#endif
