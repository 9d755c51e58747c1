/* Writes the states of a run, or all that one frame computes, to standard output. */
#include "cli/run/job_state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void take(void *ctx, const struct cs_trail_point *point) {
    cs_trail_write(ctx, point);
}

enum cs_status cs_run_trail_read(const char *value, struct cs_run_trail *trail,
                                 struct cs_error *error) {
    const size_t length = strlen(value);
    const bool number = strspn(value, "0123456789") == length && length > 0 && length < 9;
    trail->only = number ? (uint32_t)strtoul(value, NULL, 10) : 0;
    trail->asked = true;
    trail->trace = (struct cs_trace){.take = take, .ctx = stdout};
    return trail->only || !strcmp(value, "frames")
               ? CS_OK
               : cs_fail(error, CS_ERR_USAGE,
                         "--trace: found \"%.60s\", expected \"frames\" or the number of a "
                         "frame",
                         value);
}

static void write_state(const struct cs_run *run) {
    struct cs_trail_point point = {.frame = run->frame,
                                   .step = run->counts.steps,
                                   .t = run->t,
                                   .phase = run->frame ? "frame" : "start",
                                   .name = "x",
                                   .values = run->x,
                                   .n = 3 * (size_t)run->system->view.n};
    cs_trail_write(stdout, &point);
    point.name = "v";
    point.values = run->v;
    cs_trail_write(stdout, &point);
}

/* everything is told of one frame alone */
static void expect_frame(struct cs_run_trail *trail, const struct cs_run *run) {
    trail->trace.on = trail->only == run->frame + 1;
}

static enum cs_status begin(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    if (!job->trail.asked)
        return CS_OK;
    cs_trail_begin(stdout);
    write_state(run);
    expect_frame(&job->trail, run);
    return error->status;
}

static enum cs_status frame(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const struct cs_run_trail *trail = &job->trail;
    if (!trail->asked)
        return CS_OK;
    if (!trail->only || trail->only == run->frame)
        write_state(run);
    expect_frame(&job->trail, run);
    return fflush(stdout) || ferror(stdout)
               ? cs_fail(error, CS_ERR_FILE, "cannot write to standard output")
               : CS_OK;
}

/* when and where a run blew up */
static enum cs_status end(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const double where[] = {run->blow_up.particle, run->blow_up.energy};
    const struct cs_trail_point point = {.frame = run->frame + 1,
                                         .step = run->counts.steps,
                                         .t = run->blow_up.time,
                                         .phase = cs_outcome_text(run->outcome),
                                         .name = "end",
                                         .values = where,
                                         .n = 2};
    if (job->trail.asked && cs_outcome_is_blow_up(run->outcome))
        cs_trail_write(stdout, &point);
    return error->status;
}

const struct cs_run_output cs_run_output_trail = {
    .at = {[CS_RUN_BEGIN] = begin, [CS_RUN_FRAME] = frame, [CS_RUN_END] = end}};
