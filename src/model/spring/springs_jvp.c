/* The springs' derivative along a direction (Jacobian-vector product), exact: nothing is
 * clamped or left out, unlike in springs_matrix.c. */
#include "model/spring/springs.h"

#include "base/pool.h"
#include "model/spring/grid_stencil.h"

#include <float.h>
#include <math.h>

/* Compiled copies of the loops. MOVED: dx is given; TURNED: dv is given. A direction that is
 * not given is 0, and its arrays are not read. */
enum damper_tangent { MOVED = 1, TURNED = 2 };

/* Constants of one spring: L in m, k in N/m, dampers in N s/m, one of which is 0. */
struct law {
    double length, k, axial, relative;
};

/* Differences over a spring, second end less first: of x, v, dx and dv. */
struct bend {
    struct difference p, w, e, g;
};

/* df_a along (dx, dv). With u the unit vector, l the length, and e, g, w the differences of dx,
 * dv and v:
 *
 *   elastic    k (1 - L/l) e + k (L/l) (u.e) u
 *   axial      c (g.u) u + c ((w.du) u + (w.u) du),   du = (e - (u.e) u) / l
 *   relative   c g
 *
 * du is the change of u along dx: u stays a unit vector, so only the part of e across it
 * counts. */
CS_INLINE struct difference jvp_of(const struct law law, const struct bend at,
                                   const unsigned how) {
    const struct difference p = at.p, e = at.e, g = at.g, w = at.w;
    /* DBL_MIN as in the force, whose derivative this is */
    const double inverse = 1 / sqrt(p.x * p.x + p.y * p.y + p.z * p.z + DBL_MIN);
    const double ux = p.x * inverse, uy = p.y * inverse, uz = p.z * inverse;
    struct difference r = {0, 0, 0};
    /* dx changes the spring's length and direction; an axial damper turns with it */
    if (how & MOVED) {
        const double ue = ux * e.x + uy * e.y + uz * e.z;
        const double slack = law.k * (1 - law.length * inverse);
        double along = law.k * law.length * inverse * ue;
        const double tx = (e.x - ue * ux) * inverse, ty = (e.y - ue * uy) * inverse;
        const double tz = (e.z - ue * uz) * inverse;
        const double closing = law.axial * (w.x * ux + w.y * uy + w.z * uz);
        along += law.axial * (w.x * tx + w.y * ty + w.z * tz);
        r.x = slack * e.x + along * ux + closing * tx;
        r.y = slack * e.y + along * uy + closing * ty;
        r.z = slack * e.z + along * uz + closing * tz;
    }
    /* dv changes velocities only, on which dampers depend */
    if (how & TURNED) {
        const double along = law.axial * (g.x * ux + g.y * uy + g.z * uz);
        r.x += law.relative * g.x + along * ux;
        r.y += law.relative * g.y + along * uy;
        r.z += law.relative * g.z + along * uz;
    }
    return r;
}

/* One spring of a grid, from particle i of the tile. */
CS_INLINE void jvp_from(const struct stencil_input *in, const struct stencil_direction *way,
                        size_t i, const unsigned how, double *out) {
    const struct law law = {way->length, way->k, in->axial ? in->c : 0, in->axial ? 0 : in->c};
    struct bend at = {.p = fan_across(in->x, in->n, i, way->offset)};
    if (how & MOVED) {
        at.w = fan_across(in->v, in->n, i, way->offset);
        at.e = fan_across(in->dx, in->n, i, way->offset);
    }
    if (how & TURNED)
        at.g = fan_across(in->dv, in->n, i, way->offset);
    fan_put(jvp_of(law, at, how), out);
}

/* Kernels for dx alone, for dv alone, and for both. */
#define KERNEL(define, name, how)                                                              \
    CS_STENCIL_VARIANT(define, name, jvp_from(in, way, i, how, out), 3, 0, 0)

KERNEL(CS_STENCIL_KERNEL, moved_jvp, MOVED);
KERNEL(CS_STENCIL_KERNEL, turned_jvp, TURNED);
/* no method of ours asks for both at once */
KERNEL(CS_STENCIL_KERNEL_ALONE, both_jvp, MOVED | TURNED);

/* The kernel for the given directions. */
static const struct stencil_kernel *choose_jvp(const struct spring_job *job,
                                               const struct cs_spring_run *first) {
    (void)first;
    if (job->at.dx && job->at.dv)
        return &both_jvp;
    return job->at.dx ? &moved_jvp : &turned_jvp;
}

/* A piece of a mesh, with lengths and stiffnesses of its own. run->stiffness of a mesh is 1
 * here, by active_constants_of. */
CS_INLINE void jvp_rows(const struct spring_job *job, const struct piece *piece,
                        const unsigned how, double *restrict fx, double *restrict fy,
                        double *restrict fz) {
    struct gather_buffer places, speeds, moves, turns;
    const struct cs_eval *at = &job->at;
    const struct active_constants asked = active_constants_of(piece->run, at->parts);
    const size_t n = job->n, count = piece->count;
    /* a direction that is not given stands for itself, and is not read */
    const struct ends x = ends_of(piece, at->x, n, false, &places);
    const struct ends v = how & MOVED ? ends_of(piece, at->v, n, false, &speeds) : x;
    const struct ends dx = how & MOVED ? ends_of(piece, at->dx, n, false, &moves) : x;
    const struct ends dv = how & TURNED ? ends_of(piece, at->dv, n, false, &turns) : x;
    const double axial = piece->run->axial ? asked.c : 0;
    const double relative = piece->run->axial ? 0 : asked.c;
    for (size_t i = 0; i < count; i++) {
        const struct law law = {piece->lengths[i], asked.k * piece->stiffnesses[i], axial,
                                relative};
        const struct bend moves_i = {across(x, i, true), across(v, i, true),
                                     across(dx, i, true), across(dv, i, true)};
        const struct difference f = jvp_of(law, moves_i, how);
        fx[i] = f.x;
        fy[i] = f.y;
        fz[i] = f.z;
    }
}

/* Dispatches to a copy for the given directions. */
CS_INLINE void jvp_piece(const struct spring_job *job, const struct piece *piece,
                         double *restrict fx, double *restrict fy, double *restrict fz) {
    if (job->at.dx && job->at.dv)
        jvp_rows(job, piece, MOVED | TURNED, fx, fy, fz);
    else if (job->at.dx)
        jvp_rows(job, piece, MOVED, fx, fy, fz);
    else
        jvp_rows(job, piece, TURNED, fx, fy, fz);
}

/* Tells whether a run contributes: with dv alone only its dampers do. */
CS_INLINE bool asks_jvp(const struct spring_job *job, const struct cs_spring_run *run) {
    return job->at.dx ? has_force(job, run)
                      : job->at.dv && active_constants_of(run, job->at.parts).c != 0;
}

/* Sums in the order of the force, of which it is the derivative. */
CS_CLONES void cs_springs_add_jvp(const struct cs_springs *springs, uint32_t n,
                                  const struct cs_eval *at, double *df) {
    const struct spring_job job = {.springs = springs, .n = n, .at = *at, .to = df};
    add_runs(&job, at->block, asks_jvp, choose_jvp, jvp_piece);
}

/* Products of one chunk of a mesh into its slots. */
CS_CLONES static void wait_jvp_chunk(void *job, uint32_t chunk) {
    compute_chunk_to_slots(job, ((const struct spring_job *)job)->springs->chunks + chunk,
                           asks_jvp, jvp_piece);
}

void cs_springs_jvp_to_slots(const struct cs_springs *springs, uint32_t n,
                             const struct cs_eval *at) {
    struct spring_job job = {.springs = springs, .n = n, .at = *at};
    cs_pool_run(springs->n_chunks, wait_jvp_chunk, &job);
}
