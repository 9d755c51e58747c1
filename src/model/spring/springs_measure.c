/* Elastic energy and largest strain of spring runs. What each spring has is made in vectors,
 * and goes to eight lanes a piece of a run, so that a sum does not depend on the width of
 * vectors. */
#include "model/spring/springs.h"

#include "base/pool.h"
#include "model/spring/run_pieces.h"

#include <math.h>

enum { LANES = 8 };
_Static_assert(PIECE % LANES == 0, "a piece is of whole lanes");

/* twice the energy of each spring of a piece, over the run's stiffness if it has one */
CS_INLINE void square_stretches(const struct piece *piece, const struct ends e,
                                const bool listed, double *restrict squares) {
    const double length = piece->run->length;
    const size_t count = piece->count;
    for (size_t i = 0; i < count; i++) {
        const struct difference d = across(e, i, listed);
        const double stretch =
            sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - (listed ? piece->lengths[i] : length);
        squares[i] = (listed ? piece->stiffnesses[i] : 1) * (stretch * stretch);
    }
}

/* spring i to lane i modulo LANES; the lanes then pair by pair */
CS_INLINE double sum_lanes(const double *squares, size_t count) {
    double s[LANES] = {0};
    for (size_t i = 0; i + LANES <= count; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            s[l] += squares[i + l];
    for (size_t i = count - count % LANES; i < count; i++)
        s[i % LANES] += squares[i];
    return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
}

CS_CLONES static double run_energy(const struct cs_spring_run *run, size_t n, const double *x) {
    struct gather_buffer places;
    double squares[PIECE], sum = 0;
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        const struct ends e = ends_of(&piece, x, n, false, &places);
        if (run->ends)
            square_stretches(&piece, e, true, squares);
        else
            square_stretches(&piece, e, false, squares);
        sum += sum_lanes(squares, piece.count);
    }
    return 0.5 * (run->ends ? 1 : run->stiffness) * sum;
}

/* of each spring, in magnitude */
CS_INLINE void find_strains(const struct piece *piece, const struct ends e, const bool listed,
                            double *restrict strains) {
    const double length = piece->run->length;
    const size_t count = piece->count;
    for (size_t i = 0; i < count; i++) {
        const struct difference d = across(e, i, listed);
        const double now = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        strains[i] = fabs(now / (listed ? piece->lengths[i] : length) - 1);
    }
}

/* What is no number is passed over. */
CS_INLINE double find_largest(const double *values, size_t count) {
    double most[LANES] = {0};
    for (size_t i = 0; i + LANES <= count; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            most[l] = values[i + l] > most[l] ? values[i + l] : most[l];
    for (size_t i = count - count % LANES; i < count; i++)
        most[0] = values[i] > most[0] ? values[i] : most[0];
    for (size_t l = 1; l < LANES; l++)
        most[0] = most[l] > most[0] ? most[l] : most[0];
    return most[0];
}

CS_CLONES double cs_springs_largest_strain(const struct cs_springs *springs, uint32_t n,
                                           const double *x) {
    struct gather_buffer places;
    double strains[PIECE], largest = 0;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const struct piece piece = piece_of(run, start);
            const struct ends e = ends_of(&piece, x, n, false, &places);
            if (run->ends)
                find_strains(&piece, e, true, strains);
            else
                find_strains(&piece, e, false, strains);
            const double found = find_largest(strains, piece.count);
            largest = found > largest ? found : largest;
        }
    }
    return largest;
}

static bool has_energy(const struct cs_spring_run *run, uint32_t parts) {
    return parts & (CS_PART_STRETCH << run->kind);
}

static void energy_of_runs(void *arg, uint32_t block) {
    const struct spring_job *job = arg;
    const struct cs_springs *springs = job->springs;
    for (uint32_t r = RUNS * block; r < springs->n_runs && r < RUNS * (block + 1); r++)
        if (has_energy(springs->runs + r, job->at.parts))
            springs->energies[r] = run_energy(springs->runs + r, job->n, job->at.x);
}

double cs_springs_energy(const struct cs_springs *springs, uint32_t n, const double *x,
                         uint32_t parts) {
    struct spring_job job = {.springs = springs, .n = n, .at = {.x = x, .parts = parts}};
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
