/* compare_state.h - what a comparison is asked for, and what it has found so far. */
#ifndef CS_COMPARE_STATE_H
#define CS_COMPARE_STATE_H

#include "base/table.h"
#include "study/compare/compare_norm.h"
#include "study/compare/rounds.h"
#include "study/compare/sweep.h"
#include "study/reference/compare_reference_state.h"

/* The default budget: s of processor time for the cells of a comparison and for their rounds,
 * without its reference, and the most that a run may take. */
#define CS_COMPARE_SECONDS       25
#define CS_COMPARE_ROUND_SECONDS 20.0
#define CS_COMPARE_MOST          4.0

/* Leading characters of a row's key: the same for all rows of a scene, time and reference. */
#define CS_COMPARE_DIGITS 16

struct cs_compare_settings {
    struct cs_course_settings course;
    const char *methods;      /* list as in sweep.h; NULL: all */
    const char *reference[2]; /* "NAME:options" of its families, or NULL */
    double accuracy;          /* m, see compare_reference.h */
    double budget;            /* s of processor time that one run may take; 0: see below */
    uint32_t runs;            /* rounds of timed runs, at most; up to CS_ROUNDS_MOST */
    enum cs_norm rank;        /* what the verdict goes by */
    const char *folder;       /* for compare.csv */
    const char *command;      /* that repeats it, for the report; may be NULL */
    bool html;                /* one HTML file as well */
    bool ledger;              /* each method is run once more, to say where energy went */
    struct cs_shard shard;    /* of the cells; zeroed: all */
    const char *cache;        /* folder of references */
    bool fresh;               /* an earlier compare.csv is written over */
    /* may be NULL; taken: the row is of an earlier run */
    void (*reference_progress)(void *ctx, uint32_t done, uint32_t total, const char *what);
    void (*begun)(void *ctx); /* the reference is there, cells are not */
    void (*row)(void *ctx, const struct cs_cell *cell, bool taken);
    void (*round)(void *ctx, uint32_t done, uint32_t most); /* may be NULL */
    void *ctx;
};

/* Zeroed: empty. */
struct cs_compare {
    const struct cs_compare_settings *settings; /* borrowed */
    struct cs_compare_reference reference;
    struct cs_sweep sweep;
    struct cs_rounds rounds; /* of the sweep's cells */
    char scene[256];         /* path as given */
    char machine[CS_MACHINE_NAME];
    struct cs_text changes;            /* what was switched off, "" nothing */
    struct cs_text origin;             /* origin.json: what each row hangs on but its method */
    bool contact;                      /* by force: a part of the equation of motion */
    uint32_t particles, springs, cuts; /* cuts: times of events */
    double fps, omega, time, budget;
    double size;              /* m, of the scene: a power of 10 */
    double rounds_for;        /* s that rounds may go on */
    uint32_t done, taken;     /* cells; those of an earlier run */
    uint32_t ended, left_out; /* series that went over budget, and their cells behind that */
};

#endif
