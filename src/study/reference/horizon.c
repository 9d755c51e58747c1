/* Measures the predictability horizon: how fast runs from nearly equal starts move apart. */
#include "study/reference/horizon.h"

#include "study/deviation.h"

#include <math.h>

/* the free particle in the middle of the list; false: all are pinned */
static bool disturb(struct cs_course *course) {
    const struct cs_view *view = &course->session.system.view;
    uint32_t free = 0, seen = 0;
    for (uint32_t i = 0; i < view->n; i++)
        free += view->inv_mass[i] > 0;
    for (uint32_t i = 0; i < view->n; i++)
        if (view->inv_mass[i] > 0 && seen++ == free / 2) {
            // out of every plane of symmetry
            for (size_t c = 0; c < 3; c++)
                course->start[c * view->n + i] += CS_HORIZON_START / sqrt(3);
            return true;
        }
    return false;
}

static void compare(struct cs_horizon *horizon, const struct cs_course *course,
                    const struct cs_track *a, const struct cs_track *b, double accuracy) {
    const struct cs_system *system = &course->session.system;
    const double start = cs_distance_rms(system, cs_track_state(a, 0), cs_track_state(b, 0));
    horizon->time = HUGE_VAL;
    for (uint32_t k = 1; k <= a->frames; k++) {
        horizon->separation =
            cs_distance_rms(system, cs_track_state(a, k), cs_track_state(b, k));
        if (horizon->separation >= accuracy && horizon->time == HUGE_VAL)
            horizon->time = k / a->fps;
    }
    horizon->amplification = start > 0 ? horizon->separation / start : 0;
}

static enum cs_status run_twins(struct cs_horizon *horizon, struct cs_course *course,
                                double accuracy, bool *done, struct cs_error *error) {
    struct cs_track tracks[2] = {0};
    struct cs_course_end ends[2];
    *done = false;
    for (int k = 0; k < 2 && !error->status; k++) {
        if (k == 1)
            disturb(course);
        if (!cs_track_init(tracks + k, course, error))
            cs_course_run(course, 0, tracks + k, ends + k, error);
    }
    if (!error->status && tracks[0].done == course->frames &&
        tracks[1].done == course->frames) {
        compare(horizon, course, tracks, tracks + 1, accuracy);
        *done = true;
    }
    cs_track_finish(tracks);
    cs_track_finish(tracks + 1);
    return error->status;
}

enum cs_status cs_horizon_measure(struct cs_horizon *horizon,
                                  const struct cs_course_settings *settings, double accuracy,
                                  const char *fallback, struct cs_error *error) {
    const char *const methods[] = {"velocity-verlet", fallback};
    bool done = false;
    *horizon = (struct cs_horizon){.amplification = (double)NAN, .separation = (double)NAN};
    for (int k = 0; k < 2 && !done && methods[k] && !error->status; k++) {
        struct cs_course course;
        if (!cs_course_open(&course, settings, methods[k], error))
            run_twins(horizon, &course, accuracy, &done, error);
        cs_course_close(&course);
    }
    return error->status;
}
