/* Writes the rows, states and hashes of frames. */
#include "cli/line/print.h"
#include "cli/run/job_state.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void write_record(void *ctx, const struct cs_trace_record *record) {
    cs_trace_stream_write(ctx, record);
}

/* Frames have at most 8 digits here, which strtoul reads without overflow. */
enum cs_status cs_run_trace_read(const char *value, struct cs_run_trace *run_trace,
                                 struct cs_error *error) {
    const size_t length = strlen(value);
    const bool number = strspn(value, "0123456789") == length && length > 0 && length < 9;
    run_trace->frame = number ? (uint32_t)strtoul(value, NULL, 10) : 0;
    run_trace->is_requested = true;
    run_trace->trace = (struct cs_trace){.emit = write_record};
    return run_trace->frame || !strcmp(value, "frames")
               ? CS_OK
               : cs_fail(error, CS_ERR_USAGE,
                         "--trace: found \"%.60s\", expected \"frames\" or the number of a "
                         "frame",
                         value);
}

/* Writes x and v of the present frame as two records. */
static void write_state(const struct cs_job *job) {
    const struct cs_run *run = &job->session.run;
    struct cs_trace_record record = {.frame = run->frame,
                                     .step = run->counts.steps,
                                     .t = run->t,
                                     .phase = run->frame ? "frame" : "start",
                                     .name = "x",
                                     .values = run->x,
                                     .n = 3 * (size_t)run->system->view.n};
    cs_trace_stream_write(job->trace.trace.ctx, &record);
    record.name = "v";
    record.values = run->v;
    cs_trace_stream_write(job->trace.trace.ctx, &record);
}

/* Enables the full trace for the requested frame only. */
static void expect_frame(struct cs_run_trace *run_trace, const struct cs_run *run) {
    run_trace->trace.enabled = run_trace->frame == run->frame + 1;
}

static enum cs_status refuse_output(struct cs_error *error) {
    return cs_fail(error, CS_ERR_FILE, "cannot write to standard output");
}

/* Begins the stream with the start state, before the first frame. It has a descriptor of its
 * own: during calls of a module from outside, standard output is diverted (sim/crash.h). */
static enum cs_status begin_rows(struct cs_job *job, struct cs_error *error) {
    if (!job->trace.is_requested)
        return CS_OK;
    const int output = dup(STDOUT_FILENO);
    FILE *file = output < 0 ? NULL : fdopen(output, "wb");
    if (!file) // the program ends, and its descriptors with it
        return cs_fail(error, CS_ERR_FILE, "cannot write to standard output: %s",
                       strerror(errno));
    job->trace.trace.ctx = file;
    cs_trace_stream_begin(file);
    write_state(job);
    expect_frame(&job->trace, &job->session.run);
    return CS_OK;
}

/* Writes the state after a frame: after every frame, or after the traced one only. */
static enum cs_status frame(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const struct cs_run_trace *run_trace = &job->trace;
    if (!run_trace->is_requested)
        return CS_OK;
    if (!run_trace->frame || run_trace->frame == run->frame)
        write_state(job);
    expect_frame(&job->trace, run);
    return fflush(run_trace->trace.ctx) || ferror(run_trace->trace.ctx) ? refuse_output(error)
                                                                        : CS_OK;
}

/* Writes when and where a run blew up, and closes the stream. */
static enum cs_status end(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const double where[] = {run->blow_up.particle, run->blow_up.energy};
    const struct cs_trace_record record = {.frame = run->frame + 1,
                                           .step = run->counts.steps,
                                           .t = run->blow_up.time,
                                           .phase = cs_outcome_text(run->outcome),
                                           .name = "end",
                                           .values = where,
                                           .n = 2};
    FILE *file = job->trace.trace.ctx;
    if (!file)
        return error->status;
    if (cs_outcome_is_blow_up(run->outcome))
        cs_trace_stream_write(file, &record);
    const bool failed = ferror(file);
    job->trace.trace.ctx = NULL;
    return fclose(file) || failed ? refuse_output(error) : error->status;
}

const struct cs_run_output cs_run_output_trace = {
    .at = {[CS_RUN_BEGIN] = begin_rows, [CS_RUN_FRAME] = frame, [CS_RUN_END] = end}};

/* Opens the rows of a file; a resumed run goes on with those that its checkpoint has loaded. */
static enum cs_status open_rows(const struct cs_job *job, struct cs_row_log *log,
                                const char *path, struct cs_error *error) {
    return job->settings->resume ? cs_row_log_resume(log, path, error)
                                 : cs_row_log_create(log, path, error);
}

/* A checkpoint on disk has the rows of both files before it there as well. */
static enum cs_status settle_rows(struct cs_job *job, struct cs_error *error) {
    if (!cs_job_makes_checkpoints(job->settings) || cs_row_log_sync(&job->watch_log, error))
        return error->status;
    return cs_row_log_sync(&job->ledger_log, error);
}

static enum cs_status end_rows(struct cs_job *job, struct cs_error *error) {
    cs_row_log_finish(&job->watch_log, error);
    return cs_row_log_finish(&job->ledger_log, error);
}

static enum cs_status watch_frame(struct cs_job *job, struct cs_error *error) {
    struct cs_text row = {0};
    if (!job->settings->monitor_file)
        return CS_OK;
    cs_energy_monitor_print_row(&job->sound, job->session.run.frame, &row);
    return cs_row_log_add(&job->watch_log, &row, error);
}

/* Column names and the start state. */
static enum cs_status watch_begin(struct cs_job *job, struct cs_error *error) {
    struct cs_text head = {0};
    const char *path = job->settings->monitor_file;
    if (!path || open_rows(job, &job->watch_log, path, error) || job->settings->resume)
        return error->status;
    cs_energy_monitor_print_head(&head);
    return cs_row_log_add(&job->watch_log, &head, error) ? error->status
                                                         : watch_frame(job, error);
}

static void watch_record(struct cs_job *job, struct cs_serialiser *serialiser) {
    cs_row_log_record(&job->watch_log, serialiser);
}

const struct cs_run_output cs_run_output_watch = {
    .option = "--monitor",
    .path = offsetof(struct cs_job_settings, monitor_file),
    .at = {[CS_RUN_BEGIN] = watch_begin, [CS_RUN_FRAME] = watch_frame},
    .record = watch_record};

static enum cs_status ledger_frame(struct cs_job *job, struct cs_error *error) {
    struct cs_text row = {0};
    if (!job->settings->ledger)
        return CS_OK;
    cs_energy_ledger_print_row(&job->ledger, job->session.run.frame, &row);
    return cs_row_log_add(&job->ledger_log, &row, error);
}

/* A resumed ledger continues from the loaded state. */
static enum cs_status ledger_begin(struct cs_job *job, struct cs_error *error) {
    struct cs_text head = {0};
    const char *path = job->settings->ledger;
    if (!path || open_rows(job, &job->ledger_log, path, error))
        return error->status;
    if (job->settings->resume) {
        cs_energy_ledger_resume(&job->ledger, job->session.run.t);
        return CS_OK;
    }
    cs_energy_ledger_print_head(&head);
    return cs_row_log_add(&job->ledger_log, &head, error) ? error->status
                                                          : ledger_frame(job, error);
}

static void ledger_record(struct cs_job *job, struct cs_serialiser *serialiser) {
    cs_row_log_record(&job->ledger_log, serialiser);
    CS_SERIALISER(serialiser, job->ledger.work);
    CS_SERIALISER(serialiser, job->ledger.couple);
}

/* Settles and ends the rows of --monitor too. */
const struct cs_run_output cs_run_output_ledger = {.option = "--ledger",
                                                   .path =
                                                       offsetof(struct cs_job_settings, ledger),
                                                   .at = {[CS_RUN_BEGIN] = ledger_begin,
                                                          [CS_RUN_FRAME] = ledger_frame,
                                                          [CS_RUN_SETTLE] = settle_rows,
                                                          [CS_RUN_END] = end_rows},
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

const struct cs_run_output cs_run_output_hash = {
    .at = {[CS_RUN_START] = hash_frame, [CS_RUN_FRAME] = hash_frame}};
