/* grid_stencil.h - stencil kernels: evaluates all springs that start in one grid row, tile by
 * tile.
 *
 * A particle begins springs in up to six directions: right, two to the right, down, both
 * diagonals, two down. A kernel computes the directions of a tile side by side and stores the
 * results in rows on the stack. The tile is then added to three rows of particles, once each:
 *
 *   own row      sum over the directions - (right[i - 1] + right two[i - 2])
 *   next row     - (down[i] + down right[i - 1] + down left[i + 1])
 *   row after    - down two[i]
 *
 * The signs are those of forces; blocks are added with a plus at both ends. Six passes, one per
 * direction, would load and store each row of particles up to six times.
 *
 * Tiles begin at multiples of TILE particles of the row, whatever block of particles is asked
 * for. No sum therefore depends on the number of threads. Loops run over whole tiles: beside
 * the ends of a row they read other particles, and those results are dropped. In the last two
 * rows of a grid such reads could lie beyond the arrays; these rows are done direction by
 * direction, without them. */
#ifndef CS_GRID_STENCIL_H
#define CS_GRID_STENCIL_H

#include "model/spring/run_pieces.h"

/* Sizes of a tile and of its results. */
enum {
    TILE = 64,  /* particles per tile; 32 took 1.1 of the time at 64 x 64 (docs/notes) */
    MARGIN = 8, /* more than any spring reaches along the row, and a whole vector */
    PACKED_COLUMNS_MAX = 24, /* of rows that a tile packs; wider ones gain nothing */
    BEFORE = 2 * PACKED_COLUMNS_MAX + MARGIN, /* results that tiles of packed rows keep */
    PACKED_TILE = 128,                        /* size of tiles of packed rows */
    PADDED_TILE = BEFORE + PACKED_TILE + 2 * MARGIN, /* odd in cache lines */
    NUMBERS_PER_SPRING_MAX = 15, /* most results per spring: force 3, df/dx 6, df/dv 6 */
    DIRECTIONS_AT_ONCE = 3       /* directions that one loop computes side by side */
};

/* One direction of a row's springs; numbers by particle of the tile. */
struct stencil_direction {
    double k, length;      /* N/m and m; the same for the whole run */
    size_t offset;         /* from a particle to the other end of its spring */
    const double *factors; /* of the matrix, in rows of `stride`; NULL: not used */
    size_t stride;
    double *out; /* results, in rows of PADDED_TILE */
};

/* Input of a kernel: arrays from the tile's first particle on; NULL where a kernel does not
 * read them. */
struct stencil_input {
    const double *x, *v, *dx, *dv;
    size_t n;
    double c;   /* damping in N s/m */
    bool axial; /* damping along the springs only */
};

/* Computes the springs of one, two or three directions from particles [begin, end) of the tile.
 */
typedef void stencil_pass(const struct stencil_input *in, const struct stencil_direction *ways,
                          size_t begin, size_t end);

/* A kernel, compiled for one, two and three directions, or for one alone (the others NULL). Its
 * results per spring follow one another: those of the force, for job->to; of df/dx, for
 * at.dfdx_blocks; of df/dv, for at.dfdv_blocks. A particle gets those of the springs that it
 * begins. The other ends get the same of blocks, and the opposite of forces. */
struct stencil_kernel {
    stencil_pass *passes[DIRECTIONS_AT_ONCE];
    size_t n_force, n_dfdx, n_dfdv;
};

/* The runs of one row, by direction. */
struct row_stencil {
    const struct cs_spring_run
        *directions[CS_DIRECTIONS];    /* NULL: no such springs, or they contribute nothing */
    const struct cs_spring_run *first; /* any run of the row: gives row, columns, rows_below */
};

/* Adds a kernel's results for a row's springs to the particles of a block. Only the block is
 * written, although a row of springs at its border is computed for both neighbours. */
void cs_grid_stencil_add(const struct spring_job *job, const struct cs_block *block,
                         const struct row_stencil *stencil,
                         const struct stencil_kernel *kernel);

/* The same for all rows of a grid from the stencil's on, several of which a tile packs. A
 * particle's sum has the same order. */
void cs_grid_stencil_add_packed(const struct spring_job *job, const struct cs_block *block,
                                const struct row_stencil *stencil,
                                const struct stencil_kernel *kernel);

/* Collects the runs of a row, from its first on, and adds a kernel's results for those that
 * `asks` accepts. Returns the number of runs in the row, or in the grid if its rows are packed.
 */
CS_INLINE uint32_t add_row_stencil(const struct spring_job *job, const struct cs_block *block,
                                   const struct cs_spring_run *first, run_test *asks,
                                   const struct stencil_kernel *kernel) {
    const struct cs_spring_run *run = first, *end = job->springs->runs + job->springs->n_runs;
    struct row_stencil stencil = {.first = first};
    bool acts = false;
    for (; run < end && run->columns && run->row == first->row; run++)
        if (asks(job, run)) {
            stencil.directions[run->direction] = run;
            acts = true;
        }
    const bool packed = first->columns <= PACKED_COLUMNS_MAX;
    if (acts && packed)
        cs_grid_stencil_add_packed(job, block, &stencil, kernel);
    else if (acts)
        cs_grid_stencil_add(job, block, &stencil, kernel);
    // rows of one grid have the same springs
    while (packed && run < end && run->columns && run->body == first->body)
        run++;
    return (uint32_t)(run - first);
}

/* Chooses the kernel for a row's law and the results wanted. */
typedef const struct stencil_kernel *stencil_choice(const struct spring_job *job,
                                                    const struct cs_spring_run *first);

/* Adds the results of all runs to the particles of a block, in the order of the runs. Grids go
 * row by row. Meshes go by their slots if several threads share them, else directly. Without
 * job->to only blocks are wanted, which meshes add elsewhere (cs_springs_finish_diagonal). */
CS_INLINE void add_runs(const struct spring_job *job, const struct cs_block *block,
                        run_test *asks, stencil_choice *choose, piece_kernel *kernel) {
    const struct cs_springs *springs = job->springs;
    uint32_t n_runs = 1;
    for (uint32_t r = block->first_run; r < block->end_run; r += n_runs) {
        const struct cs_spring_run *run = springs->runs + r;
        n_runs = 1;
        if (run->columns)
            n_runs = add_row_stencil(job, block, run, asks, choose(job, run));
        else if (!job->to)
            continue;
        else if (asks(job, run) && springs->slots)
            gather(springs->slots + r, run, block, job->n, job->to);
        else if (asks(job, run))
            add_run(job, run, kernel);
    }
}

/* Difference over the spring of a direction from particle i of the tile: other end less
 * particle. */
CS_INLINE struct difference fan_across(const double *p, size_t n, size_t i, size_t step) {
    return (struct difference){p[i + step] - p[i], p[n + i + step] - p[n + i],
                               p[2 * n + i + step] - p[2 * n + i]};
}

/* Stores a vector as the first three results. */
CS_INLINE void fan_put(struct difference from, double *out) {
    out[0] = from.x;
    out[1] = from.y;
    out[2] = from.z;
}

/* Computes the results of the spring from particle i of the tile. */
typedef void stencil_spring(const struct stencil_input *in, const struct stencil_direction *way,
                            size_t i, double *out);

/* Computes one spring and stores its results, each in its own row. */
CS_INLINE void stencil_make(const struct stencil_input *in, const struct stencil_direction *way,
                            size_t i, stencil_spring *spring, const size_t parts) {
    double made[NUMBERS_PER_SPRING_MAX];
    spring(in, way, i, made);
    for (size_t k = 0; k < parts; k++)
        way->out[k * PADDED_TILE + i] = made[k];
}

/* The loop of a pass. Iterations are independent: every direction writes to rows of its own. */
CS_INLINE void stencil_springs(const struct stencil_input in, const struct stencil_direction p,
                               const struct stencil_direction q,
                               const struct stencil_direction r, const unsigned ways,
                               stencil_spring *spring, const size_t parts, size_t begin,
                               size_t end) {
    CS_INDEPENDENT
    for (size_t i = begin; i < end; i++) {
        stencil_make(&in, &p, i, spring, parts);
        if (ways > 1)
            stencil_make(&in, &q, i, spring, parts);
        if (ways > 2)
            stencil_make(&in, &r, i, spring, parts);
    }
}

/* Compiles the loop for n directions; `second` and `third` name those that exist, or repeat a
 * valid one. */
#define CS_STENCIL_PASS(name, spring, parts, n, second, third)                                 \
    CS_CLONES static void name(const struct stencil_input *in,                                 \
                               const struct stencil_direction *ways, size_t begin,             \
                               size_t end) {                                                   \
        stencil_springs(*in, ways[0], ways[second], ways[third], n, spring, parts, begin,      \
                        end);                                                                  \
    }

/* Defines the kernel `name` from spring(), an inline function that computes one spring, and
 * from the number of results of the force, of df/dx and of df/dv. */
#define CS_STENCIL_KERNEL(name, spring, forces_, stiff_, damped_)                              \
    CS_STENCIL_PASS(name##_1, spring, forces_ + stiff_ + damped_, 1, 0, 0)                     \
    CS_STENCIL_PASS(name##_2, spring, forces_ + stiff_ + damped_, 2, 1, 1)                     \
    CS_STENCIL_PASS(name##_3, spring, forces_ + stiff_ + damped_, 3, 1, 2)                     \
    static const struct stencil_kernel name = {                                                \
        {name##_1, name##_2, name##_3}, forces_, stiff_, damped_}

/* The same for one direction at a time: for results that are seldom asked for. Two and three
 * take five times as long to compile. */
#define CS_STENCIL_KERNEL_ALONE(name, spring, forces_, stiff_, damped_)                        \
    CS_STENCIL_PASS(name##_1, spring, forces_ + stiff_ + damped_, 1, 0, 0)                     \
    static const struct stencil_kernel name = {{name##_1}, forces_, stiff_, damped_}

/* Defines the kernel `name` by one of these two, from a call that computes one spring. */
#define CS_STENCIL_VARIANT(define, name, call, forces, stiff, damped)                          \
    CS_INLINE void name##_spring(const struct stencil_input *in,                               \
                                 const struct stencil_direction *way, size_t i, double *out) { \
        call;                                                                                  \
    }                                                                                          \
    define(name, name##_spring, forces, stiff, damped)

#endif
