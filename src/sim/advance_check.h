/* advance_check.h - what a method leaves behind at the end of an advance, held to the contract
 * before anything is hashed, written or drawn. */
#ifndef CS_ADVANCE_CHECK_H
#define CS_ADVANCE_CHECK_H

#include "model/system/system.h"

struct cs_advance_check {
    const struct cs_system *system; /* borrowed */
    uint64_t pins_hash;             /* a sum over the bits of what is pinned, at the begin */
    double last_commit;             /* s, the end of the last step */
};

/* An advance begins at t. */
void cs_advance_check_begin(struct cs_advance_check *left, const struct cs_system *system,
                            double t);

/* One has ended, which was to reach t: every step was committed, all numbers are finite, and
 * pinned particles are where they were (those on a path are placed by commit). false: why says
 * what is not so. */
bool cs_advance_check_passes(const struct cs_advance_check *left, double t,
                             struct cs_text *why);

#endif
