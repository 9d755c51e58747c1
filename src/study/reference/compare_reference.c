/* Computes the verified reference: four runs, their differences, and whether they agree. */
#include "session/scene_view.h"
#include "study/reference/compare_reference_state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Families agree if they differ by at most EXPLAINED times the larger of their own errors, or
 * by FLOOR of the motion. */
#define EXPLAINED 100
#define FLOOR     1e-9

/* The second family is in error if it is farther from the reference than ROUGH times the own
 * error of the first family and than ROUNDING of the motion. The next candidate is then tried
 * in its place. */
#define ROUGH    10
#define ROUNDING 1e-13

/* Reports the progress in hundredths; the horizon counts as one more run. */
static void tell(const struct cs_compare_reference_settings *settings, double done,
                 const char *what) {
    if (settings->progress)
        settings->progress(settings->ctx,
                           (uint32_t)(100 * done / (CS_COMPARE_REFERENCE_RUNS + 1)), 100, what);
}

/* A run, for the progress of its steps. */
struct steps {
    const struct cs_compare_reference_settings *settings;
    double before, rate; /* runs before it; of it per s */
};

static bool tell_step(void *ctx, double t, double dt, double *x, double *v) {
    const struct steps *steps = ctx;
    (void)dt, (void)x, (void)v;
    tell(steps->settings, steps->before + steps->rate * t, NULL);
    return false;
}

/* Records run k of the four. *good: it reached its last frame. */
static enum cs_status run_one(struct cs_compare_reference *reference, int k,
                              const struct cs_compare_reference_settings *settings,
                              struct cs_trajectory *trajectory, bool *good,
                              struct cs_error *error) {
    struct cs_recorded_run recording;
    struct cs_recorded_run_settings asked = *settings->run;
    struct cs_recorded_run_result result = {0};
    struct steps steps = {settings, k, 0};
    asked.session.run.after_commit = tell_step;
    asked.session.run.ctx = &steps;
    tell(settings, k, reference->methods[k]);
    if (!cs_recorded_run_open(&recording, &asked, reference->methods[k], error) &&
        !cs_trajectory_init(trajectory, &recording, error)) {
        steps.rate = trajectory->fps / trajectory->frames;
        cs_recorded_run_execute(&recording, 0, trajectory, &result, error);
    }
    *good = !error->status && result.result.outcome == CS_RUNNING;
    if (!error->status && !*good)
        snprintf(reference->reason, sizeof reference->reason, "%.100s: %.200s",
                 reference->methods[k], result.result.message);
    cs_recorded_run_close(&recording);
    return error->status;
}

/* Largest RMS distance and largest particle distance of two runs over all frames, in m. */
static void compare(const struct cs_system *system, const struct cs_trajectory *a,
                    const struct cs_trajectory *b, double *rms, double *largest) {
    *rms = *largest = 0;
    for (uint32_t k = 1; k <= a->frames; k++) {
        const double *x = cs_trajectory_state(a, k), *y = cs_trajectory_state(b, k);
        *rms = fmax(*rms, cs_distance_rms(system, a, k, x, y));
        *largest = fmax(*largest, cs_distance_max(system, x, y));
    }
}

/* Scales of the motion that make errors relative: displacement, kinetic energy, strain. */
static void measure_motion(struct cs_compare_reference *reference,
                           const struct cs_system *system) {
    const struct cs_trajectory *trajectory = &reference->trajectory;
    for (uint32_t k = 0; k <= trajectory->frames; k++) {
        const double *x = cs_trajectory_state(trajectory, k);
        const struct cs_energy energy = cs_diagnostics_energy(
            system, k / system->scene->time.fps, x, x + 3 * (size_t)trajectory->n);
        reference->kinetic = fmax(reference->kinetic, energy.kinetic);
        reference->strain = fmax(reference->strain, cs_diagnostics_strain(system, x));
        reference->motion_scale =
            fmax(reference->motion_scale,
                 cs_distance_rms(system, trajectory, k, x, cs_trajectory_state(trajectory, 0)));
    }
}

/* Differences and error bars, as the header defines them. */
static void measure_bar(struct cs_compare_reference *reference, const struct cs_system *system,
                        const struct cs_trajectory trajectories[CS_COMPARE_REFERENCE_RUNS]) {
    double largest[3];
    compare(system, trajectories, trajectories + 1, reference->differences, largest);
    reference->error_bar = reference->differences[0];
    reference->error_bar_max = largest[0];
    reference->differences[1] = reference->differences[2] = (double)NAN;
    if (reference->has_one_family)
        return;
    compare(system, trajectories + 2, trajectories + 3, reference->differences + 1,
            largest + 1);
    compare(system, trajectories + 1, trajectories + 3, reference->differences + 2,
            largest + 2);
    // what the looser twin of the other family is off by is no error of the reference
    reference->error_bar = fmax(reference->differences[0], reference->differences[2]);
    reference->error_bar_max = fmax(largest[0], largest[2]);
}

/* True if another second family should be tried. */
static bool has_disagreement(const struct cs_compare_reference *reference) {
    const double *differences = reference->differences;
    return differences[2] > ROUGH * differences[0] &&
           differences[2] > ROUNDING * reference->motion_scale;
}

/* Decides whether the families agree. */
static void judge(struct cs_compare_reference *reference) {
    const double *differences = reference->differences;
    const double own = fmax(differences[0], differences[1]);
    const bool is_lost = reference->explicit_passes > 0 && !(reference->motion_scale > 0);
    reference->families_agree = reference->has_one_family && !is_lost;
    if (is_lost)
        snprintf(
            reference->reason, sizeof reference->reason,
            "nothing moves: the scene is at rest, or its weight is lost in the rounding of "
            "its springs");
    if (is_lost || reference->has_one_family)
        return;
    const char *first = reference->methods[0], *second = reference->methods[2];
    reference->families_agree =
        differences[2] <= fmax(EXPLAINED * own, FLOOR * reference->motion_scale);
    if (!reference->families_agree)
        snprintf(reference->reason, sizeof reference->reason,
                 "%.*s and %.*s differ by %.2g m, but by %.2g m and %.2g m from their own "
                 "tighter twins: the two families do not solve the same problem",
                 (int)strcspn(first, ":"), first, (int)strcspn(second, ":"), second,
                 differences[2], differences[0], differences[1]);
}

/* Records runs `from` to `to` - 1. Returns false if one of them ended early or *error is set.
 */
static bool run_some(struct cs_compare_reference *reference, int from, int to,
                     const struct cs_compare_reference_settings *settings,
                     struct cs_trajectory trajectories[CS_COMPARE_REFERENCE_RUNS],
                     struct cs_error *error) {
    bool good = true;
    for (int k = from; k < to && good; k++)
        run_one(reference, k, settings, trajectories + k, &good, error);
    return good;
}

/* Stores the settings of a family and those of its tighter twin. */
static enum cs_status name_twins(struct cs_compare_reference *reference, int family,
                                 const char *chosen, struct cs_error *error) {
    char *const pair = reference->methods[(size_t)2 * (size_t)family];
    snprintf(pair, sizeof *reference->methods, "%s", chosen);
    return cs_compare_reference_tighten(chosen, reference->methods[2 * family + 1],
                                        sizeof *reference->methods, error);
}

/* Runs the second family; if it does not finish, the replacement. */
static bool run_second(struct cs_compare_reference *reference,
                       const struct cs_compare_reference_settings *settings,
                       struct cs_trajectory trajectories[CS_COMPARE_REFERENCE_RUNS],
                       struct cs_error *error) {
    if (run_some(reference, 2, CS_COMPARE_REFERENCE_RUNS, settings, trajectories, error))
        return true;
    if (error->status || !*reference->replacement ||
        name_twins(reference, 1, reference->replacement, error))
        return false;
    *reference->replacement = *reference->reason = 0;
    cs_trajectory_finish(trajectories + 2);
    cs_trajectory_finish(trajectories + 3);
    return run_some(reference, 2, CS_COMPARE_REFERENCE_RUNS, settings, trajectories, error);
}

/* Tries the replacement as second family, and keeps it if it comes nearer. A method of fixed
 * steps loses its order where the derivative of the force jumps, for example at slow friction,
 * and then says little about the reference. */
static enum cs_status ask_another(struct cs_compare_reference *reference,
                                  const struct cs_system *system,
                                  const struct cs_compare_reference_settings *settings,
                                  struct cs_trajectory trajectories[CS_COMPARE_REFERENCE_RUNS],
                                  struct cs_error *error) {
    struct cs_compare_reference other = *reference;
    struct cs_trajectory own[CS_COMPARE_REFERENCE_RUNS] = {
        trajectories[0], trajectories[1], {0}, {0}};
    if (name_twins(&other, 1, reference->replacement, error))
        return error->status;
    if (run_some(&other, 2, CS_COMPARE_REFERENCE_RUNS, settings, own, error)) {
        measure_bar(&other, system, own);
        if (other.error_bar < reference->error_bar)
            *reference = other;
    }
    cs_trajectory_finish(own + 2);
    cs_trajectory_finish(own + 3);
    return error->status;
}

/* Runs the second family. Where explicit methods are too dear, the twins of the first are a
 * reference by themselves if the second does not finish: Richardson's comparison of two steps.
 * Returns false if there is no reference. */
static bool has_second(struct cs_compare_reference *reference,
                       const struct cs_compare_reference_settings *settings,
                       struct cs_trajectory trajectories[CS_COMPARE_REFERENCE_RUNS],
                       struct cs_error *error) {
    const bool good = run_second(reference, settings, trajectories, error);
    reference->has_one_family = !good && !error->status && reference->explicit_passes > 0;
    return good || reference->has_one_family;
}

/* The four runs; the tighter twin of the first family becomes the reference. */
static enum cs_status compute(struct cs_compare_reference *reference,
                              const struct cs_recorded_run *probe,
                              const struct cs_compare_reference_settings *settings,
                              struct cs_error *error) {
    const struct cs_system *system = &probe->session.system;
    struct cs_trajectory trajectories[CS_COMPARE_REFERENCE_RUNS] = {0};
    if (run_some(reference, 0, 2, settings, trajectories, error) &&
        has_second(reference, settings, trajectories, error)) {
        reference->trajectory = trajectories[1];
        measure_motion(reference, system);
        measure_bar(reference, system, trajectories);
        if (*reference->replacement && has_disagreement(reference))
            ask_another(reference, system, settings, trajectories, error);
        judge(reference);
        /* its states now belong to the reference and must not be freed below */
        trajectories[1] = (struct cs_trajectory){0};
        tell(settings, CS_COMPARE_REFERENCE_RUNS, "horizon");
        if (!error->status)
            cs_compare_reference_judge_horizon(reference, settings->run, error);
    }
    for (int k = 0; k < CS_COMPARE_REFERENCE_RUNS; k++)
        cs_trajectory_finish(trajectories + k);
    return error->status;
}

enum cs_status cs_compare_reference_plan(struct cs_compare_reference *reference,
                                         const struct cs_compare_reference_settings *settings,
                                         char *key, struct cs_error *error) {
    char chosen[2][256];
    struct cs_recorded_run probe = {0};
    *reference = (struct cs_compare_reference){.accuracy = settings->accuracy};
    if (cs_compare_reference_choose(settings, chosen, reference, error) ||
        name_twins(reference, 0, chosen[0], error) ||
        name_twins(reference, 1, chosen[1], error))
        return error->status;
    if (!cs_recorded_run_open(&probe, settings->run, chosen[0], error))
        cs_compare_reference_key(reference, &probe, settings, key, error);
    cs_recorded_run_close(&probe);
    return error->status;
}

/* The runs within the budget of chosen explicit methods; where it is used up, those of implicit
 * ones. The count of the work decides, so that every machine takes the same. */
static enum cs_status compute_within(struct cs_compare_reference *reference,
                                     const struct cs_recorded_run *probe,
                                     const struct cs_compare_reference_settings *settings,
                                     struct cs_error *error) {
    double left = settings->explicit_seconds;
    struct cs_recorded_run_settings bounded = *settings->run;
    struct cs_compare_reference_settings asked = *settings;
    char unused[CS_HASH_DIGITS];
    if (settings->methods[0] || reference->explicit_passes > 0)
        return compute(reference, probe, settings, error);
    bounded.session.run.pot = &left;
    asked.run = &bounded;
    if (compute(reference, probe, &asked, error) || reference->families_agree || left > 0)
        return error->status;
    cs_compare_reference_finish(reference);
    asked.run = settings->run;
    asked.explicit_seconds = 0;
    return cs_compare_reference_plan(reference, &asked, unused, error)
               ? error->status
               : compute(reference, probe, settings, error);
}

enum cs_status cs_compare_reference_get(struct cs_compare_reference *reference,
                                        const struct cs_compare_reference_settings *settings,
                                        struct cs_error *error) {
    char key[CS_HASH_DIGITS];
    struct cs_recorded_run probe = {0};
    if (cs_compare_reference_plan(reference, settings, key, error) ||
        cs_recorded_run_open(&probe, settings->run, reference->methods[0], error))
        return error->status;
    const bool found =
        settings->cache && cs_compare_reference_read(reference, settings->cache, key, &probe);
    if (!found && !compute_within(reference, &probe, settings, error) &&
        reference->families_agree && settings->cache)
        cs_compare_reference_write(reference, settings->cache, key, error);
    tell(settings, CS_COMPARE_REFERENCE_RUNS + 1, "");
    cs_recorded_run_close(&probe);
    if (error->status)
        cs_compare_reference_finish(reference);
    return error->status;
}

uint32_t cs_compare_reference_pointwise_frames(const struct cs_compare_reference *reference) {
    return reference->pointwise ? reference->trajectory.frames : 0;
}

void cs_compare_reference_finish(struct cs_compare_reference *reference) {
    cs_trajectory_finish(&reference->trajectory);
    *reference = (struct cs_compare_reference){0};
}
