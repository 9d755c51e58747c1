/* Derives range and stiffness of contact with colliders from the scene's keys and the springs.
 */
#include "model/contact/collider_params.h"

#include <math.h>

/* N/m, softest stretch spring; HUGE_VAL without one */
static double softest(const struct cs_springs *springs) {
    double k = HUGE_VAL;
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0;
             springs->runs[r].kind == CS_SPRING_STRETCH && i < springs->runs[r].count; i++)
            k = fmin(k, cs_spring_stiffness(springs->runs + r, i));
    return k;
}

enum cs_status cs_collider_params_stiffness(const struct cs_system *system, double *k,
                                            struct cs_error *error) {
    const double given = system->scene->contact.stiffness;
    *k = isnan(given) ? softest(&system->springs) : given;
    if (!isfinite(*k))
        return cs_fail(error, CS_ERR_SCENE,
                       "contact.stiffness: no stretch spring to derive it from, expected a "
                       "number in N/m");
    return CS_OK;
}

enum cs_status cs_collider_params_table_build(struct cs_system *system,
                                              struct cs_error *error) {
    const struct cs_scene *scene = system->scene;
    const double shortest = cs_springs_shortest(&system->springs);
    double k;
    if (cs_collider_params_stiffness(system, &k, error))
        return error->status;
    struct cs_collider_params *pairings =
        cs_arena_alloc_array(&system->arena, scene->colliders.n, sizeof *pairings, error);
    for (uint32_t c = 0; pairings && c < scene->colliders.n; c++) {
        const double thickness = cs_scene_colliders(scene)[c].thickness;
        pairings[c].k = k;
        pairings[c].range = thickness > 0 ? thickness : CS_RANGE_SHARE * shortest;
        if (!(pairings[c].range > 0))
            return cs_fail(error, CS_ERR_SCENE,
                           "colliders[%u].thickness: 0, but there is no spring to derive the "
                           "contact range from; expected a length in m",
                           c);
    }
    system->collider_params = pairings;
    return error->status;
}
