/* commit.h - the call that follows each step of a method. */
#ifndef CS_COMMIT_H
#define CS_COMMIT_H

#include "sim/run_host.h"

/* host->commit: limits strains, resolves contact, takes the velocity loss, places what is
 * grabbed, and judges whether the run goes on; with the account of it all. */
enum cs_step cs_host_commit(void *ctx, double t, double dt, double *x, double *v,
                            bool *changed);

/* Particles that contact holds are pinned while the method acts, and free for all that moves
 * particles after a step, or looks on. */
void cs_host_pin(struct cs_run_host *host, bool held);

#endif
