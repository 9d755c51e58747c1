/* stick.c - the cone of friction, and pins that come and go with it; see stick.h. */
#include "model/commit/stick.h"

#include "base/vec3.h"
#include "model/force/normals.h"
#include "model/force/terms.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* m: on a surface, as far as the scene's numbers tell */
#define TOUCHING 1e-9

enum cs_status cs_stick_init(struct cs_stick *stick, struct cs_system *system,
                             struct cs_arena *arena, struct cs_error *error) {
    const size_t n = system->view.n;
    *stick = (struct cs_stick){.system = system};
    stick->on = cs_arena_take_n(arena, n, sizeof *stick->on, error);
    stick->held = cs_arena_take_n(arena, n, sizeof *stick->held, error);
    stick->load = cs_arena_take_n(arena, 3 * n, sizeof *stick->load, error);
    return error->status ? error->status : cs_pins_init(&stick->pins, system, arena, error);
}

void cs_stick_pin(struct cs_stick *stick) {
    if (stick->n > 0)
        cs_pins_set(&stick->pins, stick->held);
}

void cs_stick_unpin(struct cs_stick *stick) {
    cs_pins_clear(&stick->pins, stick->held);
}

bool cs_stick_restore(struct cs_stick *stick, double dt, const double *last, double *x,
                      double *v) {
    const size_t n = stick->system->view.n;
    bool moved = false;
    for (size_t c = 0, k = 0; c < 3 && stick->n > 0; c++)
        for (size_t i = 0; i < n; i++, k++) {
            if (!stick->held[i])
                continue;
            moved |= x[k] != last[k] || v[k] != 0;
            stick->load[k] = stick->system->mass[i] * (x[k] - last[k]) / (dt * dt);
            x[k] = last[k];
            v[k] = 0;
        }
    return moved;
}

void cs_stick_reject(struct cs_stick *stick) {
    for (uint32_t i = 0; i < stick->system->view.n; i++)
        if (!stick->held[i])
            stick->on[i] = 0;
}

/* whether friction can hold particle i at p under the load */
static bool is_held(const struct cs_obstacle *obstacle, const double p[3],
                    const double load[3]) {
    const double mu = obstacle->collider->friction;
    double n[3], across = 0;
    cs_obstacle_gap(obstacle, p, n);
    const double inward = -(load[0] * n[0] + load[1] * n[1] + load[2] * n[2]);
    for (int c = 0; c < 3; c++) {
        const double t = load[c] + inward * n[c];
        across += t * t;
    }
    return inward > 0 && across <= mu * mu * inward * inward;
}

static bool any(const struct cs_stick *stick) {
    for (uint32_t i = 0; i < stick->system->view.n && stick->n == 0; i++)
        if (stick->on[i])
            return true;
    return stick->n > 0;
}

bool cs_stick_choose(struct cs_stick *stick, const struct cs_obstacle *obstacles, double t,
                     const double *x, const double *v, double *f) {
    const struct cs_system *system = stick->system;
    const size_t n = system->view.n;
    bool changed = false;
    if (stick->off || !any(stick))
        return false;
    if (cs_terms_need_normals(system, CS_PART_ALL))
        cs_normals_update(system, x);
    cs_terms_force(system, &(struct cs_eval){.t = t, .x = x, .v = v, .parts = CS_PART_ALL}, f);
    stick->n = 0;
    for (size_t i = 0; i < n; i++) {
        const bool before = stick->held[i];
        const double p[3] = {x[i], x[n + i], x[2 * n + i]};
        double load[3];
        for (size_t c = 0; c < 3; c++)
            load[c] = f[c * n + i] + (before ? stick->load[c * n + i] : 0);
        stick->held[i] = stick->on[i] && is_held(obstacles + stick->on[i] - 1, p, load);
        changed |= stick->held[i] != before;
        stick->n += stick->held[i];
        if (!stick->held[i])
            stick->on[i] = 0;
    }
    return changed;
}

void cs_stick_forget(struct cs_stick *stick) {
    const size_t n = stick->system->view.n;
    stick->n = 0;
    memset(stick->on, 0, n * sizeof *stick->on);
    memset(stick->held, 0, n * sizeof *stick->held);
}

/* the obstacle on which a particle at p with the velocity v is at rest + 1; 0: none */
static uint32_t find_on(const struct cs_stick *stick, const struct cs_obstacle *obstacles,
                        const double p[3], const double v[3]) {
    double n[3], carried[3];
    if (!cs_vec3_is_zero(v))
        return 0;
    for (uint32_t k = 0; k < stick->system->scene->colliders.n; k++) {
        cs_obstacle_velocity(obstacles + k, p, carried);
        if (fabs(cs_obstacle_gap(obstacles + k, p, n)) <= TOUCHING &&
            cs_vec3_is_zero(carried) && obstacles[k].collider->absorption == 1)
            return k + 1;
    }
    return 0;
}

void cs_stick_start(struct cs_stick *stick, const struct cs_obstacle *obstacles, double t,
                    const double *x, const double *v, double *f) {
    const size_t n = stick->system->view.n;
    cs_stick_forget(stick);
    for (size_t i = 0; i < n; i++) {
        const double p[3] = {x[i], x[n + i], x[2 * n + i]};
        const double w[3] = {v[i], v[n + i], v[2 * n + i]};
        if (stick->system->inv_mass[i] > 0)
            stick->on[i] = find_on(stick, obstacles, p, w);
    }
    cs_stick_choose(stick, obstacles, t, x, v, f);
}

void cs_stick_record(struct cs_stick *stick, struct cs_record *record) {
    const size_t n = stick->system->view.n;
    cs_record_bytes(record, stick->on, n * sizeof *stick->on);
    cs_record_bytes(record, stick->held, n * sizeof *stick->held);
    CS_RECORD(record, stick->n);
}
