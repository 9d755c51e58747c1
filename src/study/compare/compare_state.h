/* compare_state.h - what a comparison is asked for, and what it has found so far. */
#ifndef CS_COMPARE_STATE_H
#define CS_COMPARE_STATE_H

#include "study/compare/compare_reference_state.h"
#include "study/compare/sweep.h"

/* The default budget: s that a comparison is to take without its reference, and the most that
 * a run may. */
#define CS_COMPARE_SECONDS 100
#define CS_COMPARE_MOST    4.0

/* Leading characters of a row's key: the same for all rows of a scene, time and reference. */
#define CS_COMPARE_DIGITS 16

struct cs_compare_settings {
    struct cs_course_settings course;
    const char *methods;      /* list as in sweep.h; NULL: all */
    const char *reference[2]; /* "NAME:options" of its families, or NULL */
    double accuracy;          /* m, see compare_reference.h */
    double budget;            /* s of processor time that one run may take; 0: see below */
    uint32_t runs;            /* timed runs of a cell, at least */
    const char *folder;       /* for compare.csv */
    const char *cache;        /* folder of references */
    bool fresh;               /* an earlier compare.csv is written over */
    /* may be NULL; taken: the row is of an earlier run */
    void (*reference_progress)(void *ctx, uint32_t done, uint32_t total, const char *what);
    void (*begun)(void *ctx); /* the reference is there, cells are not */
    void (*row)(void *ctx, const struct cs_cell *cell, bool taken);
    void *ctx;
};

/* Zeroed: empty. */
struct cs_compare {
    const struct cs_compare_settings *settings; /* borrowed */
    struct cs_compare_reference reference;
    struct cs_sweep sweep;
    char scene[256];                   /* path as given */
    struct cs_text changes;            /* what was switched off, "" nothing */
    bool contact;                      /* by force: a part of the equation of motion */
    uint32_t particles, springs, cuts; /* cuts: times of events */
    double fps, omega, time, budget;
    uint32_t done, taken; /* cells; those of an earlier run */
};

#endif
