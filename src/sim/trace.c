/* trace.c - sends traced numbers with their frame and step. */
#include "sim/trace.h"

void cs_trace_emit(const struct cs_run_host *host, const struct cs_trace_record *named,
                   double t, const double *values, size_t n) {
    const struct cs_trace *trace = host->settings.trace;
    struct cs_trace_record point = *named;
    point.frame = host->run->frame + 1;
    point.step = host->run->counts.steps;
    point.t = t;
    point.values = values;
    point.n = n;
    trace->emit(trace->ctx, &point);
}
