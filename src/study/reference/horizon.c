/* Measures the predictability horizon: how fast runs with nearly equal starts separate. */
#include "study/reference/compare_reference_state.h"

#include "study/trajectory_error.h"

#include <math.h>

/* Fraction of the motion that the bar of implicit families may be, for errors of position to
 * tell methods apart. */
#define RESOLVED 0.1

/* Displaces the free particle in the middle of the list by CS_HORIZON_START, along the space
 * diagonal: a displacement within a plane of symmetry would stay in it. Returns false if all
 * particles are pinned. */
static bool perturb_one(struct cs_recorded_run *recording) {
    const struct cs_view *view = &recording->session.system.view;
    uint32_t free = 0, seen = 0;
    for (uint32_t i = 0; i < view->n; i++)
        free += view->inv_mass[i] > 0;
    for (uint32_t i = 0; i < view->n; i++)
        if (view->inv_mass[i] > 0 && seen++ == free / 2) {
            // out of every plane of symmetry
            for (size_t c = 0; c < 3; c++)
                recording->initial_state[c * view->n + i] += CS_HORIZON_START / sqrt(3);
            return true;
        }
    return false;
}

/* Distance of the two runs at each frame: time of the horizon and total growth. */
static void compare(struct cs_horizon *horizon, const struct cs_recorded_run *recording,
                    const struct cs_trajectory *a, const struct cs_trajectory *b,
                    double accuracy) {
    const struct cs_system *system = &recording->session.system;
    const double start =
        cs_distance_rms(system, a, 0, cs_trajectory_state(a, 0), cs_trajectory_state(b, 0));
    horizon->time = HUGE_VAL;
    for (uint32_t k = 1; k <= a->frames; k++) {
        horizon->separation =
            cs_distance_rms(system, a, k, cs_trajectory_state(a, k), cs_trajectory_state(b, k));
        if (horizon->separation >= accuracy && horizon->time == HUGE_VAL)
            horizon->time = k / a->fps;
    }
    horizon->growth = start > 0 ? horizon->separation / start : 0;
}

/* Runs the scene and its perturbed twin. *done: both reached their last frame. */
static enum cs_status run_twins(struct cs_horizon *horizon, struct cs_recorded_run *recording,
                                double accuracy, bool *done, struct cs_error *error) {
    struct cs_trajectory trajectories[2] = {0};
    struct cs_recorded_run_result ends[2];
    *done = false;
    for (int k = 0; k < 2 && !error->status; k++) {
        if (k == 1)
            perturb_one(recording);
        if (!cs_trajectory_init(trajectories + k, recording, error))
            cs_recorded_run_execute(recording, 0, trajectories + k, ends + k, error);
    }
    if (!error->status && trajectories[0].n_recorded == recording->frames &&
        trajectories[1].n_recorded == recording->frames) {
        compare(horizon, recording, trajectories, trajectories + 1, accuracy);
        *done = true;
    }
    cs_trajectory_finish(trajectories);
    cs_trajectory_finish(trajectories + 1);
    return error->status;
}

enum cs_status cs_horizon_measure(struct cs_horizon *horizon,
                                  const struct cs_recorded_run_settings *settings,
                                  double accuracy, const char *first, const char *fallback,
                                  struct cs_error *error) {
    const char *const methods[] = {first, fallback};
    bool done = false;
    *horizon = (struct cs_horizon){.growth = (double)NAN, .separation = (double)NAN};
    for (int k = 0; k < 2 && !done && !error->status; k++) {
        struct cs_recorded_run recording;
        if (!methods[k])
            continue;
        if (!cs_recorded_run_open(&recording, settings, methods[k], error))
            run_twins(horizon, &recording, accuracy, &done, error);
        cs_recorded_run_close(&recording);
    }
    return error->status;
}

/* Decides whether there are pointwise errors. */
static void judge(struct cs_compare_reference *reference) {
    const double time = reference->trajectory.frames / reference->trajectory.fps;
    const struct cs_horizon *horizon = &reference->horizon;
    reference->pointwise = false;
    if (!reference->families_agree)
        return;
    if (!(horizon->time > time))
        snprintf(reference->reason, sizeof reference->reason,
                 "a displacement of %.0g m in one particle grows %.2g times and reaches %.0g m "
                 "at %.3g s: errors of single particles have no meaning after that time",
                 CS_HORIZON_START, horizon->growth, reference->accuracy, horizon->time);
    else if (reference->error_bar > reference->accuracy)
        snprintf(reference->reason, sizeof reference->reason,
                 "the reference is accurate only to %.2g m, but %.2g m was requested",
                 reference->error_bar, reference->accuracy);
    else
        reference->pointwise = true;
}

enum cs_status
cs_compare_reference_judge_horizon(struct cs_compare_reference *reference,
                                   const struct cs_recorded_run_settings *settings,
                                   struct cs_error *error) {
    const bool is_implicit = reference->explicit_passes > 0;
    reference->horizon = (struct cs_horizon){(double)NAN, (double)NAN, HUGE_VAL};
    if (is_implicit && reference->error_bar <= RESOLVED * reference->motion_scale)
        reference->accuracy = fmax(reference->accuracy, reference->error_bar);
    if (!is_implicit || reference->error_bar <= reference->accuracy)
        cs_horizon_measure(&reference->horizon, settings, reference->accuracy,
                           is_implicit ? NULL : "velocity-verlet", reference->methods[0],
                           error);
    judge(reference);
    return error->status;
}
