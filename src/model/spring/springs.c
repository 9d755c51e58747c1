/* Kernels over spring runs: force, alone and with diagonal blocks. What is made of springs
 * waits in a small buffer on the stack; within it no spring depends on another, so the loops
 * vectorise. */
#include "model/spring/springs.h"

#include "base/pool.h"
#include "model/spring/grid_stencil.h"
#include "model/spring/spring_law.h"

/* What kernels of grids make: the force, and the diagonal blocks that methods ask for beside
 * it, of one square root and quotient. DAMPED of axial dampers, which turn with the spring;
 * those of relative ones are one number, STEADY. */
enum what { FORCE = 4, STIFF = 8, DAMPED = 16, STEADY = 32 };

CS_INLINE void make_spring(const struct stencil_input *in, const struct stencil_direction *way,
                           size_t i, const unsigned what, double *out) {
    const struct difference d = fan_across(in->x, in->n, i, way->offset);
    if (what & FORCE) {
        const struct difference w = what & (AXIAL | RELATIVE)
                                        ? fan_across(in->v, in->n, i, way->offset)
                                        : (struct difference){0};
        fan_put(force_of(d, w, way->length, way->k, in->c, what), out);
        out += 3;
    }
    if (what & STIFF) {
        stiff_block(turned_of(d, way->length), way->k, out);
        out += SYM;
    }
    if (what & DAMPED)
        set_block(0, -in->c, turned_of(d, 0).u, out);
    if (what & STEADY)
        out[0] = -in->c;
}

#define KERNEL(name, what, forces, stiff, damped)                                              \
    CS_INLINE void name##_spring(const struct stencil_input *in,                               \
                                 const struct stencil_direction *way, size_t i, double *out) { \
        make_spring(in, way, i, what, out);                                                    \
    }                                                                                          \
    CS_STENCIL_KERNEL(name, name##_spring, forces, stiff, damped)

KERNEL(undamped_force, FORCE, 3, 0, 0);
KERNEL(axial_force, FORCE | AXIAL, 3, 0, 0);
KERNEL(relative_force, FORCE | RELATIVE, 3, 0, 0);
KERNEL(undamped_blocks, STIFF, 0, SYM, 0);
KERNEL(axial_blocks, STIFF | DAMPED, 0, SYM, SYM);
KERNEL(relative_blocks, STIFF | STEADY, 0, SYM, 1);
KERNEL(undamped_both, FORCE | STIFF, 3, SYM, 0);
KERNEL(axial_both, FORCE | AXIAL | STIFF | DAMPED, 3, SYM, SYM);
KERNEL(relative_both, FORCE | RELATIVE | STIFF | STEADY, 3, SYM, 1);

static const struct stencil_kernel *choose(const struct spring_job *job,
                                           const struct cs_spring_run *first) {
    static const struct stencil_kernel *const kernels[3][3] = {
        {&undamped_force, &axial_force, &relative_force},
        {&undamped_blocks, &axial_blocks, &relative_blocks},
        {&undamped_both, &axial_both, &relative_both}};
    const bool damped = active_constants_of(first, job->at.parts).c != 0;
    const unsigned what = !job->at.dfdx_blocks ? 0 : job->to ? 2 : 1;
    return kernels[what][damped ? 1 + !first->axial : 0];
}

/* forces of a piece of a mesh, whose lengths and stiffnesses are the springs' own */
CS_INLINE void force_rows(const struct spring_job *job, const struct piece *piece,
                          const unsigned how, double *restrict fx, double *restrict fy,
                          double *restrict fz) {
    struct gather_buffer places, speeds;
    const struct active_constants asked = active_constants_of(piece->run, job->at.parts);
    const struct ends x = ends_of(piece, job->at.x, job->n, false, &places);
    const struct ends v = how ? ends_of(piece, job->at.v, job->n, false, &speeds) : x;
    const size_t count = piece->count;
    for (size_t i = 0; i < count; i++) {
        const struct difference f =
            force_of(across(x, i, true), across(v, i, true), piece->lengths[i],
                     asked.k * piece->stiffnesses[i], asked.c, how);
        fx[i] = f.x;
        fy[i] = f.y;
        fz[i] = f.z;
    }
}

CS_INLINE void force_piece(const struct spring_job *job, const struct piece *piece,
                           double *restrict fx, double *restrict fy, double *restrict fz) {
    if (active_constants_of(piece->run, job->at.parts).c == 0)
        force_rows(job, piece, 0, fx, fy, fz);
    else if (piece->run->axial)
        force_rows(job, piece, AXIAL, fx, fy, fz);
    else
        force_rows(job, piece, RELATIVE, fx, fy, fz);
}

CS_CLONES void cs_springs_add_force(const struct cs_springs *springs, uint32_t n,
                                    const struct cs_eval *at, double *f) {
    const struct spring_job job = {.springs = springs, .n = n, .at = *at, .to = f};
    add_runs(&job, at->block, has_force, choose, force_piece);
}

CS_CLONES static void wait_force_chunk(void *job, uint32_t chunk) {
    compute_chunk_to_slots(job, ((const struct spring_job *)job)->springs->chunks + chunk,
                           has_force, force_piece);
}

void cs_springs_force_to_slots(const struct cs_springs *springs, uint32_t n,
                               const struct cs_eval *at) {
    struct spring_job job = {.springs = springs, .n = n, .at = *at};
    cs_pool_run(springs->n_chunks, wait_force_chunk, &job);
}

double cs_springs_shortest(const struct cs_springs *springs) {
    double shortest = springs->n_runs ? HUGE_VAL : 0;
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0; i < springs->runs[r].count; i++)
            shortest = fmin(shortest, cs_spring_length(springs->runs + r, i));
    return shortest;
}
