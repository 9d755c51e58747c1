/* trace.h - what a run computes on its way: what a method asked for, what it was given, what
 * each correction after its steps left. Not a bit of the run changes, and without a trace
 * nothing is called. */
#ifndef CS_TRACE_H
#define CS_TRACE_H

#include "base/trace_stream.h"
#include "sim/run_host.h"

/* Tells n numbers that belong to a phase. */
void cs_trace_emit(const struct cs_run_host *host, const struct cs_trace_record *named,
                   double t, const double *values, size_t n);

static inline bool cs_trace_is_on(const struct cs_run_host *host) {
    return host->settings.trace && host->settings.trace->enabled;
}

/* A vector for each particle; NULL: none. */
static inline void cs_trace_vector(const struct cs_run_host *host, const char *phase,
                                   const char *name, double t, const double *values) {
    if (cs_trace_is_on(host) && values)
        cs_trace_emit(host, &(struct cs_trace_record){.phase = phase, .name = name}, t, values,
                      3 * (size_t)host->run->system->view.n);
}

static inline void cs_trace_number(const struct cs_run_host *host, const char *phase,
                                   const char *name, double t, double value) {
    if (cs_trace_is_on(host))
        cs_trace_emit(host, &(struct cs_trace_record){.phase = phase, .name = name}, t, &value,
                      1);
}

static inline void cs_trace_state(const struct cs_run_host *host, const char *phase, double t,
                                  const double *x, const double *v) {
    cs_trace_vector(host, phase, "x", t, x);
    cs_trace_vector(host, phase, "v", t, v);
}

#endif
