/* Checks that the state has the same bits with any number of threads. */
#include "base/hash.h"
#include "base/pool.h"
#include "study/conform/conform_checks.h"
#include "study/conform/conform_probe.h"

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

enum { FRAMES = 2 };

/* Hash of the state after FRAMES. Returns false if there is none: the row says why. */
static bool hash_with(uint32_t threads, const struct cs_conform *card,
                      struct cs_conform_row *row, char hash[CS_HASH_DIGITS]) {
    struct cs_probe probe = {0};
    struct cs_error error = {0};
    if (cs_pool_start(threads, &error)) {
        cs_row_fail(row, "%s", error.message);
        return false;
    }
    if (cs_probe_open(&probe, card, card->method, SHARED) && cs_probe_run(&probe, FRAMES))
        cs_hash_doubles(probe.x, 6 * probe.n, hash);
    else
        cs_row_fail(row, "with %u thread%s: %s", threads, threads == 1 ? "" : "s",
                    probe.error.message);
    const bool ended = probe.has_ended;
    cs_probe_close(&probe);
    cs_pool_stop();
    return !ended;
}

void cs_check_threads(const struct cs_conform *card, struct cs_conform_row *row) {
    static const uint32_t threads[] = {2, 3, 7};
    char one[CS_HASH_DIGITS], several[CS_HASH_DIGITS];
    if (!hash_with(1, card, row, one))
        return;
    uint32_t differ = 0;
    for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
        if (!hash_with(threads[k], card, row, several))
            return;
        differ += strcmp(one, several) != 0;
    }
    cs_row_state(row, differ, 0, "of 3 numbers of threads with other bits than one has");
}
