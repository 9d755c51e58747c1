/* Rows of points, chunk by chunk: each point once, and sums that are those of all ends. */
#include "model/contact/force_gather.h"
#include "unit.h"

#include <math.h>
#include <string.h>

enum { LOTS = 5, PARTICLES = 3000, POINTS = 3400, ENDS = 4000 };

static uint32_t draw(uint64_t *state, uint32_t below) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 40) % below;
}

/* some points in a lot, others in none, and more than the table begins with */
static uint32_t point_of(uint64_t *state, uint32_t chunk) {
    return chunk == 2 ? 0 : (uint32_t)(chunk * 131 + draw(state, POINTS)) % POINTS;
}

static void fill(struct cs_gather *gather, uint32_t at[LOTS][ENDS], uint32_t to[LOTS][ENDS]) {
    uint64_t state = 3;
    for (uint32_t chunk = 0; chunk < LOTS; chunk++) {
        cs_gather_clear(gather->chunks + chunk);
        for (uint32_t e = 0; e < ENDS && chunk != 2; e++) {
            at[chunk][e] = point_of(&state, chunk);
            to[chunk][e] = cs_gather_row(gather->chunks + chunk, at[chunk][e]);
        }
    }
    ck_assert(cs_gather_set(gather));
}

TEST(each_point_has_one_row) {
    static uint32_t at[LOTS][ENDS], to[LOTS][ENDS];
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_gather gather;
    ck_assert_int_eq(cs_gather_init(&gather, LOTS, PARTICLES, &arena, &error), CS_OK);
    for (int turn = 0; turn < 2; turn++) {
        fill(&gather, at, to);
        for (uint32_t chunk = 0; chunk < LOTS; chunk++) {
            const struct cs_gather_chunk *rows = gather.chunks + chunk;
            for (uint32_t e = 0; e < ENDS && chunk != 2; e++)
                UNIT_ASSERT_OFTEN(to[chunk][e] < rows->n &&
                                  rows->points[to[chunk][e]] == at[chunk][e]);
            for (uint32_t row = 0; row < rows->n; row++)
                UNIT_ASSERT_OFTEN(cs_gather_row(gather.chunks + chunk, rows->points[row]) ==
                                  row);
        }
        ck_assert_uint_eq(gather.chunks[2].n, 0);
    }
    cs_arena_finish(&arena);
}

/* whole numbers, whose sums are the same in any order; points that are no particles get none */
TEST(sums_are_those_of_all_ends) {
    static uint32_t at[LOTS][ENDS], to[LOTS][ENDS];
    static double right[2 * PARTICLES], out[2 * PARTICLES], x[3 * POINTS];
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_gather gather;
    ck_assert_int_eq(cs_gather_init(&gather, LOTS, PARTICLES, &arena, &error), CS_OK);
    fill(&gather, at, to);
    ck_assert(cs_gather_reserve(&gather, 3));
    for (size_t i = 0; i < 3 * POINTS; i++)
        x[i] = (double)(i % 1000);
    memset(gather.row_sums, 0, 2 * gather.n_rows * sizeof *gather.row_sums);
    for (uint32_t chunk = 0; chunk < LOTS; chunk++) {
        const double *read = cs_gather_read(&gather, chunk, 0, x, PARTICLES);
        double *sums = cs_gather_of(gather.chunks + chunk, gather.row_sums, 2);
        for (uint32_t e = 0; e < ENDS && chunk != 2; e++)
            for (size_t c = 0; c < 2; c++) {
                const double value = read[3 * to[chunk][e] + c] + chunk;
                const bool is_one = at[chunk][e] < PARTICLES;
                UNIT_ASSERT_OFTEN(value ==
                                  chunk + (is_one ? x[c * PARTICLES + at[chunk][e]] : 0));
                sums[2 * to[chunk][e] + c] += value;
                if (is_one)
                    right[c * PARTICLES + at[chunk][e]] += value;
            }
    }
    cs_gather_add(&gather, gather.row_sums, 2, 0, 1234, out);
    cs_gather_add(&gather, gather.row_sums, 2, 1234, PARTICLES, out);
    ck_assert(!memcmp(right, out, sizeof out));
    cs_arena_finish(&arena);
}
