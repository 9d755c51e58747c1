/* Checks of events that the range of a single key cannot express: times, targets, directions,
 * paths, overlaps. */

#include "base/options.h"
#include "base/vec3.h"
#include "scene/body_keys.h"
#include "scene/body_particles.h"
#include "scene/event_key.h"
#include "scene/force_keys.h"
#include "scene/picture_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define EVENTS_MAX 4096
/* s, least distance of two times of one event: above the rounding of times, below any frame */
#define APART 1e-6

/* The event that is checked, for messages. */
struct look {
    struct cs_scene *scene;
    uint32_t number;
    char *path; /* CS_TEXT_MAX bytes of the caller */
    struct cs_error *error;
};

/* Fails at a part of the event: ".impact.direction", or "" for the event itself. */
__attribute__((format(printf, 3, 4))) static enum cs_status
refuse_event(const struct look *at, const char *part, const char *format, ...) {
    char message[512];
    CS_FORMAT(message, format);
    snprintf(at->path, CS_TEXT_MAX, "events[%u]%s", at->number, part);
    return cs_fail(at->error, CS_ERR_SCENE, "%s", message);
}

/* Normalises a direction of the event. */
static enum cs_status make_unit(const struct look *at, const char *part, double v[3]) {
    char path[CS_TEXT_MAX];
    snprintf(path, sizeof path, "events[%u]%s", at->number, part);
    return cs_check_unit(&(struct cs_check){at->path, at->error}, path, v, 3);
}

/* Checks that the event has `at`, or `from` before `to`. */
static enum cs_status check_times(const struct look *at, const struct cs_event *event) {
    const bool once = !isnan(event->at), from = !isnan(event->from), to = !isnan(event->to);
    if (once ? from || to : !from || !to)
        return refuse_event(at, "", "found %s, expected at, or from and to",
                            once   ? "at with from or to"
                            : from ? "from alone"
                            : to   ? "to alone"
                                   : "no time");
    if (!once && !(event->to >= event->from + APART))
        return refuse_event(at, ".to", "%.9g s is not after from = %.9g s", event->to,
                            event->from);
    if ((event->release.present || event->unsew.present) && !once)
        return refuse_event(at, event->release.present ? ".release" : ".unsew",
                            "is instantaneous, expected at");
    return CS_OK;
}

/* Checks that the target's body exists, and its particles in each body that it means. */
static enum cs_status check_aim(const struct look *at, const char *part,
                                const struct cs_event_target *target) {
    const uint32_t n = at->scene->bodies.n;
    const struct cs_check check = {at->path, at->error};
    char place[64], name[32];
    snprintf(place, sizeof place, "%s.body", part);
    if (target->body >= n)
        return refuse_event(at, place, "body %lld does not exist (0..%u)",
                            (long long)target->body, n - 1);
    snprintf(place, sizeof place, "events[%u]%s", at->number, part);
    for (uint32_t b = 0; b < n && !at->error->status; b++) {
        snprintf(name, sizeof name, "body %u", b);
        if (target->body < 0 || target->body == b)
            cs_particles_check(&check, place, &target->particles,
                               cs_scene_bodies(at->scene) + b, name);
    }
    return at->error->status;
}

/* Returns true if the scene's wind, or that of an earlier event, has a direction. */
static bool has_direction(const struct look *at) {
    const struct cs_event *events = cs_scene_events(at->scene);
    bool has = at->scene->forces->wind.present;
    for (uint32_t k = 0; k < at->scene->events.n; k++)
        has |= events[k].wind.present && !isnan(events[k].wind.direction[0]) &&
               cs_event_begin(events + k) < cs_event_begin(events + at->number);
    return has;
}

/* Checks that a change of wind changes something and leaves it with a direction. */
static enum cs_status check_wind(const struct look *at, struct cs_wind_change *wind) {
    const bool turns = !isnan(wind->direction[0]);
    if (!turns && isnan(wind->strength))
        return refuse_event(at, ".wind", "found neither direction nor strength");
    if (!turns && !has_direction(at))
        return refuse_event(at, ".wind", "no direction, and there was no wind before");
    return turns ? make_unit(at, ".wind.direction", wind->direction) : CS_OK;
}

/* Fills absent values of a viewpoint from the camera and the picture. */
static void complete_viewpoint(const struct cs_scene *scene, struct cs_viewpoint *of) {
    const struct cs_camera *camera = scene->camera;
    if (isnan(of->eye[0]))
        memcpy(of->eye, camera->eye, sizeof of->eye);
    if (isnan(of->target[0]))
        memcpy(of->target, camera->target, sizeof of->target);
    if (isnan(of->up[0]))
        memcpy(of->up, camera->up, sizeof of->up);
    if (isnan(of->fov))
        of->fov = camera->fov;
    if (isnan(of->aspect))
        of->aspect = (double)scene->render->size[0] / (double)scene->render->size[1];
}

/* A force at one moment has a duration, 1/60 s if absent; one over an interval has a rate of
 * visibility tests, 60 per s if absent. Neither may have both. */
static enum cs_status check_lengths(const struct look *at, bool once,
                                    struct cs_viewpoint_force *viewpoint_force) {
    double *used = once ? &viewpoint_force->duration : &viewpoint_force->refresh;
    const double other = once ? viewpoint_force->refresh : viewpoint_force->duration;
    if (!isnan(other))
        return once ? refuse_event(at, ".viewpoint_force.refresh",
                                   "an impulse tests visibility once, expected from and to")
                    : refuse_event(at, ".viewpoint_force.duration",
                                   "it lasts until to, expected at");
    if (isnan(*used))
        *used = once ? 1.0 / 60 : 60;
    return CS_OK;
}

/* Completes and checks a viewpoint force: view, rectangle, force, body, duration. */
static enum cs_status check_viewpoint_force(const struct look *at, bool once,
                                            struct cs_viewpoint_force *viewpoint_force) {
    const struct cs_viewpoint *from = &viewpoint_force->viewpoint;
    const double *rectangle = viewpoint_force->rectangle;
    const char *key, *fault;
    char place[64];
    /* keys of the camera stand in first: the view is checked as it will be used */
    complete_viewpoint(at->scene, &viewpoint_force->viewpoint);
    fault = cs_viewpoint_fault(from->eye, from->target, from->up, &key);
    snprintf(place, sizeof place, ".viewpoint_force.viewpoint.%s", fault ? key : "");
    if (fault)
        return refuse_event(at, place, "%s", fault);
    if (!(rectangle[0] < rectangle[2]))
        return refuse_event(at, ".viewpoint_force.rectangle",
                            "left = %.9g is not below right = %.9g", rectangle[0],
                            rectangle[2]);
    if (!(rectangle[1] < rectangle[3]))
        return refuse_event(at, ".viewpoint_force.rectangle",
                            "top = %.9g is not below bottom = %.9g", rectangle[1],
                            rectangle[3]);
    if (isnan(viewpoint_force->force))
        return refuse_event(at, ".viewpoint_force", "missing key \"force\"");
    if (viewpoint_force->body >= at->scene->bodies.n)
        return refuse_event(at, ".viewpoint_force.body", "body %lld does not exist (0..%u)",
                            (long long)viewpoint_force->body, at->scene->bodies.n - 1);
    return check_lengths(at, once, viewpoint_force);
}

/* Checks the key of a ramp, the range of its value, and that masses change at once. */
static enum cs_status check_ramp(const struct look *at, const struct cs_event *event) {
    const struct cs_ramp *ramp = &event->ramp;
    struct cs_event_key key;
    struct cs_error said = {0};
    if (cs_event_key_find(at->scene, ramp->key, &key, &said))
        return refuse_event(at, ".ramp.key", "%s", said.message);
    if (isnan(ramp->value))
        return refuse_event(at, ".ramp", "found no value, expected one for %s", ramp->key);
    /* its message starts with the ": " behind no place */
    if (cs_option_check_range(key.row, ramp->value, -1, "", CS_ERR_SCENE, &said))
        return refuse_event(at, ".ramp.value", "%s", said.message + 2);
    /* methods take a mass for constant within an advance */
    if (cs_event_changes_mass(event) && isnan(event->at))
        return refuse_event(at, "", "found from and to, expected at: masses change instantly");
    return CS_OK;
}

/* Checks that the times of a path ascend within the event; key: grab or move. */
static enum cs_status check_path(const struct look *at, const char *key,
                                 const struct cs_list *list, bool relative) {
    const struct cs_event *event = cs_scene_events(at->scene) + at->number;
    const struct cs_path_point *path = list->items;
    double before = cs_event_begin(event);
    char place[64];
    const uint32_t first = cs_path_starts_at(list, before);
    snprintf(place, sizeof place, ".%s.path[0]", key);
    if (first && relative && cs_check_length(path->point, 3) > 0)
        return refuse_event(at, place, "at the start the shift is 0, found [%.9g, %.9g, %.9g]",
                            path->point[0], path->point[1], path->point[2]);
    if (first == list->n && first)
        return refuse_event(at, place, "found no point after the start, %.9g s", before);
    for (uint32_t p = first; p < list->n; p++) {
        snprintf(place, sizeof place, ".%s.path[%u]", key, p);
        if (isnan(path[p].at))
            return refuse_event(at, place, "missing key \"at\"");
        if (!(path[p].at >= before + APART))
            return refuse_event(at, place, "at = %.9g s is not after %.9g s", path[p].at,
                                before);
        before = path[p].at;
        if (before > event->to)
            return refuse_event(at, place, "at = %.9g s is after the end, to = %.9g s", before,
                                event->to);
    }
    return CS_OK;
}

/* Checks what a grab follows, and its target: a collider, or a path or a spin of its own. */
static enum cs_status check_grab(const struct look *at, const struct cs_grab *grab) {
    const bool spins = cs_check_length(grab->spin, 3) > 0;
    char fault[160];
    if (grab->to && (grab->path.n || spins))
        return refuse_event(at, ".grab.to",
                            "found %s too, but the collider leads; expected either",
                            grab->path.n ? "path" : "spin");
    if (grab->to && cs_holder_fault(at->scene, grab->to, fault, sizeof fault))
        return refuse_event(at, ".grab.to", "%s", fault);
    if (!isnan(grab->centre[0]) && !spins)
        return refuse_event(at, ".grab.centre", "without spin it has no effect");
    if (grab->path.n == 0 && !spins && !grab->to)
        return refuse_event(at, ".grab.path",
                            "found no point, expected at least one, or spin, or to");
    return check_path(at, "grab", &grab->path, grab->relative)
               ? at->error->status
               : check_aim(at, ".grab", &grab->target);
}

/* Checks collider and path of a move, and that it moves or turns. */
static enum cs_status check_move(const struct look *at, const struct cs_move *move) {
    const uint32_t n = at->scene->colliders.n;
    const double *spin = move->spin;
    if (move->collider < 0)
        return refuse_event(at, ".move", "missing key \"collider\", expected its number");
    if (n == 0)
        return refuse_event(at, ".move.collider", "the scene has no colliders");
    if (move->collider >= n)
        return refuse_event(at, ".move.collider", "collider %lld does not exist (0..%u)",
                            (long long)move->collider, n - 1);
    if (move->path.n == 0 && cs_vec3_is_zero(spin))
        return refuse_event(at, ".move", "found neither path nor spin");
    if (!isnan(move->centre[0]) && cs_vec3_is_zero(spin))
        return refuse_event(at, ".move.centre", "without spin it has no effect");
    return check_path(at, "move", &move->path, move->relative);
}

/* Checks that the seam exists. */
static enum cs_status check_unsew(const struct look *at, const struct cs_unsew *unsew) {
    const uint32_t n = at->scene->seams.n;
    if (unsew->seam < 0)
        return refuse_event(at, ".unsew", "missing key \"seam\", expected its number");
    if (unsew->seam >= n)
        return refuse_event(at, ".unsew.seam", "seam %lld does not exist, the scene has %u",
                            (long long)unsew->seam, n);
    return CS_OK;
}

/* Returns the key of the number that an event changes, or NULL. */
static const char *moved_key(const struct cs_event *event) {
    return event->ramp.present   ? event->ramp.key
           : event->wind.present ? "forces.wind.strength"
                                 : NULL;
}

/* Refuses an event that changes a number while an earlier one in the list does. */
static enum cs_status check_overlap(const struct look *at, const struct cs_event *event) {
    const struct cs_event *events = cs_scene_events(at->scene);
    const char *key = moved_key(event);
    for (uint32_t k = 0; key && k < at->number; k++) {
        const char *other = moved_key(events + k);
        if (other && !strcmp(key, other) && cs_event_begin(event) < cs_event_end(events + k) &&
            cs_event_begin(events + k) < cs_event_end(event))
            return refuse_event(at, "", "changes %s while events[%u] does", key, k);
    }
    return CS_OK;
}

/* Checks one event: times, then its action. */
static enum cs_status check_event(const struct look *at, struct cs_event *event) {
    if (check_times(at, event) || check_overlap(at, event))
        return at->error->status;
    /* the table allows exactly one action, which the reader has checked */
    if (event->impact.present)
        return make_unit(at, ".impact.direction", event->impact.direction)
                   ? at->error->status
                   : check_aim(at, ".impact", &event->impact.target);
    if (event->wind.present)
        return check_wind(at, &event->wind);
    if (event->viewpoint_force.present)
        return check_viewpoint_force(at, !isnan(event->at), &event->viewpoint_force);
    if (event->ramp.present)
        return check_ramp(at, event);
    if (event->grab.present)
        return check_grab(at, &event->grab);
    if (event->move.present)
        return check_move(at, &event->move);
    if (event->unsew.present)
        return check_unsew(at, &event->unsew);
    return event->pin.present ? check_aim(at, ".pin", &event->pin.target)
                              : check_aim(at, ".release", &event->release.target);
}

enum cs_status cs_events_check(struct cs_scene *scene, char *path_out, struct cs_error *error) {
    struct cs_event *events = scene->events.items;
    struct look at = {.scene = scene, .path = path_out, .error = error};
    if (scene->events.n > EVENTS_MAX) {
        snprintf(path_out, CS_TEXT_MAX, "events");
        return cs_fail(error, CS_ERR_SCENE, "found %u, expected at most %d", scene->events.n,
                       EVENTS_MAX);
    }
    for (at.number = 0; at.number < scene->events.n; at.number++)
        if (check_event(&at, events + at.number))
            return error->status;
    return CS_OK;
}
