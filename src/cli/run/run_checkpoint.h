/* run_checkpoint.h - checkpoints of a run: when one is written, and how a run resumes.
 *
 * The state is captured in memory after a frame and written once the files of that frame are
 * complete. A method with saved history is captured after every frame, so an interrupted run
 * loses nothing. A method without it restarts at each capture; its checkpoints must therefore
 * be at fixed frames, or the result would depend on the clock. */
#ifndef CS_RUN_CHECKPOINT_H
#define CS_RUN_CHECKPOINT_H

#include "base/hash.h"
#include "cli/run/checkpoint.h"
#include "session/session.h"

/* Interval of checkpoints; zeroed: none. */
struct cs_checkpoint_interval {
    uint32_t frames;
    double seconds; /* of wall clock */
};

/* Facts that a resumed run must share, and the caller's state. */
struct cs_checkpoint_source {
    const char *scene, *hash, *method, *output_settings; /* texts, borrowed */
    const char *command; /* words of the command line, each closed by a newline; borrowed */
    /* what the caller keeps from frame to frame, by the same calls both ways */
    void (*serialise)(void *ctx, struct cs_serialiser *serialise);
    void *ctx;
};

/* Checkpoints of one run; zeroed: none. */
struct cs_checkpointer {
    struct cs_session *session; /* borrowed; NULL: none are made */
    struct cs_checkpoint_source source;
    struct cs_checkpoint_interval interval;
    char path[4096];
    char module[CS_HASH_DIGITS];            /* hash of the method's file */
    double last_time;                       /* s, when one was made */
    uint32_t captured_frame, written_frame; /* frames, of the record and of the file */
    struct cs_serialiser serialiser; /* owned: of the last frame, or of the last that was due */
};

/* Reads K (frames) or Ks (seconds). CS_ERR_USAGE. */
enum cs_status cs_checkpointer_read_interval(const char *value,
                                             struct cs_checkpoint_interval *interval,
                                             struct cs_error *error);

/* Refuses an interval in seconds for a method that restarts at checkpoints. CS_ERR_USAGE. */
enum cs_status cs_checkpointer_check_interval(const struct cs_session *session,
                                              const struct cs_checkpoint_interval *interval,
                                              struct cs_error *error);

/* Called before the first frame. Nothing is written. CS_ERR_FILE if the path is too long. */
enum cs_status cs_checkpointer_begin(struct cs_checkpointer *checkpointer,
                                     struct cs_session *session,
                                     const struct cs_checkpoint_source *of, const char *folder,
                                     const struct cs_checkpoint_interval *interval,
                                     struct cs_error *error);

/* Resumes from the checkpoint in the folder, with its interval. CS_ERR_FILE names the fact that
 * differs; CS_ERR_USAGE if it is beyond `frames`. */
enum cs_status cs_checkpointer_load(struct cs_checkpointer *checkpointer, uint32_t frames,
                                    struct cs_error *error);

/* Called after each frame: captures the state if needed; *due: it should be written. */
enum cs_status cs_checkpointer_capture(struct cs_checkpointer *checkpointer, bool *due,
                                       struct cs_error *error);
/* Writes the captured state once the files of its frame are complete, and at the end of a run.
 * Does nothing if it is already written. */
enum cs_status cs_checkpointer_write(struct cs_checkpointer *checkpointer,
                                     struct cs_error *error);

/* Frees the captured state; the file stays. */
void cs_checkpointer_finish(struct cs_checkpointer *checkpointer);

#endif
