/* stability_verdict.h - verdicts on a run: numerical criteria for the terms of the cloth
 * thesis.
 *
 * A run is judged by a trusted run of the same scene (stability_reference.h). The criteria
 * bound speed and energy by multiples of those of the trusted run, because absolute bounds
 * would depend on the scene. */
#ifndef CS_STABILITY_VERDICT_H
#define CS_STABILITY_VERDICT_H

#include "study/sampled_run.h"

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
