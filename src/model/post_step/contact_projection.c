/* contact_projection.c - projects all particles against all colliders and limits the energy of
 * the result; see contact_projection.h.
 *
 * State of a particle: free and in front; pushed, if a projection moved it in this commit;
 * resting, if that projection stopped it completely on a collider at rest (resting_on is set);
 * sticking, if static friction holds it from the next step on. A push without rest clears
 * resting_on, as does a commit without contact. */
#include "model/post_step/contact_projection.h"

#include "base/vec3.h"
#include "base/vector.h"
#include "model/contact/approach.h"
#include "model/contact/posed_collider.h"
#include "model/post_step/tunnelling.h"
#include "scene/collider_keys.h"

#include <clothsim/clones.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* Projection of one particle that a step has brought behind the surface of
 * a collider: push, absorption and friction. */

/* Effect of one collider on a particle. */
enum cs_project_result {
    /* nothing: it is in front, or not finite */
    CS_PROJECT_NONE,
    CS_PROJECT_PUSHED,
    /* it is at rest on a collider at rest: velocity and displacement were taken completely */
    CS_PROJECT_STUCK
};

/* Shortens the part of a across n by `lost`; returns whether nothing of it is left. */
static bool apply_friction(double a[3], const double n[3], double lost) {
    const double along = a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
    double across[3], squared = 0;
    for (int c = 0; c < 3; c++) {
        across[c] = a[c] - along * n[c];
        squared += across[c] * across[c];
    }
    const double length = sqrt(squared), kept = length > lost ? 1 - lost / length : 0;
    for (int c = 0; c < 3; c++)
        a[c] = kept * across[c] + along * n[c];
    return kept == 0;
}

/* Factor of the inward velocity that is taken away: above 1 the velocity is reflected. */
static double fraction_of(const struct cs_collider *collider) {
    const double ka = collider->absorption;
    return ka < 0 ? 1 - ka : ka;
}

/* Corrects the velocity relative to the collider; returns whether nothing of it is left. */
static bool absorb(const struct cs_collider *collider, const double n[3], double v[3]) {
    const double inward = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    if (inward >= 0)
        return false;
    const double changed = -inward * fraction_of(collider);
    const bool held =
        apply_friction(v, n, collider->friction * changed) && collider->absorption == 1;
    for (int c = 0; c < 3; c++)
        v[c] = held ? 0 : v[c] + changed * n[c];
    return held;
}

/* Moves a particle at p with velocity v onto the surface, offset by the collider's thickness,
 * after a step of dt that began at `last`. Against a moving collider all is relative to the
 * motion of its matter. With the outward normal n and the gap d < 0:
 *
 *   p -= d n                                             (cloth thesis, eq. 5.27 to 5.31)
 *   v -= ka (v.n) n  if v.n < 0, ka the absorption       (eq. 5.32 as meant)
 *   |T_v| -= at most mu times the change along n         (Coulomb)
 *   |T_x| -= at most mu min(ka, 1) |d|                   (Macklin et al. 2014)
 *
 * with T_v, T_x the tangential parts of v and of the displacement since `last`. A negative
 * absorption reflects the normal velocity, times |ka|. Position and velocity are corrected
 * alike, so that a particle that friction holds stays in its place. If it passes the collider,
 * n and d are those of the half-space at its entry. */
static enum cs_project_result project_particle(const struct cs_posed_collider *before,
                                               const struct cs_posed_collider *posed, double dt,
                                               const double last[3], double p[3], double v[3]) {
    const struct cs_collider *collider = posed->collider;
    double n[3], surface_v[3], from[3], move[3], gap;
    if (!cs_tunnelling_find(before, posed, last, p, &gap, n))
        gap = cs_posed_collider_signed_distance(posed, p, n);
    if (!(gap < 0))
        return CS_PROJECT_NONE;

    /* position that the particle would have, had it moved with the collider */
    cs_posed_collider_velocity(posed, p, surface_v);
    for (int c = 0; c < 3; c++) {
        from[c] = last[c] + dt * surface_v[c];
        move[c] = p[c] - from[c];
        v[c] -= surface_v[c];
    }
    const bool stopped = absorb(collider, n, v);
    const bool kept =
        apply_friction(move, n, collider->friction * fmin(fraction_of(collider), 1) * -gap);
    for (int c = 0; c < 3; c++) {
        v[c] += surface_v[c];
        p[c] = from[c] + move[c] - gap * n[c];
    }
    return stopped && kept && cs_vec3_is_zero(surface_v) ? CS_PROJECT_STUCK : CS_PROJECT_PUSHED;
}

/* Part of the largest depth after which a longer step may be tried; the depth falls with the
 * square of the step at least. */
#define ROOM 0.125
/* relative rounding of the times of parts */
#define ROUNDING 1e-9

/* One commit. */
struct step {
    struct cs_contact_projection *contact;
    double t, dt;
    /* the state that the step left; changed in place */
    double *x, *v;
    /* integer counts: the order of their sum does not matter */
    atomic_ullong tests, pushed;
};

static size_t count_of(const struct cs_contact_projection *contact) {
    return contact->system->view.n;
}

/* Writes one particle of (3,n). */
static void put(const double value[3], size_t n, size_t i, double *to) {
    for (size_t c = 0; c < 3; c++)
        to[c * n + i] = value[c];
}

/* Tells which of `count` particles from `begin` on are near a collider, or move far enough to
 * pass one. Most do neither. Colliders that move are asked one by one. */
CS_CLONES static void find_near(const struct step *step, size_t begin, size_t count,
                                bool near[CS_COLLIDER_ROW]) {
    const struct cs_contact_projection *contact = step->contact;
    const size_t n = count_of(contact);
    const double *x = step->x + begin, *last = contact->state_before + begin;
    const double tunnel = contact->shortest_tunnel * contact->shortest_tunnel;
    const bool all = tunnel < HUGE_VAL && contact->colliders_before != contact->colliders;
    double reach[CS_COLLIDER_ROW];
    uint8_t list[CS_COLLIDER_ROW];
    for (size_t i = 0; i < count; i++) {
        const double move[3] = {x[i] - last[i], x[n + i] - last[n + i],
                                x[2 * n + i] - last[2 * n + i]};
        near[i] = all | (cs_vec3_dot(move, move) > tunnel);
    }
    for (uint32_t k = 0; k < contact->system->scene->colliders.n; k++) {
        const struct cs_posed_collider *collider = contact->colliders + k;
        for (size_t i = 0; i < count; i++)
            reach[i] = collider->collider->thickness;
        const uint32_t n_near = cs_posed_collider_list_near(collider, reach, n, x, count, list);
        for (uint32_t l = 0; l < n_near; l++)
            near[list[l]] = true;
    }
}

/* Projects particle i against all colliders, each after the one before, into state_after if it
 * is pushed. Returns how many pushed it. */
static unsigned project_against_all(const struct step *step, size_t i) {
    struct cs_contact_projection *contact = step->contact;
    const size_t n = count_of(contact);
    double p[3], v[3], last[3];
    unsigned pushed = 0;
    cs_point_read(step->x, n, i, p);
    cs_point_read(step->v, n, i, v);
    cs_point_read(contact->state_before, n, i, last);
    for (uint32_t k = 0; k < contact->system->scene->colliders.n; k++) {
        const enum cs_project_result touch = project_particle(
            contact->colliders_before + k, contact->colliders + k, step->dt, last, p, v);
        if (touch == CS_PROJECT_NONE)
            continue;
        pushed++;
        contact->static_friction.resting_on[i] = touch == CS_PROJECT_STUCK ? k + 1 : 0;
    }
    if (pushed)
        put(p, n, i, contact->state_after), put(v, n, i, contact->state_after + 3 * n);
    return pushed;
}

/* Projects the particles [begin, end). Pinned and sticking ones take no part. */
static void project_block(void *arg, size_t begin, size_t end) {
    struct step *step = arg;
    struct cs_contact_projection *contact = step->contact;
    const struct cs_system *system = contact->system;
    uint64_t tested = 0, pushed = 0;
    bool near[CS_COLLIDER_ROW];
    for (size_t i = begin; i < end; i++) {
        const size_t place = (i - begin) % CS_COLLIDER_ROW, left = end - i;
        if (place == 0)
            find_near(step, i, left < CS_COLLIDER_ROW ? left : CS_COLLIDER_ROW, near);
        const bool free = system->inv_mass[i] > 0 && !contact->static_friction.is_sticking[i];
        const unsigned pushes = free && near[place] ? project_against_all(step, i) : 0;
        tested += free;
        pushed += pushes;
        contact->is_pushed[i] = pushes > 0;
        if (free && pushes == 0)
            contact->static_friction.resting_on[i] = 0;
    }
    step->tests += tested * system->scene->colliders.n;
    step->pushed += pushed;
}

/* Limits the energy of state_after and makes it the state. */
static void push(const struct step *step) {
    struct cs_contact_projection *contact = step->contact;
    const size_t n = count_of(contact), n3 = 3 * n;
    const struct cs_projection_step pushed = {.t = step->t,
                                              .dt = step->dt,
                                              .colliders = contact->colliders,
                                              .colliders_before = contact->colliders_before,
                                              .before_step = contact->state_before,
                                              .x = step->x,
                                              .v = step->v,
                                              .corrected = contact->state_after,
                                              .is_pushed = contact->is_pushed};
    // sticking ones count as pushed: to the elastic response their positions are imposed too
    for (size_t i = 0; i < n; i++) {
        for (size_t k = i; k < n3 && !contact->is_pushed[i]; k += n) {
            contact->state_after[k] = step->x[k];
            contact->state_after[n3 + k] = step->v[k];
        }
        contact->is_pushed[i] |= contact->static_friction.is_sticking[i];
    }
    // If the push was cut short, a particle may still be behind a surface and is not at rest.
    if (!cs_projection_energy_limit(&contact->energy_limit, &pushed))
        cs_static_friction_reject(&contact->static_friction);
    memcpy(step->x, contact->state_after, n3 * sizeof *step->x);
    memcpy(step->v, contact->state_after + n3, n3 * sizeof *step->v);
}

/* Poses the colliders at both ends of a step; they were posed once if none moves. */
static void pose_step(struct cs_contact_projection *contact, double t0, double t1) {
    if (contact->colliders_before != contact->colliders)
        cs_posed_colliders_at(contact->system, t0, contact->colliders_before);
    cs_posed_colliders_at(contact->system, t1, contact->colliders);
}

/* Without a push the last energy is unknown to the
 * next commit, and contact ends unless particles stick. */
bool cs_contact_projection_resolve(struct cs_contact_projection *contact, double t, double dt,
                                   double *x, double *v) {
    const size_t n = count_of(contact);
    struct step step = {.contact = contact, .t = t, .dt = dt, .x = x, .v = v};
    contact->memory_before = contact->energy_limit.memory;
    const bool restored =
        cs_static_friction_restore(&contact->static_friction, dt, contact->state_before, x, v);
    pose_step(contact, t - dt, t);
    cs_vector_parallel_for(n, project_block, &step);
    contact->counts.tests += step.tests;
    contact->counts.projected += step.pushed;
    if (step.pushed > 0)
        push(&step);
    contact->energy_limit.memory.has_last_energy = step.pushed > 0;
    contact->energy_limit.memory.in_contact &=
        step.pushed > 0 || contact->static_friction.n_sticking > 0;
    return step.pushed > 0 || restored;
}

/* A frame without a refusal in which little stayed inside lets the next have longer steps. */
double cs_contact_projection_end(struct cs_contact_projection *contact, bool begins, double t,
                                 double end) {
    struct cs_projection_cut *cut = &contact->cut;
    const double frame = 1 / contact->system->scene->time.fps;
    if (begins && t - cut->tight >= frame * (1 - ROUNDING))
        cut->longest = 2 * cut->longest > frame * (1 - ROUNDING) ? HUGE_VAL : 2 * cut->longest;
    const double parts = ceil((end - t) / cut->longest * (1 - ROUNDING));
    return parts > 1 ? t + (end - t) / parts : end;
}

/* A depth of before is no reason: shorter steps may not lift it. */
bool cs_contact_projection_refuses(struct cs_contact_projection *contact, double t, double dt,
                                   const double *x) {
    struct cs_projection_cut *cut = &contact->cut;
    const double shortest = 1 / (contact->system->scene->time.fps * CS_PROJECTION_PARTS);
    const double depth = contact->energy_limit.memory.has_last_energy
                             ? cs_posed_colliders_depth(contact->system, t, x)
                             : 0;
    const bool deep = depth > fmax(contact->depth_max, cut->depth) && depth > cut->vain;
    const bool refused = deep && dt > 2 * shortest * (1 - ROUNDING);
    // the shortest steps did not help: only what is twice as deep is a reason to cut others
    cut->vain = deep && !refused ? 2 * depth : depth > contact->depth_max ? cut->vain : 0;
    if (refused) {
        contact->energy_limit.memory = contact->memory_before;
        cs_static_friction_reject(&contact->static_friction);
        cut->longest = dt / 2;
    }
    if (depth > ROOM * contact->depth_max && depth > cut->vain)
        cut->tight = t;
    cut->depth = refused ? cut->depth : depth;
    return refused;
}

void cs_contact_projection_store(struct cs_contact_projection *contact, const double *x,
                                 const double *v, bool resolved) {
    const size_t n3 = 3 * count_of(contact);
    memcpy(contact->state_before, x, n3 * sizeof *x);
    memcpy(contact->state_before + n3, v, n3 * sizeof *v);
    contact->energy_limit.memory.has_last_energy &= resolved;
}

double cs_contact_projection_fraction(struct cs_contact_projection *contact, double t0,
                                      const double *x0, double t1, const double *x1) {
    const size_t n = count_of(contact);
    if (!(t1 > t0))
        return 1;
    pose_step(contact, t0, t1);
    for (uint32_t k = 0; k < contact->system->scene->colliders.n; k++)
        for (size_t i = 0; i < n; i++) {
            double from[3], to[3];
            cs_point_read(x0, n, i, from);
            cs_point_read(x1, n, i, to);
            if (contact->system->inv_mass[i] > 0 &&
                cs_tunnelling_is_deep(contact->colliders_before + k, contact->colliders + k,
                                      from, to))
                return 0.5;
        }
    return 1;
}

void cs_contact_projection_serialise(struct cs_contact_projection *contact,
                                     struct cs_serialiser *serialiser) {
    cs_serialiser_bytes(serialiser, contact->state_before,
                        6 * count_of(contact) * sizeof *contact->state_before);
    CS_SERIALISER(serialiser, contact->counts);
    cs_static_friction_serialise(&contact->static_friction, serialiser);
    CS_SERIALISER(serialiser, contact->energy_limit.memory);
    CS_SERIALISER(serialiser, contact->cut);
}

/* No energy is known yet, and no contact exists. */
void cs_contact_start(struct cs_contact_projection *contact, double t, const double *x,
                      const double *v) {
    cs_contact_projection_store(contact, x, v, false);
    contact->cut.t = t;
    contact->cut.depth = cs_posed_colliders_depth(contact->system, t, x);
    contact->energy_limit.memory.in_contact = false;
    cs_posed_colliders_at(contact->system, t, contact->colliders);
    cs_static_friction_start(&contact->static_friction, contact->colliders, t, x, v,
                             contact->state_after);
}

/* Finds the least inner radius, and whether something may pass a collider in a frame, the
 * longest step of a method by default. */
static void init_tunnelling(struct cs_contact_projection *contact) {
    const struct cs_system *system = contact->system;
    const uint32_t n_bodies = system->scene->bodies.n;
    contact->shortest_tunnel = HUGE_VAL;
    if (!cs_tunnelling_is_possible(system->scene))
        return;
    cs_posed_colliders_at(system, 0, contact->colliders);
    for (uint32_t k = 0; k < system->scene->colliders.n; k++) {
        const double inner = cs_tunnelling_inner_radius(contact->colliders + k);
        contact->shortest_tunnel = fmin(contact->shortest_tunnel, inner);
        for (uint32_t b = 0; b < n_bodies; b++)
            contact->limits_steps |=
                cs_approach_speed(system, b, n_bodies + k) > inner * system->scene->time.fps;
    }
}

enum cs_status cs_contact_projection_init(struct cs_contact_projection *contact,
                                          struct cs_system *system, struct cs_arena *arena,
                                          struct cs_error *error) {
    const size_t n = system->view.n;
    *contact = (struct cs_contact_projection){.system = system, .cut.longest = HUGE_VAL};
    CS_ARENA_ARRAY(arena, contact->colliders, system->scene->colliders.n, error);
    contact->colliders_before = contact->colliders;
    if (system->motions)
        CS_ARENA_ARRAY(arena, contact->colliders_before, system->scene->colliders.n, error);
    contact->state_before = cs_arena_alloc_array(arena, 6 * n, sizeof(double), error);
    contact->state_after = cs_arena_alloc_array(arena, 6 * n, sizeof(double), error);
    contact->is_pushed = cs_arena_alloc_array(arena, n, sizeof(bool), error);
    if (error->status ||
        cs_static_friction_init(&contact->static_friction, system, arena, error))
        return error->status;
    init_tunnelling(contact);
    return cs_projection_energy_init(&contact->energy_limit, system, arena, error);
}
