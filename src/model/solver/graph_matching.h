/* graph_matching.h - joining the nodes of a graph in pairs, for the coarse levels of a mesh. */
#ifndef CS_GRAPH_MATCHING_H
#define CS_GRAPH_MATCHING_H

#include "base/arena.h"

#include <stdint.h>

#define CS_GRAPH_NONE UINT32_MAX

struct cs_graph {
    uint32_t n, n_edges;
    uint32_t *ends;  /* (n_edges, 2), two different nodes */
    double *weights; /* (n_edges) */
};

/* Makes a graph with about half the nodes: node by node, each one that is still alone is joined
 * with the lone neighbour to which the edges weigh most together, the first of equals; those
 * left over go to the pair of their heaviest neighbour. So every node with an edge is joined
 * with some other. parents (n) are the new nodes of the old ones, targets (n_edges) the new
 * edges, CS_GRAPH_NONE between two that were joined; parallel edges become one with their
 * weights added. Memory is taken from work. CS_ERR_MEMORY. */
enum cs_status cs_graph_match(const struct cs_graph *fine, struct cs_graph *coarse,
                              uint32_t *parents, uint32_t *targets, struct cs_arena *work,
                              struct cs_error *error);

#endif
