/* Combines the step tests of contact with colliders, samples and pairs with the limit of
 * crossings. */
#include "model/contact/ccd/step_limit.h"

#include "model/contact/ccd/crossings.h"
#include "model/contact/contact_samples.h"
#include "model/contact/lagged_friction.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/step_check.h"
#include "scene/body_pairs.h"

bool cs_step_limit_applies(const struct cs_system *system) {
    return system->collider_params || system->pairs ||
           cs_scene_crossings(system->scene) == CS_CROSSINGS_LIMIT;
}

/* Cheap tests come first: particles, samples, pairs, crossings. The first that fails decides.
 */
double cs_step_limit_fraction(const struct cs_system *system, double t0, const double *x0,
                              double t1, const double *x1) {
    if (system->collider_params && t1 > t0 &&
        !cs_collider_contact_resolves_step(system, t0, x0, t1, x1))
        return 0.5;
    if (system->pairs && t1 > t0 &&
        !cs_contact_pairs_resolve_step(system->pairs, t0, x0, t1, x1))
        return 0.5;
    return cs_scene_crossings(system->scene) == CS_CROSSINGS_LIMIT
               ? cs_crossings_safe_fraction(system, t0, x0, t1, x1)
               : 1;
}

bool cs_step_limit_failed(const struct cs_system *system) {
    const struct cs_pairs *pairs = system->pairs;
    const struct cs_contact_samples *samples = system->contact_samples;
    return (pairs && pairs->failed) ||
           (samples && (samples->current_set.failed || samples->matrix.failed)) ||
           (system->lagged_friction && system->lagged_friction->set.failed) ||
           cs_crossings_failed(system);
}

/* Counts crossings only under the policy that stops a run at the first one. */
bool cs_step_limit_ends_run(const struct cs_system *system, double t, const double *x,
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
