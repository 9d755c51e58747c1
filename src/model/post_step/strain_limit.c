/* Strain limiting: Gauss-Seidel passes over the stretch springs of a body, forwards and
 * backwards in turn, then rounds until the limit is met.
 *
 * A pass hands a pull on by one spring, so that a grid of n rows needs about n^2 passes. A
 * round over a grid therefore begins with pairs that no path of springs can join: pinned
 * particles and all others, and particles 2^k springs apart along rows and columns. Of 40 x 40
 * particles a sheet too weak for its weight needs up to 60 rounds a step, and 1000 passes leave
 * 10 %. */
#include "model/post_step/contact_projection.h"
#include "scene/body_keys.h"

#include <clothsim/clones.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* A pass over a grid goes along all rows, each from its first spring to its last, then down:
 * all springs from the first row to the second, etc. A backward pass is the exact reverse.
 * Springs that are handled side by side share no particle, so that the width of vectors does
 * not change a bit of the result. */

/* Rounds after the passes, at most. */
#define ROUNDS_MAX 128

/* Pinned particles that a round begins with, at most. */
#define PINS_MAX 16

/* Rows that go side by side: their lines fit the first cache. */
#define LANES 16

/* A grid in the arrays of the system, which it borrows. */
struct cs_strain_limit_grid {
    size_t n;               /* particles of all bodies */
    double *x, *v;          /* (3,n) at the grid's first particle, borrowed */
    const double *inv_mass; /* likewise, (n) in 1/kg */
    size_t columns, rows;
    /* m, largest lengths of springs along rows and between rows; 0: there are none */
    double row_springs, column_springs;
    double inverse_dt; /* 1/s */
};

/* Pairs of particles first + k step and those `to` after them, k below count; no two share a
 * particle. */
struct pairs {
    size_t first, count, step, to;
    double longest; /* m */
};

/* d = x_b - x_a, and d.(v_b - v_a) in *lengthening. Returns d.d. */
CS_INLINE double difference(const struct cs_strain_limit_grid grid, size_t a, size_t b,
                            double d[3], double *lengthening) {
    const double *x = grid.x, *v = grid.v;
    const size_t n = grid.n;
    for (size_t c = 0; c < 3; c++)
        d[c] = x[c * n + b] - x[c * n + a];
    *lengthening = d[0] * (v[b] - v[a]) + d[1] * (v[n + b] - v[n + a]) +
                   d[2] * (v[2 * n + b] - v[2 * n + a]);
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* Relative excess of length over w, the sum of inverse masses; 0 for a spring that is short
 * enough. Without a branch, so that loops vectorise; DBL_MIN keeps the quotient finite for
 * w = 0, two pinned ends. */
CS_INLINE double fraction_of(double squared, double longest, double w) {
    const double excess = 1 - longest / sqrt(squared);
    return (excess > 0 ? excess : 0) / (w + DBL_MIN);
}

/* The same for velocities: the fraction over dt, but no more than stops the lengthening. */
CS_INLINE double velocity_fraction(double squared, double w, double lengthening,
                                   double fraction, double inverse_dt) {
    const double stops = (lengthening > 0 ? lengthening : 0) / (squared * w + DBL_MIN);
    const double fits = fraction * inverse_dt;
    return fits < stops ? fits : stops;
}

/* Moves the ends of a spring by inverse masses, which conserves momentum. Springs that are
 * short enough move by 0. Returns whether it was corrected. */
CS_INLINE uint64_t shorten(const struct cs_strain_limit_grid grid, size_t a, size_t b,
                           double longest) {
    double *x = grid.x, *v = grid.v;
    const size_t n = grid.n;
    double d[3], lengthening;
    const double squared = difference(grid, a, b, d, &lengthening);
    const double wa = grid.inv_mass[a], wb = grid.inv_mass[b], w = wa + wb;
    const double share = fraction_of(squared, longest, w);
    const double v_share = velocity_fraction(squared, w, lengthening, share, grid.inverse_dt);
    for (size_t c = 0; c < 3; c++) {
        x[c * n + a] += wa * share * d[c];
        x[c * n + b] -= wb * share * d[c];
        v[c * n + a] += wa * v_share * d[c];
        v[c * n + b] -= wb * v_share * d[c];
    }
    return (squared > longest * longest) & (w > 0);
}

/* A step of 1 is a constant here, for loops of vectors without gathers. */
CS_INLINE uint64_t shorten_each(const struct cs_strain_limit_grid grid, const struct pairs of,
                                size_t step) {
    uint64_t moves = 0;
    CS_INDEPENDENT
    for (size_t k = 0; k < of.count; k++) {
        const size_t a = of.first + k * step;
        moves += shorten(grid, a, a + of.to, of.longest);
    }
    return moves;
}

CS_CLONES static uint64_t shorten_pairs(const struct cs_strain_limit_grid *grid,
                                        const struct pairs *of) {
    return of->step == 1 ? shorten_each(*grid, *of, 1) : shorten_each(*grid, *of, of->step);
}

/* Returns whether a pair is too long: most rows have none. */
CS_CLONES static bool any_long(const struct cs_strain_limit_grid *grid,
                               const struct pairs *of) {
    uint64_t any = 0;
    for (size_t i = of->first; i < of->first + of->count; i++) {
        double d[3], lengthening;
        any |= difference(*grid, i, i + of->to, d, &lengthening) > of->longest * of->longest;
    }
    return any;
}

/* Pairs `apart` columns apart in up to LANES rows from `row` on. */
static uint64_t go_along_rows(const struct cs_strain_limit_grid *grid, size_t row, size_t apart,
                              bool backwards) {
    const size_t columns = grid->columns, pairs = columns - apart;
    const size_t lanes = grid->rows - row < LANES ? grid->rows - row : LANES;
    struct pairs of = {0, pairs, 1, apart, (double)apart * grid->row_springs};
    uint64_t moves = 0;
    bool any = false;
    for (size_t l = 0; l < lanes && !any; l++) {
        of.first = (row + l) * columns;
        any = any_long(grid, &of);
    }
    of.count = lanes;
    of.step = columns;
    for (size_t j = 0; any && j < pairs; j++) {
        of.first = row * columns + (backwards ? pairs - 1 - j : j);
        moves += shorten_pairs(grid, &of);
    }
    return moves;
}

static uint64_t go_along(const struct cs_strain_limit_grid *grid, size_t apart,
                         bool backwards) {
    uint64_t moves = 0;
    for (size_t row = 0; grid->row_springs > 0 && apart < grid->columns && row < grid->rows;
         row += LANES)
        moves += go_along_rows(grid, row, apart, backwards);
    return moves;
}

/* Pairs `apart` rows apart. */
static uint64_t go_down(const struct cs_strain_limit_grid *grid, size_t apart, bool backwards) {
    const size_t columns = grid->columns;
    struct pairs of = {0, columns, 1, apart * columns, (double)apart * grid->column_springs};
    uint64_t moves = 0;
    for (size_t k = 0; grid->column_springs > 0 && k + apart < grid->rows; k++) {
        of.first = (backwards ? grid->rows - 1 - apart - k : k) * columns;
        moves += any_long(grid, &of) ? shorten_pairs(grid, &of) : 0;
    }
    return moves;
}

/* Runs one pass over pairs `apart`; returns the number of them that were shortened. */
static uint64_t grid_pass(const struct cs_strain_limit_grid *grid, size_t apart,
                          bool backwards) {
    uint64_t moves = backwards ? go_down(grid, apart, true) : 0;
    moves += go_along(grid, apart, backwards);
    return moves + (backwards ? 0 : go_down(grid, apart, false));
}

/* Moves all particles that a path of springs to a pinned one cannot reach (Kim, Chentanez,
 * Mueller 2012): alone a pin would move its neighbour, and all others would pull that back. */
static void go_from_pin(const struct cs_strain_limit_grid *grid, size_t pin) {
    const size_t columns = grid->columns, row = pin / columns, column = pin % columns;
    for (size_t r = 0, i = 0; r < grid->rows; r++)
        for (size_t c = 0; c < columns; c++, i++) {
            const size_t along = c > column ? c - column : column - c;
            const size_t down = r > row ? r - row : row - r;
            shorten(*grid, i, pin,
                    (double)along * grid->row_springs + (double)down * grid->column_springs);
        }
}

/* Up to PINS_MAX pinned particles, evenly among all. */
static void go_from_pins(const struct cs_strain_limit_grid *grid) {
    const size_t n = grid->columns * grid->rows;
    size_t pins = 0, next = 0;
    for (size_t i = 0; i < n; i++)
        pins += !(grid->inv_mass[i] > 0);
    const size_t step = (pins + PINS_MAX - 1) / PINS_MAX;
    for (size_t i = 0, k = 0; i < n && pins > 0; i++)
        if (!(grid->inv_mass[i] > 0) && k++ == next) {
            go_from_pin(grid, i);
            next += step;
        }
}

/* Passes over far pairs, from the farthest to those of two springs. */
static void go_far(const struct cs_strain_limit_grid *grid) {
    const size_t longer = grid->columns > grid->rows ? grid->columns : grid->rows;
    size_t apart = 1;
    while (2 * apart < longer)
        apart *= 2;
    for (; apart > 1; apart /= 2)
        grid_pass(grid, apart, false);
}

/* Parameters of the passes over one body. */
struct pass {
    const struct cs_system *system;
    uint32_t body;
    /* largest length over rest length (1) */
    double limit;
    double inverse_dt; /* 1/s */
    double *x, *v;
};

/* Returns whether a run of springs is limited in this pass. */
static bool is_limited(const struct pass *pass, const struct cs_spring_run *run) {
    return run->body == pass->body && run->kind == CS_SPRING_STRETCH;
}

/* The particles of all bodies, which springs of a mesh number. */
static struct cs_strain_limit_grid all_of(const struct pass *pass) {
    return (struct cs_strain_limit_grid){.n = pass->system->view.n,
                                         .x = pass->x,
                                         .v = pass->v,
                                         .inv_mass = pass->system->inv_mass,
                                         .inverse_dt = pass->inverse_dt};
}

/* One pass over a mesh in the order of its springs. */
static uint64_t mesh_pass(const struct pass *pass, bool backwards) {
    const struct cs_springs *springs = &pass->system->springs;
    uint64_t moves = 0;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const uint32_t count = is_limited(pass, run) ? run->count : 0;
        for (uint32_t j = 0; j < count; j++) {
            const uint32_t i = backwards ? count - 1 - j : j;
            moves += shorten(all_of(pass), cs_spring_a(run, i), cs_spring_b(run, i),
                             pass->limit * cs_spring_length(run, i));
        }
    }
    return moves;
}

/* Describes the grid of a body; no rows: the body is no grid, or has no stretch springs. The
 * runs of the first row define all of it. */
static struct cs_strain_limit_grid grid_of(const struct pass *pass) {
    const struct cs_springs *springs = &pass->system->springs;
    struct cs_strain_limit_grid grid = {.n = pass->system->view.n,
                                        .inverse_dt = pass->inverse_dt};
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

/* Largest length over the limit of springs that can be shortened, less 1; below 0: none is
 * that long. */
static double largest_excess(const struct pass *pass) {
    const struct cs_system *system = pass->system;
    double largest = 0;
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; is_limited(pass, run) && i < run->count; i++) {
            const uint32_t a = cs_spring_a(run, i), b = cs_spring_b(run, i);
            const double longest = pass->limit * cs_spring_length(run, i);
            double d[3], lengthening;
            const double squared = difference(all_of(pass), a, b, d, &lengthening);
            if (system->inv_mass[a] + system->inv_mass[b] > 0)
                largest = fmax(largest, squared / (longest * longest));
        }
    }
    return sqrt(largest) - 1;
}

/* One round; returns the number of springs shortened by its pass. */
static uint64_t go_round(const struct pass *pass, const struct cs_strain_limit_grid *grid) {
    if (!grid->rows)
        return mesh_pass(pass, false);
    go_from_pins(grid);
    go_far(grid);
    return grid_pass(grid, 1, false);
}

/* y += share (y - before), and before becomes the former y. */
CS_CLONES static void extrapolate(size_t count, double share, double *restrict y,
                                  double *restrict before) {
    CS_INDEPENDENT
    for (size_t i = 0; i < count; i++) {
        const double now = y[i];
        y[i] += share * (now - before[i]);
        before[i] = now;
    }
}

/* Rounds until the limit is met, each begun beyond the last one (Nesterov 1983), by so much
 * less again where the excess has grown (O'Donoghue, Candes 2015): a fifth of the rounds.
 * Weights of states add up to 1, which keeps momentum, and their velocities follow their
 * positions. */
static uint64_t go_rounds(const struct pass *pass, const struct cs_strain_limit_grid *grid,
                          struct cs_strain_limit *limit) {
    const size_t n3 = 3 * (size_t)pass->system->view.n;
    double theta = 1, excess = largest_excess(pass);
    uint64_t moves = 0;
    memcpy(limit->before, pass->x, n3 * sizeof *pass->x);
    memcpy(limit->before + n3, pass->v, n3 * sizeof *pass->v);
    for (int k = 0; k < ROUNDS_MAX && excess > CS_STRAIN_LIMIT_TOLERANCE; k++) {
        const double next = (1 + sqrt(1 + 4 * theta * theta)) / 2;
        extrapolate(n3, (theta - 1) / next, pass->x, limit->before);
        extrapolate(n3, (theta - 1) / next, pass->v, limit->before + n3);
        moves += go_round(pass, grid);
        const double left = largest_excess(pass);
        theta = left > excess ? 1 : next;
        excess = left;
    }
    limit->missed =
        excess > CS_STRAIN_LIMIT_TOLERANCE ? fmax(limit->missed, excess) : limit->missed;
    return moves;
}

/* Bodies one after the other; odd passes run backwards. */
uint64_t cs_strain_limit_apply(struct cs_strain_limit *limit, const struct cs_system *system,
                               double dt, double *x, double *v) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    uint64_t moves = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        if (isnan(bodies[b].strain_limit))
            continue;
        const struct pass pass = {system, b, bodies[b].strain_limit, 1 / dt, x, v};
        const struct cs_strain_limit_grid grid = grid_of(&pass);
        uint64_t moved = 1;
        for (int64_t k = 0; moved > 0 && k < bodies[b].strain_limit_sweeps; k++)
            moves += moved = grid.rows ? grid_pass(&grid, 1, k % 2) : mesh_pass(&pass, k % 2);
        if (moved > 0 && limit->before)
            moves += go_rounds(&pass, &grid, limit);
    }
    return moves;
}
