/* fate.h - verdicts on a run: the words of the cloth thesis, made into numbers. */
#ifndef CS_FATE_H
#define CS_FATE_H

#include "study/trial.h"

/* X(name, word, letter of maps, what it means) from best to worst */
#define CS_FATE_LIST(X)                                                                        \
    X(CS_FATE_BOUNDED, "bounded", '.', "no sign of instability")                               \
    X(CS_FATE_DAMPED, "damped away", 'd',                                                      \
      "stable, but the mean kinetic energy is below half of the reference's")                  \
    X(CS_FATE_SHORT, "not run to the end", '>',                                                \
      "no sign of instability in the steps that a cell may take, fewer than its time needs")   \
    X(CS_FATE_LOCAL, "local instability", 'l',                                                 \
      "particles faster than five times the fastest of the reference, energy bounded")         \
    X(CS_FATE_GLOBAL, "global instability", 'G',                                               \
      "energy beyond twice the reference's, or half of it gained, and growing or tenfold")     \
    X(CS_FATE_NOT_FINITE, "not finite", 'X', "a number of the state is not finite")            \
    X(CS_FATE_FAILED, "solver failed", 'F', "the method gave up and said why")                 \
    X(CS_FATE_OVER_BUDGET, "over budget", 'b', "the time allowed for a cell ran out")
enum cs_fate {
#define X(name, word, letter, help) name,
    CS_FATE_LIST(X)
#undef X
        CS_FATES
};
const char *cs_fate_word(enum cs_fate verdict);
const char *cs_fate_help(enum cs_fate verdict);
char cs_fate_letter(enum cs_fate verdict);

/* A step that shows none of it is stable. */
static inline bool cs_fate_is_stable(enum cs_fate verdict) {
    return verdict == CS_FATE_BOUNDED || verdict == CS_FATE_DAMPED;
}

/* Nor does one whose run was too short to call it stable. */
static inline bool cs_fate_is_sound(enum cs_fate verdict) {
    return cs_fate_is_stable(verdict) || verdict == CS_FATE_SHORT;
}

/* What a run may reach, from a trusted run of the same scene over the same time: speed 5 times
 * its fastest, energy 2 times what it held, gain half of that above what it gained. */
struct cs_trial_limits cs_fate_limits(const struct cs_trial *reference);

/* Judges a run that had those limits. Energy beyond them makes a global instability where it
 * grew by half from the first half of the run to the second, or where the mean kinetic energy
 * is ten times the reference's: a symplectic method near its limit makes a fast motion larger
 * and yet stays there for ever. whole: the run was to last as long as the reference; else
 * CS_FATE_SHORT stands in place of the stable ones. */
enum cs_fate cs_fate_of(const struct cs_trial *trial, const struct cs_trial *reference,
                        bool whole);

/* Energy at the end less the reference's there, in shares of what the reference held. */
double cs_fate_drift(const struct cs_trial *trial, const struct cs_trial *reference);

#endif
