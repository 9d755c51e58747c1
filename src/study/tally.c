/* Counts crossings frame by frame, and says what there was. */
#include "study/tally.h"

void cs_tally_take(struct cs_tally *tally, const struct cs_run *run) {
    if (!run->system->plan.rows[CS_FEATURE_CROSSINGS].built)
        return;
    const struct cs_crossing_count count = cs_crossings_count(run->system, run->t, run->x);
    if (!tally->counted)
        tally->start = count.n;
    tally->counted = true;
    tally->last = count.n;
    if (count.n > tally->most) {
        tally->most = count.n;
        tally->most_time = run->t;
    }
    if (count.n && !tally->first.n) {
        tally->first = count;
        tally->first_time = run->t;
    }
}

void cs_tally_print(const struct cs_tally *tally, const struct cs_system *system,
                    struct cs_text *out) {
    if (!tally->most) {
        cs_text_add(out, "no edge goes through a triangle in any frame");
        return;
    }
    cs_text_add(out, "%llu at the end, %llu at most, at t = %.6g s; from t = %.6g s on: ",
                (unsigned long long)tally->last, (unsigned long long)tally->most,
                tally->most_time, tally->first_time);
    cs_crossings_print(system, &tally->first, out);
}
