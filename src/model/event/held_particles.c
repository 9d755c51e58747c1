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
 * constant. */
#include "model/event/carrier.h"
#include "model/event/event_state.h"

#include "base/vec3.h"
#include "model/contact/posed_collider.h"
#include "scene/body_pairs.h"
#include "scene/shape.h"

#include <math.h>
#include <string.h>

/* A holder at a time: p in m, its rate in m/s without w, R by rows, w in rad/s. */
struct frame {
    double point[3], rate[3], turn[9], spin[3];
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
    return grab->present && grab->to.present ? grab->to.collider : -1;
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
    out->deforms = collider.collider->mesh.paths;
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
    struct frame out = {.spin = {0}};
    const int64_t collider = collider_of(system->events, holder);
    memcpy(out.turn, no_turn, sizeof no_turn);
    if (collider >= 0)
        collider_frame(system, (uint32_t)collider, t, &out);
    else
        grab_frame(system->events, holder - 1, t, &out);
    return out;
}

/* Position and velocity of particle i, which such a surface carries. */
static void deformed_at(const struct cs_system *system, const struct frame *frame, size_t i,
                        double x[3], double v[3]) {
    const size_t n = system->view.n;
    const double *own = system->events->offsets + i;
    struct cs_carrier at;
    cs_carrier_at(&frame->collider, system->events->triangles[i], &at);
    for (int c = 0; c < 3; c++) {
        x[c] = at.place[0][c];
        v[c] = at.rate[0][c];
        for (size_t k = 0; k < 3; k++) {
            x[c] += own[k * n] * at.place[k + 1][c];
            v[c] += own[k * n] * at.rate[k + 1][c];
        }
    }
}

/* Gives particle i at p to the nearest triangle. */
static void take_triangle(struct cs_system *system, const struct frame *frame, size_t i,
                          const double p[3]) {
    const struct cs_trimesh *mesh = frame->collider.collider->mesh.geometry;
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
        for (size_t c = 0; c < 3; c++)
            system->events->offsets[c * system->view.n + i] = own[c];
    }
}

/* arm = R r of particle i, in m. */
static void arm_of(const struct cs_system *system, const struct frame *frame, size_t i,
                   double arm[3]) {
    const size_t n = system->view.n;
    const double *offsets = system->events->offsets;
    const double r[3] = {offsets[i], offsets[n + i], offsets[2 * n + i]};
    memcpy(arm, r, sizeof r);
    for (size_t c = 0; c < 3 && frame->is_turned; c++)
        arm[c] = cs_vec3_dot(frame->turn + 3 * c, r);
}

/* Position and velocity of particle i, which a holder carries. */
static void carried_at(const struct cs_system *system, const struct frame *frame, size_t i,
                       double x[3], double v[3]) {
    double arm[3], turning[3] = {0};
    if (frame->deforms) {
        deformed_at(system, frame, i, x, v);
        return;
    }
    arm_of(system, frame, i, arm);
    const double lever[3] = {arm[0] + frame->lever[0], arm[1] + frame->lever[1],
                             arm[2] + frame->lever[2]};
    if (frame->is_turned)
        cs_vec3_cross(frame->spin, lever, turning);
    for (int c = 0; c < 3; c++) {
        x[c] = arm[c] + frame->point[c];
        v[c] = frame->rate[c] + turning[c];
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

/* r = R^T (x - p) for the marked particles at time t. */
static void store_offsets(struct cs_system *system, uint32_t holder, const bool *marks,
                          double t) {
    const size_t n = system->view.n;
    const struct frame frame = frame_at(system, holder, t);
    const double *m = frame.turn;
    for (size_t i = 0; i < n; i++) {
        const double *x = system->state + i;
        double arm[3];
        if (!marks[i])
            continue;
        for (size_t c = 0; c < 3; c++)
            arm[c] = x[c * n] - frame.point[c];
        if (frame.deforms)
            take_triangle(system, &frame, i, (const double[3]){x[0], x[n], x[2 * n]});
        for (size_t c = 0; c < 3 && !frame.deforms; c++)
            system->events->offsets[c * n + i] =
                frame.is_turned ? m[c] * arm[0] + m[3 + c] * arm[1] + m[6 + c] * arm[2]
                                : arm[c];
    }
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
    store_offsets(system, event + 1, events->work, events->begin);
    cs_event_begin_path(state, events->begin);
}

/* Makes a pin's collider the holder of a particle; fails if another pin holds it elsewhere. */
static enum cs_status hold(struct cs_system *system, uint32_t b, uint32_t p, uint32_t i,
                           struct cs_error *error) {
    const struct cs_body *body = cs_scene_bodies(system->scene) + b;
    const struct cs_pin *pins = body->pins.items;
    const struct cs_body_range *range = system->bodies + b;
    for (uint32_t k = 0; k < body->pins.n; k++) {
        const bool same = pins[k].to.present && pins[k].to.collider == pins[p].to.collider;
        if (!same && cs_shape_pin_selects(body, pins + k, system->view.n, range->first,
                                          i - range->first, system->start))
            return cs_fail(
                error, CS_ERR_SCENE,
                "bodies[%u].pins[%u].to: pins[%u] holds particle %u of the body too, "
                "but not to collider %lld; expected one pin for each particle",
                b, p, k, i - range->first, (long long)pins[p].to.collider);
    }
    system->events->held_by[i] = system->scene->events.n + 1 + (uint32_t)pins[p].to.collider;
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
            for (uint32_t i = range->first;
                 pins[p].to.present && i < range->first + range->count; i++)
                if (cs_shape_pin_selects(body, pins + p, n, range->first, i - range->first,
                                         system->start) &&
                    hold(system, b, p, i, error))
                    return error->status;
    }
    // the offsets need a collider's frame, one collider after the other
    for (uint32_t k = 0; k < system->scene->colliders.n; k++) {
        for (uint32_t i = 0; i < n; i++)
            events->work[i] = events->held_by[i] == first + k;
        store_offsets(system, first + k, events->work, 0);
    }
    // key frames move from the start, before any event
    if (cs_scene_carries_pins(system->scene, true)) {
        cs_event_find_held(system, 0);
        cs_events_apply_paths(system, 0, system->state, system->state + 3 * (size_t)n);
    }
    return CS_OK;
}

bool cs_events_turn_particles(const struct cs_scene *scene) {
    bool turns = false, carries = cs_scene_carries_pins(scene, false), spins = false;
    for (uint32_t e = 0; e < scene->events.n; e++) {
        const struct cs_grab *grab = &cs_scene_events(scene)[e].grab;
        const struct cs_move *move = &cs_scene_events(scene)[e].move;
        carries |= grab->present && grab->to.present;
        turns |= grab->present && cs_vec3_dot(grab->spin, grab->spin) > 0;
        spins |= move->present && cs_vec3_dot(move->spin, move->spin) > 0;
    }
    return turns || (carries && (spins || cs_scene_has_key_frames(scene)));
}

/* m/s, a bound for a particle that key frames carry: that of the vertices by their weights. */
static double deformed_speed(const struct cs_system *system, const struct frame *frame,
                             size_t i) {
    const double *own = system->events->offsets + i;
    const double weights = 1 + 2 * (fabs(own[0]) + fabs(own[system->view.n]));
    return weights *
           (frame->collider.collider->mesh.paths->speed + cs_event_angular_speed(system));
}

void cs_event_find_held(struct cs_system *system, double t) {
    struct cs_events *events = system->events;
    struct frame frame = {.spin = {0}};
    uint32_t last = 0;
    events->has_grabs = events->has_turns = false;
    events->held_speed = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        const uint32_t holder = events->held_by[i];
        double arm[3];
        if (!leads(events, holder))
            continue;
        if (holder != last)
            frame = frame_at(system, last = holder, t);
        const double spin = sqrt(cs_vec3_dot(frame.spin, frame.spin));
        arm_of(system, &frame, i, arm);
        for (int c = 0; c < 3; c++)
            arm[c] += frame.lever[c];
        // of the turning alone: the rates of paths are bounded elsewhere
        events->has_grabs = true;
        events->has_turns |= spin > 0 || frame.deforms;
        events->held_speed =
            fmax(events->held_speed, frame.deforms ? deformed_speed(system, &frame, i)
                                                   : spin * sqrt(cs_vec3_dot(arm, arm)));
    }
}
