/* Writes the trail of a run. */
#include "cli/run/run_trace.h"

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

void cs_run_trace_begin(struct cs_run_trace *trail, const struct cs_run *run) {
    if (!trail->is_requested)
        return;
    cs_trace_stream_begin(stdout);
    write_state(run);
}

void cs_run_trace_step(struct cs_run_trace *trail, const struct cs_run *run) {
    trail->trace.enabled = trail->frame == run->frame + 1;
}

enum cs_status cs_run_trace_frame(struct cs_run_trace *trail, const struct cs_run *run,
                                  struct cs_error *error) {
    if (trail->is_requested && (!trail->frame || trail->frame == run->frame))
        write_state(run);
    if (trail->is_requested && (fflush(stdout) || ferror(stdout)))
        return cs_fail(error, CS_ERR_FILE, "cannot write to standard output");
    return CS_OK;
}

void cs_run_trace_end(struct cs_run_trace *trail, const struct cs_run *run) {
    const double where[] = {run->blow_up.particle, run->blow_up.energy};
    const struct cs_trace_record point = {.frame = run->frame + 1,
                                          .step = run->counts.steps,
                                          .t = run->blow_up.time,
                                          .phase = cs_outcome_text(run->outcome),
                                          .name = "end",
                                          .values = where,
                                          .n = 2};
    if (trail->is_requested && (run->outcome == CS_NOT_FINITE || run->outcome == CS_UNBOUNDED))
        cs_trace_stream_write(stdout, &point);
}
