/* Finds mistakes in pins, grabs, seams and moves, whose motion is known before a run; passages
 * through colliders are in motion_findings.c. Only what is certain is reported. Passed over are
 * colliders that are meshes, and particles that have been free. */
#include "session/scene_findings.h"

#include "base/vec3.h"
#include "model/event/event_state.h"
#include "model/system/seams.h"
#include "scene/body_keys.h"
#include "scene/body_particles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Length of a stitch at the start over the size of its body that is reported. */
#define GAP_MAX 1.0
/* Way to a collider over the size of a body that a seam may close at once. */
#define CLOSED 0.02
/* Distance of two held particles over that in the sheet at rest that is reported: that of
 * "beyond cloth". */
#define APART_MAX 1.5
/* Length of a leg of positions over that of the same numbers as shifts that is reported, and
 * the part of a body's size that such a leg has at least. */
#define JUMP_RATIO 3.0
#define JUMP_SIZE  0.25

/* Pins that hold no particle. */
static void check_pins(const struct cs_system *system, uint32_t b, const void *arg,
                       struct cs_text *out) {
    (void)arg;
    const struct cs_body *body = cs_scene_bodies(system->scene) + b;
    const struct cs_body_range *range = system->bodies + b;
    const struct cs_pin *pins = body->pins.items;
    double low[3], high[3];
    for (uint32_t p = 0; p < body->pins.n; p++) {
        uint32_t i = 0;
        while (i < range->count && !cs_body_pin_selects(body, pins + p, system->view.n,
                                                        range->first, i, system->start))
            i++;
        if (i < range->count)
            continue;
        cs_findings_box(system, b, low, high);
        cs_text_add(out,
                    "bodies[%u].pins[%u] holds no particle: the body lies between (%.4g, %.4g, "
                    "%.4g) and (%.4g, %.4g, %.4g)",
                    b, p, low[0], low[1], low[2], high[0], high[1], high[2]);
        return;
    }
}

/* A stitch that is longer at the start than each of the bodies that it joins. */
static void check_seams(const struct cs_system *system, struct cs_text *out) {
    const struct cs_seams *seams = system->seams;
    for (uint32_t s = 0; seams && s < seams->n; s++) {
        const struct cs_stitch *stitch = seams->stitches + s;
        const uint32_t a = cs_system_body_of(system, stitch->at[0]),
                       b = cs_system_body_of(system, stitch->at[1]);
        double low[3], high[3], d[3];
        cs_stitch_difference(stitch, system->view.n, system->state, d);
        /* one that breaks is meant to be too long */
        const double longer = sqrt(cs_vec3_dot(d, d)) - stitch->length;
        if (longer > GAP_MAX * fmax(cs_findings_box(system, a, low, high),
                                    cs_findings_box(system, b, low, high)) &&
            isnan(stitch->breaking_length)) {
            cs_text_add(
                out,
                "a seam between bodies[%u] and bodies[%u] is %.3g m longer at the start "
                "than its rest length, and pulls with %.3g N at each stitch: place the "
                "bodies together, or give seams[].length\n",
                a, b, longer, stitch->stiffness * longer);
            return;
        }
    }
}

/* Marks in held (n) the particles that pins hold from the start to the end: those that no
 * collider carries and no event grabs or lets go. */
static void mark_held(const struct cs_system *system, bool *held) {
    const struct cs_scene *scene = system->scene;
    for (uint32_t p = 0; p < system->n_pinned; p++)
        held[system->pinned[p]] = !system->events->held_by[system->pinned[p]];
    for (uint32_t e = 0; e < scene->events.n; e++) {
        const struct cs_event *event = cs_scene_events(scene) + e;
        if (!event->grab.present && !event->release.present)
            continue;
        /* whenever it happens: only what never moves is certain */
        cs_event_mark(system,
                      event->grab.present ? &event->grab.target : &event->release.target);
        for (uint32_t i = 0; i < system->view.n; i++)
            held[i] = held[i] && !system->events->work[i];
    }
}

/* A release of particles that neither pins nor an earlier event may hold. */
static void check_release(const struct cs_system *system, uint32_t e, const void *arg,
                          struct cs_text *out) {
    const struct cs_scene *scene = system->scene;
    const struct cs_event *event = cs_scene_events(scene) + e;
    bool holds = !event->release.present;
    (void)arg;
    for (uint32_t other = 0; other < scene->events.n; other++) {
        const struct cs_event *earlier = cs_scene_events(scene) + other;
        holds = holds || ((earlier->grab.present || earlier->pin.present) &&
                          cs_event_begin(earlier) <= cs_event_begin(event));
    }
    if (!holds)
        cs_event_mark(system, &event->release.target);
    for (uint32_t p = 0; !holds && p < system->n_pinned; p++)
        holds = holds || system->events->work[system->pinned[p]];
    if (!holds)
        cs_text_add(out, "events[%u].release lets go what nothing holds at %.4g s", e,
                    cs_event_begin(event));
}

/* A grab or a pin that lets go what pins hold, or that undoes a seam to a collider. */
static void check_let_go(const struct cs_system *system, uint32_t e, const void *arg,
                         struct cs_text *out) {
    const struct cs_event *event = cs_scene_events(system->scene) + e;
    const struct cs_events *events = system->events;
    const bool grabs = event->grab.present;
    uint32_t taken = 0, seam = 0;
    (void)arg;
    if (!grabs && !event->pin.present)
        return;
    cs_event_mark(system, grabs ? &event->grab.target : &event->pin.target);
    for (uint32_t p = 0; p < system->n_pinned; p++) {
        const uint32_t i = system->pinned[p];
        taken += events->work[i];
        seam = events->work[i] && events->seam_of ? events->seam_of[i] : seam;
    }
    // a seam comes to its end whenever the event does
    const char *what = grabs ? "grab" : "pin";
    if (seam)
        cs_text_add(out,
                    "events[%u].%s takes particles that seams[%u] sews to a collider: it "
                    "undoes the seam",
                    e, what, seam - 1);
    else if (taken && isfinite(event->to))
        cs_text_add(out,
                    "events[%u].%s takes particles that pins hold, and lets them go at %.3g "
                    "s: no \"to\", with \"at\" instead of \"from\", holds them for good",
                    e, what, event->to);
}

/* First particle that a grab takes, or view.n. */
static size_t first_target(const struct cs_system *system, const struct cs_grab *grab) {
    cs_event_mark(system, &grab->target);
    size_t i = 0;
    while (i < system->view.n && !system->events->work[i])
        i++;
    return i;
}

/* A grab whose positions begin with a jump that shifts by the same numbers would not have. */
static void check_jump(const struct cs_system *system, uint32_t e, const void *arg,
                       struct cs_text *out) {
    const struct cs_event *event = cs_scene_events(system->scene) + e;
    const struct cs_event_path path = cs_event_path_of(event);
    const size_t n = system->view.n;
    double low[3], high[3], way[3];
    (void)arg;
    if (!event->grab.present || !path.n || event->grab.relative)
        return;
    const size_t i = first_target(system, &event->grab);
    if (i == n)
        return;
    const double *to = path.points->point, seconds = path.points->at - cs_event_begin(event);
    for (size_t c = 0; c < 3; c++)
        way[c] = to[c] - system->state[c * n + i];
    const double jump = sqrt(cs_vec3_dot(way, way)), shift = sqrt(cs_vec3_dot(to, to));
    const double size =
        cs_findings_box(system, cs_system_body_of(system, (uint32_t)i), low, high);
    /* faster than a fall over the body, and not as shifts */
    const double fastest = sqrt(2 * size * cs_vec3_length(system->scene->forces->gravity));
    if (jump > JUMP_RATIO * shift && jump > JUMP_SIZE * size && jump > fastest * seconds)
        cs_text_add(out,
                    "events[%u].grab.path[0] is %.3g m from where its particle starts, reached "
                    "at %.3g m/s: points are positions, and with \"relative\": true shifts",
                    e, jump, jump / seconds);
}

/* A grab that draws a particle further from one that pins hold than the sheet between them
 * goes. In a flat sheet that is their distance at rest. */
static void check_apart(const struct cs_system *system, uint32_t e, const void *arg,
                        struct cs_text *out) {
    const bool *held = arg;
    const struct cs_grab *grab = &cs_scene_events(system->scene)[e].grab;
    const struct cs_event_path path = cs_event_path_of(cs_scene_events(system->scene) + e);
    const size_t n = system->view.n;
    if (!grab->present || !path.n || !cs_vec3_is_zero(grab->spin))
        return;
    const uint32_t i = (uint32_t)first_target(system, grab);
    if (i == n)
        return;
    // both are of one body
    const uint32_t b = cs_system_body_of(system, i);
    const struct cs_body_range *range = system->bodies + b;
    const struct cs_cloth *cloth = &cs_scene_bodies(system->scene)[b].cloth;
    for (uint32_t k = 0; k < path.n * system->n_pinned; k++) {
        const struct cs_path_point *to = path.points + k / system->n_pinned;
        const uint32_t h = system->pinned[k % system->n_pinned], p = i - range->first,
                       q = h - range->first;
        if (range->mesh || q >= range->count || !held[h])
            continue;
        // where the point leads, and the same way in the sheet
        double way[3];
        for (size_t c = 0; c < 3; c++)
            way[c] = to->point[c] + (grab->relative ? system->state[c * n + i] : 0) -
                     system->state[c * n + h];
        const double u = cloth->size[0] / fmax(range->columns - 1, 1) *
                         ((double)(p % range->columns) - (double)(q % range->columns)),
                     v = cloth->size[1] / fmax(range->rows - 1, 1) *
                         ((double)(p / range->columns) - (double)(q / range->columns));
        const double length = sqrt(cs_vec3_dot(way, way)), rest = sqrt(u * u + v * v);
        if (!(length > APART_MAX * rest))
            continue;
        cs_text_add(
            out,
            "events[%u].grab draws particle %u of bodies[%u] until %.4g s to %.3g m from "
            "particle %u, which pins hold: the sheet between them is %.3g m long",
            e, p, b, to->at, length, q, rest);
        return;
    }
}

/* m/s, speed of waves in the springs at a particle; 0: it has none. */
static double wave_speed(const struct cs_system *system, size_t particle) {
    double speed = 0;
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *s = system->springs.runs + r;
        for (uint32_t i = 0; i < s->count; i++)
            if (cs_spring_a(s, i) == particle || cs_spring_b(s, i) == particle)
                speed = fmax(speed, cs_spring_length(s, i) * sqrt(cs_spring_stiffness(s, i) /
                                                                  system->mass[particle]));
    }
    return speed;
}

/* A grab that is led faster than waves run through the springs. */
static void check_waves(const struct cs_system *system, uint32_t e, const void *arg,
                        struct cs_text *out) {
    const struct cs_event *event = cs_scene_events(system->scene) + e;
    const struct cs_grab *grab = &event->grab;
    const struct cs_event_path path = cs_event_path_of(event);
    const struct cs_path_point *to = path.points;
    const size_t n = system->view.n,
                 i = grab->present && path.n ? first_target(system, grab) : n;
    (void)arg;
    if (i == n)
        return;
    double from[3] = {0};
    for (size_t c = 0; c < 3 && !grab->relative; c++)
        from[c] = system->state[c * n + i];
    const double speed = cs_findings_first_speed(event, to, from),
                 waves = wave_speed(system, i);
    if (speed > waves && waves > 0)
        cs_text_add(out,
                    "events[%u].grab.path[0] is reached at %.3g m/s, faster than waves in the "
                    "springs, %.3g m/s: expected at = %.3g s or later%s",
                    e, speed, waves,
                    cs_event_begin(event) +
                        2 * (to->at - cs_event_begin(event)) * speed / waves,
                    grab->relative ? "" : ", or \"relative\": true if its points are shifts");
}

/* Two seams that join the same two particles. */
static void check_twice(const struct cs_system *system, struct cs_text *out) {
    const struct cs_seams *seams = system->seams;
    for (uint32_t e = 1; seams && e < seams->n_ends; e++) {
        const struct cs_stitch *one = seams->stitches + seams->ends[e - 1].stitch,
                               *other = seams->stitches + seams->ends[e].stitch;
        // ends are in the order of particles
        if (one == other || one->n != other->n || one->n > 2 ||
            one->at[0] + one->at[1] != other->at[0] + other->at[1] ||
            seams->ends[e].particle != seams->ends[e - 1].particle)
            continue;
        cs_text_add(out,
                    "seams[%u] joins particles that seams[%u] joins: their stitches add up, "
                    "to %.3g N/m\n",
                    other->seam, one->seam, one->stiffness + other->stiffness);
        return;
    }
}

/* A seam to a collider that closes faster than waves run through the springs. */
static void check_closing(const struct cs_system *system, struct cs_text *out) {
    const struct cs_events *events = system->events;
    const uint32_t i = events ? events->gap_of : 0, b = cs_system_body_of(system, i);
    double low[3], high[3];
    if (!events || !(events->gap > CLOSED * cs_findings_box(system, b, low, high)))
        return;
    const struct cs_seam *seam =
        (const struct cs_seam *)system->scene->seams.items + events->seam_of[i] - 1;
    const double waves = wave_speed(system, i);
    /* the way begins and ends at rest: at most 1.5 times the mean speed */
    if (1.5 * events->gap > waves * seam->closing_time && waves > 0)
        cs_text_add(out,
                    "seams[%u] draws particle %u of bodies[%u] %.3g m to colliders[%u] in %.3g "
                    "s, faster than waves in the springs, %.3g m/s: expected closing_time = "
                    "%.3g s or longer\n",
                    events->seam_of[i] - 1, i - system->bodies[b].first, b, events->gap,
                    (uint32_t)seam->to.collider, seam->closing_time, waves,
                    3 * events->gap / waves);
}

void cs_trajectory_findings_print(const struct cs_session *session, double seconds,
                                  struct cs_scene_findings *out) {
    const struct cs_system *system = &session->system;
    const struct cs_scene *scene = system->scene;
    bool *held = calloc((size_t)system->view.n + 1, sizeof *held);
    cs_findings_print(system, scene->bodies.n, check_pins, NULL, &out->warnings);
    check_seams(system, &out->warnings);
    check_closing(system, &out->warnings);
    check_twice(system, &out->hints);
    out->warnings.failed |= !held;
    if (scene->events.n && held)
        mark_held(system, held);
    const uint32_t n = out->warnings.failed ? 0 : scene->events.n;
    cs_motion_findings_print(session, seconds, &out->warnings);
    cs_findings_print(system, n, check_apart, held, &out->warnings);
    cs_findings_print(system, n, check_let_go, NULL, &out->hints);
    cs_findings_print(system, n, check_waves, NULL, &out->hints);
    cs_findings_print(system, n, check_release, NULL, &out->hints);
    cs_findings_print(system, n, check_jump, NULL, &out->hints);
    free(held);
}
