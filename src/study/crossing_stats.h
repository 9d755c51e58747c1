/* crossing_stats.h - statistics of crossings over the frames of a run. */
#ifndef CS_CROSSING_STATS_H
#define CS_CROSSING_STATS_H

#include "model/contact/ccd/crossings.h"
#include "sim/run.h"

/* Zeroed: nothing was counted, as where the scene ignores crossings. */
struct cs_crossing_stats {
    bool is_counted;
    uint64_t start_count; /* where the run began */
    uint64_t max_count,
        last_count;              /* of all frames and of the last one, the start among them */
    double max_time, first_time; /* s: when they were most, and the first frame with any */
    struct cs_crossing_count first; /* there; n 0: there were none */
};

/* Counts the crossings of the present state, if the scene asks for it. Called at the start and
 * after each frame. */
void cs_crossing_stats_add(struct cs_crossing_stats *stats, const struct cs_run *run);

/* "3 at the end, 12 at most, at t = 0.5 s; from t = 0.2 s on: ..." */
void cs_crossing_stats_print(const struct cs_crossing_stats *stats,
                             const struct cs_system *system, struct cs_text *out);

#endif
