/* Finds mistakes in paths of grabs and moves.
 *
 * A grab's points are positions, a move's are shifts, unless `relative` says otherwise: a path
 * written as the other kind begins with a jump. A grabbed particle that is faster than waves in
 * its springs, c = L sqrt(k/m), stretches them to twice their length and more. */
#include "study/path_findings.h"

#include "base/vec3.h"
#include "model/contact/posed_collider.h"
#include "model/event/event_state.h"

#include <math.h>
#include <string.h>

/* A first leg longer than the obstacle within so many frames is a jump. */
#define JUMP_FRAMES 1.5

static double begin_of(const struct cs_event *event) {
    return isnan(event->at) ? event->from : event->at;
}

/* m/s, mean speed of the first leg of a path. */
static double first_speed(const struct cs_event *event, const struct cs_path_point *to,
                          const double from[3]) {
    double way[3];
    for (int c = 0; c < 3; c++)
        way[c] = to->point[c] - from[c];
    return sqrt(cs_vec3_dot(way, way)) / (to->at - begin_of(event));
}

/* First particle that a grab takes, or view.n. */
static size_t first_target(const struct cs_system *system, const struct cs_grab *grab) {
    cs_event_mark(system, &grab->target);
    size_t i = 0;
    while (i < system->view.n && !system->events->work[i])
        i++;
    return i;
}

/* True if the scene pins a particle that a grab takes. */
static bool takes_pinned(const struct cs_system *system, const struct cs_grab *grab) {
    bool any = false;
    cs_event_mark(system, &grab->target);
    for (uint32_t p = 0; p < system->n_pinned; p++)
        any = any || system->events->work[system->pinned[p]];
    return any;
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

static void check_grab(const struct cs_system *system, uint32_t e, struct cs_text *out) {
    const struct cs_event *event = cs_scene_events(system->scene) + e;
    const struct cs_grab *grab = &event->grab;
    const struct cs_path_point *to = grab->path.items;
    const size_t n = system->view.n;
    const size_t i = first_target(system, grab);
    if (i == n)
        return;
    double from[3] = {0};
    for (size_t c = 0; c < 3 && !grab->relative; c++)
        from[c] = system->state[c * n + i];
    const double speed = grab->path.n ? first_speed(event, to, from) : 0;
    const double waves = wave_speed(system, i);
    if (speed > waves && waves > 0)
        cs_text_add(out,
                    "events[%u].grab.path[0] is reached at %.3g m/s, faster than waves in the "
                    "springs, %.3g m/s: expected at = %.3g s or later%s\n",
                    e, speed, waves,
                    begin_of(event) + 2 * (to->at - begin_of(event)) * speed / waves,
                    grab->relative ? "" : ", or \"relative\": true if its points are shifts");
    if (takes_pinned(system, grab) && isfinite(event->to))
        cs_text_add(out,
                    "events[%u].grab takes particles that pins hold, and lets them go at %.3g "
                    "s: no \"to\", with \"at\" instead of \"from\", holds them for good\n",
                    e, event->to);
}

/* m, of a collider without a plane: the diagonal of its box. */
static double size_of(const struct cs_posed_collider *at) {
    const struct cs_trimesh *mesh =
        at->collider->mesh.present ? at->collider->mesh.geometry : NULL;
    double sides[3], low, high;
    for (size_t c = 0; c < 3; c++) {
        sides[c] = 2 * at->half_sizes[c];
        low = high = mesh ? mesh->positions[c * mesh->n] : 0;
        for (size_t i = 0; mesh && i < mesh->n; i++) {
            low = fmin(low, mesh->positions[c * mesh->n + i]);
            high = fmax(high, mesh->positions[c * mesh->n + i]);
        }
        sides[c] += high - low;
    }
    return 2 * at->radius + sqrt(cs_vec3_dot(sides, sides));
}

static void check_move(const struct cs_system *system, uint32_t e, struct cs_text *out) {
    const struct cs_event *event = cs_scene_events(system->scene) + e;
    const struct cs_move *move = &event->move;
    const struct cs_path_point *to = move->path.items;
    struct cs_posed_collider at;
    if (!move->path.n || !system->motions)
        return;
    cs_posed_collider_at(system, (uint32_t)move->collider, 0, &at);
    if (cs_shape_is_endless(at.shape))
        return;
    const double still[3] = {0}, *from = move->relative ? still : at.centre;
    const double speed = first_speed(event, to, from);
    const double size = size_of(&at);
    const double fastest = size * system->scene->time.fps / JUMP_FRAMES;
    if (speed > fastest)
        cs_text_add(out,
                    "events[%u].move.path[0] is reached at %.3g m/s, by more than the size of "
                    "colliders[%u], %.3g m, per frame: expected at = %.3g s or later%s\n",
                    e, speed, (uint32_t)move->collider, size,
                    begin_of(event) + (to->at - begin_of(event)) * speed / fastest,
                    move->relative ? ", or \"relative\": false if its points are positions"
                                   : "");
}

void cs_path_findings_print(const struct cs_system *system, struct cs_text *out) {
    for (uint32_t e = 0; e < system->scene->events.n; e++) {
        const struct cs_event *event = cs_scene_events(system->scene) + e;
        if (event->grab.present)
            check_grab(system, e, out);
        if (event->move.present)
            check_move(system, e, out);
    }
}
