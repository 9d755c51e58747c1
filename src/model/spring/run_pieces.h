/* run_pieces.h - a run of springs in pieces: both ends' rows, and a mesh's forces added back to
 * them.
 *
 * A grid's rows are read where they lie; what is added to them goes by fans (grid_stencil.h).
 * The ends of a mesh lie anywhere: their differences are gathered into rows on the stack, and
 * the forces are added back one by one. */
#ifndef CS_RUN_PIECES_H
#define CS_RUN_PIECES_H

#include "model/spring/spring_runs.h"

#include <clothsim/clones.h>
#include <clothsim/integrator.h>

enum { PIECE = 256 }; /* springs whose forces a buffer on the stack holds */
enum { RUNS = 32 }; /* runs that one thread takes at a time where their order does not matter */
_Static_assert(CS_SPRING_CHUNK_MAX % PIECE == 0, "a lot is of whole pieces");

/* What a kernel works on. */
struct spring_job {
    const struct cs_springs *springs;
    size_t n;
    struct cs_eval at;     /* of a product with the matrix: x alone, what it is taken of */
    const double *factors; /* of the matrix */
    double *to;            /* what is added to */
};

/* what a part asks of a run: k is 0 without its elastic force, c without its dampers */
struct active_constants {
    double k, c;
};

CS_INLINE struct active_constants active_constants_of(const struct cs_spring_run *run,
                                                      uint32_t parts) {
    return (struct active_constants){
        parts & (CS_PART_STRETCH << run->kind) ? run->ends ? 1 : run->stiffness : 0,
        parts & CS_PART_DAMPING ? run->damping : 0};
}

CS_INLINE bool has_force(const struct spring_job *job, const struct cs_spring_run *run) {
    const struct active_constants asked = active_constants_of(run, job->at.parts);
    return asked.k != 0 || asked.c != 0;
}

CS_INLINE bool has_anything(const struct spring_job *job, const struct cs_spring_run *run) {
    (void)job, (void)run;
    return true;
}

/* one piece of a run: both ends' rows of an array of 3-vectors, or, of a mesh, the rows of the
 * differences in b* alone */
struct ends {
    const double *ax, *ay, *az, *bx, *by, *bz;
};

/* where the differences of a mesh's piece are gathered */
struct gather_buffer {
    double rows[3][PIECE];
};

/* one piece: its springs, and what stands in for the run's constants in a run with lists */
struct piece {
    const struct cs_spring_run *run;
    uint32_t start, count;
    const double *lengths, *stiffnesses;
};

/* true where the run has something to add */
typedef bool run_test(const struct spring_job *job, const struct cs_spring_run *run);

/* forces of one piece, in rows */
typedef void piece_kernel(const struct spring_job *job, const struct piece *piece,
                          double *restrict fx, double *restrict fy, double *restrict fz);

CS_INLINE struct piece piece_of(const struct cs_spring_run *run, uint32_t start) {
    const uint32_t left = run->count - start;
    return (struct piece){run, start, left < PIECE ? left : PIECE,
                          run->lengths ? run->lengths + start : NULL,
                          run->stiffnesses ? run->stiffnesses + start : NULL};
}

/* reversed: from end b to end a */
CS_INLINE struct ends ends_of(const struct piece *piece, const double *p, size_t n,
                              const bool reversed, struct gather_buffer *gathered) {
    const double *a = p + piece->run->first_a, *b = p + piece->run->first_b;
    if (!piece->run->ends) {
        a += piece->start;
        b += piece->start;
        return reversed ? (struct ends){b, b + n, b + 2 * n, a, a + n, a + 2 * n}
                        : (struct ends){a, a + n, a + 2 * n, b, b + n, b + 2 * n};
    }
    const uint32_t *ends = piece->run->ends + 2 * (size_t)piece->start;
    double(*rows)[PIECE] = gathered->rows;
    for (size_t i = 0; i < piece->count; i++) {
        size_t from = ends[2 * i + reversed], to = ends[2 * i + !reversed];
        /* else they are loaded as vectors, only to be taken apart again */
        __asm__("" : "+r"(from), "+r"(to));
        rows[0][i] = b[to] - a[from];
        rows[1][i] = b[n + to] - a[n + from];
        rows[2][i] = b[2 * n + to] - a[2 * n + from];
    }
    return (struct ends){NULL, NULL, NULL, rows[0], rows[1], rows[2]};
}

struct difference {
    double x, y, z;
};

/* between the ends of spring i of a piece */
CS_INLINE struct difference across(struct ends e, size_t i, const bool listed) {
    if (listed)
        return (struct difference){e.bx[i], e.by[i], e.bz[i]};
    return (struct difference){e.bx[i] - e.ax[i], e.by[i] - e.ay[i], e.bz[i] - e.az[i]};
}

CS_INLINE void add_row(size_t count, const double *restrict from, double *restrict to) {
    for (size_t i = 0; i < count; i++)
        to[i] += from[i];
}

CS_INLINE void take_row(size_t count, const double *restrict from, double *restrict to) {
    for (size_t i = 0; i < count; i++)
        to[i] -= from[i];
}

/* Adds the buffered forces of a mesh's piece at the first ends and takes them at the second. */
CS_INLINE void scatter(const struct piece *piece, const double *fx, const double *fy,
                       const double *fz, size_t n, double *f) {
    double *a = f + piece->run->first_a, *b = f + piece->run->first_b;
    const uint32_t *ends = piece->run->ends + 2 * (size_t)piece->start;
    for (size_t i = 0; i < piece->count; i++) {
        const size_t from = ends[2 * i], to = ends[2 * i + 1];
        a[from] += fx[i];
        a[n + from] += fy[i];
        a[2 * n + from] += fz[i];
        b[to] -= fx[i];
        b[n + to] -= fy[i];
        b[2 * n + to] -= fz[i];
    }
}

/* the buffered forces, particle by particle, in the order of the springs; the run's body has
 * particles in the block */
CS_INLINE void gather(const struct cs_spring_slots *wait, const struct cs_spring_run *run,
                      const struct cs_block *block, size_t n, double *f) {
    static const double sign[2] = {1, -1};
    const uint32_t begin = block->begin > run->first_a ? block->begin - run->first_a : 0;
    const uint32_t end =
        block->end - run->first_a < wait->n ? block->end - run->first_a : wait->n;
    const double *fx = wait->forces, *fy = fx + run->count, *fz = fy + run->count;
    double *to = f + run->first_a;
    for (size_t i = begin; i < end; i++) {
        double x = to[i], y = to[n + i], z = to[2 * n + i];
        for (size_t k = wait->particle_begin[i]; k < wait->particle_begin[i + 1]; k++) {
            const size_t spring = wait->particle_springs[k] >> 1;
            const double s = sign[wait->particle_springs[k] & 1];
            /* times 1 or -1 is exact: the bits are those of scatter */
            x += s * fx[spring];
            y += s * fy[spring];
            z += s * fz[spring];
        }
        to[i] = x;
        to[n + i] = y;
        to[2 * n + i] = z;
    }
}

CS_INLINE bool is_in(const struct cs_block *block, uint32_t particle) {
    return particle >= block->begin && particle < block->end;
}

/* Adds what kernel makes of a mesh's run, whose body is all in the block. */
CS_INLINE void add_run(const struct spring_job *job, const struct cs_spring_run *run,
                       piece_kernel *kernel) {
    double fx[PIECE], fy[PIECE], fz[PIECE];
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        kernel(job, &piece, fx, fy, fz);
        scatter(&piece, fx, fy, fz, job->n, job->to);
    }
}

/* Buffers what kernel makes of the springs of one chunk. */
CS_INLINE void compute_chunk_to_slots(const struct spring_job *job,
                                      const struct cs_spring_chunk *chunk, run_test *asks,
                                      piece_kernel *kernel) {
    const struct cs_spring_run *run = job->springs->runs + chunk->run;
    double *forces = job->springs->slots[chunk->run].forces;
    if (!asks(job, run))
        return;
    for (uint32_t start = chunk->begin; start < chunk->end; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        double *fx = forces + start;
        kernel(job, &piece, fx, fx + run->count, fx + 2 * (size_t)run->count);
    }
}

#endif
