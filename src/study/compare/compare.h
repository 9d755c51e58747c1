/* compare.h - error against cost of many methods on one scene.
 *
 *   scene -> verified reference and horizon -> sweep: cells -> each run, measured, timed
 *     -> compare.csv as rows finish -> orders, verdict, warnings -> report
 *
 * Cells are timed one after the other in this process; only stepping is timed.
 */
#ifndef CS_COMPARE_H
#define CS_COMPARE_H

#include "study/compare/sweep.h"
#include "study/compare/yardstick.h"

#include <stdio.h>

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
    double accuracy;          /* m, see yardstick.h */
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
    struct cs_yardstick yardstick;
    struct cs_sweep sweep;
    char scene[256];                   /* path as given */
    struct cs_text changes;            /* what was switched off, "" nothing */
    uint32_t particles, springs, cuts; /* cuts: times of events */
    double fps, omega, time, budget;
    uint32_t done, taken; /* cells; those of an earlier run */
};

/* The whole way. A reference that is none is a result: then cells have costs and counts only.
 * On failure the finished rows stay in compare.csv. */
enum cs_status cs_compare_run(struct cs_compare *compare,
                              const struct cs_compare_settings *settings,
                              struct cs_error *error);
void cs_compare_finish(struct cs_compare *compare);

/* Below: parts of compare.c. */

/* Runs, measures and times one cell. */
enum cs_status cs_compare_measure(const struct cs_compare *compare, struct cs_cell *cell,
                                  struct cs_error *error);

/* Fills the orders of a method's successive cells where the slope is steady. */
void cs_compare_find_orders(struct cs_cell *cells, uint32_t n, double bar, double scale);

/* The table's file: what is there already, and the rows to come. */
struct cs_ledger {
    char path[4096];
    struct cs_cell *old; /* (n_old) rows of an earlier run, owned */
    uint32_t n_old;
    FILE *file; /* owned, appended to */
};
/* Takes over the rows of the same scene, time and reference: those of cells of this comparison
 * (by their keys), others as further cells. Writes them and opens the file for what is to
 * come. CS_ERR_USAGE where the file is of another comparison. */
enum cs_status cs_ledger_open(struct cs_ledger *ledger, struct cs_compare *compare,
                              struct cs_error *error);
enum cs_status cs_ledger_append(struct cs_ledger *ledger, const struct cs_cell *cell,
                                struct cs_error *error);
/* Writes all cells in their order. */
enum cs_status cs_ledger_rewrite(struct cs_ledger *ledger, const struct cs_compare *compare,
                                 struct cs_error *error);
void cs_ledger_close(struct cs_ledger *ledger);

#endif
