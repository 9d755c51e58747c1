/* Computes the verified reference: four runs, their differences, and whether they agree. */
#include "study/reference/compare_reference.h"

#include "base/file.h"
#include "base/hash.h"
#include "model/force/diagnostics.h"
#include "scene/file/scene_read.h"
#include "study/reference/compare_reference_state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Stores a reference in a file for further comparisons of the scene. */

#define MAGIC "clothsim ref 1\n"

enum { FILE_BYTES_MAX = 1 << 30 };

/* Head of the file, in the byte order of the machine: on another one `one` is not 1, and the
 * file counts as missing. */
struct header {
    char magic[16];
    double one;
    uint32_t n, frames;
    double fps;
    char hash[40];                         /* of the head without it, and of the states */
    struct cs_compare_reference reference; /* pointers in it mean nothing */
};

/* Writes the hash of everything a reference depends on, CS_HASH_DIGITS characters.
 * CS_ERR_MEMORY. */
static enum cs_status compare_reference_key(
    const struct cs_compare_reference *reference, const struct cs_recorded_run *recording,
    const struct cs_compare_reference_settings *settings, char *key, struct cs_error *error) {
    const struct cs_session_settings *session = &settings->run->session;
    const struct cs_scene *scene = &recording->session.scene;
    const size_t values = 6 * (size_t)recording->session.system.view.n;
    const struct cs_method *method = &recording->session.method;
    char start[CS_HASH_DIGITS], of_scene[CS_HASH_DIGITS];
    struct cs_text all = {0};
    if (cs_scene_hash(scene, &method->table, method->options, of_scene, error))
        return error->status;
    // meshes are files of their own or made here: the start is as they came out
    cs_hash_doubles(recording->initial_state, values, start);
    cs_text_add(&all, "%s|", start);
    cs_text_add(&all, "%s|%zu|%u|%.17g|%.17g|", CS_VERSION, sizeof(struct header),
                settings->run->frames, scene->time.fps, settings->accuracy);
    for (int k = 0; k < CS_COMPARE_REFERENCE_RUNS; k++)
        cs_text_add(&all, "%s|", reference->methods[k]);
    // where the methods are chosen here, a module that is added changes nothing
    for (uint32_t k = 0; k < session->n_plugins && settings->methods[0]; k++)
        cs_text_add(&all, "%s|", session->plugins[k]);
    cs_text_add(&all, "%s", of_scene);
    if (all.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the name of a reference");
    else
        cs_hash_bytes(cs_text_get(&all), all.length, key);
    cs_text_finish(&all);
    return error->status;
}

/* Path of the file; 16 digits of the key suffice for its name. */
static void file_path(const char *folder, const char *key, char *path, size_t size) {
    snprintf(path, size, "%s/reference-%.16s.state", folder, key);
}

/* Hash of everything in the file but the hash itself. */
static void hash_file(const struct header *header, const double *states, size_t values,
                      char hash[CS_HASH_DIGITS]) {
    char both[2 * CS_HASH_DIGITS], head[sizeof *header];
    memcpy(head, header, sizeof head);
    memset(head + offsetof(struct header, hash), 0, sizeof header->hash);
    cs_hash_bytes(head, sizeof head, both);
    cs_hash_doubles(states, values, both + CS_HASH_DIGITS);
    cs_hash_bytes(both, sizeof both, hash);
}

/* Reads or writes DIR/reference-KEY.state. A file that does not match the scene, the machine or
 * its own hash counts as missing. */
static bool compare_reference_read(struct cs_compare_reference *reference, const char *folder,
                                   const char *key, const struct cs_recorded_run *recording) {
    char path[4096], *bytes, hash[CS_HASH_DIGITS];
    size_t length;
    struct cs_error missing = {0};
    struct header header;
    file_path(folder, key, path, sizeof path);
    if (cs_file_read(path, FILE_BYTES_MAX, &bytes, &length, &missing))
        return false;
    struct cs_trajectory track;
    bool good = length > sizeof header && !cs_trajectory_init(&track, recording, &missing);
    /* a file that does not fit or was damaged is passed over, and the reference is computed */
    if (good) {
        memcpy(&header, bytes, sizeof header);
        const size_t values = ((size_t)track.frames + 1) * 6 * track.n;
        good = !memcmp(header.magic, MAGIC, sizeof MAGIC) && header.one == 1 &&
               header.n == track.n && header.frames == track.frames &&
               length == sizeof header + values * sizeof(double);
        if (good) {
            memcpy(track.states, bytes + sizeof header, values * sizeof(double));
            hash_file(&header, track.states, values, hash);
            good = !memcmp(hash, header.hash, sizeof hash);
        }
        if (good) {
            *reference = header.reference;
            track.n_recorded = track.frames;
            reference->trajectory = track;
            reference->cached = true;
        } else
            cs_trajectory_finish(&track);
    }
    free(bytes);
    return good;
}

/* The file appears under its name only when it is complete, so parallel comparisons can share a
 * cache. */
static enum cs_status compare_reference_write(const struct cs_compare_reference *reference,
                                              const char *folder, const char *key,
                                              struct cs_error *error) {
    const struct cs_trajectory *track = &reference->trajectory;
    const size_t values = ((size_t)track->frames + 1) * 6 * track->n;
    struct header *header = calloc(1, sizeof *header);
    struct cs_file_out out = {0};
    char path[4096];
    if (!header)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the reference");
    file_path(folder, key, path, sizeof path);
    memcpy(header->magic, MAGIC, sizeof MAGIC);
    header->one = 1;
    header->n = track->n;
    header->frames = track->frames;
    header->reference = *reference;
    /* an address means nothing to the next run */
    header->reference.trajectory.states = NULL;
    header->reference.trajectory.free_from = NULL;
    hash_file(header, track->states, values, header->hash);
    if (!cs_folder_create(folder, error) && !cs_file_create(&out, path, error)) {
        /* failures of fwrite are seen by cs_file_finish */
        fwrite(header, sizeof *header, 1, out.file);
        fwrite(track->states, sizeof(double), values, out.file);
        cs_file_finish(&out, error);
    }
    free(header);
    return error->status;
}

/* Families agree if they differ by at most EXPLAINED times the larger of their own errors, or
 * by FLOOR of the motion. */
#define EXPLAINED 100
#define FLOOR     1e-9

/* The second family is in error if it is farther from the reference than ROUGH times the own
 * error of the first family and than ROUNDING of the motion. The next candidate is then tried
 * in its place. */
#define ROUGH    10
#define ROUNDING 1e-13

/* Reports the progress; the horizon counts as one more run. */
static void tell(const struct cs_compare_reference_settings *settings, uint32_t done,
                 const char *what) {
    if (settings->progress)
        settings->progress(settings->ctx, done, CS_COMPARE_REFERENCE_RUNS + 1, what);
}

/* Records run k of the four. *good: it reached its last frame. */
static enum cs_status run_one(struct cs_compare_reference *reference, int k,
                              const struct cs_compare_reference_settings *settings,
                              struct cs_trajectory *track, bool *good, struct cs_error *error) {
    struct cs_recorded_run recording;
    struct cs_recorded_run_result end = {0};
    tell(settings, (uint32_t)k, reference->methods[k]);
    if (!cs_recorded_run_open(&recording, settings->run, reference->methods[k], error) &&
        !cs_trajectory_init(track, &recording, error))
        cs_recorded_run_execute(&recording, 0, track, &end, error);
    *good = !error->status && end.result.outcome == CS_RUNNING;
    if (!error->status && !*good)
        snprintf(reference->reason, sizeof reference->reason, "%.100s: %.200s",
                 reference->methods[k], end.result.message);
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
    const struct cs_trajectory *track = &reference->trajectory;
    for (uint32_t k = 0; k <= track->frames; k++) {
        const double *x = cs_trajectory_state(track, k);
        const struct cs_energy energy = cs_diagnostics_energy(
            system, k / system->scene->time.fps, x, x + 3 * (size_t)track->n);
        reference->kinetic = fmax(reference->kinetic, energy.kinetic);
        reference->strain = fmax(reference->strain, cs_diagnostics_strain(system, x));
        reference->motion_scale =
            fmax(reference->motion_scale,
                 cs_distance_rms(system, track, k, x, cs_trajectory_state(track, 0)));
    }
}

/* Differences and error bars, as the header defines them. */
static void measure_bar(struct cs_compare_reference *reference, const struct cs_system *system,
                        const struct cs_trajectory tracks[CS_COMPARE_REFERENCE_RUNS]) {
    double largest[3];
    compare(system, tracks, tracks + 1, reference->differences, largest);
    reference->error_bar = reference->differences[0];
    reference->error_bar_max = largest[0];
    reference->differences[1] = reference->differences[2] = (double)NAN;
    if (reference->has_one_family)
        return;
    compare(system, tracks + 2, tracks + 3, reference->differences + 1, largest + 1);
    compare(system, tracks + 1, tracks + 3, reference->differences + 2, largest + 2);
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
                     struct cs_trajectory tracks[CS_COMPARE_REFERENCE_RUNS],
                     struct cs_error *error) {
    bool good = true;
    for (int k = from; k < to && good; k++)
        run_one(reference, k, settings, tracks + k, &good, error);
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
                       struct cs_trajectory tracks[CS_COMPARE_REFERENCE_RUNS],
                       struct cs_error *error) {
    if (run_some(reference, 2, CS_COMPARE_REFERENCE_RUNS, settings, tracks, error))
        return true;
    if (error->status || !*reference->replacement ||
        name_twins(reference, 1, reference->replacement, error))
        return false;
    *reference->replacement = *reference->reason = 0;
    cs_trajectory_finish(tracks + 2);
    cs_trajectory_finish(tracks + 3);
    return run_some(reference, 2, CS_COMPARE_REFERENCE_RUNS, settings, tracks, error);
}

/* Tries the replacement as second family, and keeps it if it comes nearer. A method of fixed
 * steps loses its order where the derivative of the force jumps, for example at slow friction,
 * and then says little about the reference. */
static enum cs_status ask_another(struct cs_compare_reference *reference,
                                  const struct cs_system *system,
                                  const struct cs_compare_reference_settings *settings,
                                  struct cs_trajectory tracks[CS_COMPARE_REFERENCE_RUNS],
                                  struct cs_error *error) {
    struct cs_compare_reference other = *reference;
    struct cs_trajectory own[CS_COMPARE_REFERENCE_RUNS] = {tracks[0], tracks[1], {0}, {0}};
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
                       struct cs_trajectory tracks[CS_COMPARE_REFERENCE_RUNS],
                       struct cs_error *error) {
    const bool good = run_second(reference, settings, tracks, error);
    reference->has_one_family = !good && !error->status && reference->explicit_passes > 0;
    return good || reference->has_one_family;
}

/* The four runs; the tighter twin of the first family becomes the reference. */
static enum cs_status compute(struct cs_compare_reference *reference,
                              const struct cs_recorded_run *probe,
                              const struct cs_compare_reference_settings *settings,
                              struct cs_error *error) {
    const struct cs_system *system = &probe->session.system;
    struct cs_trajectory tracks[CS_COMPARE_REFERENCE_RUNS] = {0};
    if (run_some(reference, 0, 2, settings, tracks, error) &&
        has_second(reference, settings, tracks, error)) {
        reference->trajectory = tracks[1];
        measure_motion(reference, system);
        measure_bar(reference, system, tracks);
        if (*reference->replacement && has_disagreement(reference))
            ask_another(reference, system, settings, tracks, error);
        judge(reference);
        /* its states now belong to the reference and must not be freed below */
        tracks[1] = (struct cs_trajectory){0};
        tell(settings, CS_COMPARE_REFERENCE_RUNS, "horizon");
        if (!error->status)
            cs_compare_reference_judge_horizon(reference, settings->run, error);
    }
    for (int k = 0; k < CS_COMPARE_REFERENCE_RUNS; k++)
        cs_trajectory_finish(tracks + k);
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
        compare_reference_key(reference, &probe, settings, key, error);
    cs_recorded_run_close(&probe);
    return error->status;
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
        settings->cache && compare_reference_read(reference, settings->cache, key, &probe);
    if (!found && !compute(reference, &probe, settings, error) && reference->families_agree &&
        settings->cache)
        compare_reference_write(reference, settings->cache, key, error);
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
