/* stability_verdict.h - sampled runs and their verdicts: the energy monitor's, and for
 * sound runs a comparison with a trusted run of the same scene. */
#ifndef CS_STABILITY_VERDICT_H
#define CS_STABILITY_VERDICT_H

#include "session/energy_monitor.h"
#include "session/recorded_run.h"
#include "session/session.h"

/* Tells a singular force from a step that is too long, for a run that ended or was unstable
 * within so many seconds. dop853 runs the scene from its start with steps by their error. Where
 * another method's step is too long it goes on. Where a force has no bound its steps shrink
 * without end, or it blows up too, whatever step the other method takes. Sets *found, whose
 * text is empty if there is none, if dop853 refuses the scene, and after so many evaluations of
 * the forces and CS_SINGULAR_SECONDS nominal seconds. CS_ERR_MEMORY. */
#define CS_SINGULAR_SECONDS 0.01
struct cs_singular_force {
    char text[200];    /* "a force is singular at t = ... s, particle ...: no step passes" */
    double time;       /* s */
    uint32_t particle; /* of the greatest acceleration */
};
enum cs_status cs_singular_force_find(const struct cs_session_settings *settings,
                                      double seconds, double evaluations,
                                      struct cs_singular_force *found, struct cs_error *error);

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

/* Verdict on a run that ended so, and of which samples showed `seen`. */
enum cs_stability_verdict cs_stability_at_end(enum cs_outcome outcome,
                                              enum cs_stability_verdict seen);

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
