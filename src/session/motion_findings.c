/* Finds colliders and held particles that go through each other, by going through all events of
 * a scene without forces. Passed over are colliders that are meshes, and particles that have
 * been free. */
#include "session/scene_findings.h"

#include "base/vec3.h"
#include "model/contact/posed_collider.h"
#include "model/event/events.h"

#include <math.h>
#include <string.h>

/* Times in a segment, and particles and times in all, at which held particles are sought in
 * colliders. */
enum { POSES = 256, POSES_MAX = 300000, TRIES = 4 };
/* Way between two such times over that depth: a path that is this deep in a round collider is
 * in it for eight times as long. */
#define STEP 4.0
/* Depth over the size of a collider, or in a plane of the first body, that a held particle may
 * have. */
#define SWEPT 0.1
#define SUNK  0.02

/* The first time at which a held particle is in a collider. */
struct entry {
    double at, clear; /* s: HUGE_VAL: never; when nothing was near before, NaN: never */
    uint32_t particle, holder, event; /* of what moves: number + 1; 0: none */
    double leg_start[3];              /* m, where the leg of its path began */
    uint32_t leg;
};

/* Keeps a collider and a particle apart: another point of a leg, or an earlier end. */
struct cure {
    uint32_t event, leg; /* number + 1; 0: none is known */
    double point[3], to; /* m; s, NaN: the point is meant */
};

/* All events of a scene, without forces. */
struct rehearsal {
    struct cs_system system;          /* a second one, whose events happen */
    const struct cs_system *start;    /* the first */
    struct cs_posed_collider *before; /* (colliders.n) at the start */
    struct entry *entries;            /* (colliders.n) */
    bool *held;                       /* (n) all the time up to now */
};

/* m, depth in a collider that counts. */
static double depth_of(const struct cs_system *system,
                       const struct cs_posed_collider *collider) {
    const double *core = collider->half_sizes;
    double low[3], high[3];
    if (cs_shape_is_endless(collider->shape))
        return SUNK * cs_findings_box(system, 0, low, high);
    return SWEPT *
           (collider->radius > 0 ? collider->radius : fmin(core[0], fmin(core[1], core[2])));
}

/* Number + 1 of the event that moves collider k, or else the holder of a particle; 0: none. */
static uint32_t mover_of(const struct cs_system *system, uint32_t k, uint32_t holder) {
    const struct cs_collider_motion *motions = system->motions;
    const uint32_t n = system->scene->events.n;
    if (motions && motions[k].event)
        return motions[k].event;
    return holder <= n ? holder : motions ? motions[holder - n - 1].event : 0;
}

/* Looks for held particles in collider k at t. What began in it is passed over. */
static void look_into(struct rehearsal *rehearsal, uint32_t k, double t) {
    const struct cs_system *system = &rehearsal->system;
    const struct cs_events *events = system->events;
    const size_t n = system->view.n;
    struct entry *entry = rehearsal->entries + k;
    struct cs_posed_collider now;
    double normal[3];
    cs_posed_collider_at(system, k, t, &now);
    const double depth = depth_of(rehearsal->start, &now);
    bool clear = true;
    for (uint32_t p = 0; p < system->n_pinned && !(entry->at < t); p++) {
        const size_t i = system->pinned[p];
        const double *x = system->state + i, *x0 = rehearsal->start->start + i;
        const double to[3] = {x[0], x[n], x[2 * n]}, from[3] = {x0[0], x0[n], x0[2 * n]};
        if (!rehearsal->held[i] || events->held_by[i] == system->scene->events.n + 1 + k ||
            !cs_posed_collider_is_near(&now, depth, to) ||
            cs_posed_collider_distance(rehearsal->before + k, from, normal) < 0)
            continue;
        const double distance = cs_posed_collider_distance(&now, to, normal);
        clear &= distance > depth;
        if (distance > -depth)
            continue;
        // what leads it there
        entry->at = t;
        entry->particle = (uint32_t)i;
        entry->holder = events->held_by[i];
        entry->event = mover_of(system, k, entry->holder);
        if (entry->event) {
            const struct cs_event_state *state = events->states + entry->event - 1;
            memcpy(entry->leg_start, state->leg_start, sizeof entry->leg_start);
            entry->leg = state->leg;
        }
        return;
    }
    if (clear && entry->at == HUGE_VAL)
        entry->clear = t;
}

/* Goes through a segment, by small steps beside the colliders. */
static void go_through(struct rehearsal *rehearsal, double from, double to) {
    struct cs_system *system = &rehearsal->system;
    const uint32_t n = system->scene->colliders.n;
    // by the thinnest of the colliders
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < n; k++)
        if (rehearsal->before[k].shape->bounds != CS_BOUNDS_MESH)
            least = fmin(least, depth_of(rehearsal->start, rehearsal->before + k));
    const double most =
        POSES_MAX / (1.0 + (double)n * system->n_pinned * system->events->n_times);
    const double poses =
        fmax(1, fmin(fmax(fmin(most, POSES), 4),
                     ceil(cs_events_speed(system) * (to - from) / (STEP * least))));
    for (double p = 1; p <= poses; p++) {
        const double t = from + (to - from) * (p / poses);
        cs_events_apply_paths(system, t, system->state,
                              system->state + 3 * (size_t)system->view.n);
        for (uint32_t k = 0; k < n; k++)
            if (rehearsal->before[k].shape->bounds != CS_BOUNDS_MESH)
                look_into(rehearsal, k, t);
    }
}

/* Lets all events of the system happen, and fills the entries. */
static void go(struct rehearsal *rehearsal, double seconds) {
    struct cs_system *system = &rehearsal->system;
    const struct cs_events *events = system->events;
    const double last = events->times[events->n_times - 1];
    const double end = last < HUGE_VAL ? fmax(last, seconds) : seconds;
    for (uint32_t k = 0; k < system->scene->colliders.n; k++)
        rehearsal->entries[k] = (struct entry){.at = HUGE_VAL, .clear = (double)NAN};
    memset(rehearsal->held, true, system->view.n * sizeof *rehearsal->held);
    // segment by segment
    for (double t = 0, next; t < end; t = next) {
        while (events->end <= t)
            cs_events_apply(system, t);
        for (uint32_t i = 0; i < system->view.n; i++)
            rehearsal->held[i] &= system->inv_mass[i] == 0;
        next = fmin(events->end, end);
        go_through(rehearsal, t, next);
    }
}

/* Goes through the events of a scene with a cure. */
static enum cs_status rehearse(const struct cs_session *session, double seconds,
                               const struct cure *cure, struct rehearsal *rehearsal,
                               struct cs_error *error) {
    if (cs_system_build(&rehearsal->system, session->scene, &session->plan, error))
        return error->status;
    struct cs_events *events = rehearsal->system.events;
    struct cs_event *event =
        cure->event ? (struct cs_event *)events->scene.events.items + cure->event - 1 : NULL;
    struct cs_path_point *leg = NULL, point;
    const double to = event ? event->to : 0;
    if (event && !isnan(cure->to)) {
        event->to = cure->to;
        cs_event_times_fill(events);
        events->end = events->times[0];
    } else if (event) {
        leg = (struct cs_path_point *)cs_event_path_of(event).points + cure->leg;
        point = *leg;
        memcpy(leg->point, cure->point, sizeof leg->point);
    }
    go(rehearsal, seconds);
    // events are the scene's own
    if (event)
        event->to = to;
    if (leg)
        *leg = point;
    cs_system_finish(&rehearsal->system);
    return CS_OK;
}

/* Cuts the leg, or the turn, where nothing was near before an entry. Returns false if that
 * cannot be. */
static bool propose(const struct cs_scene *scene, const struct entry *entry,
                    struct cure *cure) {
    if (!entry->event || isnan(entry->clear) ||
        (cure->event && (cure->event != entry->event || cure->leg != entry->leg)))
        return false;
    const struct cs_event *event = cs_scene_events(scene) + entry->event - 1;
    const struct cs_event_path path = cs_event_path_of(event);
    const double *spin = event->move.present ? event->move.spin : event->grab.spin;
    const double *from = entry->leg_start;
    const uint32_t leg = entry->leg;
    const double begin = leg ? path.points[leg - 1].at : cs_event_begin(event);
    if (path.n ? leg >= path.n || !cs_vec3_is_zero(spin) : !(entry->clear > begin))
        return false;
    // a second try cuts the leg of the first
    if (!cure->event && path.n)
        memcpy(cure->point, path.points[leg].point, sizeof cure->point);
    cure->event = entry->event;
    cure->leg = leg;
    cure->to = path.n ? (double)NAN : entry->clear;
    if (!path.n)
        return true;
    const double u = (entry->clear - begin) / (path.points[leg].at - begin),
                 part = path.n_chords > 1 ? u * u * (3 - 2 * u) : u;
    for (int c = 0; c < 3; c++)
        cure->point[c] = from[c] + part * (cure->point[c] - from[c]);
    return u > 0;
}

/* Looks for a cure of the first entry, and tries it. */
static enum cs_status find_cure(const struct cs_session *session, double seconds, uint32_t k,
                                struct rehearsal *rehearsal, struct cure *cure,
                                struct cs_error *error) {
    for (int tries = 0; tries < TRIES; tries++) {
        if (!propose(session->scene, rehearsal->entries + k, cure) ||
            rehearse(session, seconds, cure, rehearsal, error))
            break;
        // a later leg is told after this one
        if (!(rehearsal->entries[k].at < HUGE_VAL) || rehearsal->entries[k].leg > cure->leg)
            return CS_OK;
    }
    cure->event = 0;
    return error->status;
}

/* A collider that goes through particles that are held, or they through it. */
static void print(const struct cs_system *system, uint32_t k, const struct entry *entry,
                  struct cs_text *out) {
    const uint32_t n = system->scene->events.n, h = entry->holder;
    const uint32_t b = cs_system_body_of(system, entry->particle);
    if (entry->event)
        cs_text_add(out, "events[%u]: ", entry->event - 1);
    cs_text_add(out, "colliders[%u] goes at %.4g s through particle %u of bodies[%u], which ",
                k, entry->at, entry->particle - system->bodies[b].first, b);
    if (h)
        cs_text_add(out, h > n ? "colliders[%u] holds" : "events[%u] holds",
                    h > n ? h - n - 1 : h - 1);
    cs_text_add(out, "%s: contact cannot keep them apart", h ? "" : "pins hold");
}

/* Ends the line with the cure, and on how many more colliders there are. */
static void print_end(const struct cure *cure, uint32_t more, struct cs_text *out) {
    const double *p = cure->point;
    if (cure->event && isnan(cure->to))
        cs_text_add(out, "; they stay apart with path[%u].point [%.4g, %.4g, %.4g]", cure->leg,
                    p[0], p[1], p[2]);
    else if (cure->event)
        cs_text_add(out, "; they stay apart with \"to\": %.4g", cure->to);
    if (more)
        cs_text_add(out, "; the same holds for %u more", more);
    cs_text_add(out, "\n");
}

void cs_motion_findings_print(const struct cs_session *session, double seconds,
                              struct cs_text *out) {
    const struct cs_system *system = &session->system;
    const uint32_t n = system->scene->colliders.n;
    struct rehearsal rehearsal = {.start = system};
    struct cure cure = {0};
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    // a grab may hold from the start on what no pin does
    if (!n || !system->events ||
        !(system->events->offsets || (system->motions && system->n_pinned)))
        return;
    CS_ARENA_ARRAY(&arena, rehearsal.before, n, &error);
    CS_ARENA_ARRAY(&arena, rehearsal.entries, n, &error);
    CS_ARENA_ARRAY(&arena, rehearsal.held, system->view.n, &error);
    if (!error.status)
        cs_posed_colliders_at_start(system, rehearsal.before);
    // the first collider is told, and how many more there are
    uint32_t k = 0, more = 0;
    if (!error.status && !rehearse(session, seconds, &cure, &rehearsal, &error)) {
        for (uint32_t later = n; later-- > 0;)
            if (rehearsal.entries[later].at < HUGE_VAL) {
                k = later;
                more++;
            }
        const struct entry entry = rehearsal.entries[k];
        if (more) {
            print(system, k, &entry, out);
            find_cure(session, seconds, k, &rehearsal, &cure, &error);
            print_end(&cure, more - 1, out);
        }
    }
    out->failed |= error.status != CS_OK;
    cs_arena_finish(&arena);
}
