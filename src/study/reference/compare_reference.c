/* Computes the verified reference: four runs, their differences, and whether they agree. */
#include "study/reference/compare_reference.h"

#include "base/hash.h"
#include "model/force/measure.h"
#include "study/reference/compare_reference_cache.h"
#include "study/reference/compare_reference_choice.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A family's own error explains a difference up to that many times itself, and agreement to
 * less than that share of the motion is asked of nobody. */
#define EXPLAINED 100
#define FLOOR     1e-9

static void tell(const struct cs_compare_reference_settings *settings, uint32_t done,
                 const char *what) {
    if (settings->progress)
        settings->progress(settings->ctx, done, CS_COMPARE_REFERENCE_RUNS + 1, what);
}

/* Runs one of the four; *good: it got to the end. */
static enum cs_status run_one(struct cs_compare_reference *reference, int k,
                              const struct cs_compare_reference_settings *settings,
                              struct cs_track *track, bool *good, struct cs_error *error) {
    struct cs_course course;
    struct cs_course_end end = {0};
    tell(settings, (uint32_t)k, reference->methods[k]);
    if (!cs_course_open(&course, settings->course, reference->methods[k], error) &&
        !cs_track_init(track, &course, error))
        cs_course_run(&course, 0, track, &end, error);
    *good = !error->status && !end.failed && end.outcome == CS_RUNNING;
    if (!error->status && !*good)
        snprintf(reference->reason, sizeof reference->reason, "%.100s: %.200s",
                 reference->methods[k], end.failed ? end.note : cs_outcome_text(end.outcome));
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

static void measure_motion(struct cs_compare_reference *reference,
                           const struct cs_system *system) {
    const struct cs_track *track = &reference->track;
    for (uint32_t k = 0; k <= track->frames; k++) {
        const double *x = cs_track_state(track, k);
        const struct cs_energy energy =
            cs_measure_energy(system, k / system->scene->time.fps, x, x + 3 * (size_t)track->n);
        reference->kinetic = fmax(reference->kinetic, energy.kinetic);
        reference->strain = fmax(reference->strain, cs_measure_strain(system, x));
        reference->scale =
            fmax(reference->scale, cs_distance_rms(system, x, cs_track_state(track, 0)));
    }
}

static void measure_bar(struct cs_compare_reference *reference, const struct cs_system *system,
                        const struct cs_track tracks[CS_COMPARE_REFERENCE_RUNS]) {
    double largest[3];
    compare(system, tracks, tracks + 1, reference->differences, largest);
    compare(system, tracks + 2, tracks + 3, reference->differences + 1, largest + 1);
    compare(system, tracks + 1, tracks + 3, reference->differences + 2, largest + 2);
    // what the looser twin of the other family is off by is no error of the reference
    reference->bar = fmax(reference->differences[0], reference->differences[2]);
    reference->bar_max = fmax(largest[0], largest[2]);
}

static void judge(struct cs_compare_reference *reference) {
    const double *differences = reference->differences;
    const double own = fmax(differences[0], differences[1]);
    const char *first = reference->methods[0], *second = reference->methods[2];
    reference->agree = differences[2] <= fmax(EXPLAINED * own, FLOOR * reference->scale);
    if (!reference->agree)
        snprintf(reference->reason, sizeof reference->reason,
                 "%.*s and %.*s differ by %.2g m, but by %.2g m and %.2g m from their own "
                 "tighter twins: the two families do not solve the same problem",
                 (int)strcspn(first, ":"), first, (int)strcspn(second, ":"), second,
                 differences[2], differences[0], differences[1]);
}

static void judge_horizon(struct cs_compare_reference *reference) {
    const double time = reference->track.frames / reference->track.fps;
    const struct cs_horizon *horizon = &reference->horizon;
    reference->pointwise = false;
    if (!reference->agree)
        return;
    if (!(horizon->time > time))
        snprintf(reference->reason, sizeof reference->reason,
                 "a displacement of %.0g m in one particle grows %.2g times and reaches %.0g m "
                 "at %.3g s: no error of a single particle means anything beyond it",
                 CS_HORIZON_START, horizon->amplification, reference->accuracy, horizon->time);
    else if (reference->bar > reference->accuracy)
        snprintf(reference->reason, sizeof reference->reason,
                 "the reference itself is only known to %.2g m, and %.2g m were asked for",
                 reference->bar, reference->accuracy);
    else
        reference->pointwise = true;
}

/* The four runs; the tighter twin of the first family becomes the reference. */
static enum cs_status compute(struct cs_compare_reference *reference,
                              const struct cs_course *probe,
                              const struct cs_compare_reference_settings *settings,
                              struct cs_error *error) {
    struct cs_track tracks[CS_COMPARE_REFERENCE_RUNS] = {0};
    bool good = true;
    for (int k = 0; k < CS_COMPARE_REFERENCE_RUNS && good; k++)
        run_one(reference, k, settings, tracks + k, &good, error);
    if (good) {
        reference->track = tracks[1];
        measure_motion(reference, &probe->session.system);
        measure_bar(reference, &probe->session.system, tracks);
        judge(reference);
        /* its states now belong to the reference and must not be freed below */
        tracks[1] = (struct cs_track){0};
        tell(settings, CS_COMPARE_REFERENCE_RUNS, "horizon");
        cs_horizon_measure(&reference->horizon, settings->course, settings->accuracy,
                           reference->methods[0], error);
        judge_horizon(reference);
    }
    for (int k = 0; k < CS_COMPARE_REFERENCE_RUNS; k++)
        cs_track_finish(tracks + k);
    return error->status;
}

enum cs_status cs_compare_reference_plan(struct cs_compare_reference *reference,
                                         const struct cs_compare_reference_settings *settings,
                                         char *key, struct cs_error *error) {
    char chosen[2][256];
    struct cs_course probe = {0};
    *reference = (struct cs_compare_reference){.accuracy = settings->accuracy};
    if (cs_compare_reference_choose(settings, chosen, error))
        return error->status;
    for (int k = 0; k < 2; k++) {
        memcpy(reference->methods[2 * k], chosen[k], sizeof chosen[k]);
        if (cs_compare_reference_tighten(chosen[k], reference->methods[2 * k + 1],
                                         sizeof chosen[k], error))
            return error->status;
    }
    if (!cs_course_open(&probe, settings->course, chosen[0], error))
        cs_compare_reference_key(reference, &probe, settings, key, error);
    cs_course_close(&probe);
    return error->status;
}

enum cs_status cs_compare_reference_get(struct cs_compare_reference *reference,
                                        const struct cs_compare_reference_settings *settings,
                                        struct cs_error *error) {
    char key[CS_HASH_DIGITS];
    struct cs_course probe = {0};
    if (cs_compare_reference_plan(reference, settings, key, error) ||
        cs_course_open(&probe, settings->course, reference->methods[0], error))
        return error->status;
    const bool found =
        settings->cache && cs_compare_reference_read(reference, settings->cache, key, &probe);
    if (!found && !compute(reference, &probe, settings, error) && reference->agree &&
        settings->cache)
        cs_compare_reference_write(reference, settings->cache, key, error);
    tell(settings, CS_COMPARE_REFERENCE_RUNS + 1, "");
    cs_course_close(&probe);
    if (error->status)
        cs_compare_reference_finish(reference);
    return error->status;
}

uint32_t cs_compare_reference_pointwise_frames(const struct cs_compare_reference *reference) {
    return reference->pointwise ? reference->track.frames : 0;
}

void cs_compare_reference_finish(struct cs_compare_reference *reference) {
    cs_track_finish(&reference->track);
    *reference = (struct cs_compare_reference){0};
}
