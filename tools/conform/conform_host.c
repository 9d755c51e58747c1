/* The rules of the host: threads, cuts of loops and a resumed run leave the bits alone, and no
 * memory is allocated in a step, by the C library's count of bytes in use over all its arenas.
 */
#include "base/hash.h"
#include "base/pool.h"
#include "base/vector.h"
#include "conform/conform_checks.h"
#include "session/session.h"

#include <stdlib.h>
#include <string.h>

/* A sheet whose rows, and a mesh whose springs, are divided among seven threads; its vectors
 * have several blocks. Sums in an order that depends on the threads would show. */
#define SHARED                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [40, 60], \"size\": [1, 1.5], \"bump\": 0.02},"      \
    " \"mass\": {\"total\": 0.5}, \"pins\": [\"top-left\", \"top-right\"], \"springs\":"       \
    " {\"stretch\": 20, \"shear\": 7, \"bend\": 2, \"damping\": 0.01}},"                       \
    " {\"mesh\": {\"shape\": \"sphere\", \"detail\": 10, \"spin\": [3, 2, 1],"                 \
    " \"place\": {\"translate\": [2, 0, 0]}}, \"mass\": {\"total\": 0.5},"                     \
    " \"springs\": {\"stretch\": 20, \"bend\": 2, \"damping\": 0.01}}],"                       \
    " \"forces\": {\"drag\": 0.001, \"wind\": {\"direction\": [0, 0, 1], \"strength\":"        \
    " 0.001}}, \"time\": {\"fps\": 250}}"

/* A small sheet that falls on a floor. */
#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"particle\": 0.05},"            \
    " \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 5, \"damping\": 0.1},"           \
    " \"pins\": [\"top-left\"]}], \"colliders\": [{\"floor\": {\"height\": -0.55}}]}"

enum { FRAMES = 2, CUT_FRAMES = 5, CUTS = 8 };

/* Hash of the state after FRAMES. Returns false if there is none: the row says why. */
static bool hash_with(uint32_t threads, const struct cs_conform *conform,
                      struct cs_conform_row *row, char hash[CS_HASH_DIGITS]) {
    struct cs_probe probe = {0};
    struct cs_error error = {0};
    if (cs_pool_start(threads, &error)) {
        cs_row_fail(row, "%s", error.message);
        return false;
    }
    if (cs_probe_open(&probe, conform, conform->method, SHARED) && cs_probe_run(&probe, FRAMES))
        cs_hash_doubles(probe.x, 6 * probe.n, hash);
    else
        cs_row_fail(row, "with %u thread%s: %s", threads, threads == 1 ? "" : "s",
                    probe.error.message);
    const bool ended = probe.has_ended;
    cs_probe_close(&probe);
    cs_pool_stop();
    return !ended;
}

void cs_check_threads(const struct cs_conform *conform, struct cs_conform_row *row) {
    static const uint32_t threads[] = {2, 3, 7};
    char one[CS_HASH_DIGITS], several[CS_HASH_DIGITS];
    if (!hash_with(1, conform, row, one))
        return;
    uint32_t differ = 0;
    for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
        if (!hash_with(threads[k], conform, row, several))
            return;
        differ += strcmp(one, several) != 0;
    }
    cs_row_state(row, differ, 0, "of 3 numbers of threads with other bits than one has");
}

/* State of the random cuts: parallel_for has no argument for it. */
static uint32_t seed;

static size_t draw(size_t below) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % below;
}

/* Calls part for begin..end-1 in pieces of any length, in any order. */
static void cut(size_t begin, size_t end, void (*part)(void *arg, size_t begin, size_t end),
                void *arg) {
    if (end - begin == 1 || draw(8) == 0) {
        part(arg, begin, end);
        return;
    }
    const size_t middle = begin + 1 + draw(end - begin - 1);
    const bool later_first = draw(2);
    if (later_first)
        cut(middle, end, part, arg);
    cut(begin, middle, part, arg);
    if (!later_first)
        cut(middle, end, part, arg);
}

static void cut_all(size_t n, void (*part)(void *arg, size_t begin, size_t end), void *arg) {
    if (n > 0)
        cut(0, n, part, arg);
}

/* The host cuts loops into pieces that depend on the threads, but not by every number of items:
 * here they are cut at random. A sum over pieces would show. */
void cs_check_cuts(const struct cs_conform *conform, struct cs_conform_row *row) {
    struct cs_vector_kernels kernels = cs_vector_kernels;
    char hash[CS_HASH_DIGITS], first[CS_HASH_DIGITS];
    uint32_t differ = 0;
    kernels.parallel_for = cut_all;
    for (seed = 0; seed <= CUTS && row->verdict != CS_VERDICT_FAIL;) {
        const uint32_t layout = seed;
        struct cs_probe sheet;
        cs_probe_open(&sheet, conform, conform->method, SHEET);
        sheet.session.settings.run.vector = layout > 0 ? &kernels : NULL;
        if (cs_probe_run(&sheet, CUT_FRAMES)) {
            cs_hash_doubles(sheet.x, 6 * sheet.n, layout > 0 ? hash : first);
            differ += layout > 0 && strcmp(hash, first) != 0;
        } else
            cs_row_fail(row, "%s", sheet.error.message);
        cs_probe_close(&sheet);
        seed = layout + 1;
    }
    cs_row_state(row, differ, 0, "of %d random cuts of loops gave other bits", CUTS);
}

#ifdef __GLIBC__
#include <malloc.h>
#endif

/* glibc keeps a few freed blocks of each small size per thread and counts them as in use:
 * memory allocated and freed within a step would not show. Therefore SHELF blocks of each of
 * SIZES sizes are held during the frame. The thread's cache is then empty, and a block that the
 * step frees goes into it: it still counts as in use. */
enum { SIZES = 64, SIZE_STEP = 16, SHELF = 7, WARM_UP = 3, WATCHED = 5 };

/* Blocks held during a watched frame, and the bytes in use. */
struct ledger {
    void *held[SIZES][SHELF];
    size_t before; /* bytes handed out */
    size_t most;   /* more than that, at the end of a step */
};

/* Returns the bytes in use, 0 if the C library does not report them. */
static size_t bytes_allocated(void) {
#if defined(__GLIBC__) && defined(__GLIBC_PREREQ)
#if __GLIBC_PREREQ(2, 33)
    const struct mallinfo2 account = mallinfo2();
    return account.uordblks + account.hblkhd;
#endif
#endif
    return 0;
}

/* Called at each commit: records the largest increase since the frame began. */
static bool count_allocations(struct cs_probe *probe, double t, double dt, double *x,
                              double *v) {
    (void)t, (void)dt, (void)x, (void)v;
    struct ledger *ledger = probe->on_commit_ctx;
    const size_t now = ledger ? bytes_allocated() : 0;
    if (ledger && now > ledger->before && now - ledger->before > ledger->most)
        ledger->most = now - ledger->before;
    return false;
}

/* Runs one frame with the thread's cache emptied, and compares the bytes in use. */
static bool watched_frame(struct cs_probe *probe, struct ledger *ledger) {
    for (int k = 0; k < SIZES; k++)
        for (int j = 0; j < SHELF; j++)
            ledger->held[k][j] = malloc((size_t)(k + 1) * SIZE_STEP);
    ledger->before = bytes_allocated();
    probe->on_commit_ctx = ledger;
    const bool done = cs_probe_run(probe, 1);
    count_allocations(probe, 0, 0, NULL, NULL);
    probe->on_commit_ctx = NULL;
    for (int k = 0; k < SIZES; k++)
        for (int j = 0; j < SHELF; j++)
            free(ledger->held[k][j]);
    return done;
}

/* Some frames run first: the host and libraries may allocate at their first use. */
void cs_check_allocation(const struct cs_conform *conform, struct cs_conform_row *row) {
    /* without an account nothing can be seen, which is no pass */
    if (bytes_allocated() == 0) {
        cs_row_skip(row, "this C library does not report its memory use");
        return;
    }
    struct cs_probe sheet;
    struct ledger ledger = {.most = 0};
    cs_probe_open(&sheet, conform, conform->method, SHEET);
    sheet.on_commit = count_allocations;
    cs_probe_run(&sheet, WARM_UP);
    for (int k = 0; k < WATCHED && !sheet.has_ended; k++)
        watched_frame(&sheet, &ledger);
    if (sheet.has_ended)
        cs_row_fail(row, "%s", sheet.error.message);
    else
        cs_row_state(row, (double)ledger.most, 0,
                     "bytes more in use within a frame than before");
    cs_probe_close(&sheet);
}

/* --- a resumed run has the bits of the unbroken one --- */

/* Many things change between frames: ramped values, released pins, gusts and contact. */
#define EVENTFUL                                                                               \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"bump\": 0.02}, \"mass\": {\"particle\": "  \
    "0.05}, \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 5, \"damping\": 0.1},"     \
    " \"pins\": [\"top-left\", \"top-right\"]}, {\"cloth\": {\"grid\": [4, 3], \"bump\": "     \
    "0.01}, \"mass\": {\"particle\": 0.05}, \"springs\": {\"stretch\": 60}, \"pins\": [1]}],"  \
    " \"colliders\": [{\"floor\": {\"height\": -0.52}}], \"forces\": {\"drag\": 0.01},"        \
    " \"time\": {\"fps\": 60}, \"events\": [{\"from\": 0.02, \"to\": 0.12, \"ramp\": {"        \
    "\"key\": \"bodies[1].springs.stretch\", \"value\": 90}}, {\"from\": 0.01, \"to\": 0.14,"  \
    " \"wind\": {\"strength\": 3, \"direction\": [0, 0, 1]}}, {\"at\": 0.06, \"release\": {"   \
    "\"particles\": [\"top-left\"]}}]}"
/* Without events or contact, for history that those would let go. */
#define QUIET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"bump\": 0.02, \"velocity\": [0.1, 0.2, "   \
    "0.3]}, "                                                                                  \
    "\"mass\": {\"particle\": 0.05}, \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": " \
    "5, "                                                                                      \
    "\"damping\": 0.1}, \"pins\": [\"top-left\"]}], \"forces\": {\"drag\": 0.01}, \"time\": "  \
    "{\"fps\": 60}}"
/* Frames of the run, and the frame after which the checkpoint is written. */
enum { RESUME_FRAMES = 10, BROKEN = 5 };

/* Writes a record after BROKEN frames, or restores the run from one. */
static bool pass_break(struct cs_probe *probe, struct cs_serialiser *serialiser) {
    struct cs_run *run = &probe->session.run;
    if (!probe->has_ended && serialiser->is_reading)
        probe->has_ended = cs_run_load(run, serialiser, &probe->error);
    else if (!probe->has_ended)
        probe->has_ended = cs_run_save(run, serialiser, &probe->error);
    return !probe->has_ended;
}

/* True if state and counts agree exactly. */
static bool is_same(const struct cs_probe *one, const struct cs_probe *two) {
    const struct cs_counts *a = &one->session.run.counts, *b = &two->session.run.counts;
    return !memcmp(one->x, two->x, 6 * one->n * sizeof *one->x) && a->steps == b->steps &&
           a->forces == b->forces && a->solve_iterations == b->solve_iterations &&
           a->method.rejected == b->method.rejected && a->method.newton == b->method.newton;
}

static void resume_in(const struct cs_conform *conform, struct cs_conform_row *row,
                      const char *scene) {
    struct cs_probe whole, resumed;
    struct cs_serialiser serialiser = {0};
    uint32_t differ = 0;
    cs_probe_open(&whole, conform, conform->method, "%s", scene);
    cs_probe_open(&resumed, conform, conform->method, "%s", scene);
    if (cs_probe_run(&whole, BROKEN) && pass_break(&whole, &serialiser) &&
        cs_probe_run(&resumed, 0)) {
        serialiser.is_reading = true;
        pass_break(&resumed, &serialiser);
        if (!resumed.has_ended && !cs_serialiser_is_done(&serialiser))
            cs_row_fail(row, "load reads less than save wrote");
    }
    for (int k = BROKEN;
         k < RESUME_FRAMES && cs_probe_run(&whole, 1) && cs_probe_run(&resumed, 1); k++)
        differ += !is_same(&whole, &resumed);
    if (whole.has_ended || resumed.has_ended)
        cs_row_fail(row, "%s", whole.has_ended ? whole.error.message : resumed.error.message);
    else
        cs_row_state(
            row, differ, 0, "of %d frames with other bits (%s)", RESUME_FRAMES - BROKEN,
            cs_run_method_has_history(conform->method) ? "it saves its memory"
                                                       : "it is restarted at checkpoints");
    cs_serialiser_finish(&serialiser);
    cs_probe_close(&whole);
    cs_probe_close(&resumed);
}

/* A scene that the method refuses is left out. */
void cs_check_resume(const struct cs_conform *conform, struct cs_conform_row *row) {
    resume_in(conform, row, QUIET);
    struct cs_conform_row eventful = *row;
    resume_in(conform, &eventful, EVENTFUL);
    if (!*conform->refused)
        *row = eventful;
    *conform->refused = false;
}
