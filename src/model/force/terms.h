/* terms.h - the list of forces, and their sum. */
#ifndef CS_TERMS_H
#define CS_TERMS_H

#include "model/force/term.h"

/* X(name of the struct behind cs_term_) in the order in which forces are summed. A test may
 * define CS_TERM_LIST_MORE where it compiles terms.c, to plant forces of its own. */
#ifndef CS_TERM_LIST_MORE
#define CS_TERM_LIST_MORE(X)
#endif
#define CS_TERM_LIST(X)                                                                        \
    X(springs)                                                                                 \
    X(gravity) X(drag) X(wind) X(push) X(contact) X(pairs) X(cover) CS_TERM_LIST_MORE(X)

#define X(name) extern const struct cs_term cs_term_##name;
CS_TERM_LIST(X)
#undef X

/* The list; at most CS_TERMS_MAX, as many as a plan has rows for. */
extern const struct cs_term *const cs_terms[];
extern const uint32_t cs_n_terms;

/* f (3,n) = sum of the chosen parts, 0 on pinned particles; by all threads. What they use of
 * CS_USE_NORMALS must be fresh. */
void cs_terms_force(const struct cs_system *system, const struct cs_eval *at, double *f);
/* df (3,n), 0 on pinned particles. Fresh normals as above. */
void cs_terms_jvp(const struct cs_system *system, const struct cs_eval *at, double *df);
/* The diagonal blocks kxx, dvv (6,n) of CS_PART_LINEARISED: xx, xy, xz, yy, yz, zz. */
void cs_terms_diagonal(const struct cs_system *system, const struct cs_eval *at, double *kxx,
                       double *dvv);
/* Both, to the same bits, in less time: blocks (12,n) is kxx and then dvv. The parts of at, for
 * f, must have the springs. */
void cs_terms_force_diagonal(const struct cs_system *system, const struct cs_eval *at,
                             double *f, double *blocks);

/* blocks (6,n) = the shares in a matrix of the terms with one of these parts. */
void cs_terms_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                     uint32_t parts, double *blocks);

/* Adds the shares of all terms that have none between particles, at particles [begin, end):
 * numbers to diagonal (n), blocks to blocks (6,n), which is not used without
 * cs_terms_have_blocks. */
void cs_terms_add_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                         size_t begin, size_t end, double *diagonal, double *blocks);
/* Before them: what shares have to prepare at the matrix's state. kept: its products are asked
 * for until the next one that is kept. With all threads. */
void cs_terms_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                             bool kept);
/* y (3,n) += the shares of those terms that have some between particles, without the diagonal
 * blocks, of the matrix kept last, times p. */
void cs_terms_add_product(const struct cs_system *system, const double *p, double *y);
bool cs_terms_have_blocks(const struct cs_system *system);

/* true if the chosen parts need the particle normals in this scene */
bool cs_terms_need_normals(const struct cs_system *system, uint32_t parts);

/* What the forces of a scene use together, by a plan whose rows of forces are made. */
uint32_t cs_terms_use(const struct cs_scene *scene, const struct cs_plan *plan);

#endif
