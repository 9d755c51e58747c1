/* compare_reference_state.h - settings of a reference, and its result. */
#ifndef CS_COMPARE_REFERENCE_STATE_H
#define CS_COMPARE_REFERENCE_STATE_H

#include "study/reference/horizon.h"
#include "study/trajectory_error.h"

enum { CS_COMPARE_REFERENCE_RUNS = 4 };

/* Request for a reference; all pointers are borrowed. */
struct cs_compare_reference_settings {
    const struct cs_recorded_run_settings *run;
    const char *methods[2]; /* "NAME:options" of the two families; NULL: the best there are */
    double accuracy;        /* m to which pointwise errors are wanted: bounds the horizon */
    const char *cache;      /* folder, or NULL */
    /* called before each run and at the end; may be NULL */
    void (*progress)(void *ctx, uint32_t done, uint32_t total, const char *what);
    void *ctx;
};

/* A reference; zeroed: none. Owns its trajectory. */
struct cs_compare_reference {
    struct cs_trajectory trajectory;
    char methods[CS_COMPARE_REFERENCE_RUNS][256]; /* family 1, its twin, family 2, its twin */
    char replacement[256]; /* for family 2 where the scene is too rough for it; "": none */
    double differences[3]; /* m: 1 against its twin, 2 against its twin, 1 against 2 */
    double error_bar;      /* m, RMS of particles at any frame: see compare_reference.h */
    double error_bar_max;  /* m, largest distance of a particle */
    double motion_scale;   /* m, largest RMS displacement from the start */
    double kinetic;        /* J, largest */
    double strain;         /* largest */
    double accuracy;       /* m, as asked for */
    struct cs_horizon horizon;
    bool families_agree;
    bool pointwise;   /* errors at the end of the time mean something */
    bool cached;      /* read from the cache */
    char reason[320]; /* why they do not agree, or why there are no pointwise errors */
};

#endif
