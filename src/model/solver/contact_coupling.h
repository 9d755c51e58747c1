/* contact_coupling.h - contact between surfaces in the multigrid, as extra springs between
 * cells: of a body with itself, and of two bodies.
 *
 * A contact pair is a point and a triangle, or two edges. Its points x_i have weights w_i with
 * the sum 0. With a block C its energy in the matrix is
 *
 *   X^T C X / 2 = sum over i < j of -w_i w_j (x_i - x_j)^T C (x_i - x_j) / 2,   X = sum w_i x_i
 *
 * because the sum of w_i w_j (x_i - x_j)^T C (x_i - x_j) over all i and j is -2 X^T C X. A pair
 * is therefore springs with the blocks -w_i w_j C between its points. Points with weights of
 * the same sign, on the same side, have a negative spring. Pairs that are subtracted
 * (mesh_feature.h) have the opposite signs. The springs reproduce the pair except where its
 * gradient bends, near a border.
 *
 * On the next level two cells have the sum of the springs between their aggregates: Galerkin's
 * product again. It is not halved as in multigrid_hierarchy.h, because surfaces in contact move
 * against each other as wholes and not with a slope.
 *
 * Gain: a folding sheet takes 1.06 to 1.2 times the iterations of the same sheet without
 * contact. With the pairs' diagonal blocks alone it took 1.5 to 1.7 times, and tight layers six
 * times: diagonal blocks hold two layers in contact as if each lay on ground.
 *
 * Pairs of two bodies join cells of their two hierarchies on the same level. These have joint
 * vectors and equally many levels, and are smoothed together. On the last level a body is one
 * cell or a few, without springs of its own: the extra springs between the bodies are solved
 * there by Cholesky's factors of all of them, up to CS_COARSEST_CELLS cells, else smoothed.
 *
 * A pair with a collider is not here. It only has its diagonal blocks. */
#ifndef CS_CONTACT_COUPLING_H
#define CS_CONTACT_COUPLING_H

#include "base/arena.h"
#include "model/solver/multigrid_hierarchy.h"

/* The contact part of the solver's matrix, indexed by particle. */

struct cs_pairs;

/* One of the four points of a stored pair: number of the chunk, of the pair in it, and of the
 * point. */
struct cs_pair_vertex {
    uint32_t chunk, pair, vertex;
};

/* The index; rebuilt for each matrix in the memory that it has. */
struct cs_pair_vertices {
    uint32_t *starts;             /* (n + 2) */
    struct cs_pair_vertex *items; /* particle i has items[starts[i]..starts[i + 1]), in the
                                     order of the chunks and pairs */
    size_t starts_capacity, items_capacity;
};

/* Makes an empty index; the arena frees what grows. Returns CS_ERR_MEMORY if out of memory. */
enum cs_status cs_pair_vertices_init(struct cs_pair_vertices *vertices, struct cs_arena *arena,
                                     struct cs_error *error);

/* Number of pairs in the stored matrix. */
size_t cs_pair_vertices_count(const struct cs_pairs *pairs);

/* Indexes the stored matrix. Returns false if out of memory; the index must not be used then.
 */
bool cs_pair_vertices_find(struct cs_pair_vertices *vertices, const struct cs_pairs *pairs);

/* A pair's part of the matrix, seen from one of its vertices. */
struct cs_pair_vertex_terms {
    uint32_t points[4]; /* points of the pair */
    uint32_t vertex;
    double weight[4];
    double diagonal_block[6];    /* block of this vertex with itself */
    double unit_weight_block[6]; /* the pair's block C, for a weight of 1: taken at the vertex
                                    of the largest weight, whose gradient is bent least */
};

/* Gives all levels of a hierarchy the arrays that extra springs need, but for joint_parents,
 * which it fills for its own cells. Returns CS_ERR_MEMORY if out of memory. */
enum cs_status cs_coupling_init(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                struct cs_error *error);

/* A matrix of pairs on its way into the first level. All pointers are borrowed. */
struct cs_coupling {
    struct cs_hierarchy *hierarchy;         /* the body that is loaded */
    const struct cs_hierarchy *hierarchies; /* all of them */
    const struct cs_pairs *pairs;
    const struct cs_pair_vertices *pair_vertices; /* the pairs indexed by particle */
    const double *inv_mass;                       /* (n) of all particles; 0: pinned */
    double scale;                                 /* factor of all blocks */
    double trace_min;        /* springs whose block has a smaller trace stay in the diagonal */
    double *internal_blocks; /* (6,n) output for the body's particles: the pairs' diagonal
                                blocks that extra springs replace, without the parts of springs
                                to pinned particles */
};

/* Make the extra springs of the first level, and those of the next level from a finer one.
 * Return false if out of memory; the level then has none. */
bool cs_coupling_load(struct cs_coupling *coupling);
bool cs_coupling_coarsen(const struct cs_level *fine, struct cs_level *coarse);

/* Most living cells of a last level that is solved exactly. Its factors take 74 kB, and 0.3 ms
 * per matrix. */
enum { CS_COARSEST_CELLS = 32 };

/* The last level of bodies in contact. */
struct cs_coarsest {
    uint32_t n;      /* living cells; 0: not factored */
    uint32_t *cells; /* (CS_COARSEST_CELLS) their joint numbers */
    double *factors; /* (3 CS_COARSEST_CELLS)^2, lower triangle by rows */
};

/* Allocates it. Returns CS_ERR_MEMORY if out of memory. */
enum cs_status cs_coarsest_init(struct cs_coarsest *coarsest, struct cs_arena *arena,
                                struct cs_error *error);

/* Factors the matrix of the last level. n is 0 if it has too many living cells or, by rounding,
 * no factors. */
void cs_coarsest_factor(struct cs_coarsest *coarsest, const struct cs_level_group *last);

/* Sets the solution for the residual of the last level: exactly, or by two smoothings. */
void cs_coarsest_solve(const struct cs_coarsest *coarsest, const struct cs_level_group *last);

#endif
