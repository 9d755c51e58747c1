/* trace.h - trace points of a run: the arguments and results of the method's calls, and the
 * state after each correction.
 *
 * `clothsim bisect` compares two such streams to find the first number that differs. Tracing
 * changes no bit of the run, and costs one test per call when it is off. */
#ifndef CS_TRACE_H
#define CS_TRACE_H

#include "base/trace_stream.h"
#include "sim/run_host.h"

/* Sends n numbers at time t to the trace of the run, which must be on. named gives phase and
 * name; frame and step are those that are running. values is borrowed during the call. */
void cs_trace_emit(const struct cs_run_host *host, const struct cs_trace_record *named,
                   double t, const double *values, size_t n);

/* True if the run has a trace and it is enabled. */
static inline bool cs_trace_is_on(const struct cs_run_host *host) {
    return host->settings.trace && host->settings.trace->enabled;
}

/* Traces an array (3,n); values NULL: none. */
static inline void cs_trace_vector(const struct cs_run_host *host, const char *phase,
                                   const char *name, double t, const double *values) {
    if (cs_trace_is_on(host) && values)
        cs_trace_emit(host, &(struct cs_trace_record){.phase = phase, .name = name}, t, values,
                      3 * (size_t)host->run->system->view.n);
}

/* Traces one number. */
static inline void cs_trace_number(const struct cs_run_host *host, const char *phase,
                                   const char *name, double t, double value) {
    if (cs_trace_is_on(host))
        cs_trace_emit(host, &(struct cs_trace_record){.phase = phase, .name = name}, t, &value,
                      1);
}

/* Traces positions and velocities, both (3,n). */
static inline void cs_trace_state(const struct cs_run_host *host, const char *phase, double t,
                                  const double *x, const double *v) {
    cs_trace_vector(host, phase, "x", t, x);
    cs_trace_vector(host, phase, "v", t, v);
}

#endif
