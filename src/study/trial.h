/* trial.h - a probe run of a scene for a study: no pictures, only how it behaved.
 *
 * The state is sampled at equal spaces of time, so
 * that runs with different steps can be held against each other.
 */
#ifndef CS_TRIAL_H
#define CS_TRIAL_H

#include "study/follow.h"
#include "study/session.h"
#include "study/tally.h"

/* What a particle or the whole may reach before a run counts as unstable; HUGE_VAL: no limit.
 */
struct cs_trial_limits {
    double speed;  /* m/s, of one particle */
    double energy; /* J, kinetic and elastic */
    double gain;   /* J, of the whole energy above that of the start */
};

struct cs_trial_settings {
    struct cs_session_settings session; /* fps is not used */
    double seconds;                     /* to simulate */
    uint32_t samples;                   /* about so many; at least 1 */
    struct cs_trial_limits limits;
    /* called at the start and at each sample; may be NULL */
    void (*sampled)(void *ctx, const struct cs_run *run, const struct cs_energy *energy);
    void *ctx;
};

/* A particle that was faster than the limit. */
struct cs_trial_excess {
    bool found;
    double time;        /* s, of the first sample that shows it */
    uint32_t particles; /* most at one time */
};

struct cs_trial {
    struct cs_run_result result;
    uint64_t steps;
    double step;                     /* s, mean length of a step */
    double start_energy, end_energy; /* J, whole */
    double early, late;              /* J, largest kinetic + elastic of each half of the time */
    double kinetic;                  /* J, largest */
    double held;                     /* J, largest kinetic + elastic */
    double gained;                   /* J, largest energy above the start's */
    double mean_kinetic;             /* J, over the samples */
    double speed;                    /* m/s, largest */
    double seconds;                  /* wall time in the method */
    bool beyond;                     /* held or gained passed its limit */
    double beyond_time;              /* s */
    struct cs_trial_excess excess;
    struct cs_tally crossings; /* of the samples, where the scene counts them */
};

/* CS_OK with a verdict's numbers even where the run blew up or the method failed. An error is
 * one of the scene, the command or memory, or CS_ERR_INTERRUPT. */
enum cs_status cs_trial_run(struct cs_trial *trial, const struct cs_trial_settings *settings,
                            struct cs_error *error);

#endif
