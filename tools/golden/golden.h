/* golden.h - compares runs with stored results: state hashes and images.
 *
 *   tables -> per row a run to its last frame -> hash or picture, compared -> report, or
 * accepted */
#ifndef CS_GOLDEN_H
#define CS_GOLDEN_H

#include "draw/render.h"
#include "golden/golden_table.h"
#include "study/session.h"

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

/* Recomputes every row. Rows that differ are counted in failed and reported, with *.actual.png
 * and *.difference.png beside a golden image; with accept_all the tables and images are
 * rewritten. A row whose run fails is counted in failed, and the others go on; a run that is
 * added fails as a whole. CS_ERR_FILE if a table cannot be read; CS_ERR_INTERRUPT. */
enum cs_status cs_golden_check(struct cs_golden *golden, struct cs_error *error);

#endif
