/* terms.h - the list of forces, and their sum. */
#ifndef CS_TERMS_H
#define CS_TERMS_H

#include "model/force/term.h"
#include "model/system/particle_system.h"

/* X(name of the struct behind cs_term_) in the order in which forces are summed. Seams are
 * built before contact, which takes sewn particles for one. A test may define CS_TERM_LIST_MORE
 * where it compiles terms.c, to plant forces of its own. */
#ifndef CS_TERM_LIST_MORE
#define CS_TERM_LIST_MORE(X)
#endif
// the formatter would move the list at each run
// clang-format off
#define CS_TERM_LIST(X)                                                                        \
    X(springs) X(membrane) X(bending) X(gravity) X(drag) X(wind) X(airflow) X(pressure) X(gas)  \
    X(push) X(seams) X(contact) X(pairs) X(cover) CS_TERM_LIST_MORE(X)
// clang-format on

#define X(name) extern const struct cs_term cs_term_##name;
CS_TERM_LIST(X)
#undef X

/* Asserts that a force has the calls that its bits ask for, and no half of a pair of calls: a
 * missing one would be left out of a sum without a word. */
void cs_term_assert(const struct cs_term *term);

/* The list; at most CS_TERMS_MAX, as many as a plan has rows for. */
extern const struct cs_term *const cs_terms[];
extern const uint32_t cs_n_terms;

/* f (3,n) = sum of the chosen parts, 0 on pinned particles, by all threads. If a part uses
 * normals (cs_terms_need_normals), they must be up to date. */
void cs_terms_force(const struct cs_system *system, const struct cs_eval *at, double *f);
/* The same, and then a loop (NULL: none) by all threads: row by row if springs are those of
 * grids and other forces need no particle but their own. The loop may change x and v of its
 * range, which nothing reads again. */
void cs_terms_force_then(const struct cs_system *system, const struct cs_eval *at, double *f,
                         const struct cs_loop *loop);
/* df (3,n) = (df/dx) dx + (df/dv) dv of the chosen parts, 0 on pinned particles. Normals as
 * above. */
void cs_terms_jvp(const struct cs_system *system, const struct cs_eval *at, double *df);
/* df (3,n) = (df/dv) v of the forces of CS_PART_LINEARISED without blocks in the matrix, 0 on
 * pinned particles. */
void cs_terms_scalar_damping(const struct cs_system *system, double t, const double *x,
                             const double *v, double *df);
/* The diagonal blocks kxx, dvv (6,n) of df/dx and df/dv of CS_PART_LINEARISED: xx, xy, xz, yy,
 * yz, zz. */
void cs_terms_diagonal(const struct cs_system *system, const struct cs_eval *at, double *kxx,
                       double *dvv);
/* Force and diagonal blocks in one pass over the springs, with the same bits as the two calls
 * above. blocks (12,n) is kxx and then dvv. The parts of at must include the springs. */
void cs_terms_force_diagonal(const struct cs_system *system, const struct cs_eval *at,
                             double *f, double *blocks);

/* blocks (6,n) = the diagonal blocks in a matrix of the terms with one of these parts. */
void cs_terms_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                     uint32_t parts, double *blocks);

/* Adds the diagonal parts of all terms but the springs to the matrix, at particles [begin,
 * end): numbers to diagonal (n), blocks to blocks (6,n). blocks is not used unless
 * cs_terms_have_blocks. */
void cs_terms_add_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                         size_t begin, size_t end, double *diagonal, double *blocks);
/* Lets terms prepare their parts at the matrix's state; must precede cs_terms_add_matrix. kept:
 * products follow, until the next call with kept. With all threads. */
void cs_terms_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                             bool kept);
/* y (3,n) += p times the entries between particles of the terms that have some, without their
 * diagonal blocks, in the matrix kept last. */
void cs_terms_add_product(const struct cs_system *system, const double *p, double *y);
/* y (3,n) = ck df/dx of the forces with blocks times the velocities relative to obstacles, as
 * add_approach of term.h has it; 0 on pinned particles. After cs_terms_prepare_matrix, kept. */
void cs_terms_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                       double *y);
/* Tells whether a force of the scene has 3x3 blocks in the matrix, not only numbers. */
bool cs_terms_have_blocks(const struct cs_system *system);

/* Tells whether the chosen parts need the particle normals in this scene. */
bool cs_terms_need_normals(const struct cs_system *system, uint32_t parts);

/* Arrays (set of enum cs_term_use) that the forces of a scene read, by a plan whose rows of
 * forces are set. */
uint32_t cs_terms_use(const struct cs_scene *scene, const struct cs_plan *plan);

/* --- normals of particles, for the wind --- */

/* Writes system->normals (3,n), by all threads: at each particle the unit vector along (right -
 * left) x (up - down), where the particle itself replaces a missing neighbour (cloth thesis,
 * eq. 4.6-4.9). On a mesh, along the sum of the normals of its triangles, each as long as its
 * triangle is large. Where that vector is 0 the normal is 0. */
void cs_normals_update(const struct cs_system *system, const double *x);

/* The vector along the normal of particle i of a mesh, in m2: the sum of the products
 * (b - a) x (c - a) of its triangles. With at->dx its change. */
void cs_normal_product(const struct cs_system *system, const struct cs_body_range *body,
                       uint32_t i, const struct cs_eval *at, double product[3]);

/* Change dn of the unit normal of particle i of a body when at->x changes along at->dx. */
void cs_normal_derivative(const struct cs_system *system, const struct cs_body_range *body,
                          uint32_t i, const struct cs_eval *at, double dn[3]);

#endif
