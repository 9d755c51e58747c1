/* run_checkpoint.h - checkpoints of a run: when one is made, and going on from the last. */
#ifndef CS_RUN_CHECKPOINT_H
#define CS_RUN_CHECKPOINT_H

#include "base/hash.h"
#include "base/text.h"
#include "io/checkpoint.h"
#include "study/session.h"

/* How often. Zeroed: never. */
struct cs_checkpoint_interval {
    uint32_t frames;
    double seconds; /* of wall clock */
};

/* What a checkpoint belongs to, beside its session. */
struct cs_checkpoint_source {
    const char *scene, *hash, *method, *output_settings; /* texts, borrowed */
    /* what the caller keeps from frame to frame, by the same calls both ways */
    void (*serialise)(void *ctx, struct cs_serialiser *serialise);
    void *ctx;
};

/* Zeroed: no checkpoints. */
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

/* Reads K, a number of frames, or Ks, of seconds. CS_ERR_USAGE. */
enum cs_status cs_checkpointer_read_interval(const char *value,
                                             struct cs_checkpoint_interval *pace,
                                             struct cs_error *error);

/* CS_ERR_USAGE where a pace in seconds would reach the state. */
enum cs_status cs_checkpointer_check_interval(const struct cs_session *session,
                                              const struct cs_checkpoint_interval *pace,
                                              struct cs_error *error);

/* Before the first frame. */
enum cs_status cs_checkpointer_begin(struct cs_checkpointer *resume, struct cs_session *session,
                                     const struct cs_checkpoint_source *of, const char *folder,
                                     const struct cs_checkpoint_interval *pace,
                                     struct cs_error *error);

/* Goes on from the checkpoint in the folder, at its pace. CS_ERR_FILE says what differs;
 * CS_ERR_USAGE: it is of more than `frames` frames. */
enum cs_status cs_checkpointer_load(struct cs_checkpointer *resume, uint32_t frames,
                                    struct cs_error *error);

/* After each frame: keeps what it has come to; *due: it is to be written. */
enum cs_status cs_checkpointer_capture(struct cs_checkpointer *resume, bool *due,
                                       struct cs_error *error);
/* Once the files of that frame are there, and at the end of a run: nothing where the last one
 * kept is written already. */
enum cs_status cs_checkpointer_write(struct cs_checkpointer *resume, struct cs_error *error);

void cs_checkpointer_finish(struct cs_checkpointer *resume);

#endif
