/* Compares the capacity of the barrier with the energy of approach, interface by interface;
 * finds ranges that are long for a body, and obstacles that are narrow for its particles. */
#include "session/scene_findings.h"

#include "base/vec3.h"
#include "model/contact/approach.h"
#include "model/contact/barrier_law.h"
#include "model/contact/collider_params.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "scene/body_keys.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"

#include <math.h>

/* Sets range and k of two surfaces; returns false if they have no contact. */
static bool params_of(const struct cs_system *system, uint32_t a, uint32_t b,
                      struct cs_contact_capacity *out) {
    const uint32_t n_bodies = system->scene->bodies.n;
    double friction;
    *out = (struct cs_contact_capacity){.a = a, .b = b};
    if (b >= n_bodies && !cs_scene_colliders(system->scene)[b - n_bodies].mesh) {
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
            struct cs_contact_capacity capacity;
            if (!params_of(system, a, b, &capacity))
                continue;
            capacity.holds = cs_barrier_capacity(capacity.range, capacity.k);
            capacity.comes = cs_approach_energy(system, a, b);
            capacity.k_needed =
                CS_APPROACH_MARGIN * capacity.comes / cs_barrier_capacity(capacity.range, 1);
            // what nothing comes to is compared by its energy alone, after all others
            const double order =
                capacity.comes > 0 ? capacity.holds / capacity.comes : 1e100 * capacity.holds;
            if (order < least) {
                least = order;
                *out = capacity;
            }
        }
    return least < HUGE_VAL;
}

/* "bodies[0] with colliders[1]", or "bodies[0] with itself" */
static void print_surfaces(const struct cs_system *system,
                           const struct cs_contact_capacity *capacity, struct cs_text *out) {
    const uint32_t n_bodies = system->scene->bodies.n;
    cs_text_add(out, "bodies[%u] with ", capacity->a);
    if (capacity->b == capacity->a)
        cs_text_add(out, "itself");
    else
        cs_text_add(out, capacity->b < n_bodies ? "bodies[%u]" : "colliders[%u]",
                    capacity->b < n_bodies ? capacity->b : capacity->b - n_bodies);
}

void cs_contact_capacity_print(const struct cs_system *system,
                               const struct cs_contact_capacity *capacity,
                               struct cs_text *out) {
    cs_text_add(out, "a contact of ");
    print_surfaces(system, capacity, out);
    cs_text_add(out, " takes up %.3g J (k %.3g N/m, range %.3g m); ", capacity->holds,
                capacity->k, capacity->range);
    if (capacity->comes > 0)
        cs_text_add(out, "a particle comes with %.3g J, for which k = %.3g N/m would do",
                    capacity->comes, capacity->k_needed);
    else
        cs_text_add(out, "nothing comes at the start");
}

void cs_contact_capacity_warn(const struct cs_system *system, struct cs_text *out) {
    struct cs_contact_capacity capacity;
    if (!cs_contact_capacity_find(system, &capacity) ||
        isnan(system->scene->contact->stiffness) ||
        capacity.holds >= CS_APPROACH_MARGIN * capacity.comes)
        return;
    cs_text_add(out, "contact.stiffness: at %.3g N/m a contact of ", capacity.k);
    print_surfaces(system, &capacity, out);
    cs_text_add(out,
                " takes up %.3g J, but a particle comes with %.3g J: expected at least %.3g "
                "N/m, or no value for %.3g N/m",
                // three digits must not round below what holds
                capacity.holds, capacity.comes, 1.01 * capacity.k_needed,
                CS_APPROACH_STIFFNESS * capacity.comes / (capacity.range * capacity.range));
}

/* Ranges of contact per step that are reported: the step check cuts a step to about one. */
#define RANGES_MAX 10.0
/* Default range over the size of a body that is reported. */
#define HOVER_MAX 0.05

/* m/s with which a particle of a meets b. */
static double approach_speed(const struct cs_system *system, uint32_t a, uint32_t b) {
    const uint32_t bodies[2] = {a, b < system->scene->bodies.n ? b : a};
    double mass = 0;
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < system->bodies[bodies[k]].count; i++)
            mass = fmax(mass, system->mass[system->bodies[bodies[k]].first + i]);
    return mass > 0 ? sqrt(2 * cs_approach_energy(system, a, b) / mass) : 0;
}

void cs_contact_ranges_print(const struct cs_system *system, double dt, struct cs_text *out) {
    const struct cs_scene *scene = system->scene;
    struct cs_contact_capacity worst = {0};
    double most = RANGES_MAX, speed = 0;
    for (uint32_t a = 0; a < scene->bodies.n && system->approach && dt > 0; a++)
        for (uint32_t b = a; b < scene->bodies.n + scene->colliders.n; b++) {
            struct cs_contact_capacity capacity;
            if (!params_of(system, a, b, &capacity) || !(capacity.range > 0))
                continue;
            const double v = approach_speed(system, a, b);
            if (v * dt > most * capacity.range) {
                most = v * dt / capacity.range;
                speed = v;
                worst = capacity;
            }
        }
    if (!(speed > 0))
        return;
    print_surfaces(system, &worst, out);
    cs_text_add(out,
                " may meet at %.3g m/s, %.3g m per step of %.3g s, with a range of contact of "
                "%.3g m: steps are cut there; dt = %.2g s, or a thickness of %.2g m, needs "
                "no cuts\n",
                speed, speed * dt, dt, worst.range, dt / most, worst.range * most);
}

double cs_findings_spacing(const struct cs_body *body) {
    const struct cs_cloth *cloth = &body->cloth;
    double most = 0;
    for (int c = 0; c < 2 && cloth->present; c++)
        if (cloth->grid[c] > 1)
            most = fmax(most, cloth->size[c] / (double)(cloth->grid[c] - 1));
    return most;
}

/* m, smallest square hole that an obstacle does not pass: its second largest side. */
static double width_of(const struct cs_posed_collider *collider) {
    const double *h = collider->half_sizes;
    const double second = fmax(fmin(h[0], h[1]), fmin(fmax(h[0], h[1]), h[2]));
    return 2 * (second + collider->radius + collider->collider->thickness);
}

/* A range that a coarse body sets: it rests at about 0.8 of it. */
static void check_hover(const struct cs_system *system, uint32_t k, const void *arg,
                        struct cs_text *out) {
    const struct cs_scene *scene = arg;
    double low[3], high[3], range = system->collider_params[k].range;
    const bool is_default = cs_scene_colliders(scene)[k].thickness <= 0;
    for (uint32_t b = 0; b < scene->bodies.n && is_default; b++)
        if (range > HOVER_MAX * cs_findings_box(system, b, low, high)) {
            cs_text_add(out,
                        "bodies[%u], which is coarse, may rest %.3g mm above colliders[%u]: "
                        "colliders[%u].thickness %.3g makes that %.3g mm, with more steps",
                        b, 1e3 * range, k, k, range / 8, 1e3 * range / 8);
            return;
        }
}

void cs_contact_spacing_print(const struct cs_system *system, struct cs_text *out) {
    const struct cs_scene *scene = system->scene;
    if (system->collider_params)
        cs_findings_print(system, scene->colliders.n, check_hover, scene, out);
    for (uint32_t k = 0; k < scene->colliders.n && scene->contact->law == CS_CONTACT_PROJECT;
         k++) {
        struct cs_posed_collider collider;
        double gap = 0;
        cs_posed_collider_at(system, k, 0, &collider);
        for (uint32_t b = 0; b < scene->bodies.n; b++)
            gap = fmax(gap, cs_findings_spacing(cs_scene_bodies(scene) + b));
        if (!cs_shape_is_endless(collider.shape) && width_of(&collider) < gap)
            cs_text_add(out,
                        "colliders[%u] is %.3g m wide, particles are %.3g m apart: contact by "
                        "projection lets it through between them; contact.law \"force\" does "
                        "not, nor a grid with cells below %.3g m\n",
                        k, width_of(&collider), gap, width_of(&collider));
    }
}

void cs_contact_note_add(const struct cs_scene *scene, const char *before,
                         struct cs_text *out) {
    if (scene->colliders.n > 0 || cs_scene_has_body_contact(scene))
        cs_text_add(out, "%s%s", before,
                    scene->contact->law == CS_CONTACT_FORCE
                        ? "contact is a force, in linear theory and in runs"
                        : "contact is off in linear theory; in runs it acts after each step");
}

/* Near rest the friction force is about mu N v / friction_speed: a damping rate of mu N / (m
 * friction_speed). A step that is too long for it turns the sliding velocity round each time,
 * and leaves it at half of what friction can change in a step. */
void cs_contact_note_add_crossing(const struct cs_system *system, double speed,
                                  struct cs_text *out) {
    const struct cs_scene *scene = system->scene;
    struct cs_contact_capacity capacity;
    double heaviest = 0;
    if (!cs_contact_capacity_find(system, &capacity))
        return;
    for (uint32_t i = 0; i < system->view.n; i++)
        if (system->inv_mass[i] > 0)
            heaviest = fmax(heaviest, system->mass[i]);
    // what may come by the scene's start, then what came in the runs
    cs_contact_capacity_print(system, &capacity, out);
    if (speed > 0)
        cs_text_add(out, "; a particle of the runs has at most %.3g J: %.3g kg at %.3g m/s",
                    0.5 * heaviest * speed * speed, heaviest, speed);
    cs_text_add(out, "\n");
    struct cs_text warning = {0};
    cs_contact_capacity_warn(system, &warning);
    if (warning.length)
        cs_text_add(out, "warning: %s\n", cs_text_get(&warning));
    cs_text_finish(&warning);
    double stiffest = 0;
    for (uint32_t c = 0; system->collider_params && c < scene->colliders.n; c++)
        stiffest = fmax(stiffest, system->collider_params[c].k);
    if (stiffest > 0 && cs_scene_has_friction(scene) &&
        scene->contact->friction_law == CS_FRICTION_BRISTLES)
        cs_text_add(out,
                    "friction that sticks holds a particle by %.3g N/m and %.3g N s/m, "
                    "which limits explicit steps\n",
                    stiffest, 2 * sqrt(stiffest * heaviest));
    else if (cs_scene_has_friction(scene))
        cs_text_add(
            out,
            "friction under a load N damps a particle of m kg at up to mu N/(m %.3g m/s): in "
            "steps above 2 over that explicit methods let it chatter, by mu N dt/(2 m) at "
            "most; what rests on a slope of half of mu creeps by %.2g mm in 30 s, with an "
            "implicit method and a friction_speed of 5e-6 m/s by 0.09 mm\n",
            scene->contact->friction_speed, 30e3 * 0.57735 * scene->contact->friction_speed);
}
