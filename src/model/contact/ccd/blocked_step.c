/* Finds the primitives that blocked a step, once, where a run ends: by the questions of
 * step_limit.c in their order, particle by particle and pair by pair. */

#include "model/contact/approach.h"
#include "model/contact/barrier_law.h"
#include "model/contact/ccd/accd.h"
#include "model/contact/ccd/crossings.h"
#include "model/contact/ccd/step_limit.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/step_check.h"
#include "model/system/surfaces.h"
#include "scene/body_pairs.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

enum cs_status cs_blocked_step_init(struct cs_blocked_step *blocked,
                                    const struct cs_system *system, struct cs_arena *arena,
                                    struct cs_error *error) {
    *blocked = (struct cs_blocked_step){0};
    if (cs_step_limit_applies(system))
        CS_ARENA_ARRAY(arena, blocked->x, 6 * (size_t)system->view.n, error);
    return error->status;
}

void cs_blocked_step_store(struct cs_blocked_step *blocked, const struct cs_system *system,
                           const double t[2], const double *const x[2], double share) {
    const size_t n3 = 3 * (size_t)system->view.n;
    blocked->is_set = blocked->x && share < 1;
    blocked->asked = true;
    for (size_t end = 0; end < 2 && blocked->is_set; end++) {
        blocked->t[end] = t[end];
        memmove(blocked->x + end * n3, x[end], n3 * sizeof *blocked->x);
    }
}

/* --- what contact holds at a place --- */

/* Contact at a place of the blocked step. */
struct place {
    double d, range, k; /* m, m, N/m */
    double stiffness;   /* N/m, the scene's: edges have more (body_pair_params.h) */
    double energy;      /* J that comes there: in motion relative to each other, and stored */
    bool held;          /* no point of it is free */
};

/* Adds distance, energies, and what would hold, by the margin of approach.h. Energy grows with
 * k and with the square of the range. */
static void print_place(const struct place *at, struct cs_text *out) {
    cs_text_add(out, ", %.3g m apart", at->d);
    if (at->held || !(at->range > 0)) {
        cs_text_add(out, at->held ? ": all points there are pinned or on paths"
                                  : ": no contact is defined between them");
        return;
    }
    const double holds = cs_barrier_capacity(at->range, at->k);
    const double factor = CS_APPROACH_MARGIN * at->energy / holds;
    cs_text_add(out, ": contact takes up %.3g J there and %.3g J come", holds, at->energy);
    if (factor > 1)
        cs_text_add(out,
                    "; %.3g times the stiffness would hold (contact.stiffness %.3g N/m), "
                    "or %.3g times the thickness",
                    factor, factor * at->stiffness, sqrt(factor));
    else
        cs_text_add(out, ", which a contact.stiffness of %.3g N/m holds, and it is %.3g N/m",
                    factor * at->stiffness, at->stiffness);
}

/* J, kinetic energy of the relative motion of a mass in a step of h seconds. */
static double kinetic(double mass, const double way[3], double h) {
    return h > 0 ? 0.5 * mass * cs_vec3_dot(way, way) / (h * h) : 0;
}

/* --- colliders that are no meshes --- */

/* The point of a body that the step takes deepest into the range of a collider. */
struct point_search {
    struct cs_collider_step steps[2]; /* of particles, of samples */
    uint32_t collider;
    bool samples, resolved; /* of samples; those too that do not miss contact */
    double y;               /* distance at the end over the range; of the best one */
    uint32_t particle;      /* a sample is named by its first vertex */
    struct place place;
};

/* Takes a free point over that goes deepest. */
static void try_point(void *arg, const struct cs_contact_sample_point *point) {
    struct point_search *search = arg;
    const struct cs_collider_step *step = search->steps + (point->n > 1);
    const struct cs_system *system = step->system;
    const double range = step->params.range, k = step->params.k;
    const double mass = cs_contact_sample_mass(system, point);
    double from[3], to[3], start[3], way[3], g[3], h[6];
    cs_contact_sample_interpolate(point, system->view.n, step->x0, from);
    cs_contact_sample_interpolate(point, system->view.n, step->x1, to);
    // those that the check of the step refused, or all
    if (mass == HUGE_VAL ||
        (!search->resolved && !(cs_collider_step_excess(step, mass, from, to) > 0)))
        return;
    for (int c = 0; c < 3; c++) {
        start[c] = from[c] + step->at_t1.centre[c] - step->at_t0.centre[c];
        way[c] = to[c] - start[c];
    }
    const double y = cs_posed_collider_smooth_distance(&step->at_t1, to, g, h) / range;
    if (!(y < search->y))
        return;
    const double d = cs_posed_collider_smooth_distance(&step->at_t1, start, g, h);
    search->y = y;
    search->particle = point->particles[0];
    search->samples = point->n > 1;
    search->place = (struct place){
        d, range, k, k, kinetic(mass, way, step->h) + cs_barrier_energy(d, range, k), false};
}

static void print_point(const struct point_search *found, const struct cs_system *system,
                        struct cs_text *out) {
    cs_text_add(out, found->samples ? "; there the surface at " : "; there ");
    cs_system_print_particle(system, found->particle, out);
    cs_text_add(out, " comes to colliders[%u]", found->collider);
    print_place(&found->place, out);
}

/* Finds a point of a body at a collider: the deepest one in range, if resolved ones count, else
 * the deepest at the first collider whose contact is missed, which rejected the step. Returns
 * false if there is none. */
static bool find_first_point(const struct cs_blocked_step *blocked,
                             const struct cs_system *system, bool resolved,
                             struct point_search *found) {
    *found = (struct point_search){.resolved = resolved, .y = resolved ? 1 : HUGE_VAL};
    for (uint32_t c = 0; c < system->scene->colliders.n && system->collider_params; c++) {
        struct point_search search = *found;
        search.collider = c;
        for (int k = 0; k < 2; k++) {
            search.steps[k].x0 = blocked->x;
            search.steps[k].x1 = blocked->x + 3 * (size_t)system->view.n;
            cs_collider_step_set(search.steps + k, system, c, blocked->t[0], blocked->t[1]);
        }
        // samples have no flights
        cs_collider_step_set_beside_rebounds(search.steps);
        cs_contact_points_visit(system, c, try_point, &search);
        if (!(search.y < found->y))
            continue;
        *found = search;
        if (!resolved)
            return true;
    }
    return resolved && found->y < 1;
}

/* --- pairs --- */

/* Two primitives during the blocked step: their points, positions at its start in m, moves. */
struct pair_move {
    enum cs_pair_kind kind;
    uint32_t at[4];
    double p[4][3], moves[4][3];
};

/* Reads positions and moves of the points pair->at; x (2) of (3,n_points). */
static void read_pair(size_t n, const double *const x[2], struct pair_move *pair) {
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++) {
            pair->p[k][c] = x[0][c * n + pair->at[k]];
            pair->moves[k][c] = x[1][c * n + pair->at[k]] - pair->p[k][c];
        }
}

/* m, true distance at the start */
static double distance_of(const struct pair_move *pair) {
    return sqrt(cs_exact_distance_squared(pair->kind, (const double(*)[3])pair->p));
}

/* J, kinetic energy of the relative motion of both contact points in h seconds, and energy that
 * is stored. */
static double energy_of(const struct cs_system *system, struct pair_move *pair, double h,
                        const struct place *at) {
    double way[3] = {0}, inverse = 0;
    struct cs_pair_contact contact;
    const double d = cs_pair_contact_measure_whole(&contact, pair->kind, at->range, pair->p);
    const double *weight = contact.weight;
    for (int k = 0; k < 4; k++) {
        inverse += weight[k] * weight[k] * cs_surface_points_inverse_mass(system, pair->at[k]);
        for (int c = 0; c < 3; c++)
            way[c] += weight[k] * pair->moves[k][c];
    }
    // points that are held may meet beside a free one, which has no weight then
    return (inverse > 0 ? kinetic(1 / inverse, way, h) : 0) +
           cs_barrier_energy(d, at->range, at->k);
}

/* Contact of a pair in a step of h seconds. Its energy is at least the one that may come to the
 * two bodies: the pair may have been slowed down already, and h may be 0. */
static struct place place_of(const struct cs_system *system, struct pair_move *pair, double h) {
    const struct cs_surfaces *s = system->surfaces;
    const uint32_t a = cs_surfaces_body(s->first_point, s->n_bodies, pair->at[0]),
                   b = cs_surfaces_body(s->first_point, s->n_bodies, pair->at[3]);
    struct place at = {.d = distance_of(pair), .held = true};
    double friction;
    for (int k = 0; k < 4; k++)
        at.held = at.held && cs_surface_points_inverse_mass(system, pair->at[k]) == 0;
    // without contact the range stays 0
    if (at.held || !system->pairs || !cs_scene_bodies_collide(system->scene, a, b, &friction))
        return at;
    const struct cs_body_pair_params *params =
        cs_body_pair_params_of(&system->pairs->body_pairs, a, b);
    const bool edges = pair->kind == CS_PAIR_EDGE_EDGE;
    at.range = cs_pair_contact_range(params, edges);
    at.k = cs_body_pair_params_stiffness(params, edges);
    at.stiffness = params->k;
    at.energy = fmax(energy_of(system, pair, h, &at),
                     cs_approach_energy(system, a < b ? a : b, a < b ? b : a));
    return at;
}

/* Adds "; there the edge at ... VERB the edge at ...", and the contact there. */
static void print_pair(const struct cs_blocked_step *blocked, const struct cs_system *system,
                       const char *verb, struct pair_move *pair, struct cs_text *out) {
    const bool edges = pair->kind == CS_PAIR_EDGE_EDGE;
    const struct place at = place_of(system, pair, blocked->t[1] - blocked->t[0]);
    cs_text_add(out, edges ? "; there the edge at " : "; there ");
    cs_surfaces_print_point(system, pair->at[0], out);
    cs_text_add(out, edges ? " %s the edge at " : " %s the triangle at ", verb);
    cs_surfaces_print_point(system, pair->at[edges ? 2 : 1], out);
    print_place(&at, out);
}

/* Returns the distance of a candidate at the nearer end of the step, over its range. */
static double nearness_of(const struct cs_candidates *candidates, const double *const x[2],
                          struct pair_move *pair) {
    const size_t n = candidates->system->surfaces->n_points;
    read_pair(n, (const double *const[2]){x[1], x[1]}, pair);
    const double end = distance_of(pair);
    read_pair(n, x, pair);
    return fmin(end, distance_of(pair)) /
           cs_candidate_range_of(candidates, pair->kind, pair->at);
}

/* Finds the nearest of the candidates, in units of their range. Returns that, or 1 if none is
 * in range at either end. */
static double find_nearest(const struct cs_system *system, const double *const x[2],
                           struct pair_move *nearest) {
    const struct cs_candidates *candidates = &system->pairs->candidates;
    struct pair_move pair;
    double least = 1;
    for (uint32_t l = 0; l < candidates->n_chunks; l++)
        for (size_t k = 0; k < candidates->chunks[l].n; k++) {
            pair.kind = candidates->chunks[l].kind;
            cs_candidate_vertices(system->surfaces, pair.kind,
                                  candidates->chunks[l].pairs + 2 * k, pair.at);
            // ties go to the first in the order of the list
            const double y = nearness_of(candidates, x, &pair);
            if (y < least) {
                least = y;
                *nearest = pair;
            }
        }
    return least;
}

/* --- crossings --- */

/* Adds the pair that crosses first; nothing if none does. */
static void print_crossing(const struct cs_blocked_step *blocked,
                           const struct cs_system *system, const double *const x[2],
                           struct cs_text *out) {
    const struct cs_first_collision first =
        cs_crossings_first_collision(system, blocked->t[0], blocked->x, blocked->t[1],
                                     blocked->x + 3 * (size_t)system->view.n);
    struct pair_move pair = {.kind = first.kind};
    if (!(first.fraction < 1))
        return;
    memcpy(pair.at, first.points, sizeof pair.at);
    read_pair(system->surfaces->n_points, x, &pair);
    print_pair(blocked, system, "would cross", &pair, out);
}

/* Positions of all points of surfaces at both ends of the step. */
static void read_ends(const struct cs_blocked_step *blocked, const struct cs_system *system,
                      const double *x[2]) {
    const double *x0 = blocked->x, *x1 = x0 + 3 * (size_t)system->view.n;
    x[0] = cs_surface_points_positions(system, CS_POINTS_BEGIN, blocked->t[0], x0);
    x[1] = cs_surface_points_positions(system, CS_POINTS_END, blocked->t[1], x1);
}

/* Makes the list of candidates good for the step; returns whether the step resolves pairs. */
static bool pairs_resolve_step(const struct cs_blocked_step *blocked,
                               const struct cs_system *system) {
    return cs_contact_pairs_resolve_step(system->pairs, blocked->t[0], blocked->x,
                                         blocked->t[1],
                                         blocked->x + 3 * (size_t)system->view.n);
}

void cs_blocked_step_print(const struct cs_blocked_step *blocked,
                           const struct cs_system *system, struct cs_text *out) {
    const double *x[2];
    struct pair_move nearest;
    struct point_search point;
    const bool moves = blocked->t[1] > blocked->t[0];
    if (moves && find_first_point(blocked, system, false, &point)) {
        print_point(&point, system, out);
        return;
    }
    if (!system->surfaces)
        return;
    // in the order of cs_step_limit_fraction: pairs before crossings
    read_ends(blocked, system, x);
    if (system->pairs && moves && !pairs_resolve_step(blocked, system) &&
        find_nearest(system, x, &nearest) < 1)
        print_pair(blocked, system, "comes to", &nearest, out);
    else if (cs_scene_crossings(system->scene) == CS_CROSSINGS_LIMIT)
        print_crossing(blocked, system, x, out);
}

/* s, of the step straight on from a state whose deepest contact is sought */
#define INSTANT 1e-9

/* Takes the step straight on from a state. */
static void store_instant(struct cs_blocked_step *blocked, const struct cs_system *system,
                          double t, const double *x, const double *v) {
    const size_t n3 = 3 * (size_t)system->view.n;
    blocked->t[0] = t;
    blocked->t[1] = t + INSTANT;
    for (size_t i = 0; i < n3; i++) {
        blocked->x[i] = x[i];
        blocked->x[n3 + i] = x[i] + INSTANT * v[i];
    }
}

void cs_blocked_step_print_deepest(struct cs_blocked_step *blocked,
                                   const struct cs_system *system, double t, const double *x,
                                   const double *v, struct cs_text *out) {
    const double *ends[2];
    struct point_search point;
    struct pair_move nearest;
    if (!blocked->x)
        return;
    store_instant(blocked, system, t, x, v);
    const bool touches = find_first_point(blocked, system, true, &point);
    if (system->pairs) {
        read_ends(blocked, system, ends);
        pairs_resolve_step(blocked, system);
    }
    if (system->pairs && find_nearest(system, ends, &nearest) < point.y)
        print_pair(blocked, system, "comes to", &nearest, out);
    else if (touches)
        print_point(&point, system, out);
}
