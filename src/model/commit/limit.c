/* Strain limiting: passes over the stretch springs of a body, forwards and backwards in turn.
 */
#include "model/commit/limit.h"

#include <math.h>

/* passes over a body */
struct pass {
    const struct cs_system *system;
    uint32_t body;
    double limit;    /* of a length over that at rest */
    double per_time; /* 1/s: what a move does to the velocity */
    double *x, *v;
};

/* one spring; true if it was too long */
static bool shorten(const struct pass *pass, const struct cs_spring_run *run, uint32_t i) {
    const struct cs_system *system = pass->system;
    const uint32_t a = cs_spring_a(run, i), b = cs_spring_b(run, i);
    const double longest = pass->limit * cs_spring_length(run, i);
    const size_t n = system->view.n;
    double *x = pass->x, *v = pass->v;
    double d[3], squared = 0;
    for (size_t c = 0; c < 3; c++) {
        d[c] = x[c * n + b] - x[c * n + a];
        squared += d[c] * d[c];
    }
    const double wa = system->inv_mass[a], wb = system->inv_mass[b];
    /* nothing to move between two pinned ends */
    if (!(squared > longest * longest) || wa + wb == 0)
        return false;
    /* by inverse masses, so that the pair keeps its momentum */
    const double share = (1 - longest / sqrt(squared)) / (wa + wb);
    for (size_t c = 0; c < 3; c++) {
        const double move_a = wa * share * d[c], move_b = -wb * share * d[c];
        x[c * n + a] += move_a;
        x[c * n + b] += move_b;
        v[c * n + a] += move_a * pass->per_time;
        v[c * n + b] += move_b * pass->per_time;
    }
    return true;
}

/* one pass, forwards or backwards */
static uint64_t sweep(const struct pass *pass, bool backwards) {
    const struct cs_system *system = pass->system;
    uint64_t moves = 0;
    for (uint32_t k = 0; k < system->springs.n_runs; k++) {
        const struct cs_spring_run *run =
            system->springs.runs + (backwards ? system->springs.n_runs - 1 - k : k);
        if (run->body != pass->body || run->kind != CS_SPRING_STRETCH)
            continue;
        for (uint32_t j = 0; j < run->count; j++) {
            const uint32_t i = backwards ? run->count - 1 - j : j;
            moves += shorten(pass, run, i);
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
        const struct pass pass = {system, b, bodies[b].strain_limit, per_time, x, v};
        for (int64_t k = 0; k < sweeps; k++) {
            const uint64_t moved = sweep(&pass, k % 2);
            moves += moved;
            if (moved == 0)
                break;
        }
    }
    return moves;
}
