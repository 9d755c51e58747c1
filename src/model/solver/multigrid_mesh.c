/* Multigrid levels of a mesh: cells are joined in pairs, twice, along the stiffest springs.
 *
 * The structure depends on the bodies' stiffness alone, not on the state, so it is made once.
 * Each level has its springs twice: by number (`blocks`), to be summed into the next level, and
 * by slots (`springs`), for the kernels, 16 cells at a time. Cells are joined by heavy-edge
 * matching of the graph of springs; two passes make aggregates of four, as in the double
 * pairwise aggregation of Notay (2010), in time proportional to the number of edges. */
#include "model/solver/multigrid_hierarchy.h"

#include "base/pool.h"

#include <string.h>

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
    CS_ARENA_ARRAY(work, coarse->ends, 2 * (size_t)fine->n_edges, error);
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

/* Composes the maps of two coarsenings: where[i] = then[where[i]]. Vanished items stay
 * CS_GRAPH_NONE. */
static void compose_maps(uint32_t n, uint32_t *where, const uint32_t *then) {
    for (uint32_t i = 0; i < n; i++)
        if (where[i] != CS_GRAPH_NONE)
            where[i] = then[where[i]];
}

/* Makes the graph of a body: particles are nodes, springs edges in their order, stiffness in
 * N/m is the weight. */
static enum cs_status body_graph(const struct cs_hierarchy *hierarchy, struct cs_graph *graph,
                                 struct cs_arena *work, struct cs_error *error) {
    graph->n = hierarchy->count;
    for (uint32_t r = 0; r < hierarchy->n_runs; r++)
        graph->n_edges += hierarchy->runs[r].count;
    CS_ARENA_ARRAY(work, graph->ends, 2 * (size_t)graph->n_edges, error);
    graph->weights = cs_arena_alloc_array(work, graph->n_edges, sizeof(double), error);
    if (error->status)
        return error->status;
    uint32_t e = 0;
    for (uint32_t r = 0; r < hierarchy->n_runs; r++)
        for (uint32_t i = 0; i < hierarchy->runs[r].count; i++, e++) {
            graph->ends[2 * e] = cs_spring_a(hierarchy->runs + r, i) - hierarchy->first;
            graph->ends[2 * e + 1] = cs_spring_b(hierarchy->runs + r, i) - hierarchy->first;
            graph->weights[e] = cs_spring_stiffness(hierarchy->runs + r, i);
        }
    return CS_OK;
}

/* Gives each 16 cells as many slots as the longest of their spring lists; sets `starts`. */
static void count_slots(const struct cs_graph *graph, struct cs_level *level,
                        uint32_t *degrees) {
    memset(degrees, 0, level->n * sizeof *degrees);
    for (uint32_t e = 0; e < 2 * graph->n_edges; e++)
        degrees[graph->ends[e]]++;
    for (uint32_t b = 0; b < level->n / CS_LANES; b++) {
        uint32_t most = 0;
        for (uint32_t l = 0; l < CS_LANES; l++)
            most = degrees[b * CS_LANES + l] > most ? degrees[b * CS_LANES + l] : most;
        level->starts[b + 1] = level->starts[b] + most;
    }
}

/* Gives every end of every edge the next slot of its cell. Unused slots join a cell to itself,
 * with the block 0: their difference is 0, and the kernels need no test. */
static void fill_slots(const struct cs_graph *graph, struct cs_level *level, uint32_t *filled) {
    for (uint32_t i = 0; i < level->n; i++) {
        filled[i] = 0;
        for (uint32_t k = level->starts[i / CS_LANES]; k < level->starts[i / CS_LANES + 1];
             k++) {
            level->neighbours[k * CS_LANES + i % CS_LANES] = i;
            level->spring_ids[k * CS_LANES + i % CS_LANES] = CS_GRAPH_NONE;
        }
    }
    for (uint32_t end = 0; end < 2 * graph->n_edges; end++) {
        const uint32_t i = graph->ends[end];
        const size_t slot = level->starts[i / CS_LANES] + filled[i]++;
        level->neighbours[slot * CS_LANES + i % CS_LANES] = graph->ends[end ^ 1];
        level->spring_ids[slot * CS_LANES + i % CS_LANES] = end / 2;
    }
}

/* Makes the structure of one level from its graph. */
static enum cs_status level_of(const struct cs_graph *graph, uint32_t pitch,
                               struct cs_level *level, struct cs_arena *arena,
                               struct cs_arena *work, struct cs_error *error) {
    *level =
        (struct cs_level){.form = CS_LEVEL_MESH, .pitch = pitch, .n_springs = graph->n_edges};
    level->n = level->end = (graph->n + CS_LANES - 1) / CS_LANES * CS_LANES;
    uint32_t *count = cs_arena_alloc_array(work, level->n, sizeof *count, error);
    CS_ARENA_ARRAY(arena, level->starts, level->n / CS_LANES + 1, error);
    CS_ARENA_ARRAY(arena, level->ends, 2 * (size_t)graph->n_edges, error);
    CS_ARENA_ARRAY(arena, level->blocks, 6 * (size_t)graph->n_edges, error);
    if (error->status)
        return error->status;
    memcpy(level->ends, graph->ends, 2 * sizeof(uint32_t) * graph->n_edges);
    /* the number of slots is known only now */
    count_slots(graph, level, count);
    const size_t n_slots = level->starts[level->n / CS_LANES];
    CS_ARENA_ARRAY(arena, level->neighbours, n_slots * CS_LANES, error);
    CS_ARENA_ARRAY(arena, level->spring_ids, n_slots * CS_LANES, error);
    if (error->status)
        return error->status;
    fill_slots(graph, level, count);
    return cs_level_alloc(level, n_slots * 6 * CS_LANES, arena, error);
}

/* Slots of one block of the loop below. */
enum { SLOTS = 256 };

/* Copies each spring's block to its two slots, component by component across the 16 lanes. */
static void scatter_slots(void *arg, uint32_t block) {
    const struct cs_level *level = arg;
    const size_t n_slots = level->starts[level->n / CS_LANES];
    for (size_t k = (size_t)block * SLOTS; k < ((size_t)block + 1) * SLOTS && k < n_slots; k++)
        for (size_t l = 0; l < CS_LANES; l++) {
            const uint32_t spring = level->spring_ids[k * CS_LANES + l];
            for (size_t c = 0; c < 6 && spring != CS_GRAPH_NONE; c++)
                level->springs[(6 * k + c) * CS_LANES + l] =
                    level->blocks[6 * (size_t)spring + c];
        }
}

/* Fills the slots of all springs from their blocks. */
static void scatter_blocks(struct cs_level *level) {
    cs_pool_run((level->starts[level->n / CS_LANES] + SLOTS - 1) / SLOTS, scatter_slots, level);
}

/* Sets the blocks of the first level's springs: those of the matrix over scale. */
static void load(struct cs_hierarchy *hierarchy, const double *factors, const double *x,
                 size_t n, double scale) {
    (void)x, (void)n;
    const double root = 1 / sqrt(scale);
    float *block = hierarchy->levels->blocks;
    for (uint32_t r = 0; r < hierarchy->n_runs; r++) {
        const size_t count = hierarchy->runs[r].count;
        const double *from = factors + hierarchy->runs[r].factors;
        for (size_t i = 0; i < count; i++, block += 6) {
            const double sw[4] = {from[i], from[count + i], from[2 * count + i],
                                  from[3 * count + i]};
            float numbers[4];
            cs_hierarchy_spring(sw, root, sw[0] < 0, numbers);
            cs_hierarchy_block(numbers, block);
        }
    }
    scatter_blocks(hierarchy->levels);
}

/* Sums the diagonal over the cells of each aggregate. */
static void sum_diagonal(const struct cs_level *fine, struct cs_level *coarse) {
    memset(coarse->diagonal, 0, 6 * sizeof(float) * coarse->n);
    for (size_t i = 0; i < fine->n; i++)
        for (size_t c = 0; c < 6; c++)
            coarse->diagonal[c * coarse->n + fine->parents[i]] +=
                fine->diagonal[c * fine->n + i];
}

/* P^T A P with halved springs. A spring whose one end is dead goes to the living end's
 * diagonal; one inside an aggregate, or between two dead cells, vanishes. Serial, because
 * springs of one aggregate lie anywhere. */
static void coarsen(const struct cs_level *fine, struct cs_level *coarse) {
    sum_diagonal(fine, coarse);
    memset(coarse->blocks, 0, 6 * sizeof(float) * coarse->n_springs);
    for (uint32_t s = 0; s < fine->n_springs; s++) {
        const uint32_t a = fine->ends[2 * s], b = fine->ends[2 * s + 1],
                       t = fine->coarse_springs[s];
        const bool alive_a = cs_level_is_alive(fine, a), alive_b = cs_level_is_alive(fine, b);
        const bool both = alive_a && alive_b;
        if (both ? t == CS_GRAPH_NONE : !alive_a && !alive_b)
            continue;
        float *sum = both ? coarse->blocks + 6 * (size_t)t
                          : coarse->diagonal + fine->parents[alive_a ? a : b];
        for (size_t c = 0; c < 6; c++)
            sum[c * (both ? 1 : coarse->n)] +=
                CS_HIERARCHY_SOFTNESS * fine->blocks[6 * (size_t)s + c];
    }
    scatter_blocks(coarse);
}

/* Sums the residual of the living cells of each aggregate. */
static void restrict_r(const struct cs_level *fine, struct cs_level *coarse) {
    for (size_t c = 0; c < 3; c++)
        memset(coarse->residual + c * coarse->stride, 0, sizeof(float) * coarse->n);
    for (size_t i = 0; i < fine->n; i++)
        for (size_t c = 0; c < 3 && cs_level_is_alive(fine, i); c++)
            coarse->residual[c * coarse->stride + fine->parents[i]] +=
                fine->residual[c * fine->stride + i];
}

/* Gives the coarse solution to the living cells of each aggregate, as correction and on top of
 * the solution. */
static void prolong_x(const struct cs_level *coarse, struct cs_level *fine) {
    for (size_t i = 0; i < fine->n; i++)
        for (size_t c = 0; c < 3 && cs_level_is_alive(fine, i); c++) {
            fine->correction[c * fine->stride + i] =
                coarse->solution[c * coarse->stride + fine->parents[i]];
            fine->solution[c * fine->stride + i] += fine->correction[c * fine->stride + i];
        }
}

/* Coarsens by two matchings: sets the parents and coarse springs of a level, and replaces the
 * graph by the next level's. n and n_edges of *graph are 0 after failure. */
static void aggregate(struct cs_graph *graph, struct cs_level *level, struct cs_arena *arena,
                      struct cs_arena *work, struct cs_error *error) {
    struct cs_graph pairs, fours = {0};
    level->parents = cs_arena_alloc_array(arena, level->n, sizeof(uint32_t), error);
    CS_ARENA_ARRAY(arena, level->coarse_springs, graph->n_edges, error);
    uint32_t *parents = cs_arena_alloc_array(work, graph->n, sizeof *parents, error);
    uint32_t *targets = cs_arena_alloc_array(work, graph->n_edges, sizeof *targets, error);
    if (!error->status &&
        !cs_graph_match(graph, &pairs, level->parents, level->coarse_springs, work, error) &&
        !cs_graph_match(&pairs, &fours, parents, targets, work, error)) {
        compose_maps(graph->n, level->parents, parents);
        compose_maps(graph->n_edges, level->coarse_springs, targets);
    }
    *graph = fours;
}

/* Adds a level of the same cells: no spring joins them. */
static void extend(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                   struct cs_error *error) {
    struct cs_arena work = {0};
    struct cs_level *level = hierarchy->levels + hierarchy->n_levels - 1;
    struct cs_graph graph = {.n = level->n};
    aggregate(&graph, level, arena, &work, error);
    if (!error->status && !level_of(&graph, hierarchy->columns, level + 1, arena, &work, error))
        hierarchy->n_levels++;
    cs_arena_finish(&work);
}

static const struct cs_hierarchy_kind mesh = {load, coarsen, restrict_r, prolong_x, extend};

enum cs_status cs_hierarchy_of_mesh(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                    struct cs_error *error) {
    struct cs_arena work = {0};
    struct cs_graph graph = {0};
    struct cs_level *level = hierarchy->levels;
    hierarchy->kind = &mesh;
    /* ends, because every matching at least halves the nodes that have edges */
    body_graph(hierarchy, &graph, &work, error);
    while (!error->status &&
           !level_of(&graph, hierarchy->columns, level, arena, &work, error) && graph.n_edges)
        aggregate(&graph, level++, arena, &work, error);
    hierarchy->n_levels = (uint32_t)(level - hierarchy->levels) + 1;
    cs_arena_finish(&work);
    return error->status;
}
