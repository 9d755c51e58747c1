/* The levels of the multigrid: each is the matrix that it should be, its smoother is bounded,
 * and the cycle through them is a preconditioner. */
#include "crumple.h"

#include "model/solver/level_kernels.h"

static void fill_level(const struct cs_level *level, float *p, uint32_t seed) {
    memset(p, 0, 3 * sizeof *p * level->n);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = level->begin; i < level->end; i++) {
            const float value = (float)crumple_random(&seed);
            p[c * level->n + i] = cs_level_is_alive(level, i) ? value : 0;
        }
}

/* r = A d, as a level has only r -= A d */
static void multiply(struct cs_level *level) {
    memset(level->residual, 0, 3 * sizeof *level->residual * level->n);
    cs_level_subtract_product(level);
    for (size_t i = 0; i < 3 * (size_t)level->n; i++)
        level->residual[i] = -level->residual[i];
}

static double dot_alive(const struct cs_level *level, const float *a, const float *b) {
    double sum = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = level->begin; i < level->end; i++)
            if (cs_level_is_alive(level, i))
                sum += (double)a[c * level->n + i] * (double)b[c * level->n + i];
    return sum;
}

/* where a particle is on the first level */
static size_t cell_of(const struct cs_hierarchy *hierarchy, size_t i) {
    const size_t local = i - hierarchy->first;
    return hierarchy->levels->begin + local / hierarchy->columns * hierarchy->levels->pitch +
           local % hierarchy->columns;
}

/* but for the scale, in single precision */
TEST(first_level_is_the_matrix) {
    for (int kind = 0; kind < KINDS; kind++) {
        struct crumple crumple;
        open_kind(&crumple, kind, 1e3);
        const size_t n = crumple.sheet.n;
        double *p = calloc(6 * n, sizeof *p), *y = p + 3 * n;
        ck_assert(crumple_setup(&crumple, true));
        struct cs_multigrid *multigrid = &crumple.linear.multigrid;
        ck_assert_uint_eq(multigrid->n, kind == 3 ? 4 : 1);
        for (uint32_t k = 0; k < multigrid->n; k++) {
            struct cs_hierarchy *hierarchy = multigrid->hierarchies + k;
            struct cs_level *level = hierarchy->levels;
            fill_level(level, level->correction, 7);
            memset(p, 0, 6 * n * sizeof *p);
            for (size_t c = 0; c < 3; c++)
                for (size_t i = hierarchy->first; i < hierarchy->first + hierarchy->count; i++)
                    p[c * n + i] =
                        (double)level->correction[c * level->n + cell_of(hierarchy, i)];
            cs_linear_mul(&crumple.linear, p, y);
            const double largest = cs_vector_kernels.max_norm(3 * n, y) / multigrid->scale;
            multiply(level);
            for (size_t c = 0; c < 3; c++)
                for (size_t i = hierarchy->first; i < hierarchy->first + hierarchy->count; i++)
                    if (crumple.sheet.system.inv_mass[i] > 0)
                        ck_assert_double_eq_tol(
                            (double)level->residual[c * level->n + cell_of(hierarchy, i)],
                            y[c * n + i] / multigrid->scale, 2e-6 * largest);
        }
        free(p);
        crumple_shut(&crumple);
    }
}

/* A translation costs the mass, on every level the same: halved springs change that not. */
TEST(translations_cost_the_same_on_every_level) {
    for (int kind = 1; kind < 3; kind++) {
        struct crumple crumple;
        open_kind(&crumple, kind, 1e4);
        // the strip without its pins, which tie it
        for (uint32_t k = 0; k < crumple.sheet.system.n_pinned; k++)
            crumple.sheet.system.inv_mass[crumple.sheet.system.pinned[k]] = 1;
        crumple_setup(&crumple, true);
        struct cs_hierarchy *hierarchy = crumple.linear.multigrid.hierarchies;
        double expected = 0;
        ck_assert_uint_ge(hierarchy->n_levels, 5);
        for (uint32_t l = 0; l < hierarchy->n_levels; l++) {
            struct cs_level *level = hierarchy->levels + l;
            for (size_t c = 0; c < 3; c++)
                for (size_t i = level->begin; i < level->end; i++)
                    level->correction[c * level->n + i] = cs_level_is_alive(level, i) && c == 1;
            float *ones = calloc(3 * (size_t)level->n, sizeof *ones);
            memcpy(ones, level->correction, 3 * sizeof *ones * level->n);
            multiply(level);
            const double cost = dot_alive(level, ones, level->residual);
            free(ones);
            if (l == 0)
                expected = cost;
            ck_assert_double_eq_tol(cost, expected, 1e-5 * expected);
        }
        ck_assert_uint_eq(hierarchy->levels[hierarchy->n_levels - 1].n_neighbour_offsets, 0);
        crumple_shut(&crumple);
    }
}

/* The theorem of multigrid_hierarchy.h, by power iteration: (A p).(D^-1 A p) / p.(A p) is below
 * the largest eigenvalue of D^-1 A and comes near to it. */
TEST(smoother_bound_holds_on_every_level) {
    for (int kind = 0; kind < KINDS; kind++)
        for (double k = 100; k < 1e9; k *= 1e3) {
            struct crumple crumple;
            open_kind(&crumple, kind, k);
            crumple_setup(&crumple, true);
            for (uint32_t b = 0; b < crumple.linear.multigrid.n; b++) {
                struct cs_hierarchy *hierarchy = crumple.linear.multigrid.hierarchies + b;
                double largest = 0;
                for (uint32_t l = 0; l < hierarchy->n_levels; l++) {
                    struct cs_level *level = hierarchy->levels + l;
                    const size_t bytes = 3 * sizeof(float) * level->n;
                    float *p = malloc(bytes);
                    fill_level(level, level->correction, 3);
                    for (int step = 0; step < 60; step++) {
                        const float size =
                            (float)sqrt(dot_alive(level, level->correction, level->correction));
                        for (size_t i = 0; i < 3 * (size_t)level->n; i++)
                            p[i] = level->correction[i] /= size;
                        multiply(level);
                        cs_level_solve_diagonal(level); // over d as well
                        const double eigenvalue =
                            dot_alive(level, level->residual, level->solution) /
                            dot_alive(level, p, level->residual);
                        largest = fmax(largest, eigenvalue);
                        ck_assert_msg(eigenvalue <= 2 + 1e-4, "kind %d, k %g, level %u: %g",
                                      kind, k, l, eigenvalue);
                    }
                    free(p);
                }
                ck_assert_double_gt(largest, 1.3);
            }
            crumple_shut(&crumple);
        }
}

/* x.My = y.Mx to the rounding of single precision, x.Mx > 0, and nothing where pinned */
TEST(cycle_is_symmetric_and_positive) {
    for (int kind = 0; kind < KINDS; kind++) {
        struct crumple crumple;
        open_kind(&crumple, kind, 1e4);
        const size_t n3 = 3 * crumple.sheet.n;
        double *x = calloc(4 * n3, sizeof *x), *y = x + n3, *mx = y + n3, *my = mx + n3;
        uint32_t seed = 5;
        crumple_setup(&crumple, true);
        for (size_t i = 0; i < n3; i++)
            if (crumple.sheet.system.inv_mass[i % crumple.sheet.n] > 0) {
                x[i] = crumple_random(&seed);
                y[i] = 1 + 0.1 * crumple_random(&seed);
            }
        cs_multigrid_apply(&crumple.linear.multigrid, x, 1, mx);
        cs_multigrid_apply(&crumple.linear.multigrid, y, 1e-3, my);
        const double xx = cs_vector_kernels.dot(n3, x, mx);
        const double yy = cs_vector_kernels.dot(n3, y, my);
        ck_assert_double_gt(xx, 0);
        ck_assert_double_gt(yy, 0);
        ck_assert_double_eq_tol(cs_vector_kernels.dot(n3, x, my),
                                cs_vector_kernels.dot(n3, y, mx), 3e-6 * sqrt(xx * yy));
        for (size_t i = 0; i < n3; i++)
            if (crumple.sheet.system.inv_mass[i % crumple.sheet.n] == 0)
                ck_assert(mx[i] == 0 && my[i] == 0);
        free(x);
        crumple_shut(&crumple);
    }
}

/* The kernels of both widths on the same level: what they write is equal to the bit. */
TEST(widths_give_the_same_bits) {
    const struct cs_level_kernels *const kernels[] = {&cs_level_kernels_8,
                                                      &cs_level_kernels_16};
    for (int kind = 0; kind < KINDS; kind++) {
        struct crumple crumple;
        open_kind(&crumple, kind, 1e4);
        crumple_setup(&crumple, true);
        for (uint32_t b = 0; b < crumple.linear.multigrid.n; b++) {
            struct cs_level *level = crumple.linear.multigrid.hierarchies[b].levels;
            const size_t n3 = 3 * (size_t)level->n;
            float *written = calloc(10 * n3, sizeof *written), *all = written;
            fill_level(level, level->correction, 3);
            for (int w = 0; w < 2; w++, all += 5 * n3) {
                float *const arrays[] = {level->residual, level->solution,
                                         level->correction_next, level->inverse};
                fill_level(level, level->residual, 5);
                struct cs_level_loop loop = {.level = level,
                                             .d = level->correction,
                                             .e = level->correction_next,
                                             .b = 1e-6F};
                kernels[w]->invert(&loop, level->begin, level->end);
                loop.a = 0.3F, loop.b = 0.7F;
                kernels[w]->start(&loop, level->begin, level->end);
                kernels[w]->sweep(&loop, level->begin, level->end);
                for (size_t k = 0; k < 4; k++)
                    memcpy(all + k * n3, arrays[k], (k < 3 ? 1 : 2) * n3 * sizeof *all);
            }
            ck_assert(memcmp(written, written + 5 * n3, 5 * n3 * sizeof *written) == 0);
            ck_assert_double_gt(dot_alive(level, written, written), 0);
            free(written);
        }
        crumple_shut(&crumple);
    }
}
