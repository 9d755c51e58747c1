/* Writes the states of a run, or all that one frame computes, to standard output. */
#include "cli/run/job_state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void take(void *ctx, const struct cs_trace_record *point) {
    cs_trace_stream_write(ctx, point);
}

enum cs_status cs_run_trace_read(const char *value, struct cs_run_trace *trail,
                                 struct cs_error *error) {
    const size_t length = strlen(value);
    const bool number = strspn(value, "0123456789") == length && length > 0 && length < 9;
    trail->frame = number ? (uint32_t)strtoul(value, NULL, 10) : 0;
    trail->is_requested = true;
    trail->trace = (struct cs_trace){.emit = take, .ctx = stdout};
    return trail->frame || !strcmp(value, "frames")
               ? CS_OK
               : cs_fail(error, CS_ERR_USAGE,
                         "--trace: found \"%.60s\", expected \"frames\" or the number of a "
                         "frame",
                         value);
}

static void write_state(const struct cs_run *run) {
    struct cs_trace_record point = {.frame = run->frame,
                                    .step = run->counts.steps,
                                    .t = run->t,
                                    .phase = run->frame ? "frame" : "start",
                                    .name = "x",
                                    .values = run->x,
                                    .n = 3 * (size_t)run->system->view.n};
    cs_trace_stream_write(stdout, &point);
    point.name = "v";
    point.values = run->v;
    cs_trace_stream_write(stdout, &point);
}

/* everything is told of one frame alone */
static void expect_frame(struct cs_run_trace *trail, const struct cs_run *run) {
    trail->trace.enabled = trail->frame == run->frame + 1;
}

static enum cs_status begin(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    if (!job->trace.is_requested)
        return CS_OK;
    cs_trace_stream_begin(stdout);
    write_state(run);
    expect_frame(&job->trace, run);
    return error->status;
}

static enum cs_status frame(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const struct cs_run_trace *trail = &job->trace;
    if (!trail->is_requested)
        return CS_OK;
    if (!trail->frame || trail->frame == run->frame)
        write_state(run);
    expect_frame(&job->trace, run);
    return fflush(stdout) || ferror(stdout)
               ? cs_fail(error, CS_ERR_FILE, "cannot write to standard output")
               : CS_OK;
}

/* when and where a run blew up */
static enum cs_status end(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const double where[] = {run->blow_up.particle, run->blow_up.energy};
    const struct cs_trace_record point = {.frame = run->frame + 1,
                                          .step = run->counts.steps,
                                          .t = run->blow_up.time,
                                          .phase = cs_outcome_text(run->outcome),
                                          .name = "end",
                                          .values = where,
                                          .n = 2};
    if (job->trace.is_requested && cs_outcome_is_blow_up(run->outcome))
        cs_trace_stream_write(stdout, &point);
    return error->status;
}

const struct cs_run_output cs_run_output_trace = {
    .at = {[CS_RUN_BEGIN] = begin, [CS_RUN_FRAME] = frame, [CS_RUN_END] = end}};
