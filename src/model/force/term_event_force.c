/* Impacts and viewpoint forces over an interval: f = m a. An impact gives all its particles the
 * same a; a viewpoint force gives all visible particles the same f. Both are constant between
 * two calls of cs_events_apply. */
#include "model/force/term.h"
#include "scene/force_keys.h"

#include <math.h>

/* the plan has a line for events as such */
static struct cs_plan_row plan_event_force(const struct cs_scene *scene) {
    const struct cs_event *events = cs_scene_events(scene);
    struct cs_plan_row row = {0};
    for (uint32_t e = 0; e < scene->events.n; e++)
        row.built |= (events[e].impact.present || events[e].viewpoint_force.present) &&
                     isnan(events[e].at);
    return row;
}

/* event_force holds accelerations, so that one array serves both kinds of events. */
static void add_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const size_t n = system->view.n;
    const double *push = system->event_force;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = at->block->begin; i < at->block->end; i++)
            f[c * n + i] += system->mass[i] * push[c * n + i];
    for (size_t c = 0; c < 3 && at->power; c++)
        for (size_t i = at->block->begin; i < at->block->end; i++)
            at->power[i] += system->mass[i] * push[c * n + i] * at->v[c * n + i];
}

/* The present force, which no state changes. */
static double max_acceleration(const struct cs_system *system, size_t i) {
    const size_t n = system->view.n;
    const double *a = system->event_force + i;
    return system->mass[i] * sqrt(a[0] * a[0] + a[n] * a[n] + a[2 * n] * a[2 * n]);
}

const struct cs_term cs_term_push = {
    .name = "pushes",
    .part_bits = CS_PART_EXTERNAL,
    .plan = plan_event_force,
    .add_force = add_force,
    .work_column = "events_force",
    .max_acceleration = max_acceleration,
};
