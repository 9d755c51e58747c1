/* Samples runs, and compares sound ones with a trusted one. */
#include "borders/sampled_run.h"

#include <math.h>

/* J; below it the reference counts as motionless. Otherwise rounding errors alone would exceed
 * every multiple of its energy. */
#define LEAST_ENERGY 1e-15

enum cs_stability_verdict cs_stability_judge(const struct cs_sampled_run *sample,
                                             const struct cs_sampled_run *reference,
                                             bool is_full_length) {
    const enum cs_stability_verdict verdict =
        cs_stability_at_end(sample->result.outcome, sample->monitor.worst_verdict);
    if (!cs_stability_is_stable(verdict))
        return verdict;
    if (!is_full_length)
        return CS_STABILITY_SHORT;
    if (reference && reference->kinetic > LEAST_ENERGY &&
        sample->mean_kinetic < 0.5 * reference->mean_kinetic)
        return CS_STABILITY_DAMPED;
    return verdict;
}

double cs_stability_drift(const struct cs_sampled_run *sample,
                          const struct cs_sampled_run *reference) {
    return (sample->end_energy - reference->end_energy) /
           fmax(reference->energy_max, LEAST_ENERGY);
}

/* Updates all figures with the state of one sample. */
static void take_sample(struct cs_sampled_run *sample,
                        const struct cs_sampled_run_settings *settings,
                        const struct cs_run *run) {
    struct cs_energy_monitor_row row;
    cs_energy_monitor_sample(&sample->monitor, run, &row);
    sample->end_energy = cs_energy_total(&row.energy);
    sample->kinetic = fmax(sample->kinetic, row.energy.kinetic);
    sample->energy_max = fmax(sample->energy_max, cs_energy_without_gravity(&row.energy));
    sample->mean_kinetic += row.energy.kinetic;
    sample->speed_max = fmax(sample->speed_max, row.speed);
    cs_crossing_stats_add(&sample->crossings, run);
    if (settings->on_sample)
        settings->on_sample(settings->ctx, run, &row.energy);
}

/* Frame rate of the samples: a whole number of steps between two samples, so dt is not
 * shortened to end at a sample. The interval is rounded down: there may be more samples than
 * requested. */
static double choose_fps(const struct cs_sampled_run_settings *settings) {
    const double space = settings->seconds / settings->samples;
    if (settings->session.dt <= 0)
        return 1 / space;
    const double steps = fmax(1, floor(space / settings->session.dt));
    return 1 / (steps * settings->session.dt);
}

/* Steps to the end; the sample at the start is included in the mean. */
static void run_samples(struct cs_sampled_run *sample,
                        const struct cs_sampled_run_settings *settings, struct cs_run *run,
                        struct cs_error *error) {
    struct cs_follow follow = {.run = run,
                               .last = cs_follow_frames(run->system->scene, settings->seconds),
                               .every = 1};
    if (cs_energy_monitor_begin(&sample->monitor, run, error))
        return;
    do
        take_sample(sample, settings, run);
    while (cs_follow_next(&follow, error));
    sample->steps = run->counts.steps;
    sample->mean_step =
        run->t > 0 && sample->steps ? run->t / (double)sample->steps : settings->session.dt;
    sample->seconds = run->advance_seconds;
    sample->mean_kinetic /= run->frame + 1;
}

enum cs_status cs_sampled_run_execute(struct cs_sampled_run *sample,
                                      const struct cs_sampled_run_settings *settings,
                                      struct cs_error *error) {
    struct cs_session_settings asked = settings->session;
    struct cs_session session;
    *sample = (struct cs_sampled_run){0};
    asked.fps = choose_fps(settings);
    asked.count_crossings_only = true;
    if (cs_session_open_system(&session, &asked, error))
        return error->status;
    if (!cs_session_begin(&session, NULL, error))
        run_samples(sample, settings, &session.run, error);
    cs_follow_result(&session.run, "", &sample->result, error);
    cs_session_close(&session);
    return error->status;
}
