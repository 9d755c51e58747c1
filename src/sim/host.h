/* host.h - the host's calls for a method: the model's functions, counted, timed and checked. */
#ifndef CS_HOST_H
#define CS_HOST_H

#include "sim/run_host.h"

/* Fills host->table for a run over run->system, and takes the memory of contact and of the
 * linear solver. host is zeroed but for its settings. CS_ERR_MEMORY. */
enum cs_status cs_run_host_init(struct cs_run_host *host, struct cs_run *run,
                                struct cs_error *error);

/* Applies the events at time t to the state, the pins and the values, and sets the blow-up
 * bound for them. Returns true if anything changed: the method must be restarted. */
bool cs_run_host_apply_events(struct cs_run_host *host, double t);

#endif
