/* event_move.c - colliders on paths: turns the chords of an event into the motion of its
 * collider.
 *
 * A motion is a shift, linear in time from shift_begin to shift_end, and a rotation: a fixed
 * one up to t_begin, then a constant spin. Each new chord stores the rotation that was
 * reached. */
#include "model/event/event_state.h"

#include "base/vec3.h"
#include "model/contact/posed_collider.h"
#include "scene/body_pairs.h"
#include "scene/force_keys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* No shift, no spin, the unit rotation, for ever. */
static const struct cs_collider_motion at_rest = {.t_end = HUGE_VAL,
                                                  .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};

bool cs_event_moves_any(const struct cs_scene *scene) {
    if (cs_scene_has_key_frames(scene))
        return true;
    for (uint32_t e = 0; e < scene->events.n; e++)
        if ((cs_scene_events(scene)[e].move.present && scene->colliders.n > 0) ||
            cs_event_grows(cs_scene_events(scene) + e))
            return true;
    return false;
}

enum cs_status cs_event_moves_build(struct cs_system *system, struct cs_error *error) {
    const uint32_t n = system->scene->colliders.n;
    system->motions = cs_arena_alloc_array(&system->arena, n, sizeof *system->motions, error);
    CS_ARENA_ARRAY(&system->arena, system->collider_motion, 9 * (size_t)n, error);
    if (error->status)
        return error->status;
    for (uint32_t k = 0; k < n; k++)
        system->motions[k] = at_rest;
    system->view.n_colliders = n;
    system->view.collider_origin = system->collider_motion;
    system->view.collider_velocity = system->collider_motion + 3 * (size_t)n;
    system->view.collider_spin = system->collider_motion + 6 * (size_t)n;
    cs_event_show_moves(system);
    return CS_OK;
}

void cs_event_show_moves(struct cs_system *system) {
    const size_t n = system->view.n_colliders;
    for (uint32_t k = 0; k < n; k++) {
        const double since = system->motions[k].t_begin;
        double *shown = system->collider_motion + 3 * (size_t)k;
        struct cs_posed_collider collider;
        cs_posed_collider_at(system, k, since, &collider);
        for (int c = 0; c < 3; c++) {
            shown[c] = collider.rotation_centre[c] - since * collider.velocity[c];
            shown[3 * n + c] = collider.velocity[c];
            shown[6 * n + c] = collider.spin[c];
        }
    }
}

/* The keys of a move in the scene. */
static const struct cs_move *move_of(const struct cs_system *system, uint32_t event) {
    return &cs_scene_events(system->scene)[event].move;
}

/* The motion of the collider that an event moves; NULL if the collider was removed from the
 * scene, as compare does. */
static struct cs_collider_motion *motion_of(const struct cs_system *system, uint32_t event) {
    return system->motions ? system->motions + move_of(system, event)->collider : NULL;
}

/* Stops a collider at t, with the shift and rotation that it has then. */
static void stop(struct cs_collider_motion *motion, double t) {
    struct cs_collider_motion stopped = at_rest;
    stopped.t_begin = t;
    cs_posed_collider_translate(motion, t, stopped.shift_begin);
    cs_posed_collider_rotate(motion, t, stopped.rotation);
    // where the centre has come to about another point
    for (int c = 0; c < 3; c++)
        stopped.shift_begin[c] +=
            motion->pivot[c] + cs_vec3_dot(stopped.rotation + 3 * (size_t)c, motion->arm);
    memcpy(stopped.shift_end, stopped.shift_begin, sizeof stopped.shift_end);
    *motion = stopped;
}

/* Sets the point that a stopped collider turns about from t on. */
static void turn_about(const struct cs_system *system, const struct cs_move *move, double t,
                       struct cs_collider_motion *motion) {
    const double *m = motion->rotation;
    struct cs_posed_collider collider;
    if (isnan(move->centre[0]))
        return;
    cs_posed_collider_at(system, (uint32_t)move->collider, t, &collider);
    for (int c = 0; c < 3; c++)
        motion->pivot[c] = move->centre[c] - collider.centre[c];
    for (int c = 0; c < 3; c++)
        motion->arm[c] = -(m[c] * motion->pivot[0] + m[3 + c] * motion->pivot[1] +
                           m[6 + c] * motion->pivot[2]);
}

/* Sets where a path begins and the shift of its origin: of a relative one the present position,
 * else that which puts the centre of its rotation at the world's origin. */
static void begin_path_at(const struct cs_system *system, const struct cs_move *move, double t,
                          const struct cs_collider_motion *motion,
                          struct cs_event_state *state) {
    struct cs_posed_collider collider;
    memcpy(state->origin, motion->shift_begin, sizeof state->origin);
    memset(state->chord_to, 0, sizeof state->chord_to);
    if (move->relative)
        return;
    cs_posed_collider_at(system, (uint32_t)move->collider, t, &collider);
    for (int c = 0; c < 3; c++) {
        state->origin[c] = motion->shift_begin[c] - collider.rotation_centre[c];
        state->chord_to[c] = collider.rotation_centre[c];
    }
}

void cs_event_begin_move(struct cs_system *system, uint32_t event, double t) {
    struct cs_event_state *state = system->events->states + event;
    struct cs_collider_motion *motion = motion_of(system, event);
    if (!motion)
        return;
    stop(motion, t);
    motion->event = event + 1;
    turn_about(system, move_of(system, event), t, motion);
    memcpy(motion->spin, move_of(system, event)->spin, sizeof motion->spin);
    begin_path_at(system, move_of(system, event), t, motion, state);
    cs_event_begin_path(state, t);
}

void cs_event_end_move(struct cs_system *system, uint32_t event, double t) {
    struct cs_collider_motion *motion = motion_of(system, event);
    if (!motion)
        return;
    memset(system->events->states[event].rate, 0, sizeof system->events->states[event].rate);
    system->events->states[event].chord_end = HUGE_VAL;
    if (motion->event == event + 1)
        stop(motion, t);
}

void cs_event_follow_move(struct cs_system *system, uint32_t event, double t) {
    const struct cs_event_state *state = system->events->states + event;
    struct cs_collider_motion *motion = motion_of(system, event);
    if (!motion || motion->event != event + 1 || state->chord_begin != t)
        return;
    double turn[9];
    cs_posed_collider_rotate(motion, t, turn);
    memcpy(motion->rotation, turn, sizeof turn);
    motion->t_begin = t;
    motion->t_end = state->chord_end;
    for (int c = 0; c < 3; c++) {
        motion->shift_begin[c] = state->origin[c] + state->chord_from[c];
        motion->shift_end[c] = state->origin[c] + state->chord_to[c];
        motion->rate[c] = state->rate[c];
    }
}

void cs_event_follow_growth(struct cs_system *system) {
    const struct cs_events *events = system->events;
    for (uint32_t k = 0; system->motions && k < system->scene->colliders.n; k++) {
        system->motions[k].radius_changes = false;
        system->motions[k].growth = 0;
    }
    for (uint32_t e = 0; system->motions && e < events->scene.events.n; e++) {
        const struct cs_event *event = cs_scene_events(&events->scene) + e;
        const struct cs_event_state *state = events->states + e;
        if (!state->active || !cs_event_grows(event))
            continue;
        const char *index = strchr(event->ramp.key, '[') + 1;
        struct cs_collider_motion *motion = system->motions + strtoul(index, NULL, 10);
        const double rate = (state->last - state->first) / (state->end - state->begin);
        motion->growth += rate;
        if (!strstr(event->ramp.key, ".radius"))
            continue;
        motion->radius_changes = true;
        motion->t_growth = state->begin;
        motion->radius_begin = state->first;
        motion->radius_rate = rate;
    }
}

/* m, from the centre to the farthest point of a collider: the half diagonal of its core plus
 * its radius. Of a plane, which has none, to the farthest particle. */
static double reach_of(const struct cs_system *system,
                       const struct cs_posed_collider *collider) {
    const size_t n = system->view.n;
    if (!cs_shape_is_endless(collider->shape))
        return cs_vec3_length(collider->half_sizes) + collider->radius;
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        double p[3];
        cs_point_read(system->state, n, i, p);
        most = fmax(most, cs_vec3_distance(p, collider->centre));
    }
    return most;
}

double cs_event_angular_speed(const struct cs_system *system) {
    double speed = 0;
    for (uint32_t k = 0; system->motions && k < system->scene->colliders.n; k++) {
        const struct cs_collider_motion *motion = system->motions + k;
        const double rate = cs_vec3_length(motion->spin);
        struct cs_posed_collider collider;
        if (rate == 0)
            continue;
        cs_posed_collider_at(system, k, motion->t_begin, &collider);
        speed = fmax(speed, rate * (reach_of(system, &collider) +
                                    sqrt(cs_vec3_dot(motion->arm, motion->arm))));
    }
    return speed;
}

/* Follows the paths of grabs and moves, chord by chord.
 *
 * A smooth leg from p0 to p1 is p0 + (p1 - p0) w(s), w(s) = 3 s^2 - 2 s^3, s from 0 to 1: it
 * starts and ends at rest. It is cut into CS_EVENT_CHORDS chords of equal duration and
 * constant velocity. A method then sees no acceleration of the pinned particles within a
 * segment. */

/* The point at the end of the running chord; at the end of a leg its point exactly. */
static void chord_point(const struct cs_event_path *path, const struct cs_event_state *state,
                        double out[3]) {
    const double *point = path->points[state->leg].point;
    const double s = (state->chord + 1) / (double)CS_EVENT_CHORDS;
    const bool whole = state->chord + 1 == path->n_chords;
    for (int c = 0; c < 3; c++)
        out[c] = whole ? point[c]
                       : state->leg_start[c] +
                             (point[c] - state->leg_start[c]) * (s * s * (3 - 2 * s));
}

void cs_event_begin_path(struct cs_event_state *state, double t) {
    /* the end of a leg before the first: cs_event_next_leg goes on from there */
    memcpy(state->leg_start, state->chord_to, sizeof state->leg_start);
    state->leg = 0;
    state->chord = UINT32_MAX;
    state->chord_end = t;
}

void cs_event_next_leg(struct cs_events *events, uint32_t event, double t) {
    struct cs_event_state *state = events->states + event;
    const struct cs_event_path path = cs_event_path_of(cs_scene_events(&events->scene) + event);
    if (state->begin > t || state->chord_end > t)
        return;
    memcpy(state->chord_from, state->chord_to, sizeof state->chord_from);
    memset(state->rate, 0, sizeof state->rate);
    state->chord_begin = t;
    state->chord_end = HUGE_VAL;
    /* the leg is done: the next one begins where it ends */
    if (++state->chord == path.n_chords) {
        memcpy(state->leg_start, state->chord_to, sizeof state->leg_start);
        state->chord = 0;
        state->leg++;
    }
    /* after the last point it stays there */
    if (state->leg >= path.n)
        return;
    chord_point(&path, state, state->chord_to);
    state->chord_end = cs_event_chord_end(events, event, state->leg, state->chord);
    for (int c = 0; c < 3; c++)
        state->rate[c] = (state->chord_to[c] - state->chord_from[c]) / (state->chord_end - t);
}
