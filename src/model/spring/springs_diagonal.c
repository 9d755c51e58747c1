/* Diagonal blocks: of the springs' derivatives, and of the factored form of springs_matrix.c.
 */
#include "model/spring/springs.h"

#include "model/spring/fan.h"

#include <float.h>
#include <math.h>

/* symmetric blocks: xx, xy, xz, yy, yz, zz */
enum { SYM = 6 };

/* a I + b u u^T */
CS_INLINE void set_block(double a, double b, const struct difference u, double *out) {
    out[0] = a + b * u.x * u.x;
    out[1] = b * u.x * u.y;
    out[2] = b * u.x * u.z;
    out[3] = a + b * u.y * u.y;
    out[4] = b * u.y * u.z;
    out[5] = a + b * u.z * u.z;
}

/* symmetric blocks of a piece of a mesh */
struct blocks {
    double rows[SYM][PIECE];
};

CS_INLINE void put_block(const double *block, size_t i, struct blocks *blocks) {
    for (size_t c = 0; c < SYM; c++)
        blocks->rows[c][i] = block[c];
}

/* Adds them to both ends, sums (6,n). */
CS_INLINE void add_blocks(const struct piece *piece, const struct blocks *blocks, size_t n,
                          double *sums) {
    double *a = sums + piece->run->a, *b = sums + piece->run->b;
    const uint32_t *ends = piece->run->ends + 2 * (size_t)piece->start;
    for (size_t i = 0; i < piece->count; i++)
        for (size_t c = 0; c < SYM; c++) {
            a[c * n + ends[2 * i]] += blocks->rows[c][i];
            b[c * n + ends[2 * i + 1]] += blocks->rows[c][i];
        }
}

/* a spring's unit direction and ratio of its rest length to its length */
struct turned {
    struct difference u;
    double ratio;
};

CS_INLINE struct turned turned_of(const struct difference d, double length) {
    const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
    return (struct turned){{d.x * inverse, d.y * inverse, d.z * inverse}, length * inverse};
}

/* of df/dx */
CS_INLINE void stiff_block(const struct turned spring, double k, double *out) {
    set_block(-(k * (1 - spring.ratio)), -(k * spring.ratio), spring.u, out);
}

CS_INLINE void stiff(const struct fan_in *in, const struct fan_way *way, size_t i,
                     double *out) {
    stiff_block(turned_of(fan_across(in->x, in->n, i, way->step), way->length), way->k, out);
}

/* of df/dv with axial dampers, which turn with the spring */
CS_INLINE void damped(const struct fan_in *in, const struct fan_way *way, size_t i,
                      double *out) {
    set_block(0, -in->c, turned_of(fan_across(in->x, in->n, i, way->step), 0).u, out);
}

/* of df/dv with relative dampers, which are the same in every direction */
CS_INLINE void steady(const struct fan_in *in, const struct fan_way *way, size_t i,
                      double *out) {
    (void)way, (void)i;
    out[0] = -in->c;
}

CS_FAN_KERNEL(stiff_blocks, stiff, SYM, 1);
CS_FAN_KERNEL(damped_blocks, damped, SYM, 1);
CS_FAN_KERNEL(steady_block, steady, 1, 1);

static uint32_t fan_diagonal(struct job *job, const struct cs_block *all,
                             const struct cs_spring_run *first, double *kxx, double *dvv) {
    job->to = kxx;
    const uint32_t n_runs = cs_fan_add(job, all, first, asks_always, &stiff_blocks);
    job->to = dvv;
    if (first->damping != 0 && first->axial)
        cs_fan_add(job, all, first, asks_always, &damped_blocks);
    for (size_t c = 0; first->damping != 0 && !first->axial && c < SYM; c += c ? 2 : 3) {
        job->to = dvv + c * job->n;
        cs_fan_add(job, all, first, asks_always, &steady_block);
    }
    return n_runs;
}

/* of a piece of a mesh */
CS_INLINE void stiff_piece(const struct piece *piece, const struct ends e,
                           struct blocks *blocks) {
    const size_t count = piece->count;
    for (size_t i = 0; i < count; i++) {
        double block[SYM];
        stiff_block(turned_of(across(e, i, true), piece->lengths[i]), piece->stiffnesses[i],
                    block);
        put_block(block, i, blocks);
    }
}

CS_INLINE void damped_piece(const struct piece *piece, const struct ends e,
                            struct blocks *blocks) {
    const double d = -piece->run->damping;
    const bool axial = piece->run->axial;
    const size_t count = piece->count;
    for (size_t i = 0; i < count; i++) {
        double block[SYM];
        set_block(axial ? 0 : d, axial ? d : 0, turned_of(across(e, i, true), 0).u, block);
        put_block(block, i, blocks);
    }
}

CS_INLINE void run_diagonal(const struct cs_spring_run *run, size_t n, const double *x,
                            double *kxx, double *dvv) {
    struct gathered places;
    struct blocks blocks;
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        const struct ends e = ends_of(&piece, x, n, false, &places);
        stiff_piece(&piece, e, &blocks);
        add_blocks(&piece, &blocks, n, kxx);
        if (run->damping == 0)
            continue;
        damped_piece(&piece, e, &blocks);
        add_blocks(&piece, &blocks, n, dvv);
    }
}

CS_CLONES void cs_springs_add_diagonal(const struct cs_springs *springs, uint32_t n,
                                       const double *x, double *kxx, double *dvv) {
    struct job job = {
        .springs = springs, .n = n, .at = {.x = x, .parts = CS_PART_DAMPED_SPRINGS}};
    const struct cs_block all = {0, n, 0, springs->n_runs};
    uint32_t n_runs = 1;
    for (uint32_t r = 0; r < springs->n_runs; r += n_runs) {
        const struct cs_spring_run *run = springs->runs + r;
        n_runs = 1;
        if (run->columns)
            n_runs = fan_diagonal(&job, &all, run, kxx, dvv);
        else
            run_diagonal(run, n, x, kxx, dvv);
    }
}

CS_INLINE void own_block(const struct fan_in *in, const struct fan_way *way, size_t i,
                         double *out) {
    const double *s = way->factors;
    const size_t count = way->count;
    (void)in;
    set_block(s[i], 1, (struct difference){s[count + i], s[2 * count + i], s[3 * count + i]},
              out);
}

CS_FAN_KERNEL(own_blocks, own_block, SYM, 1);

CS_CLONES void cs_springs_factor_diagonal(const struct cs_springs *springs, uint32_t n,
                                          const double *factors, double *sums) {
    const struct job job = {.springs = springs, .n = n, .factors = factors, .to = sums};
    const struct cs_block all = {0, n, 0, springs->n_runs};
    struct blocks blocks;
    uint32_t n_runs = 1;
    for (uint32_t r = 0; r < springs->n_runs; r += n_runs) {
        const struct cs_spring_run *run = springs->runs + r;
        n_runs = 1;
        if (run->columns) {
            n_runs = cs_fan_add(&job, &all, run, asks_always, &own_blocks);
            continue;
        }
        const double *s = factors + 4 * (size_t)run->first, *w = s + run->count;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const struct piece piece = piece_of(run, start);
            for (size_t i = 0, k = start; i < piece.count; i++, k++) {
                const size_t count = run->count;
                double block[SYM];
                set_block(s[k], 1, (struct difference){w[k], w[count + k], w[2 * count + k]},
                          block);
                put_block(block, i, &blocks);
            }
            add_blocks(&piece, &blocks, n, sums);
        }
    }
}
