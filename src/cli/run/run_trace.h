/* run_trace.h - the states of a run, or all that one frame computes, to standard output. */
#ifndef CS_RUN_TRACE_H
#define CS_RUN_TRACE_H

#include "sim/run.h"

/* Zeroed: none. Must stay where it is while the run lasts. */
struct cs_run_trace {
    bool is_requested;
    uint32_t frame; /* the frame of which everything is told; 0: the state of each frame */
    struct cs_trace trace; /* of the run's settings */
};

/* Reads "frames", or the number of a frame. CS_ERR_USAGE. */
enum cs_status cs_run_trace_read(const char *value, struct cs_run_trace *trail,
                                 struct cs_error *error);

/* Before the first frame: the state at the start. */
void cs_run_trace_begin(struct cs_run_trace *trail, const struct cs_run *run);
/* Before each frame, and after it. CS_ERR_FILE. */
void cs_run_trace_step(struct cs_run_trace *trail, const struct cs_run *run);
enum cs_status cs_run_trace_frame(struct cs_run_trace *trail, const struct cs_run *run,
                                  struct cs_error *error);
/* Behind the last: when and where a run blew up. */
void cs_run_trace_end(struct cs_run_trace *trail, const struct cs_run *run);

#endif
