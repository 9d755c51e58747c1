/* Derives range, stiffness and friction of pairs of bodies from the scene's keys and the edges.
 */
#include "model/contact/body_pair_params.h"

#include "base/vec3.h"
#include "model/contact/approach.h"
#include "model/contact/collider_params.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/collider_keys.h"

#include <math.h>

/* m, shortest edge of a body at the start; HUGE_VAL without edges */
static double shortest_edge(const struct cs_system *system, uint32_t body) {
    const struct cs_surfaces *surfaces = system->surfaces;
    double least = HUGE_VAL;
    for (uint32_t e = surfaces->first_edge[body]; e < surfaces->first_edge[body + 1]; e++) {
        const uint32_t a = surfaces->edges[2 * (size_t)e],
                       b = surfaces->edges[2 * (size_t)e + 1];
        least = fmin(least, cs_vec3_distance_at(system->start, system->view.n, a, b));
    }
    return least;
}

/* m, thickness of a body: given, or a fraction of its shortest edge */
static double thickness_of(const struct cs_system *system, uint32_t body,
                           struct cs_error *error) {
    const double given = cs_scene_bodies(system->scene)[body].thickness;
    const double thickness =
        given > 0 ? given : CS_THICKNESS_FRACTION * shortest_edge(system, body);
    if (!(thickness > 0 && isfinite(thickness)))
        cs_fail(error, CS_ERR_SCENE,
                "bodies[%u].thickness: 0, but the body has no edge to derive it from; expected "
                "a length in m",
                body);
    return thickness;
}

/* m, range of body a and of body or collider b: the mean of both thicknesses, because each
 * surface has half of its own. A collider's thickness counts in full, as for other colliders.
 */
static double range_between(const struct cs_system *system, uint32_t a, uint32_t b,
                            struct cs_error *error) {
    const struct cs_collider *collider = cs_scene_collider_at(system->scene, b);
    if (collider && collider->thickness > 0)
        return collider->thickness;
    const double first = thickness_of(system, a, error);
    return collider || a == b ? first : 0.5 * (first + thickness_of(system, b, error));
}

/* 1/kg, of the mean free particle of a body; 0 if all are pinned, and of a collider. */
static double inverse_mass_of(const struct cs_system *system, uint32_t body) {
    double mass = 0, count = 0;
    if (body >= system->scene->bodies.n)
        return 0;
    const struct cs_body_range *range = system->bodies + body;
    for (uint32_t i = range->first; i < range->first + range->count; i++)
        if (system->inv_mass[i] > 0)
            mass += system->mass[i], count++;
    return count > 0 ? count / mass : 0;
}

/* Stores the parameters of a pair in both orders. */
static void meet(struct cs_body_pair_table *body_pairs, uint32_t a, uint32_t b,
                 const struct cs_body_pair_params *params) {
    body_pairs->params[(size_t)a * body_pairs->n_bodies + b] = *params;
    body_pairs->params[(size_t)b * body_pairs->n_bodies + a] = *params;
    body_pairs->has_partner[a] = body_pairs->has_partner[b] = true;
    body_pairs->range_max = fmax(body_pairs->range_max, params->range);
    body_pairs->range_min = fmin(body_pairs->range_min, params->range);
}

/* Range, friction and, unless the scene gives it, stiffness differ from pair to pair. */
enum cs_status cs_body_pair_table_build(struct cs_system *system,
                                        struct cs_body_pair_table *body_pairs,
                                        struct cs_error *error) {
    const uint32_t n = system->surfaces->n_bodies;
    struct cs_body_pair_params params;
    *body_pairs = (struct cs_body_pair_table){.n_bodies = n, .range_min = HUGE_VAL};
    CS_ARENA_ARRAY(&system->arena, body_pairs->params, (size_t)n * n, error);
    CS_ARENA_ARRAY(&system->arena, body_pairs->has_partner, n, error);
    if (error->status || cs_collider_params_softest(system, &body_pairs->softest, error))
        return error->status;
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = a; b < n && !error->status; b++) {
            if (!cs_scene_bodies_collide(system->scene, a, b, &params.friction))
                continue;
            // the stiffness depends on the range, and on what comes to these two
            params.range = range_between(system, a, b, error);
            params.k = cs_approach_stiffness(system, body_pairs->softest,
                                             cs_approach_energy(system, a, b), params.range);
            params.inverse_mass = (inverse_mass_of(system, a) + inverse_mass_of(system, b)) *
                                  (b < system->scene->bodies.n ? 2 : 1);
            meet(body_pairs, a, b, &params);
        }
    return error->status;
}

void cs_body_pair_table_set_range(const struct cs_system *system,
                                  struct cs_body_pair_table *body_pairs, uint32_t a, uint32_t b,
                                  double range) {
    struct cs_body_pair_params params = *cs_body_pair_params_of(body_pairs, a, b);
    params.range = range;
    params.k = cs_approach_stiffness(system, body_pairs->softest,
                                     cs_approach_energy(system, a, b), range);
    meet(body_pairs, a, b, &params);
    body_pairs->params_version++;
}

void cs_body_pair_table_update_friction(const struct cs_system *system,
                                        struct cs_body_pair_table *body_pairs) {
    const uint32_t n_bodies = system->scene->bodies.n;
    for (uint32_t b = n_bodies; b < body_pairs->n_bodies; b++)
        for (uint32_t a = 0; a < n_bodies; a++) {
            const double mu = cs_scene_collider_at(system->scene, b)->friction;
            body_pairs->params_version +=
                body_pairs->params[(size_t)a * body_pairs->n_bodies + b].friction != mu;
            body_pairs->params[(size_t)a * body_pairs->n_bodies + b].friction = mu;
            body_pairs->params[(size_t)b * body_pairs->n_bodies + a].friction = mu;
        }
}
