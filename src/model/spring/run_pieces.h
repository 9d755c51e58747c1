/* run_pieces.h - runs of springs in pieces: differences over both ends, and the forces of
 * meshes added back to particles.
 *
 * A grid's rows are read where they lie; grid_stencil.h adds to them. The ends of a mesh lie
 * anywhere: their differences are gathered into rows on the stack, kernels work on rows, and
 * forces are added back one by one, directly (scatter) or through slots (gather). Both give the
 * same bits, because the order of a particle's springs is the same. */
#ifndef CS_RUN_PIECES_H
#define CS_RUN_PIECES_H

#include "model/spring/spring_runs.h"

#include <clothsim/clones.h>
#include <clothsim/integrator.h>
#include <float.h>
#include <math.h>

/* Springs per piece: a row of a buffer on the stack takes 2 KiB. */
enum { PIECE = 256 };

/* Runs per task of loops over runs, where their order does not matter. */
enum { RUNS = 32 };

_Static_assert(CS_SPRING_CHUNK_MAX % PIECE == 0, "a chunk contains whole pieces");

/* Arguments of a kernel: springs, state and destination. */
struct spring_job {
    const struct cs_springs *springs;
    size_t n;
    struct cs_eval at;     /* state; for products with the matrix dx is the vector */
    const double *factors; /* of the matrix; NULL for other kernels */
    double *to;            /* (3,n) destination; NULL: only blocks, or slots, are written */
};

/* Constants of a run for the chosen parts: k is 0 without its elastic force, c without its
 * dampers. For a mesh k is 0 or 1, a factor of its list. */
struct active_constants {
    double k, c;
};

CS_INLINE struct active_constants active_constants_of(const struct cs_spring_run *run,
                                                      uint32_t parts) {
    return (struct active_constants){
        parts & (CS_PART_STRETCH << run->kind) ? run->ends ? 1 : run->stiffness : 0,
        parts & CS_PART_DAMPING ? run->damping : 0};
}

/* Tells whether a run has a force of the chosen parts. */
CS_INLINE bool has_force(const struct spring_job *job, const struct cs_spring_run *run) {
    const struct active_constants asked = active_constants_of(run, job->at.parts);
    return asked.k != 0 || asked.c != 0;
}

/* For the matrix, which has all springs. */
CS_INLINE bool has_anything(const struct spring_job *job, const struct cs_spring_run *run) {
    (void)job, (void)run;
    return true;
}

/* Both ends of a piece: rows of an array of 3-vectors, or, for a mesh, the rows of the
 * differences in b* alone. */
struct ends {
    const double *ax, *ay, *az, *bx, *by, *bz;
};

/* Buffer for the differences of a mesh's piece. */
struct gather_buffer {
    double rows[3][PIECE];
};

/* One piece: springs [start, start + count) of a run, and its lists from there on. */
struct piece {
    const struct cs_spring_run *run;
    uint32_t start, count;
    const double *lengths, *stiffnesses;
};

/* Returns true if the run contributes. */
typedef bool run_test(const struct spring_job *job, const struct cs_spring_run *run);

/* Computes the forces of a mesh's piece into rows. */
typedef void piece_kernel(const struct spring_job *job, const struct piece *piece,
                          double *restrict fx, double *restrict fy, double *restrict fz);

/* The piece from spring `start` on. */
CS_INLINE struct piece piece_of(const struct cs_spring_run *run, uint32_t start) {
    const uint32_t left = run->count - start;
    return (struct piece){run, start, left < PIECE ? left : PIECE,
                          run->lengths ? run->lengths + start : NULL,
                          run->stiffnesses ? run->stiffnesses + start : NULL};
}

/* Finds both ends of a piece in an array p (3,n). reversed: differences are end a less end b.
 * gathered is only used for meshes. */
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
        /* keeps the compiler from loading indices as vectors and extracting them again */
        __asm__("" : "+r"(from), "+r"(to));
        rows[0][i] = b[to] - a[from];
        rows[1][i] = b[n + to] - a[n + from];
        rows[2][i] = b[2 * n + to] - a[2 * n + from];
    }
    return (struct ends){NULL, NULL, NULL, rows[0], rows[1], rows[2]};
}

/* A vector over a spring. */
struct difference {
    double x, y, z;
};

/* Difference over spring i of a piece; `listed` is the constant that tells a mesh from a grid.
 */
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

/* Adds the buffered forces of a mesh's piece at the first ends and subtracts them at the second
 * ends. */
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

/* Adds the slots' forces to the particles of a block, particle by particle, in the order of the
 * springs. The run's body has particles in the block. */
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

/* Computes a mesh's run and adds it; its whole body must be in the block, which holds with one
 * thread. */
CS_INLINE void add_run(const struct spring_job *job, const struct cs_spring_run *run,
                       piece_kernel *kernel) {
    double fx[PIECE], fy[PIECE], fz[PIECE];
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        kernel(job, &piece, fx, fy, fz);
        scatter(&piece, fx, fy, fz, job->n, job->to);
    }
}

/* Computes the forces of one chunk into the run's slots. A run that contributes nothing is
 * skipped. */
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

/* The law of one spring: force, and diagonal blocks of its derivative.
 *
 * Notation: d = x_b - x_a with length l and unit vector u, w = v_b - v_a, rest length L,
 * stiffness k, damping c. The force on the first end is
 *
 *   f_a = k (1 - L / l) d + c (w.u) u    axial damping
 *   f_a = k (1 - L / l) d + c w          relative damping
 *
 * and -f_a acts on the second end. All spring kernels use these functions, so that force,
 * derivative and matrix belong to one law. */

/* Which damper a kernel has; 0 is none. Each value is a compiled copy of the loop, and a scene
 * without damping never reads v. */
enum damper_form { AXIAL = 1, RELATIVE = 2 };

/* Components of a symmetric block: xx, xy, xz, yy, yz, zz. */
enum { SYM = 6 };

/* f_a of the law above, for the differences d of positions and w of velocities. `how` is a
 * constant of every caller. */
CS_INLINE struct difference force_of(const struct difference d, const struct difference w,
                                     double length, double k, double c, const unsigned how) {
    /* DBL_MIN keeps two particles in one place from dividing by zero */
    const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
    double pull = k * (1 - length * inverse);
    if (how & AXIAL)
        pull += c * ((w.x * d.x + w.y * d.y + w.z * d.z) * inverse * inverse);
    if (how & RELATIVE)
        return (struct difference){pull * d.x + c * w.x, pull * d.y + c * w.y,
                                   pull * d.z + c * w.z};
    return (struct difference){pull * d.x, pull * d.y, pull * d.z};
}

/* Unit vector u of a spring, and L / l. */
struct rotated_damper {
    struct difference u;
    double force_over_length;
};

/* L = 0 gives u alone, which is what damper blocks need. */
CS_INLINE struct rotated_damper turned_of(const struct difference d, double length) {
    const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
    return (struct rotated_damper){{d.x * inverse, d.y * inverse, d.z * inverse},
                                   length * inverse};
}

/* out = a I + b u u^T, for a number a, a number b and a vector u. */
CS_INLINE void set_block(double a, double b, const struct difference u, double *out) {
    out[0] = a + b * u.x * u.x;
    out[1] = b * u.x * u.y;
    out[2] = b * u.x * u.z;
    out[3] = a + b * u.y * u.y;
    out[4] = b * u.y * u.z;
    out[5] = a + b * u.z * u.z;
}

/* Block of df/dx, the same at both ends: df_a/dx_a = -k ((1 - L/l) I + (L/l) u u^T). Along u
 * its eigenvalue is -k; across u it is -k (1 - L/l), which is positive for a compressed spring.
 */
CS_INLINE void stiff_block(const struct rotated_damper spring, double k, double *out) {
    set_block(-(k * (1 - spring.force_over_length)), -(k * spring.force_over_length), spring.u,
              out);
}

#endif
