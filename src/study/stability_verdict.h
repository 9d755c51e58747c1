/* stability_verdict.h - verdicts on a run: numerical criteria for the terms of the cloth
 * thesis.
 *
 * A run is judged by a trusted run of the same scene (stability_state.h). The criteria
 * bound speed and energy by multiples of those of the trusted run, because absolute bounds
 * would depend on the scene. */
#ifndef CS_STABILITY_VERDICT_H
#define CS_STABILITY_VERDICT_H

#include "study/follow.h"
#include "study/recorded_run.h"
#include "study/session.h"

/* Runs a scene once for a study and records scalar figures, no states.
 *
 * The state is sampled at equal intervals of time, independent of the step, so runs with
 * different steps are comparable. */

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

/* X(name, word, letter of maps, what it means) from best to worst */
#define CS_STABILITY_LIST(X)                                                                   \
    X(CS_STABILITY_BOUNDED, "bounded", '.', "no sign of instability")                          \
    X(CS_STABILITY_DAMPED, "over-damped", 'd',                                                 \
      "stable, but the mean kinetic energy is below half of the reference's")                  \
    X(CS_STABILITY_SHORT, "not run to the end", '>',                                           \
      "no sign of instability in the steps that a cell may take, fewer than its time needs")   \
    X(CS_STABILITY_LOCAL, "local instability", 'l',                                            \
      "particles faster than five times the fastest of the reference, energy bounded")         \
    X(CS_STABILITY_GLOBAL, "global instability", 'G',                                          \
      "energy beyond twice the reference's, or half of it gained, and growing or tenfold")     \
    X(CS_STABILITY_NOT_FINITE, "not finite", 'X', "a number of the state is not finite")       \
    X(CS_STABILITY_FAILED, "solver failed", 'F', "the method failed and reported a reason")    \
    X(CS_STABILITY_OVER_BUDGET, "over budget", 'b', "the time allowed for a cell ran out")     \
    X(CS_STABILITY_UNJUDGED, "not judged", '?', "there is no reference run to compare with")

enum cs_stability_verdict {
#define X(name, word, letter, help) name,
    CS_STABILITY_LIST(X)
#undef X
        CS_STABILITY_VERDICTS
};

/* Word, explanation and letter of a verdict. */
const char *cs_stability_word(enum cs_stability_verdict verdict);
const char *cs_stability_help(enum cs_stability_verdict verdict);
char cs_stability_letter(enum cs_stability_verdict verdict);

/* True if the run shows no sign of instability. */
static inline bool cs_stability_is_stable(enum cs_stability_verdict verdict) {
    return verdict == CS_STABILITY_BOUNDED || verdict == CS_STABILITY_DAMPED;
}

/* True for a stable run, and for one that was too short to be called stable. */
static inline bool cs_stability_is_sound(enum cs_stability_verdict verdict) {
    return cs_stability_is_stable(verdict) || verdict == CS_STABILITY_SHORT;
}

/* Limits for a run, from a trusted run of the same scene over the same time: 5 times its speed,
 * 2 times the energy it held, and its gain plus half of that energy. */
struct cs_sampled_run_limits cs_stability_limits(const struct cs_sampled_run *reference);

/* Judges a run that had those limits.
 *
 * Energy beyond them is a global instability only with a second sign. Either it grew by half
 * from the first half of the run to the second, or the mean kinetic energy is ten times that of
 * the reference. The reason is a symplectic method near its limit: velocity-verlet conserves
 *   w^2 + square (1 - h^2 square / 4) s^2
 * of an undamped mode, with w = s'. Its amplitude s for a given start velocity grows without
 * bound as h^2 square approaches 4, but stays there for good: the run is stable, if inaccurate.
 *
 * whole: the run was meant to last as long as the reference; otherwise CS_STABILITY_SHORT
 * replaces the stable verdicts. */
enum cs_stability_verdict cs_stability_judge(const struct cs_sampled_run *trial,
                                             const struct cs_sampled_run *reference,
                                             bool whole);

/* Energy at the end minus that of the reference, as a fraction of the energy the reference
 * held. */
double cs_stability_drift(const struct cs_sampled_run *trial,
                          const struct cs_sampled_run *reference);

#endif
