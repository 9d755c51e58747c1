/* Asks contact by force and the crossings of surfaces about a step. */
#include "sim/passage.h"

#include "model/contact/share.h"
#include "model/cover/cover.h"
#include "model/cross/crossings.h"
#include "model/pair/seen.h"
#include "scene/crossings.h"

bool cs_passage_is_judged(const struct cs_system *system) {
    return system->pairings || system->pairs ||
           cs_scene_crossings(system->scene) == CS_CROSSINGS_LIMIT;
}

double cs_passage_share(const struct cs_system *system, double t0, const double *x0, double t1,
                        const double *x1) {
    if (system->pairings && t1 > t0 && !cs_contact_is_seen(system, t0, x0, t1, x1))
        return 0.5;
    if (system->covers && t1 > t0 && !cs_covers_are_seen(system->covers, t0, x0, t1, x1))
        return 0.5;
    if (system->pairs && t1 > t0 && !cs_pairs_are_seen(system->pairs, t0, x0, t1, x1))
        return 0.5;
    return cs_scene_crossings(system->scene) == CS_CROSSINGS_LIMIT
               ? cs_crossings_share(system, t0, x0, t1, x1)
               : 1;
}

bool cs_passage_has_failed(const struct cs_system *system) {
    const struct cs_pairs *pairs = system->pairs;
    const struct cs_covers *covers = system->covers;
    return (pairs && pairs->failed) ||
           (covers && (covers->now.failed || covers->matrix.failed));
}

bool cs_passage_stops(const struct cs_system *system, double t, const double *x,
                      struct cs_text *why) {
    if (cs_scene_crossings(system->scene) != CS_CROSSINGS_STOP)
        return false;
    const struct cs_crossing_count found = cs_crossings_count(system, t, x);
    if (!found.n)
        return false;
    cs_text_add(why, "after the step to t = %.9g s ", t);
    cs_crossings_print(system, &found, why);
    return true;
}
