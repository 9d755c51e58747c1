/* Force kernels over spring runs: the force alone, with diagonal blocks, or the blocks alone.
 *
 * Results of a piece or tile of springs go to a small buffer on the stack. Within it no spring
 * depends on another, so the loops vectorise; the buffer is then added to the particles. */
#include "model/spring/springs.h"

#include "base/pool.h"
#include "model/spring/grid_stencil.h"
#include "model/spring/run_pieces.h"

#include <math.h>

/* Elastic energy and largest strain of spring runs.
 *
 * The values of a piece are computed in vectors and then go to eight lanes, whatever the width
 * of the processor's vectors: the sum has one order, and its bits are the same on every
 * machine. */

/* Lanes of every sum; as in base/vector.c. */
enum { LANES = 8 };

_Static_assert(PIECE % LANES == 0, "a piece contains whole lanes");

/* Twice the energy of `count` springs of a piece, k (l - L)^2. For a grid's run k is a common
 * factor and is left to run_energy. */
CS_INLINE void square_stretches(const struct piece *piece, const struct ends e, size_t count,
                                const bool listed, double *restrict squares) {
    const double length = piece->run->length;
    for (size_t i = 0; i < count; i++) {
        const struct difference d = across(e, i, listed);
        const double stretch =
            sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - (listed ? piece->lengths[i] : length);
        squares[i] = (listed ? piece->stiffnesses[i] : 1) * (stretch * stretch);
    }
}

/* Adds spring i to lane i modulo LANES, and then the lanes pair by pair. Lanes without a last
 * spring add 0, which changes no sum of squares. */
CS_INLINE double sum_lanes(const double squares[PIECE], size_t count) {
    const size_t whole = count - count % LANES;
    double s[LANES] = {0};
    for (size_t i = 0; i + LANES <= count; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            s[l] += squares[i + l];
    for (size_t l = 0; l < LANES && whole < count; l++)
        s[l] += l < count - whole ? squares[whole + l] : 0;
    return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
}

/* Elastic energy of one run in J. Lanes are filled up with springs that do not exist, which
 * sum_lanes leaves out, unless these would end beyond the particles. */
CS_INLINE double run_energy(const struct cs_spring_run *run, size_t n, const double *x,
                            double squares[PIECE]) {
    struct gather_buffer places;
    double sum = 0;
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        const struct ends e = ends_of(&piece, x, n, false, &places);
        const size_t whole = (piece.count + LANES - 1) / LANES * LANES;
        if (run->ends)
            square_stretches(&piece, e, piece.count, true, squares);
        else
            square_stretches(&piece, e, run->first_b + start + whole <= n ? whole : piece.count,
                             false, squares);
        sum += sum_lanes(squares, piece.count);
    }
    return 0.5 * (run->ends ? 1 : run->stiffness) * sum;
}

/* |l / L - 1| of each spring of a piece. */
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

/* The largest of some values. NaNs are skipped, because a comparison with NaN is false. */
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

/* Tells whether a run is of one of the chosen parts. */
static bool has_energy(const struct cs_spring_run *run, uint32_t parts) {
    return parts & (CS_PART_STRETCH << run->kind);
}

/* Energies of RUNS runs, each into its own entry. */
CS_CLONES static void energy_of_runs(void *arg, uint32_t block) {
    const struct spring_job *job = arg;
    const struct cs_springs *springs = job->springs;
    double squares[PIECE] = {0};
    for (uint32_t r = RUNS * block; r < springs->n_runs && r < RUNS * (block + 1); r++)
        if (has_energy(springs->runs + r, job->at.parts))
            springs->energies[r] = run_energy(springs->runs + r, job->n, job->at.x, squares);
}

/* Runs are computed by all threads if there are several, and summed in their order in any case.
 */
CS_CLONES double cs_springs_energy(const struct cs_springs *springs, uint32_t n,
                                   const double *x, uint32_t parts) {
    struct spring_job job = {.springs = springs, .n = n, .at = {.x = x, .parts = parts}};
    double energy = 0, squares[PIECE] = {0};
    if (springs->energies)
        cs_pool_run((springs->n_runs + RUNS - 1) / RUNS, energy_of_runs, &job);
    for (uint32_t r = 0; r < springs->n_runs; r++)
        if (has_energy(springs->runs + r, parts))
            energy += springs->energies ? springs->energies[r]
                                        : run_energy(springs->runs + r, n, x, squares);
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

/* Results of a grid's kernel: the force, and diagonal blocks that share its square root and
 * quotient. Blocks of axial dampers turn with the spring (DAMPED, 6 numbers); those of relative
 * dampers are one number times the identity (STEADY). */
enum what { FORCE = 4, STIFF = 8, DAMPED = 16, STEADY = 32 };

/* Computes the results of one spring, one after the other in `out`. `what` is a constant of
 * each kernel. */
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

/* A kernel for one set of results, with how many numbers it makes of force, df/dx and df/dv. */
#define KERNEL(define, name, what, forces, stiff, damped)                                      \
    CS_STENCIL_VARIANT(define, name, make_spring(in, way, i, what, out), forces, stiff, damped)

KERNEL(CS_STENCIL_KERNEL, undamped_force, FORCE, 3, 0, 0);
KERNEL(CS_STENCIL_KERNEL, axial_force, FORCE | AXIAL, 3, 0, 0);
KERNEL(CS_STENCIL_KERNEL, relative_force, FORCE | RELATIVE, 3, 0, 0);
/* no method of ours asks for blocks without the force */
KERNEL(CS_STENCIL_KERNEL_ALONE, undamped_blocks, STIFF, 0, SYM, 0);
KERNEL(CS_STENCIL_KERNEL_ALONE, axial_blocks, STIFF | DAMPED, 0, SYM, SYM);
KERNEL(CS_STENCIL_KERNEL_ALONE, relative_blocks, STIFF | STEADY, 0, SYM, 1);
KERNEL(CS_STENCIL_KERNEL, undamped_both, FORCE | STIFF, 3, SYM, 0);
KERNEL(CS_STENCIL_KERNEL, axial_both, FORCE | AXIAL | STIFF | DAMPED, 3, SYM, SYM);
KERNEL(CS_STENCIL_KERNEL, relative_both, FORCE | RELATIVE | STIFF | STEADY, 3, SYM, 1);

/* The kernel for a row's damper and for the results that the evaluation wants. */
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

/* Forces of a piece of a mesh, whose lengths and stiffnesses are the springs' own. */
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

/* Dispatches to a copy for the run's damper. A run without damping does not gather velocities.
 */
CS_INLINE void force_piece(const struct spring_job *job, const struct piece *piece,
                           double *restrict fx, double *restrict fy, double *restrict fz) {
    if (active_constants_of(piece->run, job->at.parts).c == 0)
        force_rows(job, piece, 0, fx, fy, fz);
    else if (piece->run->axial)
        force_rows(job, piece, AXIAL, fx, fy, fz);
    else
        force_rows(job, piece, RELATIVE, fx, fy, fz);
}

/* Adds runs in their order; see add_runs. */
CS_CLONES void cs_springs_add_force(const struct cs_springs *springs, uint32_t n,
                                    const struct cs_eval *at, double *f) {
    const struct spring_job job = {.springs = springs, .n = n, .at = *at, .to = f};
    add_runs(&job, at->block, has_force, choose, force_piece);
}

/* Least particles of rows that go together: fewer cost calls, more leave the first cache. */
enum { ROWS_LEAST = 256 };

struct cs_block cs_springs_rows(const struct cs_springs *springs, uint32_t n,
                                uint32_t first_run, uint32_t end_run) {
    const struct cs_spring_run *runs = springs->runs, *end = runs + end_run;
    const struct cs_spring_run *run = runs + first_run, *last = run;
    while (run < end &&
           (run->row < runs[first_run].row + ROWS_LEAST || run->row == last->row)) {
        last = run++;
        // packed rows of a grid are summed as a whole
        while (last->columns <= PACKED_COLUMNS_MAX && run < end && run->body == last->body)
            run++;
    }
    struct cs_block rows = {n, n, first_run, (uint32_t)(run - runs)};
    if (run < end) {
        rows.begin = run->row;
        rows.end = run[-1].row + 3 * run[-1].columns;
    }
    return rows;
}

/* Forces of one chunk of a mesh into its slots. */
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
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        // a grid's run has one length
        for (uint32_t i = 0; i < (run->ends ? run->count : run->count > 0); i++)
            shortest = fmin(shortest, cs_spring_length(run, i));
    }
    return shortest;
}
