/* static_friction.c - static friction: pins particles inside the friction cone and releases
 * them outside it; see static_friction.h. */
#include "model/post_step/static_friction.h"

#include "base/vec3.h"
#include "model/contact/posed_collider.h"
#include "model/force/terms.h"
#include "scene/collider_keys.h"

#include <math.h>
#include <string.h>

/* m, distance up to which a particle counts as on a surface: scenes give positions in decimals
 */
#define TOUCHING 1e-9

enum cs_status cs_static_friction_init(struct cs_static_friction *friction,
                                       struct cs_system *system, struct cs_arena *arena,
                                       struct cs_error *error) {
    const size_t n = system->view.n;
    *friction = (struct cs_static_friction){.system = system};
    friction->resting_on = cs_arena_alloc_array(arena, n, sizeof *friction->resting_on, error);
    CS_ARENA_ARRAY(arena, friction->is_sticking, n, error);
    friction->load = cs_arena_alloc_array(arena, 3 * n, sizeof *friction->load, error);
    return error->status ? error->status
                         : cs_temporary_pins_init(&friction->pins, system, arena, error);
}

void cs_static_friction_pin(struct cs_static_friction *friction, bool held) {
    if (!held)
        cs_temporary_pins_clear(&friction->pins, friction->is_sticking);
    else if (friction->n_sticking > 0)
        cs_temporary_pins_set(&friction->pins, friction->is_sticking);
}

/* The mass, not the inverse mass, is used: the latter is 0 while a particle is pinned. */
bool cs_static_friction_restore(struct cs_static_friction *friction, double dt,
                                const double *last, double *x, double *v) {
    const size_t n = friction->system->view.n;
    bool moved = false;
    for (size_t c = 0, k = 0; c < 3 && friction->n_sticking > 0; c++)
        for (size_t i = 0; i < n; i++, k++) {
            if (!friction->is_sticking[i])
                continue;
            moved |= x[k] != last[k] || v[k] != 0;
            friction->load[k] = friction->system->mass[i] * (x[k] - last[k]) / (dt * dt);
            x[k] = last[k];
            v[k] = 0;
        }
    return moved;
}

/* Sticking particles keep resting_on: their collider did not change. */
void cs_static_friction_reject(struct cs_static_friction *friction) {
    for (uint32_t i = 0; i < friction->system->view.n; i++)
        if (!friction->is_sticking[i])
            friction->resting_on[i] = 0;
}

/* Returns whether particle at p sticks under a load in N: N = -load.n > 0 and |T|^2 <= (mu
 * N)^2, with T = load + N n. */
static bool can_stick(const struct cs_posed_collider *collider, const double p[3],
                      const double load[3]) {
    const double mu = collider->collider->friction;
    double n[3], across = 0;
    cs_posed_collider_signed_distance(collider, p, n);
    const double inward = -(load[0] * n[0] + load[1] * n[1] + load[2] * n[2]);
    for (int c = 0; c < 3; c++) {
        const double t = load[c] + inward * n[c];
        across += t * t;
    }
    return inward > 0 && across <= mu * mu * inward * inward;
}

/* Returns whether a particle rests or sticks. */
static bool any(const struct cs_static_friction *friction) {
    for (uint32_t i = 0; i < friction->system->view.n && friction->n_sticking == 0; i++)
        if (friction->resting_on[i])
            return true;
    return friction->n_sticking > 0;
}

/* f is the sum of all force terms; colliders have none under this law. A sticking particle has
 * its recorded load in addition. */
bool cs_static_friction_update(struct cs_static_friction *friction,
                               const struct cs_posed_collider *colliders, double t,
                               const double *x, const double *v, double *f) {
    const struct cs_system *system = friction->system;
    const size_t n = system->view.n;
    bool changed = false;
    if (friction->disabled || !any(friction))
        return false;
    if (cs_terms_need_normals(system, CS_PART_ALL))
        cs_normals_update(system, x);
    cs_terms_force(system, &(struct cs_eval){.t = t, .x = x, .v = v, .parts = CS_PART_ALL}, f);
    friction->n_sticking = 0;
    for (size_t i = 0; i < n; i++) {
        const bool before = friction->is_sticking[i];
        const double p[3] = {x[i], x[n + i], x[2 * n + i]};
        double load[3];
        for (size_t c = 0; c < 3; c++)
            load[c] = f[c * n + i] + (before ? friction->load[c * n + i] : 0);
        friction->is_sticking[i] = friction->resting_on[i] &&
                                   can_stick(colliders + friction->resting_on[i] - 1, p, load);
        changed |= friction->is_sticking[i] != before;
        friction->n_sticking += friction->is_sticking[i];
        if (!friction->is_sticking[i])
            friction->resting_on[i] = 0;
    }
    return changed;
}

void cs_static_friction_clear(struct cs_static_friction *friction) {
    const size_t n = friction->system->view.n;
    friction->n_sticking = 0;
    memset(friction->resting_on, 0, n * sizeof *friction->resting_on);
    memset(friction->is_sticking, 0, n * sizeof *friction->is_sticking);
}

/* Number plus 1 of the collider that a particle at p with velocity v rests on; 0: none. Both
 * must be at rest, and the collider must absorb all of the normal velocity. */
static uint32_t find_resting_on(const struct cs_static_friction *friction,
                                const struct cs_posed_collider *colliders, const double p[3],
                                const double v[3]) {
    double n[3], provenance[3];
    if (!cs_vec3_is_zero(v))
        return 0;
    for (uint32_t k = 0; k < friction->system->scene->colliders.n; k++) {
        cs_posed_collider_velocity(colliders + k, p, provenance);
        if (fabs(cs_posed_collider_signed_distance(colliders + k, p, n)) <= TOUCHING &&
            cs_vec3_is_zero(provenance) && colliders[k].collider->absorption == 1)
            return k + 1;
    }
    return 0;
}

/* Sets resting_on of all particles at rest on a collider, then decides by the cone. */
void cs_static_friction_start(struct cs_static_friction *friction,
                              const struct cs_posed_collider *colliders, double t,
                              const double *x, const double *v, double *f) {
    const size_t n = friction->system->view.n;
    cs_static_friction_clear(friction);
    for (size_t i = 0; i < n; i++) {
        const double p[3] = {x[i], x[n + i], x[2 * n + i]};
        const double w[3] = {v[i], v[n + i], v[2 * n + i]};
        if (friction->system->inv_mass[i] > 0)
            friction->resting_on[i] = find_resting_on(friction, colliders, p, w);
    }
    cs_static_friction_update(friction, colliders, t, x, v, f);
}

void cs_static_friction_serialise(struct cs_static_friction *friction,
                                  struct cs_serialiser *serialiser) {
    const size_t n = friction->system->view.n;
    cs_serialiser_bytes(serialiser, friction->resting_on, n * sizeof *friction->resting_on);
    cs_serialiser_bytes(serialiser, friction->is_sticking, n * sizeof *friction->is_sticking);
    CS_SERIALISER(serialiser, friction->n_sticking);
}

/* Exchanges the system's list of pins; see static_friction.h. */

enum cs_status cs_temporary_pins_init(struct cs_temporary_pins *pins, struct cs_system *system,
                                      struct cs_arena *arena, struct cs_error *error) {
    *pins = (struct cs_temporary_pins){.system = system};
    pins->list = cs_arena_alloc_array(arena, system->view.n, sizeof *pins->list, error);
    return error->status;
}

/* Pinned particles of the system have inverse mass 0 already, and enter the list with the
 * marked ones, in ascending order. */
void cs_temporary_pins_set(struct cs_temporary_pins *pins, const bool *marks) {
    struct cs_system *system = pins->system;
    pins->scene_list = system->pinned;
    pins->n_scene_list = system->n_pinned;
    system->pinned = pins->list;
    system->n_pinned = 0;
    for (uint32_t i = 0; i < system->view.n; i++) {
        if (marks[i])
            system->inv_mass[i] = 0;
        if (system->inv_mass[i] == 0)
            system->pinned[system->n_pinned++] = i;
    }
}

/* Marked particles get 1/mass back, the inverse mass that they had before. */
void cs_temporary_pins_clear(struct cs_temporary_pins *pins, const bool *marks) {
    struct cs_system *system = pins->system;
    if (!pins->scene_list)
        return;
    system->pinned = pins->scene_list;
    system->n_pinned = pins->n_scene_list;
    pins->scene_list = NULL;
    for (uint32_t i = 0; i < system->view.n; i++)
        if (marks[i])
            system->inv_mass[i] = 1 / system->mass[i];
}
