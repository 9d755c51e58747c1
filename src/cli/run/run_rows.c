/* Writes the rows, states and hashes of frames. */
#include "cli/line/print.h"
#include "cli/run/job_state.h"

/* Rows are collected in memory and written at the end; lack of memory shows here. */
static enum cs_status check(const struct cs_text *rows, struct cs_error *error) {
    return rows->failed ? cs_fail(error, CS_ERR_MEMORY, "out of memory for the rows of frames")
                        : CS_OK;
}

/* Writes the rows of a whole or failed run; the first failure wins. */
static enum cs_status write_rows(const char *path, struct cs_text *rows,
                                 struct cs_error *error) {
    struct cs_error failure = {0};
    if (path && !rows->failed && cs_print_file(path, rows, &failure) && !error->status)
        *error = failure;
    return error->status;
}

static enum cs_status watch_frame(struct cs_job *job, struct cs_error *error) {
    if (job->settings->monitor_file)
        cs_energy_monitor_print_row(&job->sound, job->session.run.frame, &job->watch_rows);
    return check(&job->watch_rows, error);
}

/* Column names and the start state; a resumed run has loaded its rows with the checkpoint. */
static enum cs_status watch_begin(struct cs_job *job, struct cs_error *error) {
    if (job->settings->resume)
        return CS_OK;
    if (job->settings->monitor_file)
        cs_energy_monitor_print_head(&job->watch_rows);
    return watch_frame(job, error);
}

static void watch_record(struct cs_job *job, struct cs_serialiser *record) {
    cs_serialiser_text(record, &job->watch_rows);
}

static enum cs_status watch_end(struct cs_job *job, struct cs_error *error) {
    return write_rows(job->settings->monitor_file, &job->watch_rows, error);
}

const struct cs_run_output cs_run_output_watch = {
    .option = "--monitor",
    .path = offsetof(struct cs_job_settings, monitor_file),
    .at =
        {[CS_RUN_BEGIN] = watch_begin, [CS_RUN_FRAME] = watch_frame, [CS_RUN_END] = watch_end},
    .record = watch_record};

static enum cs_status ledger_frame(struct cs_job *job, struct cs_error *error) {
    if (job->settings->ledger)
        cs_energy_ledger_print_row(&job->ledger, job->session.run.frame, &job->ledger_rows);
    return check(&job->ledger_rows, error);
}

/* A resumed ledger continues from the loaded state. */
static enum cs_status ledger_begin(struct cs_job *job, struct cs_error *error) {
    if (!job->settings->ledger)
        return CS_OK;
    if (job->settings->resume) {
        cs_energy_ledger_resume(&job->ledger, job->session.run.t);
        return CS_OK;
    }
    cs_energy_ledger_print_head(&job->ledger_rows);
    return ledger_frame(job, error);
}

static void ledger_record(struct cs_job *job, struct cs_serialiser *record) {
    cs_serialiser_text(record, &job->ledger_rows);
    CS_SERIALISER(record, job->ledger.work);
}

static enum cs_status ledger_end(struct cs_job *job, struct cs_error *error) {
    return write_rows(job->settings->ledger, &job->ledger_rows, error);
}

const struct cs_run_output cs_run_output_ledger = {.option = "--ledger",
                                                   .path =
                                                       offsetof(struct cs_job_settings, ledger),
                                                   .at = {[CS_RUN_BEGIN] = ledger_begin,
                                                          [CS_RUN_FRAME] = ledger_frame,
                                                          [CS_RUN_END] = ledger_end},
                                                   .record = ledger_record};

/* Writes x_NUMBER.npy and v_NUMBER.npy of the frame. */
static enum cs_status states_frame(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const char *folder = job->settings->states;
    return folder ? cs_output_state(folder, run->frame, run->x, run->v,
                                    job->session.system.view.n, error)
                  : CS_OK;
}

/* A resumed run has the states of its start already. */
static enum cs_status states_begin(struct cs_job *job, struct cs_error *error) {
    return job->settings->resume ? CS_OK : states_frame(job, error);
}

const struct cs_run_output cs_run_output_states = {
    .option = "--states",
    .path = offsetof(struct cs_job_settings, states),
    .is_ours = cs_output_is_state,
    .at = {[CS_RUN_BEGIN] = states_begin, [CS_RUN_FRAME] = states_frame}};

/* Prints "FRAME HASH" as soon as the frame is done. */
static enum cs_status hash_frame(struct cs_job *job, struct cs_error *error) {
    struct cs_text line = {0};
    if (!job->settings->hash)
        return CS_OK;
    cs_text_add(&line, "%u %s\n", job->session.run.frame, job->hash);
    return cs_print_out(stdout, &line, error);
}

const struct cs_run_output cs_run_output_hash = {.at = {[CS_RUN_FRAME] = hash_frame}};
