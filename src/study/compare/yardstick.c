/* Computes the verified reference: four runs, their differences, and whether they agree. */
#include "study/compare/yardstick.h"

#include "base/hash.h"
#include "model/force/measure.h"
#include "study/compare/yardstick_cache.h"
#include "study/compare/yardstick_choice.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A family's own error explains a difference up to that many times itself, and agreement to
 * less than that share of the motion is asked of nobody. */
#define EXPLAINED 100
#define FLOOR     1e-9

static void tell(const struct cs_yardstick_settings *settings, uint32_t done,
                 const char *what) {
    if (settings->progress)
        settings->progress(settings->ctx, done, CS_YARDSTICK_RUNS + 1, what);
}

/* Runs one of the four; *good: it got to the end. */
static enum cs_status run_one(struct cs_yardstick *yardstick, int k,
                              const struct cs_yardstick_settings *settings,
                              struct cs_track *track, bool *good, struct cs_error *error) {
    struct cs_course course;
    struct cs_course_end end = {0};
    tell(settings, (uint32_t)k, yardstick->methods[k]);
    if (!cs_course_open(&course, settings->course, yardstick->methods[k], error) &&
        !cs_track_init(track, &course, error))
        cs_course_run(&course, 0, track, &end, error);
    *good = !error->status && !end.failed && end.outcome == CS_RUNNING;
    if (!error->status && !*good)
        snprintf(yardstick->reason, sizeof yardstick->reason, "%.100s: %.200s",
                 yardstick->methods[k], end.failed ? end.note : cs_outcome_text(end.outcome));
    cs_course_close(&course);
    return error->status;
}

/* largest RMS and particle distance of two runs at any frame */
static void compare(const struct cs_system *system, const struct cs_track *a,
                    const struct cs_track *b, double *rms, double *largest) {
    *rms = *largest = 0;
    for (uint32_t k = 1; k <= a->frames; k++) {
        const double *x = cs_track_state(a, k), *y = cs_track_state(b, k);
        *rms = fmax(*rms, cs_distance_rms(system, x, y));
        *largest = fmax(*largest, cs_distance_max(system, x, y));
    }
}

static void measure_motion(struct cs_yardstick *yardstick, const struct cs_system *system) {
    const struct cs_track *track = &yardstick->track;
    for (uint32_t k = 0; k <= track->frames; k++) {
        const double *x = cs_track_state(track, k);
        const struct cs_energy energy =
            cs_measure_energy(system, k / system->scene->time.fps, x, x + 3 * (size_t)track->n);
        yardstick->kinetic = fmax(yardstick->kinetic, energy.kinetic);
        yardstick->strain = fmax(yardstick->strain, cs_measure_strain(system, x));
        yardstick->scale =
            fmax(yardstick->scale, cs_distance_rms(system, x, cs_track_state(track, 0)));
    }
}

static void measure_bar(struct cs_yardstick *yardstick, const struct cs_system *system,
                        const struct cs_track tracks[CS_YARDSTICK_RUNS]) {
    double largest[3];
    compare(system, tracks, tracks + 1, yardstick->differences, largest);
    compare(system, tracks + 2, tracks + 3, yardstick->differences + 1, largest + 1);
    compare(system, tracks + 1, tracks + 3, yardstick->differences + 2, largest + 2);
    for (int k = 0; k < 3; k++) {
        yardstick->bar = fmax(yardstick->bar, yardstick->differences[k]);
        yardstick->bar_max = fmax(yardstick->bar_max, largest[k]);
    }
}

static void judge(struct cs_yardstick *yardstick) {
    const double *differences = yardstick->differences;
    const double own = fmax(differences[0], differences[1]);
    const char *first = yardstick->methods[0], *second = yardstick->methods[2];
    yardstick->agree = differences[2] <= fmax(EXPLAINED * own, FLOOR * yardstick->scale);
    if (!yardstick->agree)
        snprintf(yardstick->reason, sizeof yardstick->reason,
                 "%.*s and %.*s differ by %.2g m, but by %.2g m and %.2g m from their own "
                 "tighter twins: one of them solves another problem",
                 (int)strcspn(first, ":"), first, (int)strcspn(second, ":"), second,
                 differences[2], differences[0], differences[1]);
}

static void judge_horizon(struct cs_yardstick *yardstick) {
    const double time = yardstick->track.frames / yardstick->track.fps;
    const struct cs_horizon *horizon = &yardstick->horizon;
    yardstick->pointwise = false;
    if (!yardstick->agree)
        return;
    if (!(horizon->time > time))
        snprintf(yardstick->reason, sizeof yardstick->reason,
                 "a displacement of %.0g m in one particle grows %.2g times and reaches %.0g m "
                 "at %.3g s: no error of a single particle means anything beyond it",
                 CS_HORIZON_START, horizon->amplification, yardstick->accuracy, horizon->time);
    else if (yardstick->bar > yardstick->accuracy)
        snprintf(yardstick->reason, sizeof yardstick->reason,
                 "the reference itself is only known to %.2g m, and %.2g m were asked for",
                 yardstick->bar, yardstick->accuracy);
    else
        yardstick->pointwise = true;
}

/* The four runs; the tighter twin of the first family becomes the reference. */
static enum cs_status compute(struct cs_yardstick *yardstick, const struct cs_course *probe,
                              const struct cs_yardstick_settings *settings,
                              struct cs_error *error) {
    struct cs_track tracks[CS_YARDSTICK_RUNS] = {0};
    bool good = true;
    for (int k = 0; k < CS_YARDSTICK_RUNS && good; k++)
        run_one(yardstick, k, settings, tracks + k, &good, error);
    if (good) {
        yardstick->track = tracks[1];
        measure_motion(yardstick, &probe->session.system);
        measure_bar(yardstick, &probe->session.system, tracks);
        judge(yardstick);
        /* its states now belong to the reference and must not be freed below */
        tracks[1] = (struct cs_track){0};
        tell(settings, CS_YARDSTICK_RUNS, "horizon");
        cs_horizon_measure(&yardstick->horizon, settings->course, settings->accuracy,
                           yardstick->methods[0], error);
        judge_horizon(yardstick);
    }
    for (int k = 0; k < CS_YARDSTICK_RUNS; k++)
        cs_track_finish(tracks + k);
    return error->status;
}

enum cs_status cs_yardstick_plan(struct cs_yardstick *yardstick,
                                 const struct cs_yardstick_settings *settings, char *key,
                                 struct cs_error *error) {
    char chosen[2][256];
    struct cs_course probe = {0};
    *yardstick = (struct cs_yardstick){.accuracy = settings->accuracy};
    if (cs_yardstick_choose(settings, chosen, error))
        return error->status;
    for (int k = 0; k < 2; k++) {
        memcpy(yardstick->methods[2 * k], chosen[k], sizeof chosen[k]);
        if (cs_yardstick_tighten(chosen[k], yardstick->methods[2 * k + 1], sizeof chosen[k],
                                 error))
            return error->status;
    }
    if (!cs_course_open(&probe, settings->course, chosen[0], error))
        cs_yardstick_key(yardstick, &probe, settings, key, error);
    cs_course_close(&probe);
    return error->status;
}

enum cs_status cs_yardstick_get(struct cs_yardstick *yardstick,
                                const struct cs_yardstick_settings *settings,
                                struct cs_error *error) {
    char key[CS_HASH_DIGITS];
    struct cs_course probe = {0};
    if (cs_yardstick_plan(yardstick, settings, key, error) ||
        cs_course_open(&probe, settings->course, yardstick->methods[0], error))
        return error->status;
    const bool found =
        settings->cache && cs_yardstick_read(yardstick, settings->cache, key, &probe);
    if (!found && !compute(yardstick, &probe, settings, error) && yardstick->agree &&
        settings->cache)
        cs_yardstick_write(yardstick, settings->cache, key, error);
    tell(settings, CS_YARDSTICK_RUNS + 1, "");
    cs_course_close(&probe);
    if (error->status)
        cs_yardstick_finish(yardstick);
    return error->status;
}

uint32_t cs_yardstick_pointwise_frames(const struct cs_yardstick *yardstick) {
    return yardstick->pointwise ? yardstick->track.frames : 0;
}

void cs_yardstick_finish(struct cs_yardstick *yardstick) {
    cs_track_finish(&yardstick->track);
    *yardstick = (struct cs_yardstick){0};
}
