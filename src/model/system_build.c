/* Builds a system from a scene by its plan: counts, allocates from one arena, fills.
 *
 * Order, because each stage reads the ones before:
 *   1. Bodies and arrays of particles.
 *   2. Springs, and their partition among threads.
 *   3. Masses, which may depend on the springs at a particle; then state and pins.
 *   4. Forces, which may read all of that.
 *   5. Crossings, and events with the bounds on frequencies. */
#include "model/plan.h"

#include "model/contact/approach.h"
#include "model/contact/bristle_law.h"
#include "model/contact/ccd/crossings.h"
#include "model/event/event_state.h"
#include "model/event/events.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/post_step/tunnelling.h"
#include "model/system/shape_clusters.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/body_particles.h"
#include "scene/mesh_keys.h"

#include <stdlib.h>
#include <string.h>

/* Starts a feature: returns whether it is built, and counts allocations from now on in its row.
 */
static bool begin_feature(struct cs_system *system, enum cs_feature feature) {
    system->arena.part = &system->plan.rows[feature].bytes;
    return system->plan.rows[feature].built;
}

/* Allocates doubles in the system's arena. Returns NULL and sets the error if out of memory. */
static double *allocate(struct cs_system *system, size_t n, struct cs_error *error) {
    return cs_arena_alloc_array(&system->arena, n, sizeof(double), error);
}

/* Makes the runs of all bodies, in their order. The first pass counts; only meshes have lists.
 */
static void build_springs(struct cs_system *system, struct cs_error *error) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    uint32_t n_runs = 0, n_springs = 0, n_listed = 0;
    /* the first pass counts; springs of meshes alone have lists */
    for (uint32_t b = 0; b < system->scene->bodies.n; b++)
        n_runs += cs_springs_of_body(bodies + b, b, 0, NULL, NULL,
                                     bodies[b].mesh ? &n_listed : &n_springs);
    struct cs_spring_run *runs =
        cs_arena_alloc_array(&system->arena, n_runs, sizeof *runs, error);
    double *lists = allocate(system, 2 * (size_t)n_listed, error);
    if (error->status)
        return;
    n_runs = n_springs = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const uint32_t before = n_springs;
        n_runs += cs_springs_of_body(bodies + b, b, system->bodies[b].first, runs + n_runs,
                                     lists, &n_springs);
        if (bodies[b].mesh)
            lists += 2 * (size_t)(n_springs - before);
    }
    system->springs = (struct cs_springs){.runs = runs, .n_runs = n_runs, .n = n_springs};
    system->springs.n_factors = cs_springs_order_factors(runs, n_runs, 0);
}

/* Writes the runs out spring by spring, for methods that need single springs (CS_NEED_SPRINGS).
 */
static void build_spring_list(struct cs_system *system, struct cs_error *error) {
    const uint32_t n = system->springs.n;
    uint32_t *ends = cs_arena_alloc_array(&system->arena, 2 * (size_t)n, sizeof *ends, error);
    double *length = allocate(system, n, error), *stiffness = allocate(system, n, error);
    double *damping = allocate(system, n, error);
    uint32_t *kind = cs_arena_alloc_array(&system->arena, n, sizeof *kind, error);
    uint8_t *axial = cs_arena_alloc_array(&system->arena, n, sizeof *axial, error);
    if (error->status)
        return;
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            const size_t s = (size_t)run->first + i;
            ends[2 * s] = cs_spring_a(run, i);
            ends[2 * s + 1] = cs_spring_b(run, i);
            length[s] = cs_spring_length(run, i);
            stiffness[s] = cs_spring_stiffness(run, i);
            damping[s] = run->damping;
            /* the part bit by which a method asks for such forces */
            kind[s] = CS_PART_STRETCH << run->kind;
            axial[s] = run->axial;
        }
    }
    system->view.n_springs = n;
    system->view.ends = ends;
    system->view.length = length;
    system->view.stiffness = stiffness;
    system->view.damping = damping;
    system->view.kind = kind;
    system->view.axial = axial;
}

/* begin[k] of the items k < n whose numbers key (m) has: positions in a list sorted by key,
 * which items then is, stably. begin (n + 1) must be 0. Entry e of the list is e / each. */
static void sort_by_key(uint32_t n, const uint32_t *key, size_t m, uint32_t each,
                        uint32_t *begin, uint32_t *items) {
    for (size_t e = 0; e < m; e++)
        begin[key[e] + 1]++;
    for (uint32_t k = 0; k < n; k++)
        begin[k + 1] += begin[k];
    for (size_t e = m; e-- > 0;)
        items[--begin[key[e] + 1]] = (uint32_t)(e / each);
    // each begin + 1 is now the begin of its own key
    memmove(begin, begin + 1, n * sizeof *begin);
    begin[n] = (uint32_t)m;
}

/* The first colour that no coloured neighbour of particle i has; UINT32_MAX: none yet. */
static uint32_t first_free_colour(const struct cs_view *view, const uint32_t *colour,
                                  uint32_t i) {
    uint32_t found = 0;
    for (uint32_t k = view->spring_begin[i]; k < view->spring_begin[i + 1]; k++) {
        const uint32_t *ends = view->ends + 2 * (size_t)view->spring_items[k];
        if (colour[ends[ends[0] == i]] == found) {
            found++;
            k = view->spring_begin[i] - 1; // again, for the next colour
        }
    }
    return found;
}

/* Springs by particle and particles by colour, greedily in the order of their numbers. */
static void build_colours(struct cs_system *system, struct cs_error *error) {
    struct cs_view *view = &system->view;
    const size_t n = view->n, m = 2 * (size_t)view->n_springs;
    uint32_t *words = cs_arena_alloc_array(&system->arena, 4 * n + m + 2, sizeof *words, error);
    if (!words)
        return;
    uint32_t *colour = words, *items = colour + n, *spring_begin = items + n;
    uint32_t *spring_items = spring_begin + n + 1, *begin = spring_items + m;
    sort_by_key(view->n, view->ends, m, 2, spring_begin, spring_items);
    view->spring_begin = spring_begin;
    view->spring_items = spring_items;
    memset(colour, 0xff, n * sizeof *colour);
    for (uint32_t i = 0; i < n; i++) {
        colour[i] = first_free_colour(view, colour, i);
        view->n_colours = colour[i] >= view->n_colours ? colour[i] + 1 : view->n_colours;
    }
    sort_by_key(view->n_colours, colour, n, 1, begin, items);
    view->colour_begin = begin;
    view->colour_items = items;
}

/* Each particle's part of the surface in m2. */
static void fill_area(struct cs_system *system) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *range = system->bodies + b;
        for (uint32_t i = 0; i < range->count; i++)
            system->area[range->first + i] = cs_body_area(bodies + b, i);
    }
}

/* Adds the velocity of a rotation about the body's placement, v += spin x (x - centre), to free
 * particles. */
static void spin_body(struct cs_system *system, const struct cs_body *body,
                      const struct cs_body_range *range, const bool *pinned) {
    const double *w = body->mesh ? body->mesh->spin : body->cloth.spin;
    const double *centre = cs_body_placement(body)->translate;
    const size_t n = system->view.n;
    if (w[0] == 0 && w[1] == 0 && w[2] == 0)
        return;
    for (size_t i = range->first; i < (size_t)range->first + range->count; i++)
        for (size_t c = 0; c < 3 && !pinned[i]; c++) {
            const size_t d = (c + 1) % 3, e = (c + 2) % 3;
            system->state[(3 + c) * n + i] += w[d] * (system->state[e * n + i] - centre[e]) -
                                              w[e] * (system->state[d * n + i] - centre[d]);
        }
}

/* Positions and velocities at time 0, and marks of pinned particles, whose velocity is 0. */
static void fill_state(struct cs_system *system, bool *pinned) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    const uint32_t n = system->view.n;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *range = system->bodies + b;
        const double *velocity = cs_body_velocity(bodies + b);
        cs_body_position(bodies + b, n, range->first, system->state);
        cs_body_pin(bodies + b, n, range->first, system->state, pinned + range->first);
        for (uint32_t i = range->first; i < range->first + range->count; i++)
            for (size_t c = 0; c < 3; c++)
                system->state[(3 + c) * n + i] = pinned[i] ? 0 : velocity[c];
        spin_body(system, bodies + b, range, pinned);
    }
}

/* Lists the pinned particles, ascending, and sets inverse masses: 0 marks a pinned particle. */
static void fill_pins(struct cs_system *system, const bool *pinned, struct cs_error *error) {
    const uint32_t n = system->view.n;
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; i++)
        count += pinned[i];
    system->arena.part = &system->plan.state_bytes;
    system->pinned = cs_arena_alloc_array(&system->arena, count, sizeof *system->pinned, error);
    if (!system->pinned)
        return;
    for (uint32_t i = 0; i < n; i++) {
        system->inv_mass[i] = pinned[i] ? 0 : 1 / system->mass[i];
        if (pinned[i])
            system->pinned[system->n_pinned++] = i;
    }
}

/* Allocates the arrays that a force reads, and lets it build its own. */
static void build_term(struct cs_system *system, const struct cs_term *term,
                       struct cs_error *error) {
    const uint32_t uses = term->uses ? term->uses(system->scene) : 0;
    if (uses & CS_USE_NORMALS && !system->normals)
        system->normals = allocate(system, 3 * (size_t)system->view.n, error);
    if (term->build && !error->status)
        term->build(system, error);
}

/* Builds the forces of the plan, in the order of the list. One that finds nothing to do is
 * taken out of the plan, with its reason. */
static void choose_terms(struct cs_system *system, struct cs_error *error) {
    for (uint32_t k = 0; k < cs_n_terms && !error->status; k++) {
        struct cs_plan_row *row = system->plan.forces + k;
        if (!row->built)
            continue;
        system->arena.part = &row->bytes;
        build_term(system, cs_terms[k], error);
        const char *idle = cs_terms[k]->reason_idle ? cs_terms[k]->reason_idle(system) : NULL;
        row->built = !idle;
        if (idle)
            row->reason = idle;
        else
            system->terms[system->n_terms++] = cs_terms[k];
    }
}

/* Allocates the arrays of particles and describes the bodies' ranges. */
static void alloc_arrays(struct cs_system *system, struct cs_error *error) {
    const size_t n = system->view.n;
    uint32_t first = 0;
    system->arena.part = &system->plan.state_bytes;
    CS_ARENA_ARRAY(&system->arena, system->bodies, system->scene->bodies.n, error);
    system->mass = allocate(system, n, error);
    system->inv_mass = allocate(system, n, error);
    system->state = allocate(system, 6 * n, error);
    system->start = allocate(system, 3 * n, error);
    /* areas only if a force reads them */
    if (begin_feature(system, CS_FEATURE_AREA))
        system->area = allocate(system, n, error);
    if (error->status)
        return;
    system->view.mass = system->mass;
    system->view.inv_mass = system->inv_mass;
    system->view.start = system->start;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body *body = cs_scene_bodies(system->scene) + b;
        system->bodies[b] = (struct cs_body_range){
            first, (uint32_t)cs_body_count(body), (uint32_t)body->cloth.grid[0],
            (uint32_t)body->cloth.grid[1], body->geometry};
        first += system->bodies[b].count;
    }
}

/* Builds in the order above. work has 2n doubles. */
static void build(struct cs_system *system, void *work, struct cs_error *error) {
    alloc_arrays(system, error);
    if (!error->status && begin_feature(system, CS_FEATURE_SPRINGS))
        build_springs(system, error);
    begin_feature(system, CS_FEATURE_THREADS);
    if (!error->status)
        cs_thread_partition_build(system, error);
    if (!error->status && begin_feature(system, CS_FEATURE_SPRING_LIST))
        build_spring_list(system, error);
    if (!error->status && system->plan.colours)
        build_colours(system, error);
    if (!error->status && begin_feature(system, CS_FEATURE_CLUSTERS))
        cs_shape_clusters_build(system, error);
    if (error->status)
        return;
    bool *pinned = work;
    /* masses may depend on the springs at a particle, which are there now */
    cs_system_set_masses(system);
    if (system->area)
        fill_area(system);
    fill_state(system, pinned);
    fill_pins(system, pinned, error);
    if (error->status)
        return;
    /* events choose particles by where they start, so before them */
    memcpy(system->start, system->state, 3 * sizeof(double) * system->view.n);
    choose_terms(system, error);
    if (!error->status && begin_feature(system, CS_FEATURE_FRICTION_ANCHORS))
        cs_friction_anchors_build(system, error);
    if (!error->status && begin_feature(system, CS_FEATURE_CONTACT) &&
        cs_tunnelling_is_possible(system->scene))
        cs_approach_build(system, error);
    if (!error->status && begin_feature(system, CS_FEATURE_CROSSINGS))
        cs_crossings_build(system, error);
    if (error->status)
        return;
    if (begin_feature(system, CS_FEATURE_EVENTS)) {
        if (!cs_events_build(system, error))
            cs_events_set_bounds(system, work);
        return;
    }
    cs_spectral_bounds_set(system, work);
    system->arena.part = &system->plan.state_bytes;
    if (cs_scene_has_key_frames(system->scene))
        cs_event_moves_build(system, error);
}

enum cs_status cs_system_build(struct cs_system *system, const struct cs_scene *scene,
                               const struct cs_plan *plan, struct cs_error *error) {
    *system = (struct cs_system){.scene = scene, .plan = *plan};
    system->view.size = sizeof system->view;
    system->view.n = plan->n;

    /* pin marks first, then the Gershgorin sums of cs_spectral_bounds_set */
    void *work = calloc(plan->n, 2 * sizeof(double));
    if (!work)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %u particles", plan->n);
    else
        build(system, work, error);
    free(work);
    if (error->status)
        cs_system_finish(system);
    return error->status;
}
