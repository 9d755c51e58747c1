/* grid_stencil.h - all springs that lead forward from one row of a grid, at once.
 *
 * The springs of a row fan out in up to six ways: right, two to the right, down, both
 * diagonals, two down. A kernel does the ways of a tile of particles side by side, sums what
 * each particle gets from its own springs in registers, and the tile is then added to three
 * rows, once each:
 *
 *   own row      sum over the ways - (right[i - 1] + right two[i - 2])
 *   next row     - (down[i] + forth[i - 1] + back[i + 1])
 *   after next   - down two[i]
 *
 * Tiles begin at multiples of TILE particles of the row, whatever block of particles is asked
 * for: so no sum depends on the number of threads. Loops run over whole tiles: what they read
 * beside the ends of a row belongs to other particles, and what they make of it is dropped. The
 * last two rows of a grid, where that would lie behind the arrays, are done way by way. */
#ifndef CS_GRID_STENCIL_H
#define CS_GRID_STENCIL_H

#include "model/spring/run_pieces.h"

enum {
    TILE = 64,  /* particles whose springs are done together */
    MARGIN = 8, /* more than any way reaches along the row, and a whole vector */
    PADDED_TILE = MARGIN + TILE + MARGIN,
    NUMBERS_PER_SPRING_MAX = 15, /* numbers that a kernel makes of a spring */
    DIRECTIONS_AT_ONCE = 3       /* ways that are done side by side */
};

/* One way of a fan, of numbers by particle of the tile. */
struct stencil_direction {
    double k, length;
    size_t offset;         /* from a particle to the other end */
    const double *factors; /* of the matrix; a row has `count` numbers */
    size_t count;
    double *out; /* what the kernel makes, in rows of WIDE */
};

/* What a kernel reads: arrays from the tile's first particle on. */
struct stencil_input {
    const double *x, *v, *dx, *dv;
    size_t n;
    double c;   /* of dampers, N s/m */
    bool axial; /* along the springs only */
};

/* Makes the numbers of the springs of one, two or three ways from particles [begin, end) of the
 * tile. */
typedef void stencil_pass(const struct stencil_input *in, const struct stencil_direction *ways,
                          size_t begin, size_t end);

/* A kernel of some numbers a spring, one after the other: those of its force, for job->to, of
 * df/dx for at.kxx and of df/dv for at.dvv. A particle gets those of the springs that it
 * begins; the other ends get the same of blocks, and the opposite of forces. */
struct stencil_kernel {
    stencil_pass *passes[DIRECTIONS_AT_ONCE];
    size_t n_force, n_dfdx, n_dfdv;
};

/* the runs of a row */
struct row_stencil {
    const struct cs_spring_run
        *directions[CS_DIRECTIONS];    /* NULL: none, or nothing is asked of them */
    const struct cs_spring_run *first; /* gives row, columns and what lies below */
};

/* Adds what a kernel makes of a fan's springs at the particles of a block. */
void cs_grid_stencil_add(const struct spring_job *job, const struct cs_block *block,
                         const struct row_stencil *stencil,
                         const struct stencil_kernel *kernel);

/* Finds the runs of a row, from its first on, and adds what a kernel makes of those that are
 * asked for. Returns how many there are. */
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
    if (acts)
        cs_grid_stencil_add(job, block, &stencil, kernel);
    return (uint32_t)(run - first);
}

/* the kernel for a row's law, and what is asked of it */
typedef const struct stencil_kernel *stencil_choice(const struct spring_job *job,
                                                    const struct cs_spring_run *first);

/* Adds what kernels make of all runs to the particles of a block, in the order of the runs: of
 * fans, and, unless there is no job->to, of pieces of meshes. */
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

/* between the ends of the spring of a way from particle i of the tile */
CS_INLINE struct difference fan_across(const double *p, size_t n, size_t i, size_t step) {
    return (struct difference){p[i + step] - p[i], p[n + i + step] - p[n + i],
                               p[2 * n + i + step] - p[2 * n + i]};
}

CS_INLINE void fan_put(struct difference from, double *out) {
    out[0] = from.x;
    out[1] = from.y;
    out[2] = from.z;
}

/* makes the numbers of the spring of a way from particle i of the tile */
typedef void stencil_spring(const struct stencil_input *in, const struct stencil_direction *way,
                            size_t i, double *out);

/* what is made of one spring, to row after row */
CS_INLINE void stencil_make(const struct stencil_input *in, const struct stencil_direction *way,
                            size_t i, stencil_spring *spring, const size_t parts) {
    double made[NUMBERS_PER_SPRING_MAX];
    spring(in, way, i, made);
    for (size_t k = 0; k < parts; k++)
        way->out[k * PADDED_TILE + i] = made[k];
}

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

#define CS_STENCIL_PASS(name, spring, parts, n, second, third)                                 \
    CS_CLONES static void name(const struct stencil_input *in,                                 \
                               const struct stencil_direction *ways, size_t begin,             \
                               size_t end) {                                                   \
        stencil_springs(*in, ways[0], ways[second], ways[third], n, spring, parts, begin,      \
                        end);                                                                  \
    }

/* The kernel `name` of what is made of single springs by spring(), an inline function: so many
 * numbers of the force, of df/dx and of df/dv. */
#define CS_STENCIL_KERNEL(name, spring, forces_, stiff_, damped_)                              \
    CS_STENCIL_PASS(name##_1, spring, forces_ + stiff_ + damped_, 1, 0, 0)                     \
    CS_STENCIL_PASS(name##_2, spring, forces_ + stiff_ + damped_, 2, 1, 1)                     \
    CS_STENCIL_PASS(name##_3, spring, forces_ + stiff_ + damped_, 3, 1, 2)                     \
    static const struct stencil_kernel name = {                                                \
        {name##_1, name##_2, name##_3}, forces_, stiff_, damped_}

#endif
