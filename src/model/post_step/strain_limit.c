/* Strain limiting: Gauss-Seidel passes over the stretch springs of a body, forwards and
 * backwards in turn. */
#include "model/post_step/strain_limit.h"

#include "model/post_step/strain_limit_grid.h"

#include <math.h>

/* Parameters of the passes over one body. */
struct pass {
    const struct cs_system *system;
    uint32_t body;
    /* largest length over rest length (1) */
    double limit;
    /* 1/s: change of velocity per displacement */
    double per_time;
    double *x, *v;
};

/* Returns whether a run of springs is limited in this pass. */
static bool is_limited(const struct pass *pass, const struct cs_spring_run *run) {
    return run->body == pass->body && run->kind == CS_SPRING_STRETCH;
}

/* Shortens one spring of a mesh; returns whether it was too long. Displacements by inverse
 * masses conserve the momentum of the pair. */
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

/* One pass over a mesh in the order of its springs. */
static uint64_t mesh_pass(const struct pass *pass, bool backwards) {
    const struct cs_springs *springs = &pass->system->springs;
    uint64_t moves = 0;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const uint32_t count = is_limited(pass, run) ? run->count : 0;
        for (uint32_t j = 0; j < count; j++)
            moves += shorten(pass, run, backwards ? count - 1 - j : j);
    }
    return moves;
}

/* Describes the grid of a body; no rows: the body is no grid, or has no stretch springs. The
 * runs of the first row define all of it. */
static struct cs_strain_limit_grid grid_of(const struct pass *pass) {
    const struct cs_springs *springs = &pass->system->springs;
    struct cs_strain_limit_grid grid = {.n = pass->system->view.n,
                                        .inverse_dt = pass->per_time};
    for (uint32_t r = 0;
         r < springs->n_runs && !(grid.row_springs > 0 && grid.column_springs > 0); r++) {
        const struct cs_spring_run *run = springs->runs + r;
        if (!is_limited(pass, run) || !run->columns)
            continue;
        if (grid.rows == 0) {
            grid.x = pass->x + run->row;
            grid.v = pass->v + run->row;
            grid.inv_mass = pass->system->inv_mass + run->row;
            grid.columns = run->columns;
            grid.rows = run->rows_below + 1;
        }
        *(run->direction == CS_DIRECTION_RIGHT ? &grid.row_springs : &grid.column_springs) =
            pass->limit * run->length;
    }
    return grid;
}

/* Bodies one after the other; odd passes run backwards. */
uint64_t cs_strain_limit_apply(const struct cs_system *system, double dt, double *x,
                               double *v) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    const double frame = 1 / system->scene->time.fps, per_time = 1 / fmax(dt, frame);
    uint64_t moves = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        if (isnan(bodies[b].strain_limit))
            continue;
        const struct pass pass = {system, b, bodies[b].strain_limit, per_time, x, v};
        const struct cs_strain_limit_grid grid = grid_of(&pass);
        for (int64_t k = 0; k < bodies[b].strain_limit_sweeps; k++) {
            const uint64_t moved =
                grid.rows ? cs_strain_limit_grid_pass(&grid, k % 2) : mesh_pass(&pass, k % 2);
            moves += moved;
            if (moved == 0)
                break;
        }
    }
    return moves;
}
