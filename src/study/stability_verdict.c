/* Derives the verdict on a run by comparison with a trusted run of the same scene. */
#include "study/stability_verdict.h"

#include <math.h>

/* J and m/s; below these the reference counts as motionless. Otherwise rounding errors alone
 * would exceed every multiple of its energy. */
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

struct cs_sampled_run_limits cs_stability_limits(const struct cs_sampled_run *reference) {
    const double held = fmax(reference->energy_max, LEAST_ENERGY);
    return (struct cs_sampled_run_limits){
        .speed = 5 * fmax(reference->speed_max, LEAST_SPEED),
        .energy = 2 * held,
        .energy_gain = reference->energy_gain_max + held / 2,
    };
}

/* True if the energy grows between the halves of the run, or is far above the reference. */
static bool is_growing(const struct cs_sampled_run *trial,
                       const struct cs_sampled_run *reference) {
    return trial->energy_max_second_half > 1.5 * trial->energy_max_first_half ||
           trial->mean_kinetic > 10 * fmax(reference->mean_kinetic, LEAST_ENERGY);
}

enum cs_stability_verdict cs_stability_judge(const struct cs_sampled_run *trial,
                                             const struct cs_sampled_run *reference,
                                             bool whole) {
    if (trial->result.outcome == CS_NOT_FINITE)
        return CS_STABILITY_NOT_FINITE;
    if (trial->result.outcome == CS_UNBOUNDED ||
        (trial->exceeded_limit && is_growing(trial, reference)))
        return CS_STABILITY_GLOBAL;
    if (trial->result.outcome == CS_FAILED)
        return CS_STABILITY_FAILED;
    if (trial->speed_excess.exists)
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

double cs_stability_drift(const struct cs_sampled_run *trial,
                          const struct cs_sampled_run *reference) {
    return (trial->end_energy - reference->end_energy) /
           fmax(reference->energy_max, LEAST_ENERGY);
}
