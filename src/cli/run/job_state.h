/* job_state.h - a run of clothsim run while it lasts, and what an output of it is. */
#ifndef CS_JOB_STATE_H
#define CS_JOB_STATE_H

#include "base/hash.h"
#include "base/text.h"
#include "cli/run/run_camera.h"
#include "cli/run/run_checkpoint.h"
#include "cli/run/run_settings.h"
#include "cli/run_output.h"
#include "io/frame_writer.h"
#include "sim/energy_ledger.h"
#include "sim/run_record.h"
#include "study/crossing_stats.h"
#include "study/energy_monitor.h"
#include "study/frame_picture.h"
#include "study/session.h"

/* What a run keeps of a frame for its report. */
struct cs_job_frame {
    char hash[CS_HASH_DIGITS];
    bool drawn;
    double range[2];    /* of the colours, where drawn by a value */
    uint64_t crossings; /* where they are counted */
};

/* Zeroed: none. */
struct cs_frame_log {
    struct cs_job_frame *frames; /* owned */
    size_t capacity;
};

/* The frame whose picture is being drawn while the run goes on. */
struct cs_job_picture {
    uint32_t number; /* of the picture, from 1; 0: none */
    uint32_t frame;
    double time; /* s */
    char hash[CS_HASH_DIGITS];
    double range[2];
    const struct cs_image *image; /* of the writer */
};

enum { CS_RUN_OUTPUTS_MAX = 16 };

/* Zeroed: nothing done. */
struct cs_job {
    const struct cs_job_settings *settings;
    struct cs_session session;
    struct cs_picture picture;
    struct cs_frame_writer *writer;
    uint32_t frames;                    /* asked for */
    struct cs_frame_log frame_log;      /* a row a frame; only where JSON is written */
    struct cs_energy_monitor monitor;   /* is it still sound */
    struct cs_energy_monitor_row sound; /* of the last frame */
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
    struct cs_text outputs; /* which there are, as far as checkpoints depend on it */
    struct cs_output folders[CS_RUN_OUTPUTS_MAX]; /* by output; owned while the run lasts */
    struct cs_checkpointer checkpoints;
    struct cs_run_trace trace;
    struct cs_run_camera camera;
    const char *failure; /* why a step failed, in the caller's error; NULL: none did */
    double wall_seconds, encode_seconds;
    double wait_seconds; /* that the run stood still for its pictures */
};

/* The stages of a run at which outputs are called. */
enum cs_run_stage {
    CS_RUN_OPEN,   /* before any file is touched: for what may be missing on the machine */
    CS_RUN_BEGIN,  /* before the first frame, or, with settings->resume, before the next one */
    CS_RUN_FRAME,  /* after a finished frame */
    CS_RUN_SETTLE, /* before a checkpoint and at the end: waits for its files of all frames */
    CS_RUN_END,    /* after the last frame, also of a run that failed: *error may be set */
    CS_RUN_STAGES
};

/* One output of a run: where it goes, and what it does at each stage. Calls that it does not
 * need are NULL. Where the run was not asked for it, calls do nothing. */
struct cs_run_output {
    const char *option;      /* that names its file or folder; NULL: it has none of its own */
    size_t path;             /* of that text in struct cs_job_settings */
    cs_output_kind *is_ours; /* the files in its folder; NULL: it is one file, "-" none */

    /* By stage. */
    enum cs_status (*at[CS_RUN_STAGES])(struct cs_job *job, struct cs_error *error);
    /* Stores what it keeps from frame to frame in a checkpoint, or loads it. */
    void (*record)(struct cs_job *job, struct cs_serialiser *record);
};

extern const struct cs_run_output cs_run_output_export, cs_run_output_hash, cs_run_output_json,
    cs_run_output_ledger, cs_run_output_pictures, cs_run_output_states, cs_run_output_trace,
    cs_run_output_watch;

/* Frames between two checkpoints at which the method is started anew; 0: it goes on. */
static inline uint32_t cs_job_restarts(const struct cs_job *job) {
    const struct cs_run *run = &job->session.run;
    return run->integrator && cs_run_method_has_history(run->integrator)
               ? 0
               : job->checkpoints.interval.frames;
}

#endif
