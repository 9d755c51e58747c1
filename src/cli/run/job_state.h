/* job_state.h - state of clothsim run, and the interface of its outputs. */
#ifndef CS_JOB_STATE_H
#define CS_JOB_STATE_H

#include "base/hash.h"
#include "base/text.h"
#include "cli/run/frame_writer.h"
#include "cli/run/row_log.h"
#include "cli/run/run_checkpoint.h"
#include "cli/run_folder.h"
#include "cli/show/screen.h"
#include "export/export.h"
#include "session/frame_picture.h"
#include "session/recorded_run.h"
#include "session/session.h"
#include "study/stability_verdict.h"

/* The option --trace; zeroed: none. Must not move in memory while the run lasts. */
struct cs_run_trace {
    bool is_requested;
    uint32_t frame;        /* frame with a full trace; 0: the state of each frame */
    struct cs_trace trace; /* of the run's settings */
};

#define CS_FRAMES_DEFAULT UINT32_MAX
enum { CS_FRAMES_MAX = 10000000 };

/* Request for a run; texts are borrowed. */
struct cs_job_settings {
    struct cs_session_settings session;
    uint32_t frames;         /* 0: the start alone; CS_FRAMES_DEFAULT: one second of them */
    const char *command;     /* its words, each closed by a newline; stored in checkpoints */
    double seconds;          /* above 0: as many frames as cover it, instead */
    uint32_t frame_interval; /* draw every n-th frame */
    const char *folder;      /* of pictures, checkpoints, exports; NULL: none */
    const char *out;         /* the same as it was asked for: made for a file that lies in it */
    const char *states, *json; /* json "-": stdout; NULL: none */
    const char *monitor_file;  /* CSV of energy, strain and velocity; NULL: none */
    const char *ledger;        /* CSV of where energy went; NULL: none */
    enum cs_renderer_kind renderer;
    uint32_t level;                           /* zlib */
    struct cs_checkpoint_interval checkpoint; /* zeroed: none */
    struct cs_run_trace trace;                /* zeroed: none */
    bool resume;                              /* go on from the checkpoint in the folder */
    struct cs_export_settings export;         /* into the folder, as often as pictures */
    bool show;                                /* pictures in the terminal */
    bool fast_render, hash, overwrite, quiet;
    bool error; /* measure the error of the end by a second run */
};

/* Number of frames to simulate; by default one second, at least one frame. */
uint32_t cs_job_frames(const struct cs_job_settings *settings, const struct cs_scene *scene);

/* True if the report is written as JSON: beside pictures, or on request. */
static inline bool cs_job_wants_json(const struct cs_job_settings *settings) {
    return settings->session.render || settings->json;
}

/* True if checkpoints are written or one is loaded. */
static inline bool cs_job_makes_checkpoints(const struct cs_job_settings *settings) {
    return settings->checkpoint.frames || settings->checkpoint.seconds > 0 || settings->resume;
}

/* Reads --trace: "frames", or the number of a frame. CS_ERR_USAGE. */
enum cs_status cs_run_trace_read(const char *value, struct cs_run_trace *run_trace,
                                 struct cs_error *error);

/* Reads --export and --export-values, lists with commas between; NULL: not given. CS_ERR_USAGE.
 */
enum cs_status cs_run_export_read(const char *formats, const char *values,
                                  struct cs_export_settings *settings, struct cs_error *error);

/* Adds " obj pc2", or with values " vtp force"; " none". */
void cs_run_export_print(const struct cs_export_settings *settings, struct cs_text *out);

/* Finds a camera, or a camera path, that frames a whole run. */

struct cs_run_camera {
    const struct cs_job_settings *settings;
    struct cs_error error; /* of the run before */
};

/* Callback for edit_scene of a session. If camera.frame is auto, runs the scene once without
 * pictures and gives it the camera that shows its bodies in all frames to be drawn: a fixed one
 * if they are large enough in each frame, else a path. Errors are in camera->error. */
void cs_run_camera_find(struct cs_scene *scene, void *camera);

/* The picture that is drawn while the run goes on. */
struct cs_job_picture {
    uint32_t number; /* of the picture */
    uint32_t frame;
    double time;        /* s */
    double local_error; /* m, sum of local errors at that time */
    char hash[CS_HASH_DIGITS];
    double range[2];
    const struct cs_image *image; /* of the writer; NULL: none is drawn */
};

enum { CS_RUN_OUTPUTS_MAX = 16 };

/* A run in progress and everything it owns; zeroed: nothing done. */
struct cs_job {
    const struct cs_job_settings *settings;
    struct cs_session session;
    struct cs_picture picture;
    struct cs_screen screen; /* open where pictures are shown */
    struct cs_frame_writer *writer;
    uint32_t frames;                    /* asked for; 0: the start is the only result */
    struct cs_row_log frame_log;        /* rows of the report; open where JSON is written */
    struct cs_energy_monitor monitor;   /* is it still sound */
    struct cs_energy_monitor_row sound; /* of the last frame */
    struct cs_crossing_stats crossings; /* of crossings, where the scene asks for it */
    struct cs_row_log watch_log;        /* CSV; open where it is asked for */
    struct cs_energy_ledger ledger;     /* open where it is asked for */
    struct cs_row_log ledger_log;       /* CSV of it */
    struct cs_text scene;               /* the resolved scene, indented by two */
    struct cs_text method;              /* "NAME:key=value,..." with every option */
    struct cs_text provenance;          /* see session/provenance_write.h */
    struct cs_text picture_provenance;  /* what each picture carries */
    struct cs_text renderer;            /* description; empty unless pictures are drawn */
    char scene_hash[CS_HASH_DIGITS];    /* see scene/file/scene_read.h */
    char hash[CS_HASH_DIGITS];          /* of the last frame's state */
    struct cs_job_picture has_begun;    /* not yet written */
    uint32_t n_drawn;                   /* pictures written */
    struct cs_export export;
    struct cs_text outputs; /* which there are, as far as checkpoints depend on it */
    struct cs_output folders[CS_RUN_OUTPUTS_MAX]; /* by output; owned while the run lasts */
    struct cs_checkpointer checkpoints;
    struct cs_run_trace trace;
    struct cs_run_camera camera;
    struct cs_singular_force cause; /* why the run ended; its text is empty if steps are */
    const char *failure; /* why a step failed, in the caller's error; NULL: none did */
    double wall_seconds, encode_seconds;
    double measured_error; /* m at the end, against a run of finer steps; 0: not asked for */
    double wait_seconds;   /* that the run stood still for its pictures */
};

/* The stages of a run at which outputs are called. */
enum cs_run_stage {
    CS_RUN_OPEN,   /* before any file is touched: for what may be missing on the machine */
    CS_RUN_BEGIN,  /* before the first frame, or, with settings->resume, before the next one */
    CS_RUN_START,  /* in place of frames, where the start is the only result */
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
    /* Stores its state between frames in a checkpoint, or loads it. */
    void (*record)(struct cs_job *job, struct cs_serialiser *serialiser);
};

extern const struct cs_run_output cs_run_output_export, cs_run_output_hash, cs_run_output_json,
    cs_run_output_ledger, cs_run_output_pictures, cs_run_output_states, cs_run_output_trace,
    cs_run_output_watch;

/* Frames between two checkpoints at which the method restarts; 0: it saves its history and does
 * not restart. */
static inline uint32_t cs_job_restarts(const struct cs_job *job) {
    const struct cs_run *run = &job->session.run;
    return run->integrator && cs_run_method_has_history(run->integrator)
               ? 0
               : job->checkpoints.interval.frames;
}

/* One run from its settings to its last frame.
 *
 *   session -> description and provenance -> checks of outputs -> locks of folders -> warnings
 *   -> checkpoint or start -> per frame: step, sample, outputs, checkpoint -> end of outputs
 * Everything that can be refused is checked before the first file is touched. */

/* Runs to the last frame, a blow-up or an interruption (job->session.run.outcome), and waits
 * for the last picture. On failure the frames before it are kept. cs_job_finish must be called
 * in any case. Errors: those of cs_session_open and of the outputs. */
enum cs_status cs_job_run(struct cs_job *job, const struct cs_job_settings *settings,
                          struct cs_error *error);

/* Closes the outputs first, because a picture in progress draws into an image of the writer;
 * then the locks and the session. */
void cs_job_finish(struct cs_job *job);

/* The list of a run's outputs, and calls of all of them stage by stage. */

/* Compares the outputs with the files that the run reads and with each other: none may
 * overwrite another, not even with -y. Then, unless earlier files may be replaced, looks for
 * such. CS_ERR_FILE names the option and both files, or the first earlier file. */
enum cs_status cs_run_outputs_check(const struct cs_job *job, struct cs_error *error);

/* Opens what the outputs need, and locks their folders. */
enum cs_status cs_run_outputs_open(struct cs_job *job, struct cs_error *error);

/* Checks the folders of a run that goes on against their manifests, and removes these. */
enum cs_status cs_run_outputs_consume(const struct cs_job *job, struct cs_error *error);

/* Calls the outputs in the order of the list until one fails; at CS_RUN_END all of them. */
enum cs_status cs_run_outputs_at(struct cs_job *job, enum cs_run_stage stage,
                                 struct cs_error *error);

/* Serialises the outputs' state in the order of the list. */
void cs_run_outputs_record(struct cs_job *job, struct cs_serialiser *serialiser);

/* Writes the manifest of each folder of the run. All files must be complete. */
enum cs_status cs_run_outputs_sign(const struct cs_job *job, struct cs_error *error);

/* Reports a run as a table for readers and as JSON for programs. */

/* Prints the table, unless quiet: to standard output, or to standard error if an output uses
 * the former. CS_ERR_FILE. */
enum cs_status cs_report_print(const struct cs_job *job, struct cs_error *error);

/* Writes the report as JSON beside the pictures, and where --json asks for it: every value that
 * decides the run, versions, counts, energies, outcome and the hash of each frame. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_report_write_json(struct cs_job *job, struct cs_error *error);
/* Closes the rows of frames; they stay for a run that goes on from a checkpoint. CS_ERR_FILE.
 */
enum cs_status cs_run_json_close(struct cs_job *job, struct cs_error *error);

/* Adds "blew up: ... at t = ... s, particle ..." or "finished". */
void cs_report_print_outcome(const struct cs_job *job, struct cs_text *out);

/* Adds the error of that frame: as measured, or the sum of local errors in m and its worth. */
void cs_report_print_error(const struct cs_job *job, uint32_t frame, double local,
                           struct cs_text *out);

/* Warns on standard error of a strain limit that was missed, and of what is beyond cloth in a
 * stable run. */
void cs_report_print_shortfalls(const struct cs_job *job);

/* Overrides of render.range and render.marks; zeroed: nothing found. */
struct cs_run_range {
    char value[80];
    struct cs_text marks;          /* owned */
    struct cs_override *overrides; /* owned: those of the settings, and these */
};

/* Adds an override of render.range to the settings, which then borrow it. text is "MIN,MAX", or
 * "auto": the scene is then run once without pictures, and the range covers all its frames.
 * CS_ERR_USAGE if the text is neither, or if the look shows no values. */
enum cs_status cs_run_range_set(struct cs_run_range *range, const char *text,
                                struct cs_job_settings *settings, struct cs_error *error);

/* Runs the scene once without pictures, and adds an override of render.marks: the particle
 * where an instability began, and its neighbours by stretch and shear springs. Says so if there
 * was none. */
enum cs_status cs_run_marks_set(struct cs_run_range *range, struct cs_job_settings *settings,
                                struct cs_error *error);

/* Frees the overrides; the settings must not be used after it. */
void cs_run_range_finish(struct cs_run_range *range);

#endif
