/* run_record.h - a run between two frames as bytes, for a checkpoint. */
#ifndef CS_RUN_RECORD_H
#define CS_RUN_RECORD_H

#include "base/serialise.h"
#include "sim/run.h"

/* Whether the method saves what it remembers. One that does not is restarted where a record is
 * made, so that the runs that go on from there have the same bits. */
bool cs_run_method_has_history(const struct cs_integrator *integrator);

/* Adds all that the next frame hangs on: state, time, counts, events, contact, and what the
 * method remembers. CS_ERR_MEMORY, or CS_ERR_MODULE with the method's message. */
enum cs_status cs_run_save(struct cs_run *run, struct cs_serialiser *record,
                           struct cs_error *error);

/* Takes it back into a run that was begun the same way and has made no frame yet. On failure
 * (CS_ERR_FILE: bytes of another run; CS_ERR_MODULE) the run is not to be used. */
enum cs_status cs_run_load(struct cs_run *run, struct cs_serialiser *record,
                           struct cs_error *error);

#endif
