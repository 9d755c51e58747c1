/* run_job.h - one run from its settings to its last frame.
 *
 *   session -> description and provenance -> checks of outputs -> locks of folders -> warnings
 *   -> checkpoint or start -> per frame: step, sample, outputs, checkpoint -> end of outputs
 * Everything that can be refused is checked before the first file is touched. */
#ifndef CS_RUN_JOB_H
#define CS_RUN_JOB_H

#include "cli/run/job_state.h"

/* Runs to the last frame, a blow-up or an interruption (job->session.run.outcome), and waits
 * for the last picture. On failure the frames before it are kept. cs_job_finish must be called
 * in any case. Errors: those of cs_session_open and of the outputs. */
enum cs_status cs_job_run(struct cs_job *job, const struct cs_job_settings *settings,
                          struct cs_error *error);
/* Closes the outputs first, because a picture in progress draws into an image of the writer;
 * then the locks and the session. */
void cs_job_finish(struct cs_job *job);

#endif
