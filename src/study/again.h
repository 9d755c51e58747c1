/* again.h - a result made again from what it carries, and held against itself. */
#ifndef CS_AGAIN_H
#define CS_AGAIN_H

#include "study/carried.h"

struct cs_again_settings {
    const char *file;                   /* run.json, or a picture of a run */
    const char *folder;                 /* see cs_carried_ask */
    struct cs_session_settings session; /* modules, threads, stop */
    /* called after each frame; may be NULL */
    void (*progress)(void *ctx, uint32_t done, uint32_t total);
    void *ctx;
};

/* What was found. Zeroed: nothing. */
struct cs_again {
    struct cs_text what;       /* was made again: "3 frames of a.json by rk4:dt=0.001" */
    struct cs_text notes;      /* what has changed since, a line each */
    struct cs_text equal;      /* "3 states and the outcome" */
    struct cs_text difference; /* the first; empty: there is none */
};

/* Runs what run.json carries, and compares the state of each frame and how the run ended. */
enum cs_status cs_again_run(struct cs_again *again, const struct cs_again_settings *settings,
                            struct cs_error *error);
/* Runs what a picture carries up to its frame, compares the state, draws it by the same
 * renderer, and compares the pixels. */
enum cs_status cs_again_picture(struct cs_again *again,
                                const struct cs_again_settings *settings,
                                struct cs_error *error);
void cs_again_finish(struct cs_again *again);

#endif
