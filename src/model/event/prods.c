/* Viewpoint forces (the event `prod`): the particles that they act on, and the times at which
 * visibility is tested again. */
#include "model/event/prods.h"

#include "model/event/event_times.h"

#include <math.h>
#include <string.h>

static const struct cs_prod *prod_of(const struct cs_scene *scene, uint32_t event) {
    return &cs_scene_events(scene)[event].prod;
}

static uint32_t count(const struct cs_scene *scene) {
    uint32_t n = 0;
    for (uint32_t e = 0; e < scene->events.n; e++)
        n += prod_of(scene, e)->present;
    return n;
}

bool cs_prods_any(const struct cs_scene *scene) {
    return count(scene) > 0;
}

size_t cs_prods_bytes(const struct cs_scene *scene, uint32_t n) {
    return sizeof(struct cs_prods) +
           count(scene) * (sizeof(struct cs_prod_state) + n * sizeof(bool)) + cs_sight_bytes(n);
}

enum cs_status cs_prods_build(struct cs_system *system, struct cs_error *error) {
    const struct cs_scene *scene = system->scene;
    const uint32_t n = system->view.n;
    struct cs_arena *arena = &system->arena;
    struct cs_prods *prods = cs_arena_take(arena, sizeof *prods, error);
    if (!prods)
        return error->status;
    prods->states = cs_arena_take_n(arena, count(scene), sizeof *prods->states, error);
    for (uint32_t e = 0; e < scene->events.n && !error->status; e++) {
        if (!prod_of(scene, e)->present)
            continue;
        bool *seen = cs_arena_take_n(arena, n, sizeof *seen, error);
        struct cs_prod_state *state = prods->states + prods->n++;
        *state = (struct cs_prod_state){.event = e, .seen = seen, .next = HUGE_VAL};
        cs_sight_make(&state->sight, prod_of(scene, e));
    }
    /* shared work: nobody keeps anything in it between two calls */
    prods->marks = system->events->marks;
    system->events->prods = prods;
    return cs_sight_work_init(&prods->work, n, arena, error);
}

static struct cs_prod_state *state_of(const struct cs_prods *prods, uint32_t event) {
    uint32_t k = 0;
    while (prods->states[k].event != event)
        k++;
    return prods->states + k;
}

/* tests visibility again; true if other particles are seen than before */
static bool look(const struct cs_system *system, struct cs_prod_state *state, double t) {
    const struct cs_prods *prods = system->events->prods;
    const struct cs_prod *prod = prod_of(system->scene, state->event);
    const size_t bytes = system->view.n * sizeof *state->seen;
    cs_sight_find(&state->sight, system, t, system->state, prod->body, &prods->work,
                  prods->marks);
    const bool changed = memcmp(state->seen, prods->marks, bytes) != 0;
    memcpy(state->seen, prods->marks, bytes);
    return changed;
}

/* out (3,n) += factor N (or N s) along the view, over the mass, where seen and free */
static void add(const struct cs_system *system, const struct cs_prod_state *state,
                double factor, double *out) {
    const size_t n = system->view.n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (state->seen[i] && system->inv_mass[i] > 0)
                out[c * n + i] += state->sight.axes[2][c] * (factor / system->mass[i]);
}

/* time of the visibility test number `looks`, in s */
static double time_of(const struct cs_scene *scene, const struct cs_prod *prod, double begin,
                      double looks) {
    return prod->refresh > 0 ? cs_event_time_snap(scene, begin + looks / prod->refresh)
                             : HUGE_VAL;
}

static void plan_next(const struct cs_system *system, struct cs_prod_state *state, double t) {
    const struct cs_event_state *of = system->events->states + state->event;
    const struct cs_prod *prod = prod_of(system->scene, state->event);
    do
        state->next = time_of(system->scene, prod, of->begin, ++state->looks);
    while (state->next <= t + CS_EVENT_SAME);
}

void cs_prod_start(struct cs_system *system, uint32_t event) {
    const struct cs_events *events = system->events;
    const struct cs_event_state *of = events->states + event;
    const struct cs_prod *prod = prod_of(system->scene, event);
    struct cs_prod_state *state = state_of(events->prods, event);
    look(system, state, of->begin);
    state->active = of->end > of->begin;
    state->looks = 0;
    if (state->active)
        plan_next(system, state, of->begin);
    else
        add(system, state, prod->force * prod->duration,
            system->state + 3 * (size_t)system->view.n);
}

void cs_prod_finish(struct cs_system *system, uint32_t event) {
    struct cs_prod_state *state = state_of(system->events->prods, event);
    state->active = false;
    state->next = HUGE_VAL;
}

bool cs_prods_look(struct cs_system *system, double t) {
    struct cs_prods *prods = system->events->prods;
    bool changed = false;
    for (uint32_t k = 0; k < prods->n; k++) {
        if (prods->states[k].next > t + CS_EVENT_SAME)
            continue;
        changed |= look(system, prods->states + k, t);
        plan_next(system, prods->states + k, t);
    }
    return changed;
}

double cs_prods_next(const struct cs_prods *prods) {
    double next = HUGE_VAL;
    for (uint32_t k = 0; k < prods->n; k++)
        next = fmin(next, prods->states[k].next);
    return next;
}

void cs_prods_add_push(const struct cs_system *system, double *push) {
    const struct cs_prods *prods = system->events->prods;
    for (uint32_t k = 0; k < prods->n; k++)
        if (prods->states[k].active)
            add(system, prods->states + k,
                prod_of(system->scene, prods->states[k].event)->force, push);
}

double cs_prods_force(const struct cs_prods *prods, const struct cs_scene *scene) {
    double force = 0;
    for (uint32_t k = 0; k < prods->n; k++)
        if (prods->states[k].active)
            force += fabs(prod_of(scene, prods->states[k].event)->force);
    return force;
}

uint32_t cs_prods_cuts(const struct cs_scene *scene, double t) {
    uint32_t cuts = 0;
    for (uint32_t e = 0; e < scene->events.n; e++) {
        const struct cs_event *event = cs_scene_events(scene) + e;
        const double end = event->prod.present && isnan(event->at) ? fmin(event->to, t) : 0;
        for (double looks = 1, at;
             at = time_of(scene, &event->prod, event->from, looks), at < end; looks++)
            cuts += at * scene->time.fps != floor(at * scene->time.fps + 0.5);
    }
    return cuts;
}
