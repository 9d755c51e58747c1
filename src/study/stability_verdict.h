/* outcome.h - verdicts on a run: the words of the cloth thesis, made into numbers. */
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
const char *cs_stability_word(enum cs_stability_verdict verdict);
const char *cs_stability_help(enum cs_stability_verdict verdict);
char cs_stability_letter(enum cs_stability_verdict verdict);

/* A step that shows none of it is stable. */
static inline bool cs_stability_is_stable(enum cs_stability_verdict verdict) {
    return verdict == CS_STABILITY_BOUNDED || verdict == CS_STABILITY_DAMPED;
}

/* Nor does one whose run was too short to call it stable. */
static inline bool cs_stability_is_sound(enum cs_stability_verdict verdict) {
    return cs_stability_is_stable(verdict) || verdict == CS_STABILITY_SHORT;
}

/* What a run may reach, from a trusted run of the same scene over the same time: speed 5 times
 * its fastest, energy 2 times what it held, gain half of that above what it gained. */
struct cs_sampled_run_limits cs_stability_limits(const struct cs_sampled_run *reference);

/* Judges a run that had those limits. Energy beyond them makes a global instability where it
 * grew by half from the first half of the run to the second, or where the mean kinetic energy
 * is ten times the reference's: a symplectic method near its limit makes a fast motion larger
 * and yet stays there for ever. whole: the run was to last as long as the reference; else
 * CS_STABILITY_SHORT stands in place of the stable ones. */
enum cs_stability_verdict cs_stability_judge(const struct cs_sampled_run *trial,
                                             const struct cs_sampled_run *reference,
                                             bool whole);

/* Energy at the end less the reference's there, in shares of what the reference held. */
double cs_stability_drift(const struct cs_sampled_run *trial,
                          const struct cs_sampled_run *reference);

#endif
