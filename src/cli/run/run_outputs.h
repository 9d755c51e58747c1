/* run_outputs.h - the list of a run's outputs, and calls of all of them stage by stage. */
#ifndef CS_RUN_OUTPUTS_H
#define CS_RUN_OUTPUTS_H

#include "cli/run/job_state.h"

/* Compares the outputs with the files that the run reads and with each other: none may
 * overwrite another, not even with -y. Then, unless earlier files may be replaced, looks for
 * such. CS_ERR_FILE names the option and both files, or the first earlier file. */
enum cs_status cs_run_outputs_check(const struct cs_job *job, struct cs_error *error);

/* Opens what the outputs need, and locks their folders. */
enum cs_status cs_run_outputs_open(struct cs_job *job, struct cs_error *error);

/* Calls the outputs in the order of the list until one fails; at CS_RUN_END all of them. */
enum cs_status cs_run_outputs_at(struct cs_job *job, enum cs_run_stage stage,
                                 struct cs_error *error);
/* Serialises the outputs' state in the order of the list. */
void cs_run_outputs_record(struct cs_job *job, struct cs_serialiser *record);

/* Writes the manifest of each folder of the run. All files must be complete. */
enum cs_status cs_run_outputs_sign(const struct cs_job *job, struct cs_error *error);

#endif
