/* reproduce.h - reproduces a result from its stored provenance and compares the two. */
#ifndef CS_REPRODUCE_H
#define CS_REPRODUCE_H

#include "reproduce/provenance_read.h"

/* Request for a reproduction. */
struct cs_reproduction_settings {
    const char *file;                   /* run.json, or a picture of a run */
    const char *folder;                 /* see cs_provenance_to_session */
    struct cs_session_settings session; /* modules, threads, stop */
    /* called after each frame; may be NULL */
    void (*progress)(void *ctx, uint32_t done, uint32_t total);
    void *ctx;
};

/* Result of a reproduction; zeroed: nothing. The caller finishes it in any case. */
struct cs_reproduction {
    struct cs_text description;      /* "3 frames of a.json by rk4:dt=0.001" */
    struct cs_text notes;            /* what has changed since, a line each */
    struct cs_text equal_items;      /* "3 states and the outcome" */
    struct cs_text first_difference; /* the first; empty: there is none */
};

/* Reruns the scene stored in run.json, and compares the state of each frame and the outcome. A
 * difference is a result in first_difference. CS_ERR_FILE, CS_ERR_SCENE, CS_ERR_MODULE,
 * CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_reproduction_of_run(struct cs_reproduction *reproduction,
                                      const struct cs_reproduction_settings *settings,
                                      struct cs_error *error);
/* Reruns the scene stored in a picture up to its frame, compares the state, draws it with the
 * same renderer, and compares the pixels. */
enum cs_status cs_reproduction_of_picture(struct cs_reproduction *reproduction,
                                          const struct cs_reproduction_settings *settings,
                                          struct cs_error *error);
/* Frees the texts. */
void cs_reproduction_finish(struct cs_reproduction *reproduction);

#endif
