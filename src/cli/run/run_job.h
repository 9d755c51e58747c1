/* run_job.h - one run from settings to its last frame. */
#ifndef CS_RUN_JOB_H
#define CS_RUN_JOB_H

#include "cli/run/job_state.h"

/* Opens the session, checks and prepares the folders, runs to the last frame, a blow-up or an
 * interrupt (job->session.run.outcome), and waits for the last picture. On failure the frames
 * up to it are kept. cs_job_finish is to be called either way. */
enum cs_status cs_job_run(struct cs_job *job, const struct cs_job_settings *settings,
                          struct cs_error *error);
void cs_job_finish(struct cs_job *job);

#endif
