/* run_job.h - one run from settings to its last frame. */
#ifndef CS_RUN_JOB_H
#define CS_RUN_JOB_H

#include "base/hash.h"
#include "base/text.h"
#include "cli/run/run_camera.h"
#include "cli/run/run_kept.h"
#include "cli/run/run_picture.h"
#include "cli/run/run_resume.h"
#include "cli/run/run_settings.h"
#include "cli/run_output.h"
#include "sim/account.h"
#include "sim/run_record.h"
#include "study/picture.h"
#include "study/session.h"
#include "study/tally.h"
#include "study/watch.h"

/* Zeroed: nothing done. */
struct cs_job {
    const struct cs_job_settings *settings;
    struct cs_session session;
    struct cs_picture picture;
    struct cs_frames *writer;
    uint32_t frames;                 /* asked for */
    struct cs_kept kept;             /* a row a frame; only where JSON is written */
    struct cs_watch watch;           /* is it still sound */
    struct cs_tally tally;           /* of crossings, where the scene asks for it */
    struct cs_text watch_rows;       /* CSV; empty unless asked for */
    struct cs_account account;       /* open where it is asked for */
    struct cs_text ledger_rows;      /* CSV of it */
    struct cs_text scene;            /* the resolved scene, indented by two */
    struct cs_text warning;          /* about bodies that nothing keeps apart; mostly empty */
    struct cs_text method;           /* "NAME:key=value,..." with every option */
    struct cs_text origin;           /* see study/origin.h */
    struct cs_text recipe;           /* what each picture carries */
    struct cs_text renderer;         /* description; empty unless pictures are drawn */
    char scene_hash[CS_HASH_DIGITS]; /* see io/scene_hash.h */
    char hash[CS_HASH_DIGITS];       /* of the last frame's state */
    struct cs_job_picture begun;     /* not yet written */
    uint32_t drawn;                  /* pictures written */
    struct cs_export export;
    struct cs_text outputs;          /* which there are, as far as checkpoints depend on it */
    struct cs_output folder, states; /* owned while the run lasts */
    struct cs_resume checkpoints;
    struct cs_run_trail trail;
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
    return run->integrator && cs_run_remembers(run->integrator) ? 0
                                                                : job->checkpoints.pace.frames;
}

#endif
