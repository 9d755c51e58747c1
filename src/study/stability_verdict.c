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

/* Runs a scene once for a study and samples scalar figures. */

/* Records the largest speed, and the first time and largest number of particles above the
 * limit. */
static void note_excess(struct cs_sampled_run *trial, const struct cs_run *run, double limit) {
    struct cs_speed_excess *excess = &trial->speed_excess;
    uint32_t fastest, count;
    const double speed = cs_measure_speed(run->system, run->v, limit, &fastest, &count);
    trial->speed_max = fmax(trial->speed_max, speed);
    if (count && !excess->exists) {
        excess->exists = true;
        excess->time = run->t;
    }
    excess->particles = count > excess->particles ? count : excess->particles;
}

/* Updates all figures with the state of one sample. */
static void take_sample(struct cs_sampled_run *trial,
                        const struct cs_sampled_run_settings *settings,
                        const struct cs_run *run) {
    const struct cs_energy energy = cs_diagnostics_energy(run->system, run->t, run->x, run->v);
    const double whole = cs_energy_total(&energy);
    if (run->frame == 0)
        trial->start_energy = whole;
    trial->end_energy = whole;
    trial->kinetic = fmax(trial->kinetic, energy.kinetic);
    trial->energy_max = fmax(trial->energy_max, cs_energy_without_gravity(&energy));
    /* energy that keeps growing from one half to the next marks an instability */
    double *half = run->t < settings->seconds / 2 ? &trial->energy_max_first_half
                                                  : &trial->energy_max_second_half;
    *half = fmax(*half, cs_energy_without_gravity(&energy));
    trial->energy_gain_max = fmax(trial->energy_gain_max, whole - trial->start_energy);
    trial->mean_kinetic += energy.kinetic;
    note_excess(trial, run, settings->limits.speed);
    cs_crossing_stats_add(&trial->crossings, run);
    /* only the first crossing counts: its time is reported */
    if (!trial->exceeded_limit && (trial->energy_max > settings->limits.energy ||
                                   trial->energy_gain_max > settings->limits.energy_gain)) {
        trial->exceeded_limit = true;
        trial->exceeded_time = run->t;
    }
    if (settings->on_sample)
        settings->on_sample(settings->ctx, run, &energy);
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
static void run_samples(struct cs_sampled_run *trial,
                        const struct cs_sampled_run_settings *settings, struct cs_run *run,
                        struct cs_error *error) {
    struct cs_follow follow = {.run = run,
                               .last = cs_follow_frames(run->system->scene, settings->seconds),
                               .every = 1};
    do
        take_sample(trial, settings, run);
    while (cs_follow_next(&follow, error));
    trial->steps = run->counts.steps;
    trial->mean_step =
        run->t > 0 && trial->steps ? run->t / (double)trial->steps : settings->session.dt;
    trial->seconds = run->advance_seconds;
    trial->mean_kinetic /= run->frame + 1;
}

enum cs_status cs_sampled_run_execute(struct cs_sampled_run *trial,
                                      const struct cs_sampled_run_settings *settings,
                                      struct cs_error *error) {
    struct cs_session_settings asked = settings->session;
    struct cs_session session;
    *trial = (struct cs_sampled_run){0};
    asked.fps = choose_fps(settings);
    asked.count_crossings_only = true;
    if (cs_session_open_system(&session, &asked, error))
        return error->status;
    if (!cs_session_begin(&session, NULL, error))
        run_samples(trial, settings, &session.run, error);
    cs_follow_result(&session.run, "", &trial->result, error);
    cs_session_close(&session);
    return error->status;
}
