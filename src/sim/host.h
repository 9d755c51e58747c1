/* host.h - the calls that a method may make, over the model: counted, timed, checked. */
#ifndef CS_HOST_H
#define CS_HOST_H

#include "sim/run_host.h"

/* Fills the calls for a run over system. CS_ERR_MEMORY. */
enum cs_status cs_run_host_init(struct cs_run_host *host, struct cs_run *run,
                                struct cs_error *error);

/* Replaces the call solve by one that fails. */
void cs_run_host_fail_solves(struct cs_run_host *host);

/* What happens at time t: the state, the pins and the values change, and so does the bound of
 * the kinetic energy. true: the method must be restarted; false: nothing changed. */
bool cs_run_host_apply_events(struct cs_run_host *host, double t);

#endif
