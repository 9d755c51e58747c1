/* recorded_run.h - one method on the smooth form of a scene: opened, run, and recorded.
 *
 * Contact by projection, strain limit and velocity loss act after steps and are no part of the
 * equation of motion; with them the result would depend on the step whatever the method. They
 * are off. Contact by force is a part of it, and stays.
 */
#ifndef CS_RECORDED_RUN_H
#define CS_RECORDED_RUN_H

#include "base/hash.h"
#include "study/crossing_stats.h"
#include "study/follow.h"
#include "study/session.h"

/* The scene and how long; what every run of a comparison shares. */
struct cs_recorded_run_settings {
    struct cs_session_settings session; /* integrator is not looked at */
    uint32_t frames;
};

/* Zeroed: closed. Must stay where it is while open. */
struct cs_recorded_run {
    struct cs_session session; /* system built; the run is not begun */
    double *initial_state;     /* (6n) the state at time 0, owned */
    uint32_t frames;
};

/* States of the frames 0..frames of one run. */
struct cs_trajectory {
    double *states; /* (frames + 1, 6n), owned */
    uint32_t n;     /* particles */
    uint32_t frames, n_recorded;
    double fps;
};

/* What one run came to, beside its states. */
struct cs_recorded_run_result {
    struct cs_run_result result;
    double cpu, wall; /* s, of stepping only */
    struct cs_counts counts;
    struct cs_crossing_stats
        crossings;             /* of the frames of a track, where the scene counts them */
    char note[240];            /* the method's remarks, or why it failed */
    char hash[CS_HASH_DIGITS]; /* of the last state */
};

/* Opens a scene for a method, "NAME:key=value,...", without what is no equation of motion. */
enum cs_status cs_recorded_run_open(struct cs_recorded_run *recording,
                                    const struct cs_recorded_run_settings *settings,
                                    const char *integrator, struct cs_error *error);

/* Sets the frames, whole ones, that cover a time in s. CS_ERR_USAGE for more than a million. */
enum cs_status cs_recorded_run_count_frames(struct cs_recorded_run_settings *settings,
                                            double seconds, struct cs_error *error);

/* Adds what of a scene is switched off, as words ("contact, strain limit"); nothing where
 * nothing is. The scene is one that was not opened by cs_recorded_run_open. */
void cs_recorded_run_describe_changes(const struct cs_scene *scene, struct cs_text *out);

/* Runs from the start to the last frame within a budget in s (0: none). Only stepping is
 * timed; track may be NULL: then nothing is kept. A method that gives up is a result.
 * CS_ERR_INTERRUPT, CS_ERR_MEMORY. */
enum cs_status cs_recorded_run_execute(struct cs_recorded_run *recording, double budget,
                                       struct cs_trajectory *track,
                                       struct cs_recorded_run_result *end,
                                       struct cs_error *error);
void cs_recorded_run_close(struct cs_recorded_run *recording);

enum cs_status cs_trajectory_init(struct cs_trajectory *track,
                                  const struct cs_recorded_run *recording,
                                  struct cs_error *error);
/* x of a frame; v stands 3n behind it. */
double *cs_trajectory_state(const struct cs_trajectory *track, uint32_t frame);
void cs_trajectory_finish(struct cs_trajectory *track);

#endif
