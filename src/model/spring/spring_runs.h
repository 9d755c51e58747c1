/* spring_runs.h - springs as runs, and how threads share them.
 *
 * A run is a row of springs of one kind and law: spring i joins particles a + i and b + i. On a
 * grid no list of ends is stored or read. The 12 neighbours of a grid's particle are six runs
 * per row, one for each forward direction; they stand together, and a kernel evaluates them at
 * once (grid_stencil.h). A mesh has one run per kind, with lists of ends, lengths and
 * stiffnesses; their differences are gathered into rows, and kernels with the same formulas
 * work on them.
 *
 * The order of runs, of springs in a run, and of the directions of a row is the order of every
 * sum. The state hash depends on it. */
#ifndef CS_SPRING_RUNS_H
#define CS_SPRING_RUNS_H

#include "base/arena.h"

#include <clothsim/system.h>

/* Kinds of springs. A grid's diagonals and the inner springs of a network are shear
 * springs. */
enum cs_spring_kind { CS_SPRING_STRETCH, CS_SPRING_SHEAR, CS_SPRING_BEND, CS_SPRING_KINDS };

/* Forward directions of the springs that begin at a grid's particle, in the order in which the
 * particle sums them: along its row, then to the next row, then to the one after. */
enum cs_spring_direction {
    CS_DIRECTION_RIGHT,      /* stretch, along the row */
    CS_DIRECTION_RIGHT_TWO,  /* bend, over one particle */
    CS_DIRECTION_DOWN,       /* stretch, to the next row */
    CS_DIRECTION_DOWN_RIGHT, /* down and right */
    CS_DIRECTION_DOWN_LEFT,  /* down and left */
    CS_DIRECTION_DOWN_TWO,
    CS_DIRECTIONS
};

/* A run of springs. Lists belong to the mesh or the system; the run borrows them. */
struct cs_spring_run {
    uint32_t first_a, first_b, count; /* first particles at either end; springs */
    uint32_t kind;                    /* enum cs_spring_kind */
    uint32_t body;
    uint32_t first; /* number of the run's first spring */
    size_t factors; /* first of its numbers in the factors of the solver's matrix */
    uint32_t factor_rows, factor_stride; /* rows of numbers there, and from one to the next */
    double stiffness;    /* N/m; with lists: the law's, N/m or N, that they were made of */
    double length;       /* rest length in m */
    double damping;      /* N s/m */
    bool axial;          /* damping along the spring only */
    uint32_t n_factored; /* springs whose factors are found with it, as if they were its own */

    /* of a grid's run; columns 0 of a mesh's */
    uint32_t direction;                /* enum cs_spring_direction */
    uint32_t row, columns, rows_below; /* the row's first particle, its length, rows after it */

    /* lists of a mesh's run, or all NULL: spring i joins a + ends[2 i] and b + ends[2 i + 1] */
    const uint32_t *ends;                /* (count, 2) */
    const double *lengths, *stiffnesses; /* (count) m, N/m, instead of those above */
};

/* Particles at the ends, rest length in m and stiffness in N/m of spring i of a run, of either
 * form. */
static inline uint32_t cs_spring_a(const struct cs_spring_run *run, uint32_t i) {
    return run->first_a + (run->ends ? run->ends[2 * (size_t)i] : i);
}
static inline uint32_t cs_spring_b(const struct cs_spring_run *run, uint32_t i) {
    return run->first_b + (run->ends ? run->ends[2 * (size_t)i + 1] : i);
}
static inline double cs_spring_length(const struct cs_spring_run *run, uint32_t i) {
    return run->lengths ? run->lengths[i] : run->length;
}
static inline double cs_spring_stiffness(const struct cs_spring_run *run, uint32_t i) {
    return run->stiffnesses ? run->stiffnesses[i] : run->stiffness;
}

/* Particles [begin, end) to which one thread adds forces: whole rows of grids, any range of a
 * mesh. Runs [first_run, end_run) contain all that have an end there, and some that have none.
 * A row of springs across the border of two blocks is computed for both, and each thread adds
 * its own side. */
struct cs_block {
    uint32_t begin, end, first_run, end_run;
};

/* One evaluation of the forces; with dx or dv, of their derivative along that direction. All
 * arrays are borrowed. */
struct cs_eval {
    double t;
    const double *x, *v;               /* (3,n) in m and m/s */
    uint32_t parts;                    /* set of enum cs_part */
    const double *dx, *dv;             /* (3,n) directions; NULL: 0 */
    double *dfdx_blocks, *dfdv_blocks; /* (6,n) output: diagonal blocks of grids' springs, in
                                          the same pass as the force; NULL: not wanted */
    double *power; /* (n) output with the force, in W: what gives energy adds f.u at the
                      particle, with the velocity u that it prescribes; NULL: not wanted */
    const struct cs_block *block; /* particles to add to; NULL in prepare */
};

/* Forces at the state of a matrix, by which friction by its chord knows where a step ends
 * (contact/friction_chord.h): (3,n) in N. */
struct cs_chord_forces {
    const double *all, *contact; /* the sum of all forces, and of the elastic ones of contact */
    bool is_end_known; /* `all` is the force of the whole step, M (v' - v)/h, friction of its
                          end included; `contact` is not read */
};

/* The matrix of a linear solver, A = cm M + cd df/dv + ck df/dx at a state. cd and ck are at
 * most 0, as in implicit methods: backward Euler has cm = 1, cd = -h, ck = -h^2. */
struct cs_matrix {
    double t;
    const double *x, *v; /* (3,n) in m and m/s */
    double cm, cd, ck;
    bool psd;                            /* each force's part is made positive semi-definite */
    bool bound;                          /* friction by an upper bound (CS_SOLVE_BOUND) */
    const struct cs_chord_forces *chord; /* friction by its chord, and cd = -h; NULL: by its
                                            derivative */
    bool rebounds; /* of a step whose particles in impact were found (contact/rebound.h) */
};

/* Springs [begin, end) of a mesh's run, whose forces one thread computes. Their ends lie
 * anywhere, so two threads could want the same particle. Each force is therefore stored in a
 * slot of its own; in a second pass the thread of a block adds to its particles from the slots,
 * in the order of the springs. */
struct cs_spring_chunk {
    uint32_t run, begin, end;
};
/* Most springs per chunk: a multiple of PIECE, few enough to balance the threads. Chosen by
 * trial. */
enum { CS_SPRING_CHUNK_MAX = 2048 };

/* Slots of a mesh's run; all 0 for a grid's. At particle i of the body, 0..n-1, end the springs
 * particle_springs[particle_begin[i]..particle_begin[i + 1]) >> 1 of the run, ascending; the
 * last bit is 1 at their second ends. */
struct cs_spring_slots {
    uint32_t n;
    const uint32_t *particle_begin, *particle_springs; /* (n + 1), (2 count) */
    double *forces;                                    /* (3, count) */
};

/* All springs of a system, and their partition among threads. The system's arena owns the
 * arrays. */
struct cs_springs {
    const struct cs_spring_run *runs;
    uint32_t n_runs, n; /* runs; springs */
    size_t n_factors;   /* numbers of the solver's matrix, of membranes' edges too */

    /* Partition among threads (plan.h). With one thread the pointers are NULL, and
     * one block has all particles. */
    const struct cs_block *blocks; /* (n_blocks) ascending */
    uint32_t n_blocks;
    const struct cs_spring_chunk *chunks;
    uint32_t n_chunks;
    const struct cs_spring_slots *slots; /* (n_runs); NULL without meshes too */
    double *energies;                    /* (n_runs) work of cs_springs_energy */
};

/* Block number `block` of n_blocks, for a system of n particles. */
static inline struct cs_block cs_springs_block(const struct cs_springs *springs, uint32_t n,
                                               uint32_t block) {
    return springs->blocks ? springs->blocks[block]
                           : (struct cs_block){0, n, 0, springs->n_runs};
}

#endif
