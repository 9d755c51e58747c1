/* event_apply.c - the effect of single events on the state, the pins, a value, a collider.
 *
 * An impact gives the selected free particles the momentum J along its direction. All get the
 * same change of velocity, J / m with m their total free mass: a cloth that is hit as a whole
 * moves as a whole. At once the velocities jump; over an interval T a constant acceleration J
 * / (m T) acts. */
#include "model/event/carrier.h"
#include "model/event/event_state.h"

#include "base/vec3.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/system/seams.h"
#include "model/system/shape_clusters.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/body_particles.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <string.h>

void cs_event_mark(const struct cs_system *system, const struct cs_event_target *target) {
    bool *marks = system->events->work;
    memset(marks, 0, system->view.n * sizeof *marks);
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *range = system->bodies + b;
        if (target->body >= 0 && target->body != b)
            continue;
        if (target->particles.n == 0) {
            memset(marks + range->first, true, range->count * sizeof *marks);
            continue;
        }
        struct cs_body body = cs_scene_bodies(system->scene)[b];
        body.pins = target->particles;
        cs_body_pin(&body, system->view.n, range->first, system->start, marks + range->first);
    }
}

/* Mass in kg of the marked particles that are free. */
static double free_mass(const struct cs_system *system) {
    double mass = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        if (system->events->work[i] && system->inv_mass[i] > 0)
            mass += system->mass[i];
    return mass;
}

/* out (3,n) += the change of velocity in m/s of the free particles by a momentum in N s. With
 * a force in N for it, an acceleration in m/s2. */
static void add_impulse(const struct cs_system *system, const struct cs_impact *impact,
                        double momentum, double *out) {
    const size_t n = system->view.n;
    cs_event_mark(system, &impact->target);
    const double mass = free_mass(system);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (system->events->work[i] && system->inv_mass[i] > 0)
                out[c * n + i] += impact->direction[c] * (momentum / mass);
}

/* Computed again from all active events, instead of added and subtracted: no rounding remains
 * when an event ends. */
void cs_event_sum_pushes(struct cs_system *system) {
    struct cs_events *events = system->events;
    if (!system->event_force)
        return;
    memset(system->event_force, 0, 3 * system->view.n * sizeof *system->event_force);
    for (uint32_t e = 0; e < events->scene.events.n; e++) {
        const struct cs_event_state *state = events->states + e;
        const struct cs_impact *impact = &cs_scene_events(&events->scene)[e].impact;
        if (state->active && impact->present)
            add_impulse(system, impact, impact->impulse / (state->end - state->begin),
                        system->event_force);
    }
    if (events->viewpoint_forces)
        cs_viewpoint_forces_add_push(system, system->event_force);
}

/* Pins the marked particles, at rest, and makes the event their holder. A grab sets their
 * velocity afterwards. */
static void pin_marked(struct cs_system *system, uint32_t event) {
    const size_t n = system->view.n;
    for (size_t i = 0; i < n; i++) {
        if (!system->events->work[i])
            continue;
        system->events->held_by[i] = event + 1;
        system->inv_mass[i] = 0;
        for (size_t c = 3; c < 6; c++)
            system->state[c * n + i] = 0;
    }
}

/* Frees a particle; its velocity stays. */
static void unpin(struct cs_system *system, uint32_t i) {
    system->events->held_by[i] = 0;
    system->inv_mass[i] = 1 / system->mass[i];
}

void cs_event_release_tangled(struct cs_system *system, double t) {
    const struct cs_events *events = system->events;
    bool stay = false, meet = false;
    for (uint32_t i = 0; system->tangled && i < system->view.n; i++) {
        const bool carried = events->held_by[i] > events->scene.events.n;
        const bool led = events->tangled[i] == CS_TANGLED_LED_OUT;
        const bool stays = led ? events->untangled > t : carried;
        if (led && !stays && carried)
            unpin(system, i);
        stay |= stays && events->tangled[i];
        meet |= !stays && events->tangled[i];
        events->tangled[i] = stays ? events->tangled[i] : CS_TANGLED_NOT;
    }
    system->tangled = stay ? events->tangled : NULL;
    // their pairs with colliders were left out
    if (meet && system->pairs)
        system->pairs->candidates.is_built = false;
}

/* Opens a seam: frees the particles that a collider carries by it. */
static void unsew(struct cs_system *system, uint32_t seam) {
    const struct cs_events *events = system->events;
    cs_seams_open(system, seam);
    for (uint32_t i = 0; events->seam_of && i < system->view.n; i++)
        if (events->seam_of[i] == seam + 1 && events->held_by[i] > events->scene.events.n)
            unpin(system, i);
}

/* Stores strength and direction of the wind before and after a gust. A number that the gust
 * does not give (NaN) stays. */
static void begin_gust(const struct cs_events *events, const struct cs_wind_change *change,
                       struct cs_event_state *state) {
    const struct cs_wind *wind = &events->scene.forces->wind;
    const bool turns = !isnan(change->direction[0]);
    state->first = wind->strength;
    state->last = isnan(change->strength) ? wind->strength : change->strength;
    memcpy(state->wind_ends[0], wind->direction, sizeof state->wind_ends[0]);
    memcpy(state->wind_ends[1], turns ? change->direction : wind->direction,
           sizeof state->wind_ends[1]);
}

/* Sets the wind at a fraction of a gust: the vector strength x direction is linear in time,
 * so that a gust can turn the wind through any angle. If it passes through 0, the last
 * direction stays. */
static void set_wind(struct cs_wind *wind, const struct cs_event_state *state, double share) {
    double w[3], squared = 0;
    for (int c = 0; c < 3; c++) {
        const double before = state->first * state->wind_ends[0][c];
        w[c] = before + (state->last * state->wind_ends[1][c] - before) * share;
        squared += w[c] * w[c];
    }
    wind->strength = sqrt(squared);
    for (int c = 0; c < 3 && wind->strength > 0; c++)
        wind->direction[c] = w[c] / wind->strength;
}

/* Sets the number of a ramp or gust to its last value, without rounding. */
static void end_value(struct cs_system *system, uint32_t event) {
    struct cs_event_state *state = system->events->states + event;
    struct cs_wind *wind = &system->events->scene.forces->wind;
    if (state->value) {
        *state->value = state->last;
        return;
    }
    wind->strength = state->last;
    memcpy(wind->direction, state->wind_ends[1], sizeof wind->direction);
}

/* A ramp is linear in time; t may lie past its end, see cs_events_move_values. */
void cs_event_set_value(struct cs_system *system, uint32_t event, double t) {
    struct cs_events *events = system->events;
    const struct cs_event_state *state = events->states + event;
    const struct cs_event *of = cs_scene_events(&events->scene) + event;
    const double share = (t - state->begin) / (state->end - state->begin);
    if (of->ramp.present)
        *state->value = state->first + (state->last - state->first) * share;
    else if (of->wind.present)
        set_wind(&events->scene.forces->wind, state, share);
}

void cs_event_start(struct cs_system *system, uint32_t event) {
    struct cs_events *events = system->events;
    struct cs_event_state *state = events->states + event;
    const struct cs_event *of = cs_scene_events(&events->scene) + event;
    state->active = state->end > state->begin;
    if (of->wind.present)
        begin_gust(events, &of->wind, state);
    if (of->ramp.present) {
        state->first = *state->value;
        state->last = of->ramp.value;
    }
    /* at once: the last value now; else cs_event_set_value changes it gradually */
    if ((of->wind.present || of->ramp.present) && !state->active)
        end_value(system, event);
    /* at once: a change of velocity; else a force, see cs_event_sum_pushes */
    if (of->impact.present && !state->active)
        add_impulse(system, &of->impact, of->impact.impulse,
                    system->state + 3 * (size_t)system->view.n);
    if (of->viewpoint_force.present)
        cs_viewpoint_force_start(system, event);
    if (of->grab.present) {
        cs_event_mark(system, &of->grab.target);
        pin_marked(system, event);
        cs_event_begin_grab(system, event);
    }
    if (of->move.present)
        cs_event_begin_move(system, event, events->begin);
    if (of->pin.present) {
        cs_event_mark(system, &of->pin.target);
        pin_marked(system, event);
    }
    if (of->unsew.present)
        unsew(system, (uint32_t)of->unsew.seam);
    if (of->release.present) {
        cs_event_mark(system, &of->release.target);
        for (uint32_t i = 0; i < system->view.n; i++)
            if (events->work[i] && !cs_system_is_led_out(system, i))
                unpin(system, i);
    }
}

/* A particle is freed only by the event that holds it: a later one may have taken it over. */
void cs_event_finish(struct cs_system *system, uint32_t event) {
    struct cs_events *events = system->events;
    const struct cs_event *of = cs_scene_events(&events->scene) + event;
    events->states[event].active = false;
    if (of->ramp.present || of->wind.present)
        end_value(system, event);
    if (of->viewpoint_force.present)
        cs_viewpoint_force_finish(system, event);
    if (of->move.present)
        cs_event_end_move(system, event, events->begin);
    for (uint32_t i = 0; i < system->view.n; i++)
        if (events->held_by[i] == event + 1)
            unpin(system, i);
}

void cs_event_refresh_springs(struct cs_system *system) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    /* the system owns both arrays; its views of them are read-only */
    struct cs_spring_run *runs = (struct cs_spring_run *)system->springs.runs;
    double *stiffness = (double *)system->view.stiffness;
    double *damping = (double *)system->view.damping;
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_law *law = &bodies[runs[r].body].springs;
        cs_springs_stiffen(runs + r, bodies + runs[r].body);
        runs[r].damping = law->damping;
        for (uint32_t i = 0; stiffness && i < runs[r].count; i++) {
            stiffness[runs[r].first + i] = cs_spring_stiffness(runs + r, i);
            damping[runs[r].first + i] = law->damping;
        }
    }
    cs_shape_clusters_refresh(system);
}

/* Makes a pin's collider the holder of a particle; fails if another pin holds it elsewhere. */
static enum cs_status hold(struct cs_system *system, uint32_t b, uint32_t p, uint32_t i,
                           struct cs_error *error) {
    const struct cs_body *body = cs_scene_bodies(system->scene) + b;
    const struct cs_pin *pins = body->pins.items;
    const struct cs_body_range *range = system->bodies + b;
    for (uint32_t k = 0; k < body->pins.n; k++) {
        const bool same = pins[k].to && pins[k].to->collider == pins[p].to->collider;
        if (!same && cs_body_pin_selects(body, pins + k, system->view.n, range->first,
                                         i - range->first, system->start))
            return cs_fail(
                error, CS_ERR_SCENE,
                "bodies[%u].pins[%u].to: pins[%u] holds particle %u of the body too, "
                "but not to collider %lld; expected one pin for each particle",
                b, p, k, i - range->first, (long long)pins[p].to->collider);
    }
    system->events->held_by[i] = system->scene->events.n + 1 + (uint32_t)pins[p].to->collider;
    return CS_OK;
}

enum cs_status cs_event_attach_pins(struct cs_system *system, struct cs_error *error) {
    struct cs_events *events = system->events;
    const uint32_t n = system->view.n, first = system->scene->events.n + 1;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body *body = cs_scene_bodies(system->scene) + b;
        const struct cs_pin *pins = body->pins.items;
        const struct cs_body_range *range = system->bodies + b;
        for (uint32_t p = 0; p < body->pins.n; p++)
            for (uint32_t i = range->first; pins[p].to && i < range->first + range->count; i++)
                if (cs_body_pin_selects(body, pins + p, n, range->first, i - range->first,
                                        system->start) &&
                    hold(system, b, p, i, error))
                    return error->status;
    }
    // the offsets need a collider's frame, one collider after the other
    for (uint32_t k = 0; k < system->scene->colliders.n; k++) {
        for (uint32_t i = 0; i < n; i++)
            events->work[i] = events->held_by[i] == first + k;
        cs_event_store_offsets(system, first + k, events->work, 0);
    }
    // key frames move from the start, before any event
    if (cs_scene_carries_pins(system->scene, true)) {
        cs_event_find_held(system, 0);
        cs_events_apply_paths(system, 0, system->state, system->state + 3 * (size_t)n);
    }
    return CS_OK;
}

/* Refuses events that let particles go on the surface they are sewn to, where contact by force
 * would have all its energy at once. */
static enum cs_status check_opening(struct cs_system *system, struct cs_error *error) {
    const struct cs_events *events = system->events;
    for (uint32_t e = 0; e < system->scene->events.n; e++) {
        const struct cs_event *event = cs_scene_events(system->scene) + e;
        const bool ends = isfinite(event->to),
                   lets_go = event->release.present ||
                             (ends && (event->pin.present || event->grab.present));
        if (lets_go)
            cs_event_mark(system, event->release.present ? &event->release.target
                                  : event->pin.present   ? &event->pin.target
                                                         : &event->grab.target);
        for (uint32_t i = 0; i < system->view.n; i++) {
            const uint32_t seam = events->seam_of[i];
            if (seam && ((lets_go && events->work[i]) ||
                         (event->unsew.present && event->unsew.seam == seam - 1)))
                return cs_fail(error, CS_ERR_SCENE,
                               "events[%u] opens seams[%u] on a surface that contact by force "
                               "keeps clear; expected contact.law project, or no such event",
                               e, seam - 1);
        }
    }
    return CS_OK;
}

/* Gives colliders what is sewn to them, seam by seam. */
enum cs_status cs_event_attach_seams(struct cs_system *system, struct cs_error *error) {
    const struct cs_seam *seams = system->scene->seams.items;
    const size_t n = system->view.n;
    uint32_t *colliders = NULL;
    struct cs_arena arena = {0};
    double *targets = cs_arena_alloc_array(&arena, 3 * n, sizeof *targets, error);
    CS_ARENA_ARRAY(&arena, colliders, n, error);
    CS_ARENA_ARRAY(&system->arena, system->events->seam_of, n, error);
    for (uint32_t s = 0; s < system->scene->seams.n && !error->status; s++) {
        if (seams[s].to.collider < 0 || cs_carrier_sew(system, s, targets, error))
            continue;
        for (size_t i = 0; i < n; i++)
            colliders[i] =
                system->events->seam_of[i] == s + 1 ? (uint32_t)seams[s].to.collider + 1 : 0;
        cs_event_lead(system, colliders, targets, seams[s].closing_time, CS_TANGLED_SEWN,
                      error);
    }
    cs_arena_finish(&arena);
    return error->status || system->scene->contact->law != CS_CONTACT_FORCE
               ? error->status
               : check_opening(system, error);
}

bool cs_events_turn_particles(const struct cs_scene *scene) {
    bool turns = !isnan(scene->contact->untangle) || cs_scene_sews(scene, true), spins = false,
         carries = cs_scene_carries_pins(scene, false);
    for (uint32_t e = 0; e < scene->events.n; e++) {
        const struct cs_grab *grab = &cs_scene_events(scene)[e].grab;
        const struct cs_move *move = &cs_scene_events(scene)[e].move;
        carries |= grab->present && grab->to;
        turns |= grab->present && cs_vec3_dot(grab->spin, grab->spin) > 0;
        spins |= move->present && cs_vec3_dot(move->spin, move->spin) > 0;
    }
    return turns || (carries && (spins || cs_scene_has_key_frames(scene)));
}
