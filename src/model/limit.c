#include "model/limit.h"

#include <math.h>

/* one spring; true if it was too long */
static bool shorten(const struct cs_system *system, uint32_t a, uint32_t b, double longest,
                    double per_dt, double *x, double *v) {
    const size_t n = system->view.n;
    double d[3], squared = 0;
    for (size_t c = 0; c < 3; c++) {
        d[c] = x[c * n + b] - x[c * n + a];
        squared += d[c] * d[c];
    }
    const double wa = system->inv_mass[a], wb = system->inv_mass[b];
    if (!(squared > longest * longest) || wa + wb == 0)
        return false;
    const double share = (1 - longest / sqrt(squared)) / (wa + wb);
    for (size_t c = 0; c < 3; c++) {
        const double move_a = wa * share * d[c], move_b = -wb * share * d[c];
        x[c * n + a] += move_a;
        x[c * n + b] += move_b;
        v[c * n + a] += move_a * per_dt;
        v[c * n + b] += move_b * per_dt;
    }
    return true;
}

static uint64_t sweep_body(const struct cs_system *system, uint32_t body, double limit,
                           double per_dt, double *x, double *v) {
    uint64_t moves = 0;
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; i < run->count && run->body == body; i++)
            moves += shorten(system, run->a + i, run->b + i, limit * run->length, per_dt, x, v);
    }
    return moves;
}

uint64_t cs_limit_apply(const struct cs_system *system, double dt, double *x, double *v) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    uint64_t moves = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++)
        for (int64_t k = 0; k < bodies[b].strain_limit_sweeps && !isnan(bodies[b].strain_limit);
             k++) {
            const uint64_t moved =
                sweep_body(system, b, bodies[b].strain_limit, 1 / dt, x, v);
            moves += moved;
            if (moved == 0)
                break;
        }
    return moves;
}
