/* Range, stiffness and friction between bodies and with obstacles, from the scene's keys and
 * the edges. */
#include "model/pair/meeting.h"

#include "model/contact/pairing.h"
#include "scene/pairs.h"

#include <math.h>

/* m, of a body at the start; HUGE_VAL: it has no edge */
static double shortest_edge(const struct cs_system *system, uint32_t body) {
    const struct cs_surfaces *surfaces = system->surfaces;
    const double *x = system->start;
    const size_t n = system->view.n;
    double least = HUGE_VAL;
    for (uint32_t e = surfaces->first_edge[body]; e < surfaces->first_edge[body + 1]; e++) {
        const uint32_t a = surfaces->edges[2 * (size_t)e],
                       b = surfaces->edges[2 * (size_t)e + 1];
        double squared = 0;
        for (size_t c = 0; c < 3; c++)
            squared += (x[c * n + b] - x[c * n + a]) * (x[c * n + b] - x[c * n + a]);
        least = fmin(least, squared);
    }
    return sqrt(least);
}

static double thickness_of(const struct cs_system *system, uint32_t body,
                           struct cs_error *error) {
    const double given = cs_scene_bodies(system->scene)[body].thickness;
    const double thickness =
        given > 0 ? given : CS_THICKNESS_SHARE * shortest_edge(system, body);
    if (!(thickness > 0 && isfinite(thickness)))
        cs_fail(error, CS_ERR_SCENE,
                "bodies[%u].thickness: 0, and no edge to take it from; expected a length in m",
                body);
    return thickness;
}

/* m, between two of which the first is a body; an obstacle's is all of it, as other colliders'
 * is */
static double range_between(const struct cs_system *system, uint32_t a, uint32_t b,
                            struct cs_error *error) {
    const struct cs_collider *obstacle = cs_scene_obstacle(system->scene, b);
    if (obstacle && obstacle->thickness > 0)
        return obstacle->thickness;
    const double first = thickness_of(system, a, error);
    return obstacle || a == b ? first : 0.5 * (first + thickness_of(system, b, error));
}

static void meet(struct cs_meetings *meetings, uint32_t a, uint32_t b,
                 const struct cs_meeting *meeting) {
    meetings->of[(size_t)a * meetings->n_bodies + b] = *meeting;
    meetings->of[(size_t)b * meetings->n_bodies + a] = *meeting;
    meetings->any[a] = meetings->any[b] = true;
    meetings->widest = fmax(meetings->widest, meeting->range);
    meetings->least = fmin(meetings->least, meeting->range);
}

enum cs_status cs_meetings_build(struct cs_system *system, struct cs_meetings *meetings,
                                 struct cs_error *error) {
    const uint32_t n = system->surfaces->n_bodies;
    struct cs_meeting meeting;
    *meetings = (struct cs_meetings){.n_bodies = n, .least = HUGE_VAL};
    meetings->of = cs_arena_take_n(&system->arena, (size_t)n * n, sizeof *meetings->of, error);
    meetings->any = cs_arena_take_n(&system->arena, n, sizeof *meetings->any, error);
    if (error->status || cs_pairing_stiffness(system, &meeting.k, error))
        return error->status;
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = a; b < n && !error->status; b++) {
            if (!cs_scene_bodies_meet(system->scene, a, b, &meeting.mu))
                continue;
            meeting.range = range_between(system, a, b, error);
            meet(meetings, a, b, &meeting);
        }
    return error->status;
}

void cs_meetings_rub(const struct cs_system *system, struct cs_meetings *meetings) {
    const uint32_t n_bodies = system->scene->bodies.n;
    for (uint32_t b = n_bodies; b < meetings->n_bodies; b++)
        for (uint32_t a = 0; a < n_bodies; a++) {
            const double mu = cs_scene_obstacle(system->scene, b)->friction;
            meetings->rubbed += meetings->of[(size_t)a * meetings->n_bodies + b].mu != mu;
            meetings->of[(size_t)a * meetings->n_bodies + b].mu = mu;
            meetings->of[(size_t)b * meetings->n_bodies + a].mu = mu;
        }
}
