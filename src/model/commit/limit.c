#include "model/commit/limit.h"

#include <math.h>

/* one spring; true if it was too long */
static bool shorten(const struct cs_system *system, uint32_t a, uint32_t b, double longest,
                    double per_time, double *x, double *v) {
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
        v[c * n + a] += move_a * per_time;
        v[c * n + b] += move_b * per_time;
    }
    return true;
}

/* one pass, forwards or backwards */
static uint64_t sweep(const struct cs_system *system, uint32_t body, double limit,
                      double per_time, bool backwards, double *x, double *v) {
    uint64_t moves = 0;
    for (uint32_t k = 0; k < system->springs.n_runs; k++) {
        const struct cs_spring_run *run =
            system->springs.runs + (backwards ? system->springs.n_runs - 1 - k : k);
        if (run->body != body || run->kind != CS_SPRING_STRETCH)
            continue;
        for (uint32_t j = 0; j < run->count; j++) {
            const uint32_t i = backwards ? run->count - 1 - j : j;
            moves += shorten(system, cs_spring_a(run, i), cs_spring_b(run, i),
                             limit * cs_spring_length(run, i), per_time, x, v);
        }
    }
    return moves;
}

uint64_t cs_limit_apply(const struct cs_system *system, double dt, double *x, double *v) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    const double frame = 1 / system->scene->time.fps, per_time = 1 / fmax(dt, frame);
    uint64_t moves = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const int64_t sweeps =
            isnan(bodies[b].strain_limit) ? 0 : bodies[b].strain_limit_sweeps;
        for (int64_t k = 0; k < sweeps; k++) {
            const uint64_t moved =
                sweep(system, b, bodies[b].strain_limit, per_time, k % 2, x, v);
            moves += moved;
            if (moved == 0)
                break;
        }
    }
    return moves;
}
