/* recorded_run.h - runs one method on a scene without post-step corrections and records the
 * trajectory.
 *
 * Contact by projection, strain limit and velocity loss act after steps and are no part of the
 * equation of motion. With them the result would depend on the step for any method, and no
 * order of convergence would exist. They are switched off. Contact by force is a part of the
 * equation and stays. */
#ifndef CS_RECORDED_RUN_H
#define CS_RECORDED_RUN_H

#include "base/hash.h"
#include "model/contact/ccd/crossings.h"
#include "session/energy_monitor.h"
#include "session/session.h"
#include "sim/run_state.h"

/* Statistics of crossings over the frames of a run. */

/* Zeroed: nothing was counted, as where the scene ignores crossings. */
struct cs_crossing_stats {
    bool is_counted;
    uint64_t start_count; /* where the run began */
    uint64_t max_count,
        last_count;              /* of all frames and of the last one, the start among them */
    double max_time, first_time; /* s: when they were most, and the first frame with any */
    struct cs_crossing_count first; /* there; n 0: there were none */
};

/* Counts the crossings of the present state, if the scene asks for it. Called at the start and
 * after each frame. */
void cs_crossing_stats_add(struct cs_crossing_stats *stats, const struct cs_run *run);

/* The particles (2) of the first edge; a max_count above 0. */
const uint32_t *cs_crossing_stats_edge(const struct cs_crossing_stats *stats,
                                       const struct cs_system *system);

/* "3 at the end, 12 at most, at t = 0.5 s; from t = 0.2 s on: ..." */
void cs_crossing_stats_print(const struct cs_crossing_stats *stats,
                             const struct cs_system *system, struct cs_text *out);

/* The scene and the number of frames, common to all runs of a comparison. */
struct cs_recorded_run_settings {
    struct cs_session_settings session; /* integrator is not used */
    uint32_t frames;
};

/* An open scene with one method; zeroed: closed. Must not move in memory while open. */
struct cs_recorded_run {
    struct cs_session session; /* system built; the run is not begun */
    double *initial_state;     /* (6n) the state at time 0, then free_from; owned */
    double
        *free_from; /* (n) s, when an event lets the particle move; 0: it can from the start */
    uint32_t frames;
};

/* States of the frames 0..frames of one run; frames beyond n_recorded are 0. */
struct cs_trajectory {
    double *states;          /* (frames + 1, 6n), then free_from; owned */
    const double *free_from; /* (n) s: as in the recorded run */
    uint32_t n;              /* particles */
    uint32_t frames, n_recorded;
    double fps;
};

/* Result of a run besides its states. */
struct cs_recorded_run_result {
    struct cs_run_result result;
    double cpu, wall; /* s, of stepping only */
    struct cs_counts counts;
    struct cs_crossing_stats
        crossings; /* of the frames of a track, where the scene counts them */
    struct cs_energy_monitor monitor; /* of the frames of a track */
    char note[240];                   /* the method's remarks, or why it failed */
    char hash[CS_HASH_DIGITS];        /* of the last state */
};

/* Opens a scene for a method, "NAME:key=value,...", without post-step corrections. On failure
 * it is closed. Errors: those of cs_session_open_system. */
enum cs_status cs_recorded_run_open(struct cs_recorded_run *recording,
                                    const struct cs_recorded_run_settings *settings,
                                    const char *integrator, struct cs_error *error);

/* Completes a length of simulated time: *frames 0: the whole frames that cover *seconds, at
 * most a million (CS_ERR_USAGE), else *seconds is their time. Errors of the scene. */
enum cs_status cs_session_fit_frames(const struct cs_session_settings *settings,
                                     uint32_t *frames, double *seconds, struct cs_error *error);

/* Adds the corrections of a scene that are switched off, as words ("contact, strain limit");
 * nothing if there are none. The scene must not come from cs_recorded_run_open, which has
 * removed them. */
void cs_recorded_run_describe_changes(const struct cs_scene *scene, struct cs_text *out);

/* Instants up to t in s at which events make a method stop. */
uint32_t cs_recorded_run_count_stops(const struct cs_recorded_run *recording, double t);

/* Runs from the start to the last frame within a budget in s (0: none). Only stepping is timed.
 * track may be NULL: then no states are stored. A method that gives up is a result. Can be
 * called again: each run starts from initial_state. CS_ERR_INTERRUPT, CS_ERR_MEMORY. */
enum cs_status cs_recorded_run_execute(struct cs_recorded_run *recording, double budget,
                                       struct cs_trajectory *trajectory,
                                       struct cs_recorded_run_result *result,
                                       struct cs_error *error);

/* Closes the scene; a zeroed object is allowed. */
void cs_recorded_run_close(struct cs_recorded_run *recording);

/* Allocates the states of a recorded run. Returns CS_ERR_MEMORY; the trajectory is then empty.
 */
enum cs_status cs_trajectory_init(struct cs_trajectory *trajectory,
                                  const struct cs_recorded_run *recording,
                                  struct cs_error *error);

/* Returns x (3,n) of a frame; v (3,n) follows it. */
double *cs_trajectory_state(const struct cs_trajectory *trajectory, uint32_t frame);
void cs_trajectory_finish(struct cs_trajectory *trajectory);

/* Measures the distance of one recorded run from another.
 *
 * Pointwise figures (end, path, velocity) compare each particle with itself. Beyond the horizon
 * of predictability (study/reference/compare_reference_state.h) they saturate; statistical
 * figures (energy, centre of mass, box) remain meaningful there. */

/* Distances of a run from the reference. */
struct cs_trajectory_error {
    double end, end_max;   /* m: mass-weighted RMS and largest distance at the last frame */
    double path, path_max; /* m over all frames */
    double velocity;       /* m/s at the last frame, mass-weighted RMS */
    double energy;         /* J, largest over frames */
    double centre, box;    /* m, largest over frames */
    double strain;         /* of the run itself, largest over frames */
};

/* Compares the frames 1..`frames`, which both runs must have. Pointwise figures use the frames
 * up to pointwise_frames only; they are NAN if these are fewer than `frames`. */
void cs_trajectory_error_compute(struct cs_trajectory_error *error,
                                 const struct cs_system *system,
                                 const struct cs_trajectory *trajectory,
                                 const struct cs_trajectory *reference, uint32_t frames,
                                 uint32_t pointwise_frames);

/* Root mean square of a - b over n >= 1 values. */
double cs_rms_difference(const double *a, const double *b, size_t n);

/* sqrt(sum m |a - b|^2 / sum m) of two (3,n) at a frame of a run, over the particles that can
 * move there or could before: those that an event releases from then on. 0 without any. The
 * mass as weight makes it independent of the resolution of a mesh. */
double cs_distance_rms(const struct cs_system *system, const struct cs_trajectory *run,
                       uint32_t frame, const double *a, const double *b);
/* Largest distance of a particle, pinned ones included. */
double cs_distance_max(const struct cs_system *system, const double *a, const double *b);
/* The distance of each particle, (n). */
void cs_distance_each(uint32_t n, const double *a, const double *b, double *out);

#endif
