/* run_kept.h - what a run keeps from frame to frame. */
#ifndef CS_RUN_KEPT_H
#define CS_RUN_KEPT_H

#include "cli/run/run_job.h"

/* A frame of the report; CS_ERR_MEMORY. */
enum cs_status cs_job_keep(struct cs_job *job, const struct cs_job_frame *frame,
                           struct cs_error *error);

/* What the job keeps of the frames so far, for a checkpoint; ctx: the job. */
void cs_job_record(void *ctx, struct cs_record *record);

#endif
