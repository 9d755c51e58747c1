/* Heavy-edge matching of a weighted graph. Two passes of it make aggregates of four nodes, as
 * in the double pairwise aggregation of Notay (2010). Time is proportional to the number of
 * edges. */
#include "model/solver/multigrid_hierarchy.h"

#include <stdbool.h>

/* Edges, or ends of edges, sorted by node: those of node i are list[starts[i]..starts[i + 1]).
 * End k belongs to edge k / 2, and the other end of that edge is k ^ 1. */
struct stars {
    uint32_t *starts, *list;
};

/* Counting sort by node, stable. nodes (n_ends) are the nodes of edges or of ends;
 * CS_GRAPH_NONE is left out. Counts are stored two places further on, so that the second loop,
 * which advances each start, leaves every start where it belongs. */
static enum cs_status sort_edges(uint32_t n, uint32_t n_ends, const uint32_t *nodes,
                                 struct stars *stars, struct cs_arena *work,
                                 struct cs_error *error) {
    stars->starts = cs_arena_alloc_array(work, (size_t)n + 2, sizeof(uint32_t), error);
    stars->list = cs_arena_alloc_array(work, n_ends, sizeof(uint32_t), error);
    if (error->status)
        return error->status;
    for (uint32_t k = 0; k < n_ends; k++)
        if (nodes[k] != CS_GRAPH_NONE)
            stars->starts[nodes[k] + 2]++;
    for (uint32_t i = 2; i < n + 2; i++)
        stars->starts[i] += stars->starts[i - 1];
    for (uint32_t k = 0; k < n_ends; k++)
        if (nodes[k] != CS_GRAPH_NONE)
            stars->list[stars->starts[nodes[k] + 1]++] = k;
    return CS_OK;
}

/* Returns the neighbour of i with the largest total weight, among the joined or the free ones,
 * the lowest-numbered of equals; CS_GRAPH_NONE if there is none. sums (n) is 0 before and
 * afterwards: only the entries of i's neighbours are touched, so a call costs the degree of i.
 */
static uint32_t heaviest(const struct cs_graph *graph, const struct stars *stars, uint32_t i,
                         const uint32_t *parents, bool joined, double *sums) {
    uint32_t best = CS_GRAPH_NONE;
    for (uint32_t k = stars->starts[i]; k < stars->starts[i + 1]; k++)
        sums[graph->ends[stars->list[k] ^ 1]] += graph->weights[stars->list[k] / 2];
    for (uint32_t k = stars->starts[i]; k < stars->starts[i + 1]; k++) {
        const uint32_t j = graph->ends[stars->list[k] ^ 1];
        const bool fits = (parents[j] != CS_GRAPH_NONE) == joined;
        if (fits && (best == CS_GRAPH_NONE || sums[j] > sums[best] ||
                     (!(sums[j] < sums[best]) && j < best)))
            best = j;
    }
    for (uint32_t k = stars->starts[i]; k < stars->starts[i + 1]; k++)
        sums[graph->ends[stars->list[k] ^ 1]] = 0;
    return best;
}

/* Sets the parents and returns the number of new nodes. The first loop matches. The second
 * assigns the nodes left over, all of whose neighbours have a parent by then. */
static uint32_t join(const struct cs_graph *graph, const struct stars *stars, double *sums,
                     uint32_t *parents) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < graph->n; i++)
        parents[i] = CS_GRAPH_NONE;
    for (uint32_t i = 0; i < graph->n; i++) {
        if (parents[i] != CS_GRAPH_NONE)
            continue;
        const uint32_t j = heaviest(graph, stars, i, parents, false, sums);
        if (j != CS_GRAPH_NONE && j != i)
            parents[i] = parents[j] = n++;
        else if (stars->starts[i] == stars->starts[i + 1])
            parents[i] = n++; // without an edge
    }
    for (uint32_t i = 0; i < graph->n; i++)
        if (parents[i] == CS_GRAPH_NONE)
            parents[i] = parents[heaviest(graph, stars, i, parents, true, sums)];
    return n;
}

/* Makes the coarse edges. Edges between the same two new nodes become one; the new edges are
 * ordered by their lower node, and then by their first old edge. by_low lists the edges by
 * their lower new node, without those inside a node. known (coarse->n) is work: the last new
 * edge to each node, valid for the current lower node if its number is at least `before`. */
static void merge(const struct cs_graph *fine, struct cs_graph *coarse, const uint32_t *parents,
                  const struct stars *by_low, uint32_t *known, uint32_t *targets) {
    for (uint32_t i = 0; i < coarse->n; i++)
        known[i] = CS_GRAPH_NONE;
    for (uint32_t low = 0; low < coarse->n; low++) {
        const uint32_t before = coarse->n_edges;
        for (uint32_t k = by_low->starts[low]; k < by_low->starts[low + 1]; k++) {
            const uint32_t e = by_low->list[k];
            const uint32_t high =
                parents[fine->ends[2 * e]] + parents[fine->ends[2 * e + 1]] - low;
            if (known[high] == CS_GRAPH_NONE || known[high] < before) {
                known[high] = coarse->n_edges++;
                coarse->ends[2 * known[high]] = low;
                coarse->ends[2 * known[high] + 1] = high;
            }
            targets[e] = known[high];
            coarse->weights[known[high]] += fine->weights[e];
        }
    }
}

enum cs_status cs_graph_match(const struct cs_graph *fine, struct cs_graph *coarse,
                              uint32_t *parents, uint32_t *targets, struct cs_arena *work,
                              struct cs_error *error) {
    struct stars stars, by_low;
    *coarse = (struct cs_graph){0};
    double *sums = cs_arena_alloc_array(work, fine->n, sizeof *sums, error);
    uint32_t *known = cs_arena_alloc_array(work, fine->n, sizeof *known, error);
    coarse->ends =
        cs_arena_alloc_array(work, 2 * (size_t)fine->n_edges, sizeof(uint32_t), error);
    coarse->weights = cs_arena_alloc_array(work, fine->n_edges, sizeof(double), error);
    if (sort_edges(fine->n, 2 * fine->n_edges, fine->ends, &stars, work, error))
        return error->status;
    coarse->n = join(fine, &stars, sums, parents);
    for (uint32_t e = 0; e < fine->n_edges; e++) {
        const uint32_t a = parents[fine->ends[2 * e]], b = parents[fine->ends[2 * e + 1]];
        // the lower node first, as the key of the sort; merge replaces it by the edge
        targets[e] = a == b ? CS_GRAPH_NONE : a < b ? a : b;
    }
    if (!sort_edges(coarse->n, fine->n_edges, targets, &by_low, work, error))
        merge(fine, coarse, parents, &by_low, known, targets);
    return error->status;
}
