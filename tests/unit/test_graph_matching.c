/* Joining the nodes of a graph in pairs, on graphs small enough to do by hand. */
#include "model/solver/multigrid_hierarchy.h"
#include "unit.h"

enum { MOST = 64 };

struct joined {
    struct cs_graph coarse;
    uint32_t parents[MOST], targets[MOST];
    struct cs_arena arena;
};

static void join(struct joined *joined, uint32_t n, uint32_t n_edges, const uint32_t *ends,
                 const double *weights) {
    struct cs_error error = {0};
    uint32_t flat[2 * MOST];
    double copy[MOST];
    for (uint32_t e = 0; e < n_edges; e++) {
        flat[2 * e] = ends[2 * e];
        flat[2 * e + 1] = ends[2 * e + 1];
        copy[e] = weights ? weights[e] : 1;
    }
    const struct cs_graph fine = {n, n_edges, flat, copy};
    *joined = (struct joined){0};
    cs_graph_match(&fine, &joined->coarse, joined->parents, joined->targets, &joined->arena,
                   &error);
    UNIT_ASSERT_OK(&error);
}

static void expect_parents(const struct joined *joined, uint32_t n, const uint32_t *parents) {
    for (uint32_t i = 0; i < n; i++)
        ck_assert_msg(joined->parents[i] == parents[i], "node %u: found %u, expected %u", i,
                      joined->parents[i], parents[i]);
}

/* 0 - 1 - 2 - 3 - 4: the last one is left over and goes to the pair beside it */
TEST(path_becomes_a_shorter_path) {
    static const uint32_t ends[][2] = {{0, 1}, {1, 2}, {2, 3}, {4, 3}}, to[] = {0, 0, 1, 1, 1};
    struct joined joined;
    join(&joined, 5, 4, ends[0], NULL);
    ck_assert_uint_eq(joined.coarse.n, 2);
    ck_assert_uint_eq(joined.coarse.n_edges, 1);
    expect_parents(&joined, 5, to);
    ck_assert_uint_eq(joined.targets[0], CS_GRAPH_NONE);
    ck_assert_uint_eq(joined.targets[1], 0);
    ck_assert_uint_eq(joined.targets[2], CS_GRAPH_NONE);
    ck_assert_uint_eq(joined.targets[3], CS_GRAPH_NONE);
    ck_assert_uint_eq(joined.coarse.ends[0], 0);
    ck_assert_uint_eq(joined.coarse.ends[1], 1);
    cs_arena_finish(&joined.arena);
}

/* the heaviest neighbour, by the sum of parallel edges; of equals the first */
TEST(weights_choose) {
    static const uint32_t ends[][2] = {{0, 1}, {0, 2}, {0, 3}, {3, 0}, {1, 2}};
    static const double heavy[] = {1, 2, 1.5, 1.5, 1}, equal[] = {2, 2, 1, 1, 1};
    static const uint32_t to_heavy[] = {0, 1, 1, 0}, to_equal[] = {0, 0, 0, 0};
    struct joined joined;
    join(&joined, 4, 5, ends[0], heavy);
    expect_parents(&joined, 4, to_heavy);
    // the three edges between the pairs have become one, with their weights together
    ck_assert_uint_eq(joined.coarse.n_edges, 1);
    ck_assert_double_eq(joined.coarse.weights[0], 3);
    ck_assert(joined.targets[0] == 0 && joined.targets[1] == 0);
    cs_arena_finish(&joined.arena);

    join(&joined, 4, 5, ends[0], equal);
    ck_assert_uint_eq(joined.coarse.n, 1);
    expect_parents(&joined, 4, to_equal);
    cs_arena_finish(&joined.arena);
}

/* All tips of a star but one find its hub taken, and follow it; a node without edges stays. */
TEST(star_and_lone_node) {
    uint32_t ends[20][2];
    struct joined joined;
    for (uint32_t k = 0; k < 20; k++) {
        ends[k][0] = 21;
        ends[k][1] = k;
    }
    join(&joined, 22, 20, ends[0], NULL);
    ck_assert_uint_eq(joined.coarse.n, 2);
    ck_assert_uint_eq(joined.coarse.n_edges, 0);
    for (uint32_t k = 0; k < 22; k++)
        ck_assert_uint_eq(joined.parents[k], k == 20 ? 1 : 0);
    cs_arena_finish(&joined.arena);
}

/* again and again a closed ring ends as one node, and no weight is lost but inside pairs */
TEST(ring_ends_as_one_node) {
    uint32_t ends[MOST][2];
    struct joined joined;
    uint32_t n = 50, n_edges = 50, rounds = 0;
    for (uint32_t k = 0; k < n; k++) {
        ends[k][0] = k;
        ends[k][1] = (k + 1) % n;
    }
    while (n > 1) {
        join(&joined, n, n_edges, ends[0], NULL);
        ck_assert_uint_le(joined.coarse.n, n / 2);
        for (uint32_t e = 0; e < n_edges; e++) {
            const uint32_t a = joined.parents[ends[e][0]], b = joined.parents[ends[e][1]];
            const uint32_t t = joined.targets[e];
            ck_assert_int_eq(t == CS_GRAPH_NONE, a == b);
            if (a != b)
                ck_assert(joined.coarse.ends[2 * t] == (a < b ? a : b) &&
                          joined.coarse.ends[2 * t + 1] == (a < b ? b : a));
        }
        n = joined.coarse.n;
        n_edges = joined.coarse.n_edges;
        memcpy(ends, joined.coarse.ends, n_edges * sizeof *ends);
        cs_arena_finish(&joined.arena);
        rounds++;
    }
    ck_assert_uint_le(rounds, 6);
}
