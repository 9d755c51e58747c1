/* Kernels over spring runs: force, energy, Jacobian product. Rows are done in pieces that fit a
 * small buffer on the stack; within a piece no spring depends on another, so the loops
 * vectorise. */
#include "model/spring/springs.h"

#include "base/pool.h"
#include "model/spring/rows.h"

#include <clothsim/integrator.h>
#include <float.h>
#include <math.h>

/* what a part asks of a run: k is 0 without its elastic force, c without its dampers */
struct asked {
    double k, c;
};

/* Copies of the loops, so that a scene without damping never reads v. */
enum how { LISTED = 1, DAMPED = 2, AXIAL = 4, MOVED = 8, TURNED = 16 };

/* what a piece's loop reads: both ends of each array */
struct inputs {
    struct ends x, v, dx, dv;
    struct asked asked;
};

CS_INLINE struct asked asked_of(const struct cs_spring_run *run, uint32_t parts) {
    return (struct asked){
        parts & (CS_PART_STRETCH << run->kind) ? run->ends ? 1 : run->stiffness : 0,
        parts & CS_PART_DAMPING ? run->damping : 0};
}

CS_INLINE bool asks_force(const struct job *job, const struct cs_spring_run *run) {
    const struct asked asked = asked_of(run, job->at.parts);
    return asked.k != 0 || asked.c != 0;
}

/* force of one piece; LISTED: length and stiffness are the spring's own, and times k */
CS_INLINE void force_of(const struct piece *piece, const struct inputs *in, const unsigned how,
                        double *restrict fx, double *restrict fy, double *restrict fz) {
    const bool listed = how & LISTED, damped = how & DAMPED, axial = how & AXIAL;
    const struct ends x = in->x, v = in->v;
    const struct asked asked = in->asked;
    const double c = asked.c, length = piece->run->length;
    const uint32_t count = piece->count;
    for (uint32_t i = 0; i < count; i++) {
        const double L = listed ? piece->lengths[i] : length;
        const double k = listed ? asked.k * piece->stiffnesses[i] : asked.k;
        const struct difference d = across(x, i, listed);
        /* DBL_MIN keeps two particles in one place from dividing by zero */
        const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
        double pull = k * (1 - L * inverse);
        struct difference w = {0};
        if (damped) {
            w = across(v, i, listed);
            if (axial)
                pull += c * ((w.x * d.x + w.y * d.y + w.z * d.z) * inverse * inverse);
        }
        if (damped && !axial) {
            fx[i] = pull * d.x + c * w.x;
            fy[i] = pull * d.y + c * w.y;
            fz[i] = pull * d.z + c * w.z;
        } else {
            fx[i] = pull * d.x;
            fy[i] = pull * d.y;
            fz[i] = pull * d.z;
        }
    }
}

CS_INLINE void force_listed_or_not(const struct job *job, const struct piece *piece,
                                   const unsigned listed, double *restrict fx,
                                   double *restrict fy, double *restrict fz) {
    struct gathered places, speeds;
    struct inputs in = {.asked = asked_of(piece->run, job->at.parts)};
    const bool damped = in.asked.c != 0;
    in.x = ends_of(piece, job->at.x, job->n, false, &places);
    in.v = damped ? ends_of(piece, job->at.v, job->n, false, &speeds) : in.x;
    if (!damped)
        force_of(piece, &in, listed, fx, fy, fz);
    else if (piece->run->axial)
        force_of(piece, &in, listed | DAMPED | AXIAL, fx, fy, fz);
    else
        force_of(piece, &in, listed | DAMPED, fx, fy, fz);
}

CS_INLINE void force_piece(const struct job *job, const struct piece *piece,
                           double *restrict fx, double *restrict fy, double *restrict fz) {
    if (piece->run->ends)
        force_listed_or_not(job, piece, LISTED, fx, fy, fz);
    else
        force_listed_or_not(job, piece, 0, fx, fy, fz);
}

CS_CLONES void cs_springs_add_force(const struct cs_springs *springs, uint32_t n,
                                    const struct cs_eval *at, double *f) {
    const struct job job = {.springs = springs, .n = n, .at = *at, .to = f};
    add_runs(&job, at->block, asks_force, force_piece);
}

CS_CLONES static void wait_force_lot(void *job, uint32_t lot) {
    wait_lot(job, ((const struct job *)job)->springs->lots + lot, asks_force, force_piece);
}

void cs_springs_wait_force(const struct cs_springs *springs, uint32_t n,
                           const struct cs_eval *at) {
    struct job job = {.springs = springs, .n = n, .at = *at};
    cs_pool_run(springs->n_lots, wait_force_lot, &job);
}

double cs_springs_shortest(const struct cs_springs *springs) {
    double shortest = springs->n_runs ? HUGE_VAL : 0;
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0; i < springs->runs[r].count; i++)
            shortest = fmin(shortest, cs_spring_length(springs->runs + r, i));
    return shortest;
}

static double run_energy(const struct cs_spring_run *run, size_t n, const double *x) {
    struct gathered places;
    const bool listed = run->ends != NULL;
    double sum = 0;
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        const struct ends e = ends_of(&piece, x, n, false, &places);
        for (uint32_t i = 0; i < piece.count; i++) {
            const struct difference d = across(e, i, listed);
            const double stretch =
                sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - cs_spring_length(run, start + i);
            sum += (listed ? piece.stiffnesses[i] : 1) * (stretch * stretch);
        }
    }
    return 0.5 * (listed ? 1 : run->stiffness) * sum;
}

static bool has_energy(const struct cs_spring_run *run, uint32_t parts) {
    return parts & (CS_PART_STRETCH << run->kind);
}

static void energy_of_runs(void *arg, uint32_t block) {
    const struct job *job = arg;
    const struct cs_springs *springs = job->springs;
    for (uint32_t r = RUNS * block; r < springs->n_runs && r < RUNS * (block + 1); r++)
        if (has_energy(springs->runs + r, job->at.parts))
            springs->energies[r] = run_energy(springs->runs + r, job->n, job->at.x);
}

double cs_springs_energy(const struct cs_springs *springs, uint32_t n, const double *x,
                         uint32_t parts) {
    struct job job = {.springs = springs, .n = n, .at = {.x = x, .parts = parts}};
    double energy = 0;
    if (springs->energies)
        cs_pool_run((springs->n_runs + RUNS - 1) / RUNS, energy_of_runs, &job);
    for (uint32_t r = 0; r < springs->n_runs; r++)
        if (has_energy(springs->runs + r, parts))
            energy +=
                springs->energies ? springs->energies[r] : run_energy(springs->runs + r, n, x);
    return energy;
}

double cs_springs_energy_at_twice(const struct cs_springs *springs) {
    double energy = 0;
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0; i < springs->runs[r].count; i++) {
            const double length = cs_spring_length(springs->runs + r, i);
            energy += 0.5 * cs_spring_stiffness(springs->runs + r, i) * length * length;
        }
    return energy;
}

/* What dx and dv at the ends do to the force of each spring of a piece: with u the unit
 * direction, l the length, e and g the differences of dx and dv, w that of v:
 *   elastic    k (1 - L/l) e + k L/l (u.e) u
 *   axial      d (g.u) u + d [(w.du) u + (w.u) du],  du = (e - (u.e) u) / l
 *   relative   d g
 * MOVED: dx is given; TURNED: dv is given. */
CS_INLINE void jvp_of(const struct piece *piece, const struct inputs *in, const unsigned how,
                      double *restrict fx, double *restrict fy, double *restrict fz) {
    const bool listed = how & LISTED, moved = how & MOVED, turned = how & TURNED;
    const struct ends x = in->x, v = in->v, dx = in->dx, dv = in->dv;
    const struct asked asked = in->asked;
    const double axial = piece->run->axial ? asked.c : 0;
    const double relative = piece->run->axial ? 0 : asked.c;
    const double length = piece->run->length;
    const uint32_t count = piece->count;
    for (uint32_t i = 0; i < count; i++) {
        const double L = listed ? piece->lengths[i] : length;
        const double k = listed ? asked.k * piece->stiffnesses[i] : asked.k;
        const struct difference p = across(x, i, listed);
        /* DBL_MIN as in force_of, whose derivative this is */
        const double inverse = 1 / sqrt(p.x * p.x + p.y * p.y + p.z * p.z + DBL_MIN);
        const double ux = p.x * inverse, uy = p.y * inverse, uz = p.z * inverse;
        double rx = 0, ry = 0, rz = 0;
        /* the spring changes its length and turns, and axial dampers turn with it */
        if (moved) {
            const struct difference e = across(dx, i, listed);
            const double ue = ux * e.x + uy * e.y + uz * e.z;
            const double slack = k * (1 - L * inverse);
            double along = k * L * inverse * ue;
            const struct difference w = across(v, i, listed);
            const double tx = (e.x - ue * ux) * inverse, ty = (e.y - ue * uy) * inverse;
            const double tz = (e.z - ue * uz) * inverse;
            const double closing = axial * (w.x * ux + w.y * uy + w.z * uz);
            along += axial * (w.x * tx + w.y * ty + w.z * tz);
            rx = slack * e.x + along * ux + closing * tx;
            ry = slack * e.y + along * uy + closing * ty;
            rz = slack * e.z + along * uz + closing * tz;
        }
        /* dv changes the speeds of the ends alone, which dampers feel */
        if (turned) {
            const struct difference g = across(dv, i, listed);
            const double along = axial * (g.x * ux + g.y * uy + g.z * uz);
            rx += relative * g.x + along * ux;
            ry += relative * g.y + along * uy;
            rz += relative * g.z + along * uz;
        }
        fx[i] = rx;
        fy[i] = ry;
        fz[i] = rz;
    }
}

CS_INLINE void jvp_listed_or_not(const struct job *job, const struct piece *piece,
                                 const unsigned listed, double *restrict fx,
                                 double *restrict fy, double *restrict fz) {
    struct gathered places, speeds, moves, turns;
    const struct cs_eval *at = &job->at;
    struct inputs in = {.asked = asked_of(piece->run, at->parts)};
    in.x = ends_of(piece, at->x, job->n, false, &places);
    in.v = ends_of(piece, at->v, job->n, false, &speeds);
    /* a direction that is not given stands for itself, and is not read */
    in.dx = at->dx ? ends_of(piece, at->dx, job->n, false, &moves) : in.x;
    in.dv = at->dv ? ends_of(piece, at->dv, job->n, false, &turns) : in.x;
    if (at->dx && at->dv)
        jvp_of(piece, &in, listed | MOVED | TURNED, fx, fy, fz);
    else if (at->dx)
        jvp_of(piece, &in, listed | MOVED, fx, fy, fz);
    else
        jvp_of(piece, &in, listed | TURNED, fx, fy, fz);
}

CS_INLINE void jvp_piece(const struct job *job, const struct piece *piece, double *restrict fx,
                         double *restrict fy, double *restrict fz) {
    if (piece->run->ends)
        jvp_listed_or_not(job, piece, LISTED, fx, fy, fz);
    else
        jvp_listed_or_not(job, piece, 0, fx, fy, fz);
}

CS_INLINE bool asks_jvp(const struct job *job, const struct cs_spring_run *run) {
    return job->at.dx ? asks_force(job, run)
                      : job->at.dv && asked_of(run, job->at.parts).c != 0;
}

CS_CLONES void cs_springs_add_jvp(const struct cs_springs *springs, uint32_t n,
                                  const struct cs_eval *at, double *df) {
    const struct job job = {.springs = springs, .n = n, .at = *at, .to = df};
    add_runs(&job, at->block, asks_jvp, jvp_piece);
}

CS_CLONES static void wait_jvp_lot(void *job, uint32_t lot) {
    wait_lot(job, ((const struct job *)job)->springs->lots + lot, asks_jvp, jvp_piece);
}

void cs_springs_wait_jvp(const struct cs_springs *springs, uint32_t n,
                         const struct cs_eval *at) {
    struct job job = {.springs = springs, .n = n, .at = *at};
    cs_pool_run(springs->n_lots, wait_jvp_lot, &job);
}
