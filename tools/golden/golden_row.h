/* golden_row.h - a check, and one row of its tables: the run, and the verdict on its state or
 * picture. */
#ifndef CS_GOLDEN_ROW_H
#define CS_GOLDEN_ROW_H

#include "golden/golden_table.h"
#include "session/frame_picture.h"
#include "session/session.h"

/* Settings and counts of a check; pointers are borrowed. */
struct cs_golden {
    const char *folder;    /* "golden" */
    const char *only_rows; /* rows whose scene or integrator holds this text; NULL: all */
    bool hashes, images;   /* what to do */
    bool any_table;        /* one of the two may be missing: it has no rows */
    bool accept_all;       /* write what was found instead of failing */
    /* with a scene: this run alone is done, and added to the tables, which are made if they are
     * not there; set accept_all too */
    struct cs_golden_run add;
    const char *add_tolerance; /* "bits" or m, of its row; NULL: as it is there, or bits */
    uint32_t states; /* frames whose positions are kept for a row that has none; 0: none */
    const char *const *plugins; /* (n_plugins) modules and programs that rows may name */
    uint32_t n_plugins;
    uint32_t renderers; /* set of 1 << enum cs_renderer_kind: each draws every picture */
    uint32_t threads;   /* as in struct cs_session_settings */
    uint32_t jobs; /* rows at a time, each in a process of its own, up to CS_PROCESS_POOL_MAX */
    const volatile sig_atomic_t *stop;
    /* called after each row, in their order; may be NULL */
    void (*report)(void *ctx, const struct cs_golden_row *row);
    void *ctx;
    uint32_t passed, failed, skipped, accepted;
    uint32_t broken; /* of the failed ones: those whose run failed */
};

/* States that a run leaves: at the frames of `like`, or with NULL at `kept` of its frames. */
struct cs_golden_recording {
    const struct cs_golden_states *like;
    uint32_t kept;
    struct cs_golden_states states; /* out, of the caller in any case */
};

/* Steps a row's run to its last frame, recording its states on the way; NULL: none. On success
 * the session is open and the caller closes it. */
enum cs_status cs_golden_step(const struct cs_golden *golden, const struct cs_golden_run *run,
                              bool render, struct cs_golden_recording *recording,
                              struct cs_session *session, struct cs_error *error);

/* Check a row of hash.tsv or of image.tsv: fill row->finding, and row->message if it differs.
 * With accept_all the stored states or the picture are written. An error is of the run. */
enum cs_status cs_golden_check_state(struct cs_golden *golden, struct cs_golden_row *row,
                                     struct cs_error *error);
enum cs_status cs_golden_check_image(struct cs_golden *golden, struct cs_golden_row *row,
                                     struct cs_error *error);

/* Path of a picture of a row: FOLDER/image/NAME and the ending. */
void cs_golden_image_path(const char *folder, const struct cs_golden_row *row,
                          const char *ending, char path[1024]);

#endif
