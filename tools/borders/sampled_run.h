/* sampled_run.h - sampled runs and their verdicts: the energy monitor's, and for
 * sound runs a comparison with a trusted run of the same scene. */
#ifndef CS_SAMPLED_RUN_H
#define CS_SAMPLED_RUN_H

#include "session/recorded_run.h"
#include "study/stability_verdict.h"

/* Runs a scene once for a study and records scalar figures, no states.
 *
 * The state is sampled at equal intervals of time, independent of the step, so runs with
 * different steps are comparable. */

/* Request for a run; pointers are borrowed. */
struct cs_sampled_run_settings {
    struct cs_session_settings session; /* fps is not used */
    double seconds;                     /* to simulate */
    uint32_t samples;                   /* about so many; at least 1 */
    /* called at the start and at each sample; may be NULL */
    void (*on_sample)(void *ctx, const struct cs_run *run, const struct cs_energy *energy);
    void *ctx;
};

/* Figures of a run. They are valid up to the time that the run reached. */
struct cs_sampled_run {
    struct cs_run_result result;
    struct cs_energy_monitor monitor;
    uint64_t steps;
    double mean_step;                   /* s, mean length of a step */
    double end_energy;                  /* J, whole */
    double kinetic;                     /* J, largest */
    double energy_max;                  /* J, largest kinetic + elastic */
    double mean_kinetic;                /* J, over the samples */
    double speed_max;                   /* m/s, largest */
    double seconds;                     /* wall time in the method */
    struct cs_crossing_stats crossings; /* of the samples, where the scene counts them */
};

/* Runs the scene and fills *trial. A blow-up or a failed method is a result, not an error.
 * Errors are those of the scene, the command, memory, or CS_ERR_INTERRUPT. */
enum cs_status cs_sampled_run_execute(struct cs_sampled_run *sample,
                                      const struct cs_sampled_run_settings *settings,
                                      struct cs_error *error);

/* Verdict on a run by its outcome and its monitor; a sound one by that of the reference over
 * the same time, too: over-damped, if its mean kinetic energy is below half. NULL: none.
 *
 * is_full_length: the run was meant to last as long as the reference; otherwise
 * CS_STABILITY_SHORT replaces the stable verdicts. */
enum cs_stability_verdict cs_stability_judge(const struct cs_sampled_run *sample,
                                             const struct cs_sampled_run *reference,
                                             bool is_full_length);

/* Energy at the end minus that of the reference, as a fraction of the energy the reference
 * held. */
double cs_stability_drift(const struct cs_sampled_run *sample,
                          const struct cs_sampled_run *reference);

#endif
