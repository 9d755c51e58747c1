/* Compares the capacity of the barrier with the energy of approach, interface by interface. */
#include "study/contact_capacity.h"

#include "model/contact/approach.h"
#include "model/contact/barrier_law.h"
#include "model/contact/collider_params.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "scene/body_pairs.h"

#include <math.h>

/* Sets range and k of two surfaces; returns false if they have no contact. */
static bool params_of(const struct cs_system *system, uint32_t a, uint32_t b,
                      struct cs_contact_capacity *out) {
    const uint32_t n_bodies = system->scene->bodies.n;
    double friction;
    *out = (struct cs_contact_capacity){.a = a, .b = b};
    if (b >= n_bodies && !cs_scene_colliders(system->scene)[b - n_bodies].mesh.present) {
        if (!system->collider_params)
            return false;
        out->range = system->collider_params[b - n_bodies].range;
        out->k = system->collider_params[b - n_bodies].k;
        return true;
    }
    if (!system->pairs || !cs_scene_bodies_collide(system->scene, a, b, &friction))
        return false;
    const struct cs_body_pair_params *params =
        cs_body_pair_params_of(&system->pairs->body_pairs, a, b);
    out->range = params->range;
    out->k = params->k;
    return true;
}

bool cs_contact_capacity_find(const struct cs_system *system, struct cs_contact_capacity *out) {
    const struct cs_scene *scene = system->scene;
    double least = HUGE_VAL;
    if (!system->approach)
        return false;
    for (uint32_t a = 0; a < scene->bodies.n; a++)
        for (uint32_t b = a; b < scene->bodies.n + scene->colliders.n; b++) {
            struct cs_contact_capacity at;
            if (!params_of(system, a, b, &at))
                continue;
            at.holds = cs_barrier_capacity(at.range, at.k);
            at.comes = cs_approach_energy(system, a, b);
            at.k_needed = CS_APPROACH_MARGIN * at.comes / cs_barrier_capacity(at.range, 1);
            // what nothing comes to is compared by its energy alone, after all others
            const double order = at.comes > 0 ? at.holds / at.comes : 1e100 * at.holds;
            if (order < least) {
                least = order;
                *out = at;
            }
        }
    return least < HUGE_VAL;
}

/* "bodies[0] with colliders[1]", or "bodies[0] with itself" */
static void print_surfaces(const struct cs_system *system, const struct cs_contact_capacity *at,
                           struct cs_text *out) {
    const uint32_t n_bodies = system->scene->bodies.n;
    cs_text_add(out, "bodies[%u] with ", at->a);
    if (at->b == at->a)
        cs_text_add(out, "itself");
    else
        cs_text_add(out, at->b < n_bodies ? "bodies[%u]" : "colliders[%u]",
                    at->b < n_bodies ? at->b : at->b - n_bodies);
}

void cs_contact_capacity_print(const struct cs_system *system,
                               const struct cs_contact_capacity *at, struct cs_text *out) {
    cs_text_add(out, "a contact of ");
    print_surfaces(system, at, out);
    cs_text_add(out, " takes up %.3g J (k %.3g N/m, range %.3g m); ", at->holds, at->k,
                at->range);
    if (at->comes > 0)
        cs_text_add(out, "a particle comes with %.3g J, for which k = %.3g N/m would do",
                    at->comes, at->k_needed);
    else
        cs_text_add(out, "nothing comes at the start");
}

void cs_contact_capacity_warn(const struct cs_system *system, struct cs_text *out) {
    struct cs_contact_capacity at;
    if (!cs_contact_capacity_find(system, &at) || isnan(system->scene->contact.stiffness) ||
        at.holds >= CS_APPROACH_MARGIN * at.comes)
        return;
    cs_text_add(out, "contact.stiffness: at %.3g N/m a contact of ", at.k);
    print_surfaces(system, &at, out);
    cs_text_add(out,
                " takes up %.3g J, but a particle comes with %.3g J: expected at least %.3g "
                "N/m, or no value for %.3g N/m",
                at.holds, at.comes, at.k_needed,
                CS_APPROACH_STIFFNESS * at.comes / (at.range * at.range));
}
