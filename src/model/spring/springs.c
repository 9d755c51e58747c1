/* Kernels over spring runs: force and energy. What is made of springs waits in a small buffer
 * on the stack; within it no spring depends on another, so the loops vectorise. */
#include "model/spring/springs.h"

#include "base/pool.h"
#include "model/spring/fan.h"

#include <float.h>
#include <math.h>

/* Copies of the loops, so that a scene without damping never reads v. */
enum how { AXIAL = 1, RELATIVE = 2 };

/* Of one spring, on its first end: d and w are the differences of places and speeds. */
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

CS_INLINE void force_from(const struct fan_in *in, const struct fan_way *way, size_t i,
                          const unsigned how, double *out) {
    const struct difference d = fan_across(in->x, in->n, i, way->step);
    const struct difference w =
        how ? fan_across(in->v, in->n, i, way->step) : (struct difference){0};
    fan_put(force_of(d, w, way->length, way->k, in->c, how), out);
}

CS_INLINE void undamped(const struct fan_in *in, const struct fan_way *way, size_t i,
                        double *out) {
    force_from(in, way, i, 0, out);
}

CS_INLINE void axial(const struct fan_in *in, const struct fan_way *way, size_t i,
                     double *out) {
    force_from(in, way, i, AXIAL, out);
}

CS_INLINE void relative(const struct fan_in *in, const struct fan_way *way, size_t i,
                        double *out) {
    force_from(in, way, i, RELATIVE, out);
}

CS_FAN_KERNEL(undamped_force, undamped, 3, -1);
CS_FAN_KERNEL(axial_force, axial, 3, -1);
CS_FAN_KERNEL(relative_force, relative, 3, -1);

static const struct fan_kernel *choose_force(const struct job *job,
                                             const struct cs_spring_run *first) {
    if (asked_of(first, job->at.parts).c == 0)
        return &undamped_force;
    return first->axial ? &axial_force : &relative_force;
}

/* forces of a piece of a mesh, whose lengths and stiffnesses are the springs' own */
CS_INLINE void force_rows(const struct job *job, const struct piece *piece, const unsigned how,
                          double *restrict fx, double *restrict fy, double *restrict fz) {
    struct gathered places, speeds;
    const struct asked asked = asked_of(piece->run, job->at.parts);
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

CS_INLINE void force_piece(const struct job *job, const struct piece *piece,
                           double *restrict fx, double *restrict fy, double *restrict fz) {
    if (asked_of(piece->run, job->at.parts).c == 0)
        force_rows(job, piece, 0, fx, fy, fz);
    else if (piece->run->axial)
        force_rows(job, piece, AXIAL, fx, fy, fz);
    else
        force_rows(job, piece, RELATIVE, fx, fy, fz);
}

CS_CLONES void cs_springs_add_force(const struct cs_springs *springs, uint32_t n,
                                    const struct cs_eval *at, double *f) {
    const struct job job = {.springs = springs, .n = n, .at = *at, .to = f};
    add_runs(&job, at->block, asks_force, choose_force, force_piece);
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
