/* held_particles.c - particles whose motion is prescribed: grabs on paths, and particles that a
 * collider carries.
 *
 * A holder is a frame that moves: x = p(t) + R(t) r and v = c' + w x (R r + p - c), with r
 * constant (events->offsets). A grab's p = c is the point of its path, and R turns with its
 * spin w. A collider's are its pose, c the point that it turns about. c is linear between two
 * events; where w is 0, x is so too, and
 * methods move such particles exactly by x + h v. Where w is not 0 the host sets them to x(t)
 * at every time that a method asks about (cs_host_state_at in sim/run_host.h): forces then
 * depend on t, and the order of a method stays.
 *
 * A collider with key frames has no R. The triangle nearest to a particle when it is taken
 * carries it: x = p0 + a (p1 - p0) + b (p2 - p0) + h n with the unit normal n, and (a, b, h)
 * constant.
 *
 * A particle on a way (cs_event_lead) has (a, b, h), or r, that are not constant yet. */
#include "model/event/carrier.h"
#include "model/event/event_state.h"

#include "base/vec3.h"
#include "scene/body_pairs.h"
#include "scene/check.h"
#include "scene/collider_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <string.h>

/* A holder at a time: p in m, its rate in m/s without w, R by rows, w in rad/s. */
struct frame {
    double t, point[3], rate[3], turn[9], spin[3];
    double lever[3]; /* m, from the point of rotation, whose rate it is, to p */
    bool is_turned;  /* R is not the identity, or will not be */
    bool deforms;    /* it is `surface`, with key frames, and the above does not count */
    struct cs_posed_collider collider;
};

static const double no_turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

/* The collider of a holder (number + 1 of an event, or behind the events that of a collider),
 * or -1. */
static int64_t collider_of(const struct cs_events *events, uint32_t holder) {
    const uint32_t n = events->scene.events.n;
    if (holder > n)
        return (int64_t)holder - n - 1;
    const struct cs_grab *grab = &cs_scene_events(&events->scene)[holder - 1].grab;
    return grab->present && grab->to ? grab->to->collider : -1;
}

/* True if particles of this holder are on a path. */
static bool leads(const struct cs_events *events, uint32_t holder) {
    return holder > events->scene.events.n ||
           (holder && cs_scene_events(&events->scene)[holder - 1].grab.present);
}

static void collider_frame(const struct cs_system *system, uint32_t k, double t,
                           struct frame *out) {
    struct cs_posed_collider collider;
    cs_posed_collider_at(system, k, t, &collider);
    out->deforms = collider.collider->paths;
    out->collider = collider;
    memcpy(out->point, collider.centre, sizeof out->point);
    memcpy(out->rate, collider.velocity, sizeof out->rate);
    memcpy(out->spin, collider.spin, sizeof out->spin);
    if (system->motions)
        cs_posed_collider_rotate(system->motions + k, t, out->turn);
    for (int c = 0; c < 3; c++)
        out->lever[c] = collider.centre[c] - collider.rotation_centre[c];
    out->is_turned = memcmp(out->turn, no_turn, sizeof no_turn) ||
                     cs_vec3_dot(collider.spin, collider.spin) > 0;
}

/* Position chord_from + rate (t - chord_begin), and exactly chord_to at its end; with a spin
 * the centre, which is `pivot` from the point of the path. */
static void grab_frame(const struct cs_events *events, uint32_t event, double t,
                       struct frame *out) {
    const struct cs_event_state *state = events->states + event;
    const double *spin = cs_scene_events(&events->scene)[event].grab.spin;
    for (int c = 0; c < 3; c++)
        out->point[c] = (t >= state->chord_end ? state->chord_to[c]
                                               : state->chord_from[c] +
                                                     state->rate[c] * (t - state->chord_begin));
    memcpy(out->rate, state->rate, sizeof out->rate);
    if (!(out->is_turned = cs_vec3_dot(spin, spin) > 0))
        return;
    struct cs_collider_motion motion = {.t_begin = state->begin};
    memcpy(motion.rotation, no_turn, sizeof no_turn);
    memcpy(motion.spin, spin, sizeof motion.spin);
    cs_posed_collider_rotate(&motion, t, out->turn);
    memcpy(out->spin, spin, sizeof out->spin);
    for (int c = 0; c < 3; c++)
        out->point[c] += state->pivot[c];
}

static struct frame frame_at(const struct cs_system *system, uint32_t holder, double t) {
    struct frame out = {.t = t};
    const int64_t collider = collider_of(system->events, holder);
    memcpy(out.turn, no_turn, sizeof no_turn);
    if (collider >= 0)
        collider_frame(system, (uint32_t)collider, t, &out);
    else
        grab_frame(system->events, holder - 1, t, &out);
    return out;
}

/* s at which particle i arrives, if it is on a way; else 0. */
static double arrival_of(const struct cs_events *events, size_t i) {
    return events->arrivals && events->held_by[i] > events->scene.events.n ? events->arrivals[i]
                                                                           : 0;
}

/* Place of particle i in the frame of its holder, and its rate, which is 0 but on a way. */
static void own_at(const struct cs_system *system, const struct frame *frame, size_t i,
                   double own[3], double rate[3]) {
    const struct cs_events *events = system->events;
    const double end = arrival_of(events, i), u = frame->t / end;
    const bool moves = frame->t < end;
    for (size_t c = 0, k = i; c < 3; c++, k += system->view.n) {
        own[c] = events->offsets[k] - (moves ? (1 - u * u * (3 - 2 * u)) * events->ways[k] : 0);
        rate[c] = moves ? 6 * u * (1 - u) / end * events->ways[k] : 0;
    }
}

/* Position and velocity of particle i, which such a surface carries. */
static void deformed_at(const struct cs_system *system, const struct frame *frame, size_t i,
                        double x[3], double v[3]) {
    double own[3], rate[3];
    struct cs_carrier at;
    own_at(system, frame, i, own, rate);
    cs_carrier_at(&frame->collider, system->events->triangles[i], &at);
    for (int c = 0; c < 3; c++) {
        x[c] = at.place[0][c];
        v[c] = at.rate[0][c];
        for (size_t k = 0; k < 3; k++) {
            x[c] += own[k] * at.place[k + 1][c];
            v[c] += own[k] * at.rate[k + 1][c] + rate[k] * at.place[k + 1][c];
        }
    }
}

/* Gives particle i at p to the nearest triangle. */
static void take_triangle(struct cs_system *system, const struct frame *frame, size_t i,
                          const double p[3]) {
    const struct cs_trimesh *mesh = frame->collider.collider->geometry;
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < mesh->n_triangles; k++) {
        struct cs_carrier at;
        double own[3];
        cs_carrier_at(&frame->collider, k, &at);
        const double squared = cs_carrier_find(&at, p, own);
        if (!(squared < least))
            continue;
        least = squared;
        system->events->triangles[i] = k;
    }
}

/* own = place of p in the frame: r = R^T (p - point), or (a, b, h) in particle i's triangle. */
static void locate(const struct cs_system *system, const struct frame *frame, size_t i,
                   const double p[3], double own[3]) {
    const double *m = frame->turn;
    double arm[3];
    struct cs_carrier at;
    for (size_t c = 0; c < 3; c++)
        arm[c] = p[c] - frame->point[c];
    for (size_t c = 0; c < 3; c++)
        own[c] =
            frame->is_turned ? m[c] * arm[0] + m[3 + c] * arm[1] + m[6 + c] * arm[2] : arm[c];
    if (!frame->deforms)
        return;
    cs_carrier_at(&frame->collider, system->events->triangles[i], &at);
    cs_carrier_find(&at, p, own);
}

/* R r of a vector in the frame. */
static void turn(const struct frame *frame, const double r[3], double out[3]) {
    for (size_t c = 0; c < 3; c++)
        out[c] = frame->is_turned ? cs_vec3_dot(frame->turn + 3 * c, r) : r[c];
}

/* Position and velocity of particle i, which a holder carries. */
static void carried_at(const struct cs_system *system, const struct frame *frame, size_t i,
                       double x[3], double v[3]) {
    double own[3], own_rate[3], arm[3], rate[3], turning[3] = {0};
    if (frame->deforms) {
        deformed_at(system, frame, i, x, v);
        return;
    }
    own_at(system, frame, i, own, own_rate);
    turn(frame, own, arm);
    turn(frame, own_rate, rate);
    const double lever[3] = {arm[0] + frame->lever[0], arm[1] + frame->lever[1],
                             arm[2] + frame->lever[2]};
    if (frame->is_turned)
        cs_vec3_cross(frame->spin, lever, turning);
    for (int c = 0; c < 3; c++) {
        x[c] = arm[c] + frame->point[c];
        v[c] = frame->rate[c] + turning[c] + rate[c];
    }
}

void cs_events_apply_paths(const struct cs_system *system, double t, double *x, double *v) {
    const struct cs_events *events = system->events;
    const size_t n = system->view.n;
    struct frame frame = {.spin = {0}};
    uint32_t last = 0;
    for (uint32_t p = 0; events->has_grabs && p < system->n_pinned; p++) {
        const size_t i = system->pinned[p];
        const uint32_t holder = events->held_by[i];
        double place[3], rate[3];
        if (!leads(events, holder))
            continue;
        // neighbours mostly have one holder
        if (holder != last)
            frame = frame_at(system, last = holder, t);
        carried_at(system, &frame, i, place, rate);
        for (size_t c = 0; c < 3; c++) {
            x[c * n + i] = place[c];
            v[c * n + i] = rate[c];
        }
    }
}

void cs_events_apply_arcs(const struct cs_system *system, double t, double *x, double *v) {
    if (system->events && system->events->has_turns)
        cs_events_apply_paths(system, t, x, v);
}

double cs_events_turning_work(const struct cs_system *system, const double *v0,
                              const double *v1) {
    const size_t n = system->view.n;
    const bool turns = system->events && system->events->has_turns;
    double energy = 0;
    for (uint32_t p = 0; turns && p < system->n_pinned; p++)
        for (size_t k = system->pinned[p]; k < 3 * n; k += n)
            energy += 0.5 * system->mass[system->pinned[p]] * (v1[k] * v1[k] - v0[k] * v0[k]);
    return energy;
}

/* Stores the place of particle i at x (3,n) in the frame that takes it. */
static void take(struct cs_system *system, const struct frame *frame, size_t i,
                 const double *x) {
    const size_t n = system->view.n;
    const double p[3] = {x[i], x[n + i], x[2 * n + i]};
    double own[3];
    if (frame->deforms)
        take_triangle(system, frame, i, p);
    locate(system, frame, i, p, own);
    for (size_t c = 0; c < 3; c++)
        system->events->offsets[c * n + i] = own[c];
}

void cs_event_store_offsets(struct cs_system *system, uint32_t holder, const bool *marks,
                            double t) {
    const size_t n = system->view.n;
    const struct frame frame = frame_at(system, holder, t);
    for (size_t i = 0; i < n; i++)
        if (marks[i])
            take(system, &frame, i, system->state);
}

/* m, the mean of the marked particles along one axis. */
static double mean_of(const double *x, const bool *marks, size_t n) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < n; i++)
        if (marks[i])
            sum += x[i], count++;
    return count > 0 ? sum / count : 0;
}

/* The path starts at the first particle, or for a relative grab at the origin: its points are
 * then shifts. */
void cs_event_begin_grab(struct cs_system *system, uint32_t event) {
    struct cs_events *events = system->events;
    struct cs_event_state *state = events->states + event;
    const struct cs_grab *grab = &cs_scene_events(&events->scene)[event].grab;
    const size_t n = system->view.n;
    const bool *first = memchr(events->work, true, n);
    for (size_t c = 0; c < 3; c++) {
        const double *x = system->state + c * n;
        state->chord_to[c] = first && !grab->relative ? x[first - events->work] : 0;
        state->pivot[c] =
            -state->chord_to[c] +
            (isnan(grab->centre[0]) ? mean_of(x, events->work, n) : grab->centre[c]);
    }
    // the frame of a grab is that of a path that has come to its end
    state->chord_end = events->begin;
    cs_event_store_offsets(system, event + 1, events->work, events->begin);
    cs_event_begin_path(state, events->begin);
}

/* m/s, a bound for a particle that key frames carry: that of the vertices by their weights. */
static double deformed_speed(const struct cs_system *system, const struct frame *frame,
                             size_t i) {
    double own[3], rate[3];
    own_at(system, frame, i, own, rate);
    const double weights = 1 + 2 * (fabs(own[0]) + fabs(own[1]));
    return weights * (frame->collider.collider->paths->speed + cs_event_angular_speed(system));
}

void cs_event_find_held(struct cs_system *system, double t) {
    struct cs_events *events = system->events;
    struct frame frame = {.spin = {0}};
    uint32_t last = 0;
    events->has_grabs = events->has_turns = false;
    events->held_speed = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        const uint32_t holder = events->held_by[i];
        double own[3], rate[3], arm[3];
        if (!leads(events, holder))
            continue;
        if (holder != last)
            frame = frame_at(system, last = holder, t);
        const double spin = sqrt(cs_vec3_dot(frame.spin, frame.spin));
        const bool moves = arrival_of(events, i) > t;
        own_at(system, &frame, i, own, rate);
        turn(&frame, own, arm);
        for (int c = 0; c < 3; c++)
            arm[c] += frame.lever[c];
        // of the turning alone: the rates of paths are bounded elsewhere
        events->has_grabs = true;
        events->has_turns |= spin > 0 || frame.deforms || moves;
        events->held_speed =
            fmax(events->held_speed, (frame.deforms ? deformed_speed(system, &frame, i)
                                                    : spin * sqrt(cs_vec3_dot(arm, arm))) +
                                         (moves ? events->way_speed : 0));
    }
}

/* Takes the arrays of ways, and those of carried particles where no event has them. */
static enum cs_status take_ways(struct cs_system *system, struct cs_error *error) {
    struct cs_events *events = system->events;
    struct cs_arena *arena = &system->arena;
    const size_t n = system->view.n;
    if (events->ways)
        return CS_OK;
    if (!events->offsets)
        CS_ARENA_ARRAY(arena, events->offsets, 3 * n, error);
    if (!events->triangles && cs_scene_has_key_frames(system->scene))
        CS_ARENA_ARRAY(arena, events->triangles, n, error);
    CS_ARENA_ARRAY(arena, events->ways, 3 * n, error);
    CS_ARENA_ARRAY(arena, events->arrivals, n, error);
    CS_ARENA_ARRAY(arena, events->tangled, n, error);
    return error->status;
}

/* Leads particle i to its target (3,n) until `end`. */
static void lead(struct cs_system *system, const struct frame *frame, size_t i,
                 const double *targets, double end) {
    struct cs_events *events = system->events;
    const size_t n = system->view.n;
    const double *x = system->state + i, p[3] = {x[0], x[n], x[2 * n]};
    double own[3], squared = 0;
    take(system, frame, i, targets);
    locate(system, frame, i, p, own);
    for (size_t c = 0; c < 3; c++) {
        const size_t k = c * n + i;
        events->ways[k] = events->offsets[k] - own[c];
        squared += (targets[k] - x[c * n]) * (targets[k] - x[c * n]);
    }
    events->arrivals[i] = end;
    // the slope of u^2 (3 - 2 u) is at most 1.5
    if (end > 0)
        events->way_speed = fmax(events->way_speed, 1.5 * sqrt(squared) / end);
    system->inv_mass[i] = 0;
}

enum cs_status cs_event_lead(struct cs_system *system, const uint32_t *colliders,
                             const double *targets, double end, enum cs_tangled why,
                             struct cs_error *error) {
    struct cs_events *events = system->events;
    struct frame frame = {.spin = {0}};
    const size_t n = system->view.n;
    uint32_t last = 0;
    if (take_ways(system, error))
        return error->status;
    end = end > 0 ? cs_event_times_add(events, end) : 0;
    events->untangled = why == CS_TANGLED_LED_OUT ? end : events->untangled;
    for (size_t i = 0; i < n; i++) {
        if (!colliders[i])
            continue;
        events->held_by[i] = system->scene->events.n + colliders[i];
        if (events->held_by[i] != last)
            frame = frame_at(system, last = events->held_by[i], 0);
        lead(system, &frame, i, targets, end);
        events->tangled[i] = (uint8_t)why;
    }
    system->tangled = events->tangled;
    cs_event_list_pinned(system);
    cs_event_find_held(system, 0);
    cs_events_apply_paths(system, 0, system->state, system->state + 3 * n);
    return CS_OK;
}
