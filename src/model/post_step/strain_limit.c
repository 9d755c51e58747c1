/* Strain limiting: Gauss-Seidel passes over the stretch springs of a body, forwards and
 * backwards in turn. */
#include "model/post_step/contact_projection.h"

#include <clothsim/clones.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* One pass of the strain limit over a grid, vectorised.
 *
 * A pass goes along all rows, each from its first spring to its last, then down: all springs
 * from the first row to the second, etc. A backward pass is the exact reverse. Springs
 * that are handled side by side share no particle (different rows, or all springs between two
 * rows), so that the width of vectors does not change a bit of the result. */

/* A grid in the arrays of the system, which it borrows. */
struct cs_strain_limit_grid {
    size_t n;               /* particles of all bodies */
    double *x, *v;          /* (3,n) at the grid's first particle, borrowed */
    const double *inv_mass; /* likewise, (n) in 1/kg */
    size_t columns, rows;
    /* m, largest lengths of springs along rows and between rows; 0: there are none */
    double row_springs, column_springs;
    /* 1/s: change of velocity per displacement */
    double inverse_dt;
};

enum {
    LANES = 16,  /* rows that go side by side: the next vector fills the wait for a root */
    LENGTH = 16, /* springs of each in a strip */
    NUMBERS = 6  /* of a particle: x, y, z and its velocity */
};

/* Some columns of sixteen rows, transposed. Its first column is the last one of the strip
 * before. */
struct strip {
    _Alignas(64) double numbers[LENGTH + 1][NUMBERS][LANES];
    double inv_mass[LENGTH + 1][LANES];
};

/* Particles of a strip: rows row + l, columns begin + j, counted from the last if backwards. */
struct place {
    size_t row, lanes, begin, count;
    bool backwards;
};

/* Index of the particle in lane `lane` and column j of a strip. */
CS_INLINE size_t particle_of(const struct cs_strain_limit_grid *grid, const struct place *place,
                             size_t lane, size_t j) {
    const size_t column = place->begin + j;
    return (place->row + lane) * grid->columns +
           (place->backwards ? grid->columns - 1 - column : column);
}

CS_INLINE void load(const struct cs_strain_limit_grid *grid, const struct place *place,
                    struct strip *strip, size_t j, size_t lane) {
    const size_t i = particle_of(grid, place, lane, j);
    for (size_t c = 0; c < 3; c++) {
        strip->numbers[j][c][lane] = grid->x[c * grid->n + i];
        strip->numbers[j][3 + c][lane] = grid->v[c * grid->n + i];
    }
    strip->inv_mass[j][lane] = grid->inv_mass[i];
}

CS_INLINE void store(const struct cs_strain_limit_grid *grid, const struct place *place,
                     const struct strip *strip, size_t j, size_t lane) {
    const size_t i = particle_of(grid, place, lane, j);
    for (size_t c = 0; c < 3; c++) {
        grid->x[c * grid->n + i] = strip->numbers[j][c][lane];
        grid->v[c * grid->n + i] = strip->numbers[j][3 + c][lane];
    }
}

/* Returns whether a spring is corrected; w is the sum of inverse masses, 0 between two pinned
 * ends. */
CS_INLINE bool is_moved(double squared, double longest, double w) {
    return (squared > longest * longest) & (w > 0);
}

/* Relative excess of length over w; 0 for a spring that is short enough. Without a branch, so
 * that loops vectorise; DBL_MIN keeps the quotient finite for w = 0. */
CS_INLINE double fraction_of(double squared, double longest, double w) {
    const double excess = 1 - longest / sqrt(squared);
    return (excess > 0 ? excess : 0) / (w + DBL_MIN);
}

CS_INLINE void move_lane(double p[NUMBERS][LANES], size_t l, double to, const double d[3],
                         double per_time) {
    p[0][l] += to * d[0];
    p[1][l] += to * d[1];
    p[2][l] += to * d[2];
    p[3][l] += to * d[0] * per_time;
    p[4][l] += to * d[1] * per_time;
    p[5][l] += to * d[2] * per_time;
}

/* Springs between two columns of a strip, by inverse masses, which conserves momentum. All
 * springs are treated alike: short ones move by 0. */
CS_INLINE uint64_t shorten_columns(double a[NUMBERS][LANES], double b[NUMBERS][LANES],
                                   const double *wa, const double *wb, double longest,
                                   double per_time) {
    uint64_t moves = 0;
    CS_INDEPENDENT
    for (size_t l = 0; l < LANES; l++) {
        const double d[3] = {b[0][l] - a[0][l], b[1][l] - a[1][l], b[2][l] - a[2][l]};
        const double squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], w = wa[l] + wb[l];
        const double share = fraction_of(squared, longest, w);
        const double to_a = wa[l] * share, to_b = -wb[l] * share;
        move_lane(a, l, to_a, d, per_time);
        move_lane(b, l, to_b, d, per_time);
        moves += is_moved(squared, longest, w);
    }
    return moves;
}

/* Loads a strip, shortens its springs column by column, and stores it if any was too long. */
CS_INLINE uint64_t shorten_strip(const struct cs_strain_limit_grid *grid,
                                 const struct place *place, struct strip *strip) {
    uint64_t moves = 0;
    for (size_t lane = 0; lane < place->lanes; lane++)
        for (size_t j = 0; j <= place->count; j++)
            load(grid, place, strip, j, lane);
    for (size_t j = 0; j < place->count; j++)
        moves += shorten_columns(strip->numbers[j], strip->numbers[j + 1], strip->inv_mass[j],
                                 strip->inv_mass[j + 1], grid->row_springs, grid->inverse_dt);
    for (size_t lane = 0; moves > 0 && lane < place->lanes; lane++)
        for (size_t j = 0; j <= place->count; j++)
            store(grid, place, strip, j, lane);
    return moves;
}

/* Squared length of the spring between two particles; its components go to d. */
CS_INLINE double squared_of(const struct cs_strain_limit_grid *grid, size_t a, size_t b,
                            double d[3]) {
    for (size_t c = 0; c < 3; c++)
        d[c] = grid->x[c * grid->n + b] - grid->x[c * grid->n + a];
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* Returns whether one of `count` springs, between particles first + k and first + k + to, is
 * too long. Most rows have none and are not transposed. */
CS_INLINE bool any_long(const struct cs_strain_limit_grid grid, size_t first, size_t count,
                        size_t to, double longest) {
    uint64_t any = 0;
    for (size_t i = first; i < first + count; i++) {
        double d[3];
        any |= squared_of(&grid, i, i + to, d) > longest * longest;
    }
    return any;
}

/* Handles up to sixteen rows side by side. */
CS_CLONES static uint64_t shorten_along(const struct cs_strain_limit_grid *grid,
                                        struct place place) {
    struct strip strip;
    const size_t springs = grid->columns - 1;
    uint64_t moves = 0;
    bool any = false;
    for (size_t l = 0; l < place.lanes && !any; l++)
        any = any_long(*grid, (place.row + l) * grid->columns, springs, 1, grid->row_springs);
    /* rows that there are not */
    if (any && place.lanes < LANES)
        memset(&strip, 0, sizeof strip);
    for (place.begin = 0; any && place.begin < springs; place.begin += LENGTH) {
        place.count = springs - place.begin < LENGTH ? springs - place.begin : LENGTH;
        moves += shorten_strip(grid, &place, &strip);
    }
    return moves;
}

CS_INLINE void move(const struct cs_strain_limit_grid *grid, size_t i, double by) {
    grid->x[i] += by;
    grid->v[i] += by * grid->inverse_dt;
}

/* Springs from a row to the next, by the formula of shorten_columns. */
CS_INLINE uint64_t shorten_rows(const struct cs_strain_limit_grid grid, size_t row) {
    const size_t first = row * grid.columns, to = grid.columns, n = grid.n;
    uint64_t moves = 0;
    CS_INDEPENDENT
    for (size_t a = first; a < first + to; a++) {
        double d[3];
        const double squared = squared_of(&grid, a, a + to, d);
        const double wa = grid.inv_mass[a], wb = grid.inv_mass[a + to], w = wa + wb;
        const double share = fraction_of(squared, grid.column_springs, w);
        const double to_a = wa * share, to_b = -wb * share;
        move(&grid, a, to_a * d[0]);
        move(&grid, n + a, to_a * d[1]);
        move(&grid, 2 * n + a, to_a * d[2]);
        move(&grid, a + to, to_b * d[0]);
        move(&grid, n + a + to, to_b * d[1]);
        move(&grid, 2 * n + a + to, to_b * d[2]);
        moves += is_moved(squared, grid.column_springs, w);
    }
    return moves;
}

CS_CLONES static uint64_t shorten_down(const struct cs_strain_limit_grid *grid, size_t row) {
    if (!any_long(*grid, row * grid->columns, grid->columns, grid->columns,
                  grid->column_springs))
        return 0;
    return shorten_rows(*grid, row);
}

static uint64_t go_along(const struct cs_strain_limit_grid *grid, bool backwards) {
    uint64_t moves = 0;
    for (size_t row = 0; grid->row_springs > 0 && row < grid->rows; row += LANES) {
        const size_t left = grid->rows - row;
        moves += shorten_along(grid, (struct place){.row = row,
                                                    .lanes = left < LANES ? left : LANES,
                                                    .backwards = backwards});
    }
    return moves;
}

static uint64_t go_down(const struct cs_strain_limit_grid *grid, bool backwards) {
    uint64_t moves = 0;
    for (size_t k = 0; grid->column_springs > 0 && k + 1 < grid->rows; k++)
        moves += shorten_down(grid, backwards ? grid->rows - 2 - k : k);
    return moves;
}

/* Runs one pass; returns the number of springs that were shortened. */
static uint64_t strain_limit_grid_pass(const struct cs_strain_limit_grid *grid,
                                       bool backwards) {
    if (backwards) {
        const uint64_t moves = go_down(grid, true);
        return moves + go_along(grid, true);
    }
    const uint64_t moves = go_along(grid, false);
    return moves + go_down(grid, false);
}

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
                grid.rows ? strain_limit_grid_pass(&grid, k % 2) : mesh_pass(&pass, k % 2);
            moves += moved;
            if (moved == 0)
                break;
        }
    }
    return moves;
}
