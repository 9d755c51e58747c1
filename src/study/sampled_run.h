/* sampled_run.h - runs a scene once for a study and records scalar figures, no states.
 *
 * The state is sampled at equal intervals of time, independent of the step, so runs with
 * different steps are comparable. */
#ifndef CS_SAMPLED_RUN_H
#define CS_SAMPLED_RUN_H

#include "study/crossing_stats.h"
#include "study/follow.h"
#include "study/session.h"

/* Values above which a run counts as unstable; HUGE_VAL: no limit. */
struct cs_sampled_run_limits {
    double speed;       /* m/s, of one particle */
    double energy;      /* J, kinetic and elastic */
    double energy_gain; /* J, of the whole energy above that of the start */
};

/* Request for a run; pointers are borrowed. */
struct cs_sampled_run_settings {
    struct cs_session_settings session; /* fps is not used */
    double seconds;                     /* to simulate */
    uint32_t samples;                   /* about so many; at least 1 */
    struct cs_sampled_run_limits limits;
    /* called at the start and at each sample; may be NULL */
    void (*on_sample)(void *ctx, const struct cs_run *run, const struct cs_energy *energy);
    void *ctx;
};

/* A particle that was faster than the limit. */
struct cs_speed_excess {
    bool exists;
    double time;        /* s, of the first sample that shows it */
    uint32_t particles; /* most at one time */
};

/* Figures of a run. They are valid up to the time that the run reached. */
struct cs_sampled_run {
    struct cs_run_result result;
    uint64_t steps;
    double mean_step;                /* s, mean length of a step */
    double start_energy, end_energy; /* J, whole */
    double energy_max_first_half,
        energy_max_second_half; /* J, largest kinetic + elastic of each half of the time */
    double kinetic;             /* J, largest */
    double energy_max;          /* J, largest kinetic + elastic */
    double energy_gain_max;     /* J, largest energy above the start's */
    double mean_kinetic;        /* J, over the samples */
    double speed_max;           /* m/s, largest */
    double seconds;             /* wall time in the method */
    bool exceeded_limit;        /* held or gained passed its limit */
    double exceeded_time;       /* s */
    struct cs_speed_excess speed_excess;
    struct cs_crossing_stats crossings; /* of the samples, where the scene counts them */
};

/* Runs the scene and fills *trial. A blow-up or a failed method is a result, not an error.
 * Errors are those of the scene, the command, memory, or CS_ERR_INTERRUPT. */
enum cs_status cs_sampled_run_execute(struct cs_sampled_run *trial,
                                      const struct cs_sampled_run_settings *settings,
                                      struct cs_error *error);

#endif
