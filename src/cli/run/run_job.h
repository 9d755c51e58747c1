/* run_job.h - one run from settings to its last frame. */
#ifndef CS_RUN_JOB_H
#define CS_RUN_JOB_H

#include "base/hash.h"
#include "base/text.h"
#include "cli/run/run_camera.h"
#include "cli/run/run_checkpoint.h"
#include "cli/run/run_frame_log.h"
#include "cli/run/run_picture.h"
#include "cli/run/run_settings.h"
#include "cli/run_output.h"
#include "sim/energy_ledger.h"
#include "sim/run_record.h"
#include "study/crossing_stats.h"
#include "study/energy_monitor.h"
#include "study/frame_picture.h"
#include "study/session.h"

/* Zeroed: nothing done. */
struct cs_job {
    const struct cs_job_settings *settings;
    struct cs_session session;
    struct cs_picture picture;
    struct cs_frame_writer *writer;
    uint32_t frames;                    /* asked for */
    struct cs_frame_log frame_log;      /* a row a frame; only where JSON is written */
    struct cs_energy_monitor monitor;   /* is it still sound */
    struct cs_crossing_stats crossings; /* of crossings, where the scene asks for it */
    struct cs_text watch_rows;          /* CSV; empty unless asked for */
    struct cs_energy_ledger ledger;     /* open where it is asked for */
    struct cs_text ledger_rows;         /* CSV of it */
    struct cs_text scene;               /* the resolved scene, indented by two */
    struct cs_text warning;            /* about bodies that nothing keeps apart; mostly empty */
    struct cs_text method;             /* "NAME:key=value,..." with every option */
    struct cs_text provenance;         /* see study/provenance_write.h */
    struct cs_text picture_provenance; /* what each picture carries */
    struct cs_text renderer;           /* description; empty unless pictures are drawn */
    char scene_hash[CS_HASH_DIGITS];   /* see scene/file/scene_hash.h */
    char hash[CS_HASH_DIGITS];         /* of the last frame's state */
    struct cs_job_picture has_begun;   /* not yet written */
    uint32_t n_drawn;                  /* pictures written */
    struct cs_export export;
    struct cs_text outputs;          /* which there are, as far as checkpoints depend on it */
    struct cs_output folder, states; /* owned while the run lasts */
    struct cs_checkpointer checkpoints;
    struct cs_run_trace trace;
    struct cs_run_camera camera;
    const char *failure; /* why a step failed, in the caller's error; NULL: none did */
    double wall_seconds, encode_seconds;
    double wait_seconds; /* that the run stood still for its pictures */
};

/* Opens the session, checks and prepares the folders, runs to the last frame, a blow-up or an
 * interrupt (job->session.run.outcome), and waits for the last picture. On failure the frames
 * up to it are kept. cs_job_finish is to be called either way. */
enum cs_status cs_job_run(struct cs_job *job, const struct cs_job_settings *settings,
                          struct cs_error *error);
void cs_job_finish(struct cs_job *job);

/* Frames between two checkpoints at which the method is started anew; 0: it goes on. */
static inline uint32_t cs_job_restarts(const struct cs_job *job) {
    const struct cs_run *run = &job->session.run;
    return run->integrator && cs_run_method_has_history(run->integrator)
               ? 0
               : job->checkpoints.interval.frames;
}

#endif
