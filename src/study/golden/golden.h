/* golden.h - compares runs with stored results: state hashes and images.
 *
 * golden/hash.tsv has one run per line; golden/image.tsv one picture, with
 * golden/image/NAME.png. A run is a scene, an integrator with options ("-": the scene's own),
 * overrides ("path=value;path=value", "-": none) and a number of frames. Paths are relative to
 * the folder above the golden folder. */
#ifndef CS_GOLDEN_H
#define CS_GOLDEN_H

#include "base/hash.h"
#include "base/text.h"
#include "draw/render.h"
#include "study/session.h"

/* A golden row, its settings, and its run. */

/* The run of a row; texts are the table's. */
struct cs_golden_run {
    char *scene, *integrator, *overrides; /* "-": none */
    uint32_t frames;
};

/* A line of a table: a run and its expected result. Fields are the table's. */
struct cs_golden_row {
    struct cs_golden_run run;
    char *hash; /* of the state (hash.tsv) or of the pixels (image.tsv) */
    /* "any", or the library and version that the bits are of ("SUNDIALS 6.4.1"), or the image's
     * renderer */
    char *note;
    char *image; /* name of the picture; NULL in hash.tsv */
    char found[CS_HASH_DIGITS], renderer[256];
    char library[64];       /* as in note, of this build; "": the bits are the program's own */
    struct cs_text message; /* the difference, or why the row was skipped; empty: equal */
    bool skipped;           /* the library is not in this build, or of another version */
    bool added;             /* accepted for that version, in a row of its own */
};

/* Settings and counts of a check; pointers are borrowed. */
struct cs_golden {
    const char *folder;    /* "golden" */
    const char *only_rows; /* rows whose scene or integrator holds this text; NULL: all */
    bool hashes, images;   /* what to do */
    bool accept_all;       /* write what was found instead of failing */
    uint32_t renderers;    /* set of 1 << enum cs_renderer_kind: each draws every picture */
    uint32_t threads;      /* as in struct cs_session_settings */
    const volatile sig_atomic_t *stop;
    /* called after each row; may be NULL */
    void (*report)(void *ctx, const struct cs_golden_row *row);
    void *ctx;
    uint32_t passed, failed, skipped, accepted;
};

/* Steps a row's run to its last frame. On success the session is open and the caller closes it.
 */
enum cs_status cs_golden_step(const struct cs_golden *golden, const struct cs_golden_run *run,
                              bool render, struct cs_session *session, struct cs_error *error);

/* Recomputes every row. Rows that differ are counted in failed and reported, with *.actual.png
 * and *.difference.png beside a golden image; with accept_all the tables and images are
 * rewritten. CS_ERR_FILE if a table cannot be read; CS_ERR_INTERRUPT. */
enum cs_status cs_golden_check(struct cs_golden *golden, struct cs_error *error);

#endif
