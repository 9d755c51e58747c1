/* graph_matching.h - matches the nodes of a weighted graph in pairs, for the coarse levels of a
 * mesh.
 *
 * Heavy-edge matching (Karypis, Kumar 1998) visits the nodes and joins each free one with the
 * free neighbour across its heaviest edge. Here the order of visits is that of the nodes'
 * numbers and not random, so that the result is the same in every run. */
#ifndef CS_GRAPH_MATCHING_H
#define CS_GRAPH_MATCHING_H

#include "base/arena.h"

#include <stdint.h>

#define CS_GRAPH_NONE UINT32_MAX

/* An undirected graph; two nodes may share several edges. The arena that made it owns the
 * arrays. */
struct cs_graph {
    uint32_t n, n_edges;
    uint32_t *ends;  /* (n_edges, 2), two different nodes */
    double *weights; /* (n_edges) */
};

/* Makes a graph with about half the nodes. Node by node, each free one is joined with the free
 * neighbour to which its edges weigh most in total, the lowest-numbered of equals. A node whose
 * neighbours are all joined follows the heaviest of them. Every node with an edge is therefore
 * joined with another one; a node without edges stays alone.
 *
 * parents (n) are the new nodes of the old ones. targets (n_edges) are the new edges,
 * CS_GRAPH_NONE between two joined nodes; parallel edges become one with the sum of their
 * weights. Memory comes from work. Returns CS_ERR_MEMORY if out of memory; *coarse must not be
 * used then. */
enum cs_status cs_graph_match(const struct cs_graph *fine, struct cs_graph *coarse,
                              uint32_t *parents, uint32_t *targets, struct cs_arena *work,
                              struct cs_error *error);

#endif
