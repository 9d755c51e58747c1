/* commit.h - host->commit, the call that follows each step of a method. */
#ifndef CS_COMMIT_H
#define CS_COMMIT_H

#include "sim/run_host.h"

/* host->commit. Corrects the state (x, v) that a step of length dt left at time t, books the
 * corrections in the energy ledger, and decides if the run continues. *changed: the state or
 * the pins differ from those that the method left, other than by its own paths. Returns
 * CS_STEP_HALT after a blow-up, an interrupt or the end of the budget, with run->outcome set;
 * CS_STEP_FAIL with a message. */
enum cs_step cs_host_commit(void *ctx, double t, double dt, double *x, double *v,
                            bool *changed);

/* Pins the particles that static friction holds, or releases them. They are pinned during the
 * method's calls only: corrections, the ledger and outputs see them as free. */
void cs_host_pin(struct cs_run_host *host, bool held);

#endif
