/* springs.h - the kernels over runs of springs: forces, energies, derivatives and the solver's
 * matrix.
 *
 * Kernels that add to particles come in two calls. `..._to_slots` computes the springs of
 * meshes, by all threads; `cs_springs_add_...` then adds to the particles of one block. With
 * one thread the first does nothing, and the second computes meshes too. */
#ifndef CS_SPRINGS_H
#define CS_SPRINGS_H

#include "model/spring/spring_runs.h"

struct cs_body;

/* Orders the numbers of some runs in the factors of the solver's matrix, from `begin` on.
 * Returns the end of the last one. */
size_t cs_springs_order_factors(struct cs_spring_run *runs, uint32_t n_runs, size_t begin);

/* Appends the runs of one body, whose particles start at `first`, at runs[0..]: those of a
 * cloth's rows, or one per kind of a mesh. lists receives the lengths and stiffnesses of a
 * mesh, 2 doubles per spring. Both may be NULL to count. Kinds of stiffness 0 have no springs,
 * nor has a body with shape matching instead. Returns the number of runs and adds that of
 * springs to *n_springs. */
uint32_t cs_springs_of_body(const struct cs_body *body, uint32_t body_index, uint32_t first,
                            struct cs_spring_run *runs, double *lists, uint32_t *n_springs);

/* Sets a run's stiffness, and its list if it has one, by the law that its body has now. Rest
 * lengths must be set. A list that is up to date is not written. */
void cs_springs_stiffen(struct cs_spring_run *run, const struct cs_body *body);

/* Adds the spring and damper forces of the chosen parts to f (3,n) at the particles of one
 * block, after cs_springs_force_to_slots with the same arguments.
 *
 * For a spring of rest length L, stiffness k and damping c, with unit vector u from end a to
 * end b:
 *
 *   f_a += (k (|x_b - x_a| - L) + c (v_b - v_a).u) u   axial (flag thesis, sec. 2.4)
 *   f_a += k (|x_b - x_a| - L) u + c (v_b - v_a)       relative (cloth thesis, eq. 5.10)
 *
 * and the opposite on b. DBL_MIN is added to the squared length before the root: two particles
 * at one position then feel no spring force, and nothing is divided by 0.
 *
 * If at->dfdx_blocks and at->dfdv_blocks are given, the diagonal blocks of df/dx and df/dv
 * (6,n) of grids are added too, and f may be NULL. cs_springs_finish_diagonal adds the
 * remaining blocks. */
void cs_springs_add_force(const struct cs_springs *springs, uint32_t n,
                          const struct cs_eval *at, double *f);
/* Some rows of grids from a run on, the first of its row, and before end_run: the runs of the
 * result, which add to particles before its `end`. Those before its `begin` have then all that
 * springs give them; after the last run both are n. */
struct cs_block cs_springs_rows(const struct cs_springs *springs, uint32_t n,
                                uint32_t first_run, uint32_t end_run);
/* Computes the forces of meshes into slots, by all threads, before any block. Does nothing if
 * meshes are not shared. */
void cs_springs_force_to_slots(const struct cs_springs *springs, uint32_t n,
                               const struct cs_eval *at);

/* Returns the smallest rest length in m; 0 without springs. */
double cs_springs_shortest(const struct cs_springs *springs);

/* Elastic energy in J of the springs of `parts`: the sum of k (l - L)^2 / 2. Summed run by run
 * in their order, by all threads. */
double cs_springs_energy(const struct cs_springs *springs, uint32_t n, const double *x,
                         uint32_t parts);

/* Largest |l / L - 1| over all springs; NaNs are skipped. 0 without springs. */
double cs_springs_largest_strain(const struct cs_springs *springs, uint32_t n, const double *x);

/* Elastic energy in J that all springs would hold at twice their rest lengths, k L^2 / 2 each.
 */
double cs_springs_energy_at_twice(const struct cs_springs *springs);

/* Adds (df/dx) dx + (df/dv) dv of the chosen parts to df (3,n) at the particles of a block; dx
 * or dv may be NULL, which means 0. cs_springs_jvp_to_slots goes before, as above. */
void cs_springs_add_jvp(const struct cs_springs *springs, uint32_t n, const struct cs_eval *at,
                        double *df);
/* Computes the derivatives of meshes' springs into slots, by all threads, before any block. */
void cs_springs_jvp_to_slots(const struct cs_springs *springs, uint32_t n,
                             const struct cs_eval *at);

/* Adds the remaining diagonal blocks after all blocks of cs_springs_add_force with
 * at->dfdx_blocks and at->dfdv_blocks, which must have been 0 before: xx, xy, xz, yy, yz, zz.
 * The position derivative of axial damping is left out, as in the solver's matrix. */
void cs_springs_finish_diagonal(const struct cs_springs *springs, uint32_t n,
                                const struct cs_eval *at);

/* The springs' part of the matrix in factored form:
 *
 *   A p = sum over the springs of (s I + w w^T) (p_a - p_b), added at a and subtracted at b
 *
 * factors has rows by run: s, wx, wy and wz; of a large grid s and |w| / l, because w is
 * parallel to the spring and x gives it again, to the bit. With psd
 * the transverse part of a compressed spring is dropped (Choi, Ko 2002; Teran et al. 2005);
 * else s may be negative. The position derivative of axial damping, which is not symmetric, is
 * left out. Derivation: springs_matrix.c. */
void cs_springs_factor(const struct cs_springs *springs, uint32_t n,
                       const struct cs_matrix *matrix, double *factors);
/* y += the springs' part of A p, by all threads. x is that of the matrix. */
void cs_springs_mul_add(const struct cs_springs *springs, uint32_t n, const double *factors,
                        const double *x, const double *p, double *y);
/* blocks (6,n) += the diagonal blocks of that matrix. */
void cs_springs_factor_diagonal(const struct cs_springs *springs, uint32_t n,
                                const double *factors, const double *x, double *blocks);

#endif
