/* run_outputs.h - the list of a run's outputs: who writes what, and all of them stage by stage.
 */
#ifndef CS_RUN_OUTPUTS_H
#define CS_RUN_OUTPUTS_H

#include "cli/run/job_state.h"

/* Holds the outputs against the files that the run reads, and against each other: none of them
 * is overwritten, also with -y. Then, where earlier files are to stay, looks for such.
 * CS_ERR_FILE names the option and what the file is beside, or the first file that is there. */
enum cs_status cs_run_outputs_check(const struct cs_job *job, struct cs_error *error);

/* Opens what the outputs need, and becomes the owner of their folders. */
enum cs_status cs_run_outputs_open(struct cs_job *job, struct cs_error *error);

/* Calls the outputs in the order of the list until one fails; at CS_RUN_END all of them. */
enum cs_status cs_run_outputs_at(struct cs_job *job, enum cs_run_stage stage,
                                 struct cs_error *error);
void cs_run_outputs_record(struct cs_job *job, struct cs_serialiser *record);

/* Writes the manifest of each folder that the run owns, once all of its files are there. */
enum cs_status cs_run_outputs_sign(const struct cs_job *job, struct cs_error *error);

#endif
