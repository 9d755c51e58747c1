/* Derives range and stiffness of contact with colliders from the scene's keys and the springs.
 */
#include "model/contact/collider_params.h"

#include "base/vec3.h"
#include "model/contact/approach.h"
#include "model/contact/lagged_friction.h"
#include "model/force/diagnostics.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/elastic_keys.h"

#include <math.h>

/* N/m, softest stretch spring, or membrane along its threads; HUGE_VAL without one */
static double softest(const struct cs_system *system) {
    const struct cs_springs *springs = &system->springs;
    double k = HUGE_VAL;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_elastic *elastic = cs_scene_elastic(system->scene, b);
        const struct cs_moduli moduli = cs_membrane_moduli(elastic);
        k = elastic->present ? fmin(k, fmin(moduli.warp, moduli.weft)) : k;
    }
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0;
             springs->runs[r].kind == CS_SPRING_STRETCH && i < springs->runs[r].count; i++)
            k = fmin(k, cs_spring_stiffness(springs->runs + r, i));
    return k;
}

enum cs_status cs_collider_params_softest(struct cs_system *system, double *k,
                                          struct cs_error *error) {
    *k = softest(system);
    if (isnan(system->scene->contact->stiffness) && !isfinite(*k))
        return cs_fail(
            error, CS_ERR_SCENE,
            "contact.stiffness: no stretch spring or membrane to derive it from, expected a "
            "number in N/m");
    return cs_approach_build(system, error);
}

/* J, the most with which a particle of any body comes to a collider. */
static double energy_of(const struct cs_system *system, uint32_t collider) {
    double energy = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++)
        energy =
            fmax(energy, cs_approach_energy(system, b, system->scene->bodies.n + collider));
    return energy;
}

/* m, the range that nobody gave: RANGE_FRACTION of the shortest spring, or the distance at
 * which a free particle starts, down to CS_RANGE_SHRINK_MIN of it: a body may start closer than
 * its coarse grid would have it. */
static double default_range(const struct cs_system *system, uint32_t collider,
                            double shortest) {
    const size_t n = system->view.n;
    const double *x = system->state;
    const double whole = CS_RANGE_FRACTION * shortest, least = CS_RANGE_SHRINK_MIN * whole;
    struct cs_posed_collider posed;
    double range = whole, normal[3];
    // who asks for bodies to be moved out of the range means all of it
    if (system->scene->contact->start == CS_CONTACT_START_MOVE_OUT)
        return whole;
    cs_posed_collider_at(system, collider, 0, &posed);
    for (size_t i = 0; i < n; i++) {
        const double p[3] = {x[i], x[n + i], x[2 * n + i]};
        if (system->inv_mass[i] <= 0 || !cs_posed_collider_is_near(&posed, range, p))
            continue;
        // one that starts inside or touches is refused, or moved out, by the whole range
        const double distance = cs_posed_collider_distance(&posed, p, normal);
        if (distance < -CS_PENETRATION_MIN && !isnan(system->scene->contact->untangle))
            return whole;
        range = distance > least ? fmin(range, distance) : range;
    }
    return range;
}

/* s, the damping that nobody gave: half of critical damping, c = tau k = sqrt(m k), of the
 * heaviest free particle on the stiffest collider. Tuned on a box of 56 particles that falls by
 * 5 cm: it rests after 5 s from 0.4 of critical damping on. */
static double default_damping(const struct cs_system *system, double stiffest) {
    double heaviest = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        heaviest = fmax(heaviest, system->inv_mass[i] > 0 ? system->mass[i] : 0);
    return sqrt(heaviest / stiffest);
}

/* The coefficient of restitution e that a loss leaves. With q = |w|/s along the impact, 1 to 0
 * and back, E = M s^2/2 changes by dE = -+ alpha q d(psi) with psi = E (1 - q^2), so that
 *
 *   ln e^2 = - integral over q in (0, 1) of 4 alpha q^2 / (1 - (alpha q (1 - q^2))^2)
 *
 * which depends neither on psi nor on the speed. exp of each part by its Pade form, so that all
 * machines agree. */
static double restitution_of(double loss) {
    enum { PARTS = 1000 };
    double squared = 1;
    for (int i = 0; i < PARTS; i++) {
        const double q = (i + 0.5) / PARTS, b = loss * q * (1 - q * q);
        const double part = 4 * loss * q * q / (1 - b * b) / PARTS;
        squared *= fmax(1 - 0.5 * part, 0) / (1 + 0.5 * part);
    }
    return sqrt(squared);
}

/* alpha of a coefficient, by halving: 0 to 3 sqrt(3)/2, where b comes to 1 and nothing comes
 * back. */
static double loss_of(double restitution) {
    double low = 0, high = restitution < 1 ? 1.5 * sqrt(3.0) : 0;
    for (int halving = 0; halving < 50; halving++) {
        const double loss = 0.5 * (low + high);
        *(restitution_of(loss) > restitution ? &low : &high) = loss;
    }
    return high;
}

void cs_contact_keys_complete(struct cs_contact_keys *keys, const struct cs_system *system) {
    double sum = 0, count = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        if (system->inv_mass[i] > 0)
            sum += system->mass[i], count++;
    keys->mass = count > 0 ? sum / count : 1;
    keys->loss = isnan(keys->restitution) ? 0 : loss_of(keys->restitution);
    if (keys->damping_is_default)
        keys->damping = system->default_damping;
}

enum cs_status cs_collider_params_table_build(struct cs_system *system,
                                              struct cs_error *error) {
    const struct cs_scene *scene = system->scene;
    const double shortest = cs_diagnostics_shortest(system);
    double k, stiffest = 0;
    if (cs_collider_params_softest(system, &k, error))
        return error->status;
    struct cs_collider_params *pairings =
        cs_arena_alloc_array(&system->arena, scene->colliders.n, sizeof *pairings, error);
    for (uint32_t c = 0; pairings && c < scene->colliders.n; c++) {
        const double thickness = cs_scene_colliders(scene)[c].thickness;
        pairings[c].range = thickness > 0 ? thickness : default_range(system, c, shortest);
        // the stiffness divides by it
        if (!(pairings[c].range > 0))
            return cs_fail(
                error, CS_ERR_SCENE,
                "colliders[%u].thickness: 0, but there is no spring or membrane to derive the "
                "contact range from; expected a length in m",
                c);
        pairings[c].k =
            cs_approach_stiffness(system, k, energy_of(system, c), pairings[c].range);
        stiffest = fmax(stiffest, pairings[c].k);
    }
    if (scene->contact->damping_is_default)
        system->default_damping = default_damping(system, stiffest);
    system->collider_params = pairings;
    return error->status;
}

/* Range test, distance and relative velocity of a point against a collider. */

void cs_posed_collider_law_at(const struct cs_system *system, uint32_t collider, double t,
                              struct cs_posed_collider_law *law) {
    const struct cs_scene *scene = system->scene;
    const double friction = cs_scene_colliders(scene)[collider].friction;
    const bool sticks = scene->contact->friction_law == CS_FRICTION_BRISTLES;
    *law = (struct cs_posed_collider_law){
        .params = system->collider_params[collider],
        .friction = sticks || cs_lagged_friction_acts(system) ? 0 : friction,
        .sticking_friction = sticks ? friction : 0,
        .friction_speed = scene->contact->friction_speed,
        .damping = scene->contact->damping,
        .loss = scene->contact->loss};
    law->rate = law->loss > 0 ? law->params.k / scene->contact->mass : 0;
    cs_posed_collider_at(system, collider, t, &law->collider);
    // a ramp may change it
    if (law->collider.collider->thickness > 0)
        law->params.range = law->collider.collider->thickness;
}

bool cs_posed_collider_law_is_plain(const struct cs_posed_collider_law *law) {
    const struct cs_posed_collider *collider = &law->collider;
    const double *spin = collider->spin;
    const enum cs_shape_bounds bounds = collider->shape->bounds;
    return (bounds == CS_BOUNDS_HALF_SPACE || bounds == CS_BOUNDS_SPHERE) && spin[0] == 0 &&
           spin[1] == 0 && spin[2] == 0 && collider->growth == 0 && law->sticking_friction == 0;
}

/* A bounding test precedes the smooth distance, which costs far more. */
bool cs_posed_collider_law_in_range(const struct cs_posed_collider_law *law, const double p[3],
                                    const double v[3], struct cs_point_contact *contact) {
    double surface[3];
    if (!cs_posed_collider_is_near(&law->collider, law->params.range, p))
        return false;
    contact->d = cs_posed_collider_smooth_distance(&law->collider, p, contact->g, contact->h);
    if (!(contact->d < law->params.range))
        return false;
    cs_posed_collider_velocity(&law->collider, p, surface);
    for (int c = 0; c < 3; c++)
        contact->v[c] = v[c] - surface[c];
    cs_posed_collider_law_set(law, contact);
    return true;
}

struct cs_point_contact_motion
cs_posed_collider_law_motion(const struct cs_posed_collider_law *law, const double dp[3],
                             const double dv[3]) {
    struct cs_point_contact_motion motion;
    double turned[3];
    cs_vec3_cross(law->collider.spin, dp, turned);
    for (int c = 0; c < 3; c++) {
        motion.dp[c] = dp[c];
        motion.dv[c] = dv[c] - turned[c];
    }
    motion.extra_dd = 0;
    return motion;
}
