/* advance_check.h - checks the post-conditions of advance() before a state is hashed, written
 * or drawn.
 *
 * The contract asks three things of a method: the last commit was at t1, all numbers are
 * finite, and pinned particles still have their bits. A method that breaks one could
 * otherwise report a wrong result as a success. */
#ifndef CS_ADVANCE_CHECK_H
#define CS_ADVANCE_CHECK_H

#include "model/system/system.h"

/* The state of the check within one advance; host->commit sets last_commit. */
struct cs_advance_check {
    const struct cs_system *system; /* borrowed */
    uint64_t pins_hash;             /* hash of x and v of the pinned particles at the begin */
    double last_commit;             /* s, the end of the last committed step */
};

/* Starts the check of an advance that begins at t. */
void cs_advance_check_begin(struct cs_advance_check *left, const struct cs_system *system,
                            double t);

/* Checks the state after an advance to t. Pinned particles on a path are left out: commit
 * places them. Returns false on a violation and adds one line about it to why. */
bool cs_advance_check_passes(const struct cs_advance_check *left, double t,
                             struct cs_text *why);

#endif
