/* run_settings.h - settings of clothsim run. */
#ifndef CS_RUN_SETTINGS_H
#define CS_RUN_SETTINGS_H

#include "cli/run/run_checkpoint.h"
#include "draw/render.h"
#include "io/export/export.h"
#include "study/session.h"

#include <math.h>

/* The option --trace; zeroed: none. Must not move in memory while the run lasts. */
struct cs_run_trace {
    bool is_requested;
    uint32_t frame;        /* frame with a full trace; 0: the state of each frame */
    struct cs_trace trace; /* of the run's settings */
};

/* Request for a run; texts are borrowed. */
struct cs_job_settings {
    struct cs_session_settings session;
    uint32_t frames;           /* 0: one second of them */
    uint32_t frame_interval;   /* draw every n-th frame */
    const char *folder;        /* of pictures, checkpoints, exports; NULL: none */
    const char *states, *json; /* json "-": stdout; NULL: none */
    const char *monitor_file;  /* CSV of energy, strain and velocity; NULL: none */
    const char *ledger;        /* CSV of where energy went; NULL: none */
    enum cs_renderer_kind renderer;
    uint32_t level;                           /* zlib */
    struct cs_checkpoint_interval checkpoint; /* zeroed: none */
    struct cs_run_trace trace;                /* zeroed: none */
    bool resume;                              /* go on from the checkpoint in the folder */
    struct cs_export_settings export;         /* into the folder, as often as pictures */
    bool fast_render, hash, overwrite, quiet;
};

/* Number of frames to simulate; by default one second, at least one frame. */
static inline uint32_t cs_job_frames(const struct cs_job_settings *settings,
                                     const struct cs_scene *scene) {
    const double second = floor(scene->time.fps + 0.5);
    return settings->frames ? settings->frames : second < 1 ? 1 : (uint32_t)second;
}

/* True if the report is written as JSON: beside pictures, or on request. */
static inline bool cs_job_wants_json(const struct cs_job_settings *settings) {
    return settings->session.render || settings->json;
}

/* True if checkpoints are written or one is loaded. */
static inline bool cs_job_makes_checkpoints(const struct cs_job_settings *settings) {
    return settings->checkpoint.frames || settings->checkpoint.seconds > 0 || settings->resume;
}

/* Reads --trace: "frames", or the number of a frame. CS_ERR_USAGE. */
enum cs_status cs_run_trace_read(const char *value, struct cs_run_trace *trail,
                                 struct cs_error *error);

/* Reads --export and --export-values, lists with commas between; NULL: not given. CS_ERR_USAGE.
 */
enum cs_status cs_run_export_read(const char *formats, const char *values,
                                  struct cs_export_settings *settings, struct cs_error *error);

/* Adds " obj pc2", or with values " vtp force"; " none". */
void cs_run_export_print(const struct cs_export_settings *settings, struct cs_text *out);

#endif
