/* run_record.h - a run between two frames as bytes, for a checkpoint. */
#ifndef CS_RUN_RECORD_H
#define CS_RUN_RECORD_H

#include "base/serialise.h"
#include "sim/run.h"

/* True if the method has save and load. A method without them is restarted whenever a record
 * is made, in the unbroken run too: both runs then continue with the same bits. */
bool cs_run_method_has_history(const struct cs_integrator *integrator);

/* Writes everything that the next frame depends on: state, time, counts, events, contact, and
 * the method's history. May restart the method, see above. CS_ERR_MEMORY, or CS_ERR_MODULE
 * with the method's message. */
enum cs_status cs_run_save(struct cs_run *run, struct cs_serialiser *record,
                           struct cs_error *error);

/* Reads a record into a run that was begun in the same way and has made no frame yet. After a
 * failure (CS_ERR_FILE: bytes of another run; CS_ERR_MODULE) the run must not be used. */
enum cs_status cs_run_load(struct cs_run *run, struct cs_serialiser *record,
                           struct cs_error *error);

#endif
