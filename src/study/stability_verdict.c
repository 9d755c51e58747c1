/* Derives the verdict on a run by comparing it with a trusted run of the same scene. */
#include "study/stability_verdict.h"

#include <math.h>

/* below this the reference does not move: rounding alone must not look like a motion */
#define LEAST_ENERGY 1e-15
#define LEAST_SPEED  1e-9

static const struct {
    const char *word, *help;
    char letter;
} verdicts[] = {
#define X(name, word, letter, help) [name] = {word, help, letter},
    CS_STABILITY_LIST(X)
#undef X
};

const char *cs_stability_word(enum cs_stability_verdict verdict) {
    return verdicts[verdict].word;
}

const char *cs_stability_help(enum cs_stability_verdict verdict) {
    return verdicts[verdict].help;
}

char cs_stability_letter(enum cs_stability_verdict verdict) {
    return verdicts[verdict].letter;
}

struct cs_trial_limits cs_stability_limits(const struct cs_trial *reference) {
    const double held = fmax(reference->held, LEAST_ENERGY);
    return (struct cs_trial_limits){
        .speed = 5 * fmax(reference->speed, LEAST_SPEED),
        .energy = 2 * held,
        .gain = reference->gained + held / 2,
    };
}

static bool is_growing(const struct cs_trial *trial, const struct cs_trial *reference) {
    return trial->late > 1.5 * trial->early ||
           trial->mean_kinetic > 10 * fmax(reference->mean_kinetic, LEAST_ENERGY);
}

enum cs_stability_verdict cs_stability_judge(const struct cs_trial *trial,
                                             const struct cs_trial *reference, bool whole) {
    if (trial->result.outcome == CS_NOT_FINITE)
        return CS_STABILITY_NOT_FINITE;
    if (trial->result.outcome == CS_UNBOUNDED ||
        (trial->beyond && is_growing(trial, reference)))
        return CS_STABILITY_GLOBAL;
    if (trial->result.outcome == CS_FAILED)
        return CS_STABILITY_FAILED;
    if (trial->excess.found)
        return CS_STABILITY_LOCAL;
    if (trial->result.outcome == CS_OVER_BUDGET)
        return CS_STABILITY_OVER_BUDGET;
    if (!whole)
        return CS_STABILITY_SHORT;
    if (reference->kinetic > LEAST_ENERGY &&
        trial->mean_kinetic < 0.5 * reference->mean_kinetic)
        return CS_STABILITY_DAMPED;
    return CS_STABILITY_BOUNDED;
}

double cs_stability_drift(const struct cs_trial *trial, const struct cs_trial *reference) {
    return (trial->end_energy - reference->end_energy) / fmax(reference->held, LEAST_ENERGY);
}
