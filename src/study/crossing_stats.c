/* Counts crossings frame by frame, and prints their statistics. */
#include "study/crossing_stats.h"

/* Counts only if the plan has built the feature. `first` keeps the crossings of the first frame
 * with any, for the message. */
void cs_crossing_stats_add(struct cs_crossing_stats *stats, const struct cs_run *run) {
    if (!run->system->plan.rows[CS_FEATURE_CROSSINGS].built)
        return;
    const struct cs_crossing_count count = cs_crossings_count(run->system, run->t, run->x);
    if (!stats->is_counted)
        stats->start_count = count.n;
    stats->is_counted = true;
    stats->last_count = count.n;
    if (count.n > stats->max_count) {
        stats->max_count = count.n;
        stats->max_time = run->t;
    }
    if (count.n && !stats->first.n) {
        stats->first = count;
        stats->first_time = run->t;
    }
}

void cs_crossing_stats_print(const struct cs_crossing_stats *stats,
                             const struct cs_system *system, struct cs_text *out) {
    if (!stats->max_count) {
        cs_text_add(out, "no edge goes through a triangle in any frame");
        return;
    }
    cs_text_add(out, "%llu at the end, maximum %llu at t = %.6g s; from t = %.6g s on: ",
                (unsigned long long)stats->last_count, (unsigned long long)stats->max_count,
                stats->max_time, stats->first_time);
    cs_crossings_print(system, &stats->first, out);
}
